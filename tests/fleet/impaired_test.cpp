// SPDX-License-Identifier: MIT
#include <surfleet/fleet/impaired.hpp>

#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <surfleet/fleet/packet.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
struct Parcel {
  int id = 0;
  std::size_t size = 100;
  std::uint8_t kind = 0;
};
std::size_t byte_size(const Parcel& p) { return p.size; }
std::uint8_t kind_of(const Parcel& p) { return p.kind; }
static_assert(NetworkPayload<Parcel> && NetworkPayload<Packet> && !NetworkPayload<int>);
static_assert(Transport<SimulatedNetwork<Packet>>);
static_assert(Transport<Impaired<Impaired<PerfectTransport<Packet>>>>);
using ParcelNetwork = SimulatedNetwork<Parcel>;

struct Arrival {
  int id;
  double time;
};
/// Sends `count` parcels, one every 10 ms, and tells what robot 1 receives and when.
std::vector<Arrival> sent_through(ParcelNetwork& network, int count, double until) {
  std::vector<Arrival> arrived;
  int next = 0;
  for (int tick = 0; tick * 0.01 < until; ++tick) {
    network.advance(tick * 0.01);
    if (next < count) {
      network.send({.time = tick * 0.01, .from = 0, .payload = {.id = next}});
      ++next;
    }
    for (const Message<Parcel>& m : network.receive(1))
      arrived.push_back({m.payload.id, tick * 0.01});
  }
  return arrived;
}
}  // namespace

TEST(a_network_without_conditions_is_perfect) {
  ParcelNetwork network(3);
  network.send({.time = 0.5, .from = 2, .payload = {.id = 7, .size = 10}});
  network.send({.time = 0.2, .from = 0, .to = 1, .payload = {.id = 8, .size = 1000, .kind = 3}});
  const auto got = network.receive(1);
  CHECK(got.size() == 2 && got[0].payload.id == 8 && got[1].payload.id == 7);
  CHECK(network.receive(0).size() == 1 && network.receive(2).empty());
  CHECK(network.bytes_sent(2) == 10 && network.bytes_sent(0) == 1000 && network.bytes_sent(1) == 0);
  CHECK(network.bytes_sent(0, 3) == 1000 && network.bytes_sent(0, 0) == 0);
  CHECK(network.bytes_sent_by_kind(0) == 10 && network.bytes_sent_by_kind(3) == 1000);
  CHECK_THROWS(Error, network.send({.from = 3}));
  network.advance(1.0);
  CHECK_THROWS(Error, network.advance(0.5));
}

TEST(loss_duplication_and_order_are_what_was_said) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    ParcelNetwork network(
        2, {.loss = 0.3, .duplication = 0.2, .latency = 0.05, .jitter = 0.03, .seed = seed});
    const auto arrived = sent_through(network, 4000, 42.0);
    std::map<int, int> times;
    for (const Arrival& a : arrived) ++times[a.id];
    std::size_t twice = 0;
    for (const auto& [id, n] : times) twice += n == 2 ? 1 : 0;
    CHECK_NEAR(times.size(), 2800, 120);
    CHECK_NEAR(twice, 0.2 * 2800, 80);
    CHECK(network.dropped(NetworkDrop::loss) + times.size() == 4000);
    // In order, as nothing is held back, and within latency ± jitter and a tick.
    for (std::size_t i = 1; i < arrived.size(); ++i) CHECK(arrived[i - 1].id <= arrived[i].id);
    for (const Arrival& a : arrived)
      CHECK(a.time - 0.01 * a.id >= 0.02 - 1e-9 && a.time - 0.01 * a.id <= 0.09 + 1e-9);
  }
  ParcelNetwork network(2, {.reordering = 0.2, .latency = 0.05});
  const auto arrived = sent_through(network, 1000, 12.0);
  std::size_t overtaken = 0;
  int latest = -1;
  for (const Arrival& a : arrived) {
    overtaken += a.id < latest ? 1 : 0;
    latest = std::max(latest, a.id);
  }
  CHECK(arrived.size() == 1000 && overtaken > 100 && overtaken < 220);
}

TEST(the_same_seed_gives_the_same_whatever_else_is_sent) {
  const NetworkConditions conditions{
      .loss = 0.3, .duplication = 0.1, .reordering = 0.1, .latency = 0.05, .seed = 9};
  ParcelNetwork a(2, conditions), b(4, conditions);
  for (int i = 0; i < 200; ++i) b.send({.from = 3, .payload = {.id = 5000}});
  const auto alone = sent_through(a, 500, 7.0);
  auto beside = sent_through(b, 500, 7.0);
  std::erase_if(beside, [](const Arrival& x) { return x.id == 5000; });
  CHECK(alone.size() == beside.size());
  for (std::size_t i = 0; i < alone.size() && i < beside.size(); ++i)
    CHECK(alone[i].id == beside[i].id && alone[i].time == beside[i].time);
}

TEST(bandwidth_queues_and_the_urgent_go_first) {
  // 8000 bit/s: 1000 bytes a second.
  ParcelNetwork network(2, {.bandwidth = 8000.0, .queue_bytes = 5000});
  for (int i = 0; i < 4; ++i)
    network.send({.from = 0, .payload = {.id = i, .size = 1000, .kind = 4}});
  network.advance(0.5);  // the first is on the air
  network.send({.from = 0, .payload = {.id = 10, .size = 500, .kind = 0}});
  std::map<int, double> at;
  for (int tick = 0; tick <= 100; ++tick) {
    network.advance(0.5 + 0.05 * tick);
    for (const auto& m : network.receive(1)) at[m.payload.id] = network.time();
  }
  CHECK_NEAR(at[0], 1.0, 0.051);
  CHECK_NEAR(at[10], 1.5, 0.051);
  CHECK_NEAR(at[1], 2.5, 0.051);
  CHECK_NEAR(at[3], 4.5, 0.051);
  CHECK(network.bytes_sent(0) == 4500 && network.dropped(NetworkDrop::queue) == 0);
  // What does not fit is dropped, the least urgent first.
  for (int i = 0; i < 7; ++i)
    network.send({.from = 0, .payload = {.id = 20 + i, .size = 1000, .kind = 4}});
  network.send({.from = 0, .payload = {.id = 30, .size = 1000, .kind = 1}});
  CHECK(network.dropped(NetworkDrop::queue) == 3);
  network.advance(30.0);
  std::set<int> got;
  for (const auto& m : network.receive(1)) got.insert(m.payload.id);
  CHECK(got == std::set<int>({20, 21, 22, 23, 30}));
}

TEST(partitions_cuts_range_and_sight_part_robots) {
  ParcelNetwork network(4, {.range = 10.0,
                            .line_of_sight = true,
                            .partitions = {{.from = 1.0, .until = 2.0, .groups = {{0, 1}}}},
                            .cuts = {{.from = 3.0, .until = 4.0, .sender = 0, .receiver = 1}}});
  std::vector<Point3> at{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  CHECK_THROWS(Error, network.send({.from = 0}));
  network.position = [&](RobotId robot) { return at[robot]; };
  CHECK_THROWS(Error, network.send({.from = 0}));
  network.line_of_sight = [](const Point3&, const Point3&) { return true; };
  const auto heard = [&](double time) {
    network.advance(time);
    for (RobotId from = 0; from < 4; ++from) network.send({.from = from});
    std::set<std::pair<RobotId, RobotId>> pairs;
    for (RobotId to = 0; to < 4; ++to)
      for (const auto& m : network.receive(to)) pairs.insert({m.from, to});
    return pairs;
  };
  CHECK(heard(0.0).size() == 12);
  CHECK(heard(1.0) == (std::set<std::pair<RobotId, RobotId>>{{0, 1}, {1, 0}, {2, 3}, {3, 2}}));
  CHECK(heard(2.0).size() == 12);
  const auto cut = heard(3.0);
  CHECK(cut.size() == 11 && !cut.contains({0, 1}) && cut.contains({1, 0}));
  at[3] = {11.5, 0, 0};
  const auto far = heard(5.0);
  CHECK(far.size() == 8 && far.contains({3, 2}) && !far.contains({3, 1}));
  network.line_of_sight = [](const Point3& a, const Point3& b) {
    return (a.x() < 1.5) == (b.x() < 1.5);
  };
  CHECK(heard(6.0) == (std::set<std::pair<RobotId, RobotId>>{{0, 1}, {1, 0}, {2, 3}, {3, 2}}));
  CHECK(network.dropped(NetworkDrop::partition) == 8 + 1);
  CHECK(network.dropped(NetworkDrop::out_of_range) == 4 + 8);
}

TEST(networks_that_are_none_are_refused) {
  CHECK(NetworkConditions::named("poor").loss == 0.3 &&
        !NetworkConditions::named("perfect").bandwidth);
  CHECK_THROWS(Error, NetworkConditions::named("good"));
  CHECK_THROWS(Error, ParcelNetwork(2, {.loss = 1.5}));
  CHECK_THROWS(Error, ParcelNetwork(2, {.latency = 0.1, .jitter = 0.2}));
  CHECK_THROWS(Error, ParcelNetwork(2, {.latency = std::nan("")}));
  CHECK_THROWS(Error, ParcelNetwork(2, {.bandwidth = 0.0}));
  CHECK_THROWS(Error,
               ParcelNetwork(2, {.partitions = {{.from = 2.0, .until = 1.0, .groups = {}}}}));
}

TEST(conditions_go_around_any_transport) {
  // Twice impaired: latencies add.
  using Once = Impaired<PerfectTransport<Parcel>>;
  Once inner({.latency = 0.0}, PerfectTransport<Parcel>(2), {0, 1});
  Impaired<Once> outer({.latency = 0.2}, std::move(inner), {0, 1});
  outer.send({.from = 0, .payload = {.id = 4}});
  CHECK(outer.receive(1).empty());
  outer.advance(0.21);
  CHECK(outer.receive(1).size() == 1 && outer.receive(1).empty());
  // A message that comes from elsewhere is late from when it is first seen.
  outer.inner().send({.from = 0, .payload = {.id = 5}});
  CHECK(outer.receive(1).empty());
  outer.advance(0.42);
  CHECK(outer.receive(1).size() == 1);
}
