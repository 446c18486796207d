// SPDX-License-Identifier: MIT
#include <surfleet/fleet/team_agreement.hpp>

#include <set>
#include <string>

#include "check.hpp"

namespace {
using namespace surfleet;

TeamAgreement agreed_by(RobotId robot) {
  return {.team = "alpha",
          .robot = robot,
          .robots = 3,
          .voxel = 0.3,
          .truncation = 0.1 + 0.2,  // not a short number
          .known_weight = 1.0 / 3.0,
          .image_weight = 0.25,
          .range = 5.1};
}
bool says(const TeamAgreement& theirs, const std::string& word) {
  const auto why = disagreement(agreed_by(0), theirs);
  return why && why->find(word) != why->npos;
}
}  // namespace

TEST(robots_that_agree_read_each_others_notes) {
  const TeamAgreement two = agreed_by(1);
  const auto read = TeamAgreement::read(two.note());
  CHECK(read && read->robot == 1 && read->note() == two.note());
  CHECK(!disagreement(agreed_by(0), *read));
  CHECK(agreed_by(0).number() == two.number());
}
TEST(what_differs_is_said_and_marks_packets) {
  std::set<std::uint32_t> numbers{agreed_by(0).number()};
  const auto other = [&](auto change, const std::string& word) {
    TeamAgreement theirs = agreed_by(1);
    change(theirs);
    CHECK(says(*TeamAgreement::read(theirs.note()), word));
    CHECK(numbers.insert(theirs.number()).second);
  };
  other([](TeamAgreement& a) { a.team = "beta"; }, "beta");
  other([](TeamAgreement& a) { a.protocol = 7; }, "protocol 7");
  other([](TeamAgreement& a) { a.robots = 4; }, "team of 4");
  other([](TeamAgreement& a) { a.voxel = 0.31; }, "voxels of 0.31");
  other([](TeamAgreement& a) { a.truncation = 0.3; }, "truncation of 0.3");
  other([](TeamAgreement& a) { a.known_weight = 0.5; }, "weight of 0.5");
  other([](TeamAgreement& a) { a.image_weight = 1.0; }, "weigh at 2 m 1;");
  other([](TeamAgreement& a) { a.range = 30.0; }, "range of 30;");
  other([](TeamAgreement& a) { a.packing = 1; }, "packed by 1");
  CHECK(says(agreed_by(0), "robot 1 of team alpha is alive elsewhere"));
}
TEST(notes_that_are_none_are_passed_over) {
  for (const char* note :
       {"", "surfleet", "surfleet,alpha,1", "other,alpha,1,5,3,0.3,0.9,0.3,1,5,0",
        "surfleet,alpha,-1,5,3,0.3,0.9,0.3,1,5,0", "surfleet,alpha,1,5,3,0.3,0.9,0.3,1,5",
        "surfleet,alpha,1,5,3,x,0.9,0.3,1,5,0", "surfleet,alpha,1,5,3,0.3,0.9,0.3,1,5,-1",
        "surfleet,alpha,1,5,3,0.3,0.9,0.3,1,5,0,4"})
    CHECK(!TeamAgreement::read(note));
  for (const char* team : {"a\nb", "\x1b[2J", "a b", "\xc3\xa4"})
    CHECK(!TeamAgreement::read("surfleet," + std::string(team) + ",1,5,3,0.3,0.9,0.3,1,5,0"));
  CHECK(!TeamAgreement::read(std::string(100000, ',')));
  CHECK(TeamAgreement::read("surfleet,alpha,1,7,whatever")->protocol == 7);
  CHECK(TeamAgreement::read("surfleet,alpha,1,5,3,0.3,0.9,0.3,1,5,1")->packing == 1);
}
