// SPDX-License-Identifier: MIT
// Robots whose cameras hang in gimbals.
#include <surfleet/simulation/simulated_drone.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/fleet/agent.hpp>
#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/drone_world.hpp>
#include <surfleet/simulation/fly_distributed.hpp>
#include <surfleet/simulation/fly_mission.hpp>

namespace {
using namespace surfleet;

using Drone = SimulatedDrone<box_world::World>;
/// As every body was before there were gimbals.
struct FixedBody {
  Drone* drone;
  SensorReading sense() { return drone->sense(); }
  Configuration estimate() const { return drone->estimate(); }
  std::vector<SeenRobot> neighbours() const { return drone->neighbours(); }
  void follow(std::span<const Point3> path, double yaw, std::optional<double> watch) {
    drone->follow(path, yaw, watch);
  }
  void watch(double yaw) { drone->watch(yaw); }
  std::vector<Point3> path_onto(std::span<const Point3> path) const {
    return drone->path_onto(path);
  }
  void stop() { drone->stop(); }
  void resume() { drone->resume(); }
  std::vector<Point3> remaining() const { return drone->remaining(); }
  double stopping_distance() const { return drone->stopping_distance(); }
  Eigen::Vector3d velocity() const { return drone->velocity(); }
  bool standing() const { return drone->standing(); }
  bool braking() const { return drone->braking(); }
  bool finished() const { return drone->finished(); }
  void advance(double dt) { drone->advance(dt); }
};
/// The least that is a gimbal.
struct TiltingBody : FixedBody {
  void tilt(double pitch) { drone->tilt(pitch); }
};
static_assert(GimballedBody<TiltingBody> && RobotBody<Drone>);
static_assert(GimballedBody<Drone> && RobotBody<FixedBody> && !GimballedBody<FixedBody>);

const std::vector<double> kPitches{0.0, radians(60.0), -radians(60.0)};

TEST(a_gimbal_turns_at_its_rate_whatever_the_body_does) {
  box_world::World world;
  const MissionOptions o = box_world::options(world);
  AerialLimits limits = o.kind.limits;
  limits.pitch_rate = 0.5;
  limits.pitch_acceleration = 2.0;
  std::vector<Configuration> fleet = box_world::starts(2);
  Drone tilting(world, 0, fleet, limits, o.neighbours),
      level(world, 1, fleet, limits, o.neighbours);
  for (auto* drone : {&tilting, &level}) {
    const Point3 from = drone->estimate().position;
    const std::vector<Point3> path{from, from + Point3(0, 0, 2.0)};
    drone->follow(path, 1.0, std::nullopt);
  }
  tilting.tilt(1.0);
  double before = 0.0, fastest = 0.0;
  int steps = 0;
  for (; steps < 40 && fleet[0].pitch != 1.0; ++steps) {
    for (auto* drone : {&tilting, &level}) drone->advance(0.1);
    const double rate = (fleet[0].pitch - before) / 0.1;
    CHECK(rate > 0.0 && rate <= 0.5 + 1e-9 && fleet[0].pitch <= 1.0 + 1e-9);
    fastest = std::max(fastest, rate);
    before = fleet[0].pitch;
    // Else it moves as the other.
    CHECK(fleet[1].pitch == 0.0 && fleet[0].yaw == fleet[1].yaw);
    CHECK_NEAR(fleet[0].position.z(), fleet[1].position.z(), 1e-12);
  }
  // 1 rad at 0.5 rad/s, and a quarter of a second each to set off and to arrive.
  CHECK_NEAR(fastest, 0.5, 1e-6);
  CHECK(steps >= 22 && steps <= 25 && tilting.estimate().pitch == 1.0);
}

TEST(a_world_shows_what_a_tilted_camera_sees) {
  const box_world::World box;
  const Point3 offset(0.2, 0.1, -0.1);
  const DroneWorldOptions exact{.noise = false};
  const DroneWorld<Bvh> gimbal(box.bvh, box.camera, forward_camera_mount(0.1, offset), exact);
  const DroneWorld<Bvh> mount(box.bvh, box.camera, forward_camera_mount(0.6, offset), exact);
  const std::vector<Configuration> tilted{{Point3(-2.5, 0.5, 2.5), 0.3, 0.5}},
      level{{Point3(-2.5, 0.5, 2.5), 0.3}};
  const DepthImage a = gimbal.capture(0, 0, tilted), b = mount.capture(0, 0, level),
                   ahead = gimbal.capture(0, 0, level);
  double apart = 0.0, moved = 0.0;
  for (int v = 0; v < a.height; ++v)
    for (int u = 0; u < a.width; ++u) {
      apart = std::max(apart, std::abs(static_cast<double>(a(u, v)) - b(u, v)));
      moved = std::max(moved, std::abs(static_cast<double>(a(u, v)) - ahead(u, v)));
    }
  CHECK(apart < 1e-4 && moved > 0.5);
}

TEST(a_kind_with_a_gimbal_asks_for_bodies_that_have_one) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  std::vector<Configuration> fleet = box_world::starts(1);
  Drone drone(world, 0, fleet, o.kind.limits, o.neighbours);
  FixedBody fixed{&drone};
  for (const bool gimbal : {false, true}) {
    if (gimbal) o.kind.pitches = kPitches;
    SurfaceBelief belief(o.belief, std::span<const RobotKind>(&o.kind, 1));
    const Agent<Drone> any(0, 0, drone, belief, o.agent);
    if (gimbal)
      CHECK_THROWS(Error, Agent<FixedBody>(0, 0, fixed, belief, o.agent));
    else
      CHECK(Agent<FixedBody>(0, 0, fixed, belief, o.agent).scanning());
  }
  RobotKind level;
  CHECK(kind_number(level) != kind_number(o.kind) && o.kind.has_gimbal() && !level.has_gimbal());
}

/// A plate above a shaft, out of which no level camera sees it.
struct Plate : box_world::World {
  Plate() {
    mesh = make_box({Point3(-1.5, -1.5, 3.2), Point3(1.5, 1.5, 3.6)});
    bvh = Bvh(mesh);
  }
};
double mapped_underside(const TsdfMap& map) {
  const Bvh mapped(extract_mesh(map, {.min_weight = 1e-6F}));
  double near = 0.0, all = 0.0;
  for (double x = -1.2; x <= 1.2; x += 0.1)
    for (double y = -1.2; y <= 1.2; y += 0.1) {
      all += 1.0;
      near += mapped.distance({x, y, 3.2}) < 0.2 ? 1.0 : 0.0;
    }
  return near / all;
}
FlownMission fly_below(const std::vector<double>& pitches, double pitch_rate = 1.0) {
  Plate world;
  MissionOptions o = box_world::options(world);
  o.kind.pitches = pitches;
  o.kind.limits.pitch_rate = pitch_rate;
  o.kind.bounds = {Point3(-1.0, -1.0, 0.0), Point3(1.0, 1.0, 1.2)};
  o.belief.region = {Point3(-1.6, -1.6, 0.0), Point3(1.6, 1.6, 3.4)};
  const std::vector<Configuration> start{{Point3(0.0, 0.0, 0.6), 0.0}};
  FlownMission flown = fly_mission(o, world, start, make_planner("surfleet", {.standoff = 2.0}));
  CHECK(flown.result.complete);
  return flown;
}
double steepest(const MissionResult& result) {
  double most = 0.0;
  for (const auto& trajectory : result.trajectories)
    for (const TimedConfiguration& t : trajectory)
      most = std::max(most, std::abs(t.configuration.pitch));
  return most;
}
TEST(a_tilted_camera_sees_what_a_level_one_cannot) {
  const FlownMission level = fly_below({0.0}), tilted = fly_below(kPitches);
  CHECK(mapped_underside(level.map) == 0.0 && steepest(level.result) == 0.0);
  CHECK(mapped_underside(tilted.map) > 0.95);
  CHECK_NEAR(steepest(tilted.result), kPitches[1], 1e-9);
  // A slow gimbal is waited for.
  const FlownMission slow = fly_below(kPitches, 0.1);
  CHECK(mapped_underside(slow.map) > 0.95);
  CHECK(slow.result.completion_time > tilted.result.completion_time);
}

TEST(threads_change_nothing_of_missions_with_gimbals) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.kind.pitches = kPitches;
  std::vector<FlownMission> flown;
  for (const int threads : {1, 2}) {
    o.threads = threads;
    flown.push_back(
        fly_mission(o, world, box_world::starts(2), make_planner("surfleet", {.standoff = 2.0})));
  }
  const MissionResult &a = flown[0].result, &b = flown[1].result;
  CHECK(a.complete && a.coverage.share() > 0.9 && steepest(a) > 1.0);
  std::size_t different = 0;
  for (std::size_t r = 0; r < 2; ++r) {
    CHECK(a.trajectories[r].size() == b.trajectories[r].size());
    for (std::size_t k = 1; k < std::min(a.trajectories[r].size(), b.trajectories[r].size()); ++k) {
      const Configuration &p = a.trajectories[r][k].configuration,
                          &q = b.trajectories[r][k].configuration;
      different += p.position == q.position && p.yaw == q.yaw && p.pitch == q.pitch ? 0 : 1;
      CHECK(std::abs(p.pitch - a.trajectories[r][k - 1].configuration.pitch) <=
            o.kind.limits.pitch_rate * o.agent.image_period + 1e-9);
    }
  }
  CHECK(different == 0);
}

TEST(a_distributed_fleet_has_gimbals_too) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.kind.pitches = kPitches;
  const FlownDistributed flown = fly_distributed(o, {}, world, box_world::starts(2), [](RobotId) {
    return make_planner("surfleet", {.standoff = 2.0});
  });
  CHECK(flown.result.mission.complete && flown.result.maps_equal);
  CHECK(flown.result.mission.coverage.share() > 0.9 && steepest(flown.result.mission) > 1.0);
}
}  // namespace
