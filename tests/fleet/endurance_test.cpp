// SPDX-License-Identifier: MIT
#include <surfleet/fleet/endurance.hpp>

#include <algorithm>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"
#include "paint_states.hpp"

#include <surfleet/core/random.hpp>
#include <surfleet/planning/default_planner.hpp>
#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/simulation/simulation.hpp>

namespace {
using namespace surfleet;

/// Boxes on a floor, seen without noise, with streets between them.
struct Town : box_world::World {
  Box3 bounds{Point3(-7.0, -7.0, 0.5), Point3(7.0, 7.0, 2.5)};

  explicit Town(std::uint64_t seed) {
    Random random(seed);
    mesh = {};
    for (int k = 0; k < 6; ++k) {
      const Point3 at(-3.0 + 4.0 * (k % 3) + random.uniform(-0.5, 0.5),
                      -3.0 + 5.0 * (k / 3) + random.uniform(-0.5, 0.5), 0.0);
      const Point3 size(random.uniform(0.5, 2.0), random.uniform(0.5, 3.0), 3.0);
      append(make_box({at - 0.5 * Point3(size.x(), size.y(), 0.0),
                       at + Point3(0.5 * size.x(), 0.5 * size.y(), size.z())}));
    }
    bvh = Bvh(mesh);
  }
  void append(const TriangleMesh& box) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), box.vertices.begin(), box.vertices.end());
    for (auto t : box.triangles) {
      for (auto& i : t) i += first;
      mesh.triangles.push_back(t);
    }
  }
};
MissionResult fly(const Town& town, int robots, const EnduranceLimits& endurance) {
  Town world = town;
  MissionOptions o = box_world::options(world);
  o.limits.endurance = endurance;
  o.kind.bounds = town.bounds;
  o.belief.region = Box3(Point3(-5.0, -5.5, -0.3), Point3(7.0, 5.5, 3.3));
  std::vector<Configuration> starts;
  for (int r = 0; r < robots; ++r) starts.push_back({Point3(-6.3, -3.0 + 1.5 * r, 1.5), 0.0});
  return Simulation<DefaultPlanner, Town>(o, world, starts, default_planner({.standoff = 2.0}))
      .run();
}

/// A hall of 12 by 8 m that a wall divides, or does not, but for a door at its far side.
struct Hall {
  TsdfMap map{{.voxel_size = 0.25}};
  VoxelStateMap states{map, {.known_weight = 0.3}};
  RobotKind kind = [] {
    RobotKind k;
    k.body_radius = 0.4;
    k.bounds = Box3(Point3(0.0, 0.0, 0.0), Point3(12.0, 8.0, 3.0));
    return k;
  }();
  KindSpace space{kind, states, 0.25, 1};

  void build(bool wall) {
    map_test::paint(map, VoxelIndex(-2, -2, -2), VoxelIndex(50, 34, 14), [&](const VoxelIndex& v) {
      return wall && v.x() == 24 && v.y() < 24 ? VoxelState::occupied : VoxelState::empty;
    });
    states.update(map);
    space.free.update();
    space.roadmap.update();
  }
};
const Point3 home(2.0, 1.0, 1.5), desk(10.0, 1.0, 1.5);

TEST(the_way_home_follows_the_robot_and_the_map) {
  Hall hall;
  hall.build(false);
  WayHome way(home);
  const auto go = [&](const Point3& to) {
    const Point3 from = way.points().front();
    for (int k = 1; k <= 40; ++k) {
      way.moved_to(from + (to - from) * (k / 40.0));
      way.update(hall.space.roadmap);
      CHECK(way.is_open(hall.space.free));
      CHECK(way.points().back() == home);
    }
  };
  go(Point3(6.0, 6.0, 1.5));
  go(desk);
  CHECK_NEAR(way.length(), 8.0, 1e-6);
  hall.build(true);
  CHECK(!way.is_open(hall.space.free));
  way.update(hall.space.roadmap);
  CHECK(way.is_open(hall.space.free) && way.points().front() == desk);
  CHECK(way.length() > 13.0 && way.length() < 20.0);
  // On the way it is not longer than what is left of it.
  const std::vector<Point3> path = way.points();
  const double whole = way.length();
  double flown = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    flown += (path[i] - path[i - 1]).norm();
    go(path[i]);
    CHECK(way.length() <= whole - flown + 1e-6);
  }
  // Open again, the way that is kept is the long one until a shorter one is asked for.
  way.moved_to(desk);
  way.update(hall.space.roadmap);
  hall.build(false);
  way.shorten(hall.space.roadmap);
  CHECK_NEAR(way.length(), 8.0, 0.1);
}
TEST(a_charge_is_asked_again_when_the_way_home_has_become_longer) {
  Hall hall;
  hall.build(false);
  const AerialLimits motion;
  Endurance endurance({.distance = 24.5}, home, motion, 1.0);
  const auto returns = [&] {
    endurance.update(hall.space.roadmap, 0);
    return endurance.must_return(0.0, hall.space.roadmap);
  };
  endurance.moved_to(home);
  CHECK(!returns());
  endurance.moved_to(desk);
  CHECK(!returns());  // 8 m are flown, and 8 m take it home
  hall.build(true);
  CHECK(returns());  // 14 m do now
  CHECK(endurance.covers(endurance.way().length(), 0.0));
  CHECK(!endurance.affords(endurance.way().length(), 0.0));
  // Stepping aside counts, there and back, and may cost the reserve of one on its way home.
  CHECK(endurance.affords_aside(0.3, 0.0, true) && !endurance.affords_aside(0.3, 0.0, false));
  CHECK(!endurance.affords_aside(2.0, 0.0, true));
}
TEST(a_charge_in_seconds_pays_for_waiting_and_one_in_use_goes_on) {
  Hall hall;
  hall.build(false);
  const AerialLimits motion;
  Endurance endurance({.time = 60.0}, home, motion, 1.0);
  endurance.moved_to(home);
  endurance.moved_to(desk);
  const auto latest = [&](std::size_t mates) {
    endurance.update(hall.space.roadmap, mates);
    double time = 0.0;
    while (!endurance.must_return(time, hall.space.roadmap)) time += 0.25;
    return time;
  };
  const double alone = latest(0);
  CHECK(alone + 8.0 / motion.speed + 2.0 * kPi / motion.yaw_rate < 60.0 && alone > 10.0);
  CHECK_NEAR(latest(2), alone - 10.0, 0.3);
  Endurance used({.distance = 26.0}, home, motion, 1.0, 20.0);
  used.moved_to(desk);
  used.update(hall.space.roadmap, 0);
  CHECK(used.travelled() == 20.0 && used.must_return(0.0, hall.space.roadmap));
}
static_assert(MeasuredBody<SimulatedDrone<box_world::World>>);
TEST(who_takes_a_body_over_knows_what_that_has_flown) {
  box_world::World world;
  const MissionOptions o = box_world::options(world);
  std::vector<Configuration> fleet = box_world::starts(1);
  SurfaceBelief belief(o.belief, std::span<const RobotKind>(&o.kind, 1));
  SimulatedDrone<box_world::World> body(world, 0, fleet, o.kind.limits, o.neighbours);
  const std::vector<Point3> path{fleet[0].position, fleet[0].position + Point3(0, 2, 0)};
  body.follow(path, 0.0, std::nullopt);
  for (int k = 0; k < 40; ++k) body.advance(0.25);
  const Agent<SimulatedDrone<box_world::World>> agent(0, 0, body, belief, o.agent);
  CHECK_NEAR(agent.travelled_at_work(), 2.0, 1e-6);
}
TEST(no_robot_flies_farther_than_its_charge_lasts) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    const int robots = 1 + static_cast<int>(seed % 4);
    const bool timed = seed % 4 == 0;
    const double metres = random.uniform(8.0, 25.0), seconds = random.uniform(50.0, 100.0);
    const MissionResult r =
        fly(Town(seed), robots,
            timed ? EnduranceLimits{.time = seconds} : EnduranceLimits{.distance = metres});
    for (std::size_t k = 0; k < r.path_length.size(); ++k) {
      const auto& t = r.trajectories[k];
      CHECK((t.back().configuration.position - t.front().configuration.position).norm() < 0.06);
      CHECK(timed ? r.completion_time <= seconds : r.path_length[k] <= metres);
    }
  }
}
}  // namespace
