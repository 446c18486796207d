// SPDX-License-Identifier: MIT
// Missions of robots that see with a LiDAR.
#include <surfleet/simulation/lidar_world.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/fly_distributed.hpp>
#include <surfleet/simulation/fly_mission.hpp>

namespace {
using namespace surfleet;

using LidarBox = LidarWorld<Bvh>;

MissionOptions lidar_options() {
  MissionOptions o = box_world::options(box_world::World{});
  carry(o.kind, box_world::lidar());
  o.belief.integrator =
      TsdfIntegrator({}, drop_off_by_voxels(o.belief.voxel_size, ConstantWeight{}));
  return o;
}
/// No robot hits the box or a teammate, none turns, and the box is mapped.
void judge_lidar_mission(const MissionResult& result, const TsdfMap& map) {
  const box_world::World box;
  for (std::size_t r = 0; r < result.trajectories.size(); ++r)
    for (std::size_t k = 0; k < result.trajectories[r].size(); ++k) {
      const Configuration& q = result.trajectories[r][k].configuration;
      CHECK(box.bvh.distance(q.position) > 0.4 && std::abs(q.yaw) < 1e-9);
      for (std::size_t s = 0; s < r; ++s)
        CHECK((result.trajectories[s][k].configuration.position - q.position).norm() > 0.8);
    }
  CHECK(box_world::mapped_share(box, map, 0.3) > 0.95);
}
TEST(robots_with_a_lidar_reconstruct_a_box_on_any_number_of_threads) {
  const box_world::World box;
  for (const char* planner : {"surfleet", "tsga"}) {
    std::vector<FlownMission> flown;
    for (const int threads : {1, 2}) {
      LidarBox world(box.bvh, RotatingLidar(box_world::lidar(), 0.01), {.body_radius = 0.2});
      MissionOptions o = lidar_options();
      o.threads = threads;
      flown.push_back(
          fly_mission(o, world, box_world::starts(2), make_planner(planner, {.standoff = 2.0})));
    }
    const MissionResult& one = flown[0].result;
    judge_lidar_mission(one, flown[0].map);
    CHECK(one.complete);
    CHECK(one.completion_time == flown[1].result.completion_time);
    CHECK(one.path_length == flown[1].result.path_length);
    CHECK(equal_maps(flown[0].map, flown[1].map));
    CHECK(one.traffic.images == 2 * one.images * box_world::lidar().beams());
  }
}
TEST(robots_with_a_lidar_plan_at_once) {
  const box_world::World box;
  LidarBox world(box.bvh, RotatingLidar(box_world::lidar()));
  MissionOptions o = lidar_options();
  o.max_time = 1.0;
  CHECK(fly_mission(o, world, box_world::starts(1), make_planner("tsga")).result.plans > 0);
}
TEST(a_distributed_fleet_shares_what_its_lidars_see) {
  const box_world::World box;
  LidarBox world(box.bvh, RotatingLidar(box_world::lidar(), 0.01), {.body_radius = 0.2});
  const FlownDistributed flown =
      fly_distributed(lidar_options(), {}, world, box_world::starts(2),
                      [](RobotId) { return make_planner("tsga", {.standoff = 2.0}); });
  judge_lidar_mission(flown.result.mission, flown.map);
  CHECK(flown.result.mission.complete && flown.result.maps_equal);
}
}  // namespace
