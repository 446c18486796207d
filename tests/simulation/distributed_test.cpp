// SPDX-License-Identifier: MIT
#include <surfleet/simulation/distributed_simulation.hpp>

#include <algorithm>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/planning/named_planners.hpp>

namespace {
using namespace surfleet;

DistributedResult fly(int robots, const DistributedOptions& d, int threads = 1) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.threads = threads;
  DistributedSimulation<box_world::World> simulation(
      o, d, world, box_world::starts(robots),
      [&](RobotId) { return make_planner("tsga", {.standoff = 2.0}); });
  DistributedResult result = simulation.run();
  double least = 1e9;
  const auto& all = result.mission.trajectories;
  for (std::size_t r = 0; r < all.size(); ++r)
    for (std::size_t k = 0; k < all[r].size(); ++k) {
      CHECK(world.bvh.distance(all[r][k].configuration.position) > 0.4);
      for (std::size_t s = 0; s < r; ++s)
        if (k < all[s].size())
          least = std::min(
              least, (all[r][k].configuration.position - all[s][k].configuration.position).norm());
    }
  CHECK(least > 0.8);
  return result;
}

TEST(a_distributed_fleet_ends_with_equal_maps) {
  for (const char* name : {"perfect", "wifi", "poor"}) {
    const DistributedResult r = fly(3, {.network = NetworkConditions::named(name)});
    CHECK(r.mission.complete && r.maps_equal && r.lost.empty());
    CHECK(r.mission.coverage.share() > 0.9);
    CHECK(r.mission.total_path_length() > 5.0);
    for (const std::uint64_t bytes : r.bytes_sent) CHECK(bytes > 1000);
    CHECK((r.dropped[static_cast<std::size_t>(NetworkDrop::loss)] > 0) ==
          (std::string(name) != "perfect"));
  }
}
TEST(one_robot_of_a_distributed_fleet_works_alone) {
  const DistributedResult r = fly(1, {});
  CHECK(r.mission.complete && r.maps_equal && r.mission.coverage.share() > 0.9);
}
TEST(threads_change_nothing_of_a_distributed_fleet) {
  const DistributedOptions d{.network = NetworkConditions::named("poor")};
  const DistributedResult a = fly(2, d, 1), b = fly(2, d, 2);
  CHECK(a.mission.completion_time == b.mission.completion_time);
  CHECK(a.bytes_sent == b.bytes_sent);
  for (std::size_t r = 0; r < 2; ++r)
    CHECK(a.mission.trajectories[r].back().configuration.position ==
          b.mission.trajectories[r].back().configuration.position);
}
TEST(a_fleet_goes_on_without_who_is_lost) {
  for (const auto kind : {FleetEvent::Kind::killed, FleetEvent::Kind::vanished})
    for (const double time : {3.0, 20.0}) {
      DistributedOptions d;
      d.events = {{.time = time, .robot = 1, .kind = kind}};
      const DistributedResult r = fly(3, d);
      CHECK(r.mission.complete && r.maps_equal && r.lost.size() == 1);
      CHECK(r.mission.coverage.share() > 0.9);
    }
}
TEST(a_parted_fleet_comes_together) {
  DistributedOptions d;
  d.network.partitions = {{.from = 2.0, .until = 30.0, .groups = {{0}, {1, 2}}}};
  const DistributedResult r = fly(3, d);
  CHECK(r.mission.complete && r.maps_equal && r.mission.coverage.share() > 0.9);
  CHECK(r.dropped[static_cast<std::size_t>(NetworkDrop::partition)] > 0);
}
}  // namespace
