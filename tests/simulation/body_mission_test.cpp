// SPDX-License-Identifier: MIT
#include <surfleet/adapters/fcl_body_judge.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/body_judge.hpp>
#include <surfleet/simulation/fly_mission.hpp>

#include <algorithm>
#include <memory>
#include <vector>

#include <fcl/geometry/shape/ellipsoid.h>

#include "box_world.hpp"
#include "check.hpp"

namespace {
using namespace surfleet;

struct Flight {
  MissionResult result;
  JudgeReport shape, ball;
};
Flight fly_flat_drones(int threads) {
  const box_world::World world;
  const EllipsoidBody body{{0.5, 0.4, 0.15}};
  MissionOptions o = box_world::options(world);
  o.kind.take_shape(body);
  o.start_clearance = 2.2;
  o.max_time = 40.0;
  o.threads = threads;
  Flight f;
  f.result = fly_mission(o, world, box_world::starts(2), make_planner("surfleet")).result;
  std::vector<std::vector<Configuration>> paths;
  std::vector<std::vector<Point3>> centers;
  for (const auto& trajectory : f.result.trajectories) {
    paths.emplace_back();
    centers.emplace_back();
    for (const TimedConfiguration& t : trajectory) {
      paths.back().push_back(t.configuration);
      centers.back().push_back(t.configuration.position);
    }
  }
  f.ball = judge_paths(world.bvh, centers, body.bounding_radius());
  f.shape = f.ball;
  const MeshJudge mesh(world.mesh);
  const FclBodyJudge judge(
      mesh, FclBody(std::make_shared<fcl::Ellipsoidd>(body.semi_axes), body.inscribed_radius()));
  judge_bodies(judge, paths, body.bounding_radius(), f.shape);
  return f;
}
}  // namespace

TEST(flat_drones_fly_without_a_touch_the_same_on_two_threads) {
  const Flight one = fly_flat_drones(1), two = fly_flat_drones(2);
  CHECK(one.result.images > 50 && one.result.total_path_length() > 20.0);
  CHECK(one.shape.collisions == 0 && one.shape.min_clearance_m > 0.0);
  // The ball around it lies about the body, and the ball within it in the body.
  CHECK(one.shape.min_clearance_m >= one.ball.min_clearance_m - 1e-3);
  CHECK(one.shape.min_clearance_m <= one.ball.min_distance_m - 0.15 + 1e-3);
  CHECK(one.result.trajectories.size() == two.result.trajectories.size());
  for (std::size_t r = 0; r < one.result.trajectories.size(); ++r) {
    const auto &a = one.result.trajectories[r], &b = two.result.trajectories[r];
    CHECK(a.size() == b.size());
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
      CHECK(a[k].configuration == b[k].configuration);
  }
}
