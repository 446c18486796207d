// SPDX-License-Identifier: MIT
#include <surfleet/simulation/marker_sight.hpp>

#include <algorithm>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/simulation/simulation.hpp>

namespace {
using namespace surfleet;

TEST(robots_are_where_their_lights_are_seen_within_the_error_told) {
  const Bvh far_off(make_box({Point3(90, 90, 90), Point3(91, 91, 91)}));
  MarkerSight sight(far_off, 3);
  std::vector<Configuration> fleet{{{0, 0, 0}, 0.3}, {{4, 1, 0.5}, 0.0}, {{-2, -3, 0.2}, 2.0}};
  Random random(7);
  int seen = 0, within = 0, shots = 0;
  std::vector<double> errors;
  for (std::uint64_t shot = 0; shot < 200; ++shot) {
    for (std::size_t k = 0; k < 3; ++k) {
      fleet[k].position += 0.15 * Point3(random.normal(), random.normal(), random.normal());
      fleet[k].yaw += 0.1 * random.normal();
    }
    for (std::size_t r = 0; r < 3; ++r) {
      const std::vector<SeenRobot> found = sight(r, shot, fleet);
      for (std::size_t k = 0; k < 3; ++k) {
        if (k == r || (fleet[k].position - fleet[r].position).norm() > 6.0) continue;
        ++shots;
        // Both cameras may see it; the better one counts.
        double least = 1e9;
        bool told = false;
        for (const SeenRobot& n : found) {
          const double off = (n.position - fleet[k].position).norm();
          least = std::min(least, off);
          told = told || off <= n.error;
        }
        seen += least < 1.0 ? 1 : 0;
        within += told ? 1 : 0;
        if (least < 1.0) errors.push_back(least);
      }
    }
  }
  CHECK(shots > 500);
  CHECK(seen >= 0.98 * shots);
  CHECK(within >= 0.95 * shots);
  std::sort(errors.begin(), errors.end());
  CHECK(errors[errors.size() / 2] < 0.05);
  CHECK(errors[errors.size() * 95 / 100] < 0.2);
}
TEST(what_stands_between_hides_lights_and_who_is_far_is_not_seen) {
  const Bvh wall(make_box({Point3(1.9, -5, -5), Point3(2.1, 5, 5)}));
  const std::vector<Configuration> apart{{{0, 0, 0}, 0.0}, {{4, 0, 0}, 0.0}, {{-14, 0, 0}, 0.0}};
  CHECK(MarkerSight(wall, 3)(0, 0, apart).empty());
  const std::vector<Configuration> beside{{{0, 0, 0}, 0.0}, {{-4, 0, 0}, 0.0}, {{-14, 0, 0}, 0.0}};
  CHECK(MarkerSight(wall, 3)(0, 0, beside).size() == 1);
}
TEST(sight_by_markers_refuses_what_tells_no_pose) {
  const Bvh wall(make_box({Point3(1.9, -5, -5), Point3(2.1, 5, 5)}));
  MarkerSightOptions line;
  line.target.markers = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  CHECK_THROWS(Error, MarkerSight(wall, 2, line));
  MarkerSightOptions blind;
  blind.T_body_camera.clear();
  CHECK_THROWS(Error, MarkerSight(wall, 2, blind));
  CHECK_THROWS(Error, MarkerSight(wall, 0));
}

/// Each of two to where the other began, straight through it.
struct ChangePlaces {
  std::vector<Configuration> starts;
  Plan operator()(const SurfaceSituation& situation) {
    Plan plan;
    for (const RobotState& robot : situation.team)
      plan.routes[robot.id] = Stops{{starts[1 - robot.id], {}}};
    return plan;
  }
};
double least_separation(const NeighbourSense& sense, int threads) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.start_clearance = 4.5;
  o.announces = false;
  o.neighbours = sense;
  o.max_time = 20.0;
  o.threads = threads;
  const std::vector<Configuration> starts{{{-3.5, -2.5, 1.0}, 0.5 * kPi}, {{-3.5, 2.5, 1.0}, 0.0}};
  Simulation<ChangePlaces, box_world::World> mission(o, world, starts, ChangePlaces{starts});
  const MissionResult result = mission.run();
  double least = 1e9;
  for (std::size_t k = 0; k < result.trajectories[0].size(); ++k)
    least = std::min(least, (result.trajectories[0][k].configuration.position -
                             result.trajectories[1][k].configuration.position)
                                .norm());
  return least;
}
TEST(robots_that_tell_nothing_keep_apart_by_sight_alone) {
  const box_world::World world;
  const auto blind = [](std::size_t, std::uint64_t, std::span<const Configuration>) {
    return std::vector<SeenRobot>{};
  };
  const double by_sight = least_separation(MarkerSight(world.bvh, 2), 1);
  CHECK(by_sight > 0.8);
  CHECK(least_separation(blind, 1) < 0.8);  // they would have met
  CHECK(least_separation(MarkerSight(world.bvh, 2), 2) == by_sight);
}
}  // namespace
