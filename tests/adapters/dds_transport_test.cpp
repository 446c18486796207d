// SPDX-License-Identifier: MIT
// requires: dds
#include <surfleet/adapters/dds_bodies.hpp>
#include <surfleet/adapters/dds_team.hpp>
#include <surfleet/adapters/dds_transport.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "check.hpp"

namespace {
using namespace surfleet;

constexpr std::uint32_t kTeam = 7;

/// A team's name that no other process uses at the same time.
DdsOptions team(const std::string& name) {
  return {.domain = 71, .team = name + std::to_string(getpid())};
}
bool within(double seconds, const std::function<bool()>& done) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}
std::vector<std::unique_ptr<DdsTransport>> fleet(std::size_t robots, const DdsOptions& options) {
  std::vector<std::unique_ptr<DdsTransport>> all;
  for (RobotId r = 0; r < robots; ++r) all.push_back(std::make_unique<DdsTransport>(r, options));
  return all;
}
bool all_met(const std::vector<std::unique_ptr<DdsTransport>>& all) {
  return within(20.0, [&] {
    for (const auto& air : all)
      if (air->listeners() + 1 < all.size()) return false;
    return true;
  });
}
Message<Packet> message(RobotId from, MessageKind kind, std::size_t size,
                        std::optional<RobotId> to = {}, std::uint32_t number = 0) {
  const Bytes body(size, std::byte{static_cast<unsigned char>(number)});
  return {.time = number * 0.5,
          .from = from,
          .to = to,
          .payload =
              seal({.kind = kind, .team = kTeam, .sender = from, .number = number, .body = body})};
}
/// What comes in the seconds that follow, until there are so many.
std::vector<Message<Packet>> heard(DdsTransport& air, RobotId robot, std::size_t count,
                                   double seconds = 10.0) {
  std::vector<Message<Packet>> all;
  within(seconds, [&] {
    for (auto& m : air.receive(robot)) all.push_back(std::move(m));
    return all.size() >= count;
  });
  return all;
}

TEST(robots_hear_each_other_over_dds_and_not_themselves) {
  auto air = fleet(3, team("three"));
  CHECK(all_met(air));
  for (std::uint32_t k = 0; k < 10; ++k) air[0]->send(message(0, MessageKind::patch, 50000, {}, k));
  air[1]->send(message(1, MessageKind::request, 20, RobotId{2}));
  const auto one = heard(*air[1], 1, 10), two = heard(*air[2], 2, 11);
  CHECK(one.size() == 10 && two.size() == 11);
  for (const auto& m : one) {
    CHECK(m.from == 0 && !m.to && m.payload.kind == MessageKind::patch);
    CHECK(byte_size(m.payload) > 50000 && m.time == m.sequence * 0.5);
  }
  CHECK(std::any_of(two.begin(), two.end(),
                    [](const auto& m) { return m.from == 1 && m.to == RobotId{2}; }));
  CHECK(heard(*air[0], 0, 1, 0.3).empty());
  CHECK(air[0]->counts().bytes_sent[static_cast<std::size_t>(MessageKind::patch)] > 500000);
  CHECK_THROWS(Error, air[0]->send(message(1, MessageKind::state, 1)));
  CHECK_THROWS(Error, air[0]->receive(1));
}
TEST(who_comes_late_hears_the_last_digest_but_no_patch) {
  DdsTransport early(0, team("late"));
  for (std::uint32_t k = 1; k <= 5; ++k) {
    early.send(message(0, MessageKind::digest, 100, {}, k));
    early.send(message(0, MessageKind::patch, 100, {}, k));
  }
  DdsTransport late(1, team("late"));
  const auto found = heard(late, 1, 2, 3.0);
  CHECK(found.size() == 1 && found[0].payload.kind == MessageKind::digest && found[0].time == 2.5);
}
TEST(memory_is_bounded_whatever_senders_call_themselves) {
  DdsOptions options = team("many");
  options.robots = 4;
  DdsTransport victim(0, options);
  const DdsTeam liar(1, options);
  const detail::DdsQos qos(dds_create_qos()), own = liar.own_partition("robot");
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(1));
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t topic = dds_create_topic(liar.participant(), &surfleet_dds_FleetMessage_desc,
                                              "surfleet_patch", nullptr, nullptr);
  const dds_entity_t writer = dds_create_writer(
      dds_create_publisher(liar.participant(), own.get(), nullptr), topic, qos.get(), nullptr);
  CHECK(within(20.0, [&] {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer, &status);
    return status.current_count == 1;
  }));
  for (std::uint32_t k = 0; k < 300; ++k) {
    surfleet_dds_FleetMessage m{};
    m.sender = 4 + k;  // no robot's
    std::uint8_t octet = 0;
    m.bytes._length = m.bytes._maximum = 1;
    m.bytes._buffer = &octet;
    dds_write(writer, &m);  // which is not taken in for as long as there is no room
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(victim.receive(0).empty());
  CHECK(victim.counts().unreadable > 0 && victim.counts().unreadable <= 4 * 16);
  // Its mates are heard as ever.
  DdsTransport mate(2, options);
  CHECK(within(20.0, [&] { return mate.listeners() == 1; }));
  mate.send(message(2, MessageKind::patch, 10));
  CHECK(heard(victim, 0, 1).size() == 1);
}
TEST(messages_of_all_kinds_have_one_order) {
  auto air = fleet(2, team("order"));
  CHECK(all_met(air));
  const std::array<MessageKind, 3> kinds{MessageKind::patch, MessageKind::route,
                                         MessageKind::request};
  for (std::uint32_t k = 0; k < 9; ++k) air[0]->send(message(0, kinds[k % 3], 10));
  const auto all = heard(*air[1], 1, 9);
  CHECK(all.size() == 9);
  std::vector<std::uint32_t> numbers;
  for (const auto& m : all) numbers.push_back(m.sequence);
  std::sort(numbers.begin(), numbers.end());
  CHECK(std::adjacent_find(numbers.begin(), numbers.end()) == numbers.end());
}
TEST(teams_do_not_hear_each_other) {
  DdsTransport ours(0, team("ours")), theirs(1, team("theirs")), mate(2, team("ours"));
  CHECK(within(20.0, [&] { return ours.listeners() == 1; }));
  ours.send(message(0, MessageKind::route, 10));
  CHECK(heard(mate, 2, 1).size() == 1);
  CHECK(heard(theirs, 1, 1, 0.3).empty());
}
TEST(others_of_the_network_are_found_with_their_notes) {
  DdsOptions alpha = team("alpha"), beta = team("beta");
  alpha.domain = beta.domain = 73;  // where no one else is
  alpha.note = "first";
  const DdsTeam one(0, alpha);
  CHECK(one.others().empty());
  beta.note = std::string("sec\0nd", 6);
  {
    const DdsTeam two(0, beta);
    CHECK(within(20.0, [&] { return one.others().size() == 1 && two.others().size() == 1; }));
    CHECK(one.others() == std::vector<std::string>{beta.note});
    CHECK(two.others() == std::vector<std::string>{"first"});
  }
  CHECK(within(20.0, [&] { return one.others().empty(); }));
}
TEST(bodies_tell_where_they_are_and_stay_where_they_were_last) {
  const auto join = [](RobotId id) { return std::make_shared<DdsTeam>(id, team("bodies")); };
  DdsBodies one(join(0));
  {
    DdsBodies two(join(1));
    CHECK(within(20.0, [&] {
      two.tell({{1.0, 2.0, 3.0}, 0.5});
      return one.others().contains(1);
    }));
    two.tell({{1.0, 2.0, 4.0}, 0.25});
    CHECK(within(10.0, [&] { return one.others().at(1).position.z() == 4.0; }));
    CHECK(two.others().empty());
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(one.others().at(1).position == Point3(1.0, 2.0, 4.0) && one.others().at(1).yaw == 0.25);
  CHECK(one.others().size() == 1);
}
TEST(dds_options_that_cannot_be_are_refused) {
  CHECK_THROWS(Error, DdsTransport(64, team("x")));
  CHECK_THROWS(Error, DdsTransport(0, {.team = "a/b"}));
  CHECK_THROWS(Error, DdsTransport(0, {.team = ""}));
  CHECK_THROWS(Error, dds_configuration({.peers = {"\"/><x"}}));
  CHECK_THROWS(Error, dds_configuration({.peers = {}}));
  CHECK(dds_configuration({.most_bytes = 1000}).find(">2024B<") != std::string::npos);
  CHECK_THROWS(Error, dds_configuration({.lease = -1.0}));
  CHECK_THROWS(Error, dds_configuration({.lost_packets = 1.0}));
  DdsOptions unkeyed = team("x");
  unkeyed.security = "/nowhere";
  CHECK_THROWS(Error, DdsTeam(0, unkeyed));
}
}  // namespace
