// SPDX-License-Identifier: MIT
#include <surfleet/core/transport.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "check.hpp"

#include <surfleet/core/random.hpp>

namespace {
using namespace surfleet;

TEST(messages_arrive_once_by_time_sender_and_sequence_however_they_were_sent) {
  constexpr std::size_t kRobots = 4;
  std::vector<std::vector<Message<int>>> results;
  for (const std::uint64_t seed : {1U, 2U}) {
    // Every sender's own messages stay in their order; between senders it is anybody's guess.
    std::vector<RobotId> turns;
    for (RobotId r = 0; r < kRobots; ++r) turns.insert(turns.end(), 50, r);
    Random random(seed);
    for (std::size_t i = turns.size(); i > 1; --i)
      std::swap(turns[i - 1], turns[random.below(static_cast<std::uint32_t>(i))]);
    PerfectTransport<int> air(kRobots);
    std::size_t told = 0;
    air.on_send = [&](const Message<int>&) { ++told; };
    std::vector<int> count(kRobots, 0);
    for (const RobotId from : turns) {
      const int n = count[from]++;
      air.send({.time = 0.1 * (n / 7),
                .from = from,
                .to = n % 3 == 0 ? std::optional<RobotId>(0) : std::nullopt,
                .payload = n});
    }
    CHECK(told == turns.size());
    std::vector<Message<int>> got = air.receive(0);
    CHECK(got.size() == 50 * (kRobots - 1) + 17);  // a robot may write to itself, but not to all
    CHECK(air.receive(0).empty());
    CHECK(air.receive(1).size() == 33 * (kRobots - 1));
    for (std::size_t i = 1; i < got.size(); ++i) {
      const auto &a = got[i - 1], &b = got[i];
      CHECK(
          a.time < b.time ||
          (a.time == b.time && (a.from < b.from || (a.from == b.from && a.sequence < b.sequence))));
      CHECK(static_cast<int>(b.sequence) == b.payload);
    }
    results.push_back(std::move(got));
  }
  CHECK(std::equal(results[0].begin(), results[0].end(), results[1].begin(), results[1].end(),
                   [](const auto& a, const auto& b) {
                     return a.from == b.from && a.sequence == b.sequence && a.to == b.to;
                   }));
}

TEST(who_is_not_there_neither_sends_nor_receives) {
  PerfectTransport<int> air(2);
  CHECK_THROWS(Error, air.send({.from = 2, .payload = 1}));
  CHECK_THROWS(Error, air.send({.from = 0, .to = 5, .payload = 1}));
  CHECK_THROWS(Error, air.receive(7));
  CHECK(air.sent(0) == 0 && air.receive(1).empty());
}
}  // namespace
