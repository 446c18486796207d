// SPDX-License-Identifier: MIT
// `tsga` and `nnb` are [000 Alg. 1-4], line by line: docs/planner.md says which line is which.
#include <surfleet/planning/named_planners.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <surfleet/simulation/simulation.hpp>

#include "box_world.hpp"
#include "check.hpp"

namespace {
using namespace surfleet;

/// Gives routes in turn, and then none. Notes where and when it was asked.
struct Scripted {
  struct Question {
    double time;
    Point3 at;
    bool with_route;
  };
  std::vector<std::function<Stops(const SurfaceSituation&)>> routes;
  bool as_printed;
  std::vector<Question>* asked;
  Plan operator()(const SurfaceSituation& s) {
    Plan plan;
    plan.replan = {.utility_share = 0.8, .watch_on = true, .as_printed = as_printed};
    plan.routes[0] = asked->size() < routes.size() ? routes[asked->size()](s) : Stops{};
    asked->push_back({s.time, s.team[0].at.position, !s.team[0].route.empty()});
    return plan;
  }
};
template <typename World>
MissionResult fly(const World& world, const Configuration& start, const Scripted& script) {
  World own = world;
  MissionOptions o = box_world::options(own);
  o.max_time = 90.0;
  Simulation<AnyPlanner, World> mission(o, own, std::span(&start, 1), script);
  return mission.run();
}
const Configuration& end_of(const MissionResult& r) {
  return r.trajectories[0].back().configuration;
}

/// Shows nothing at all to a robot that has not come any nearer.
struct Fog : box_world::World {
  DepthImage capture(std::size_t robot, std::uint64_t shot,
                     std::span<const Configuration> fleet) const {
    return fleet[robot].position.x() < -2.85 ? DepthImage(camera.width, camera.height, 0.0F)
                                             : World::capture(robot, shot, fleet);
  }
};
TEST(an_obstacle_ahead_ends_a_printed_route_and_asks_for_another) {
  const Configuration start{Point3(-2.9, 0.0, 1.0), 0.0};
  const Configuration blocked{Point3(-1.9, 0.0, 1.0), 0.0}, clear{Point3(-2.9, 0.9, 1.0), 0.0};
  for (const bool printed : {true, false}) {
    std::vector<Scripted::Question> asked;
    const MissionResult r = fly(Fog{}, start,
                                {{[&](const SurfaceSituation&) {
                                   return Stops{{blocked, {}}, {clear, {}}};
                                 }},
                                 printed,
                                 &asked});
    CHECK(r.emergency_stops == 1 && asked.size() >= 2);
    CHECK((end_of(r).position.y() > 0.8) == !printed);
    if (printed) CHECK(!asked[1].with_route && asked[1].at.x() < -1.95);
  }
}

/// The incomplete elements, by height.
std::vector<VoxelIndex> by_height(const SurfaceSituation& s) {
  std::vector<VoxelIndex> open;
  for (const IncompleteElement& e : s.goals) open.push_back(e.voxel);
  std::stable_sort(open.begin(), open.end(),
                   [](const VoxelIndex& a, const VoxelIndex& b) { return a.z() < b.z(); });
  return open;
}
TEST(what_was_viewed_in_vain_is_not_complete_by_the_printed_utility) {
  // Nine tenths of the elements are for a first stop, from which none is seen.
  const auto route = [](const SurfaceSituation& s) {
    const std::vector<VoxelIndex> open = by_height(s);
    CHECK(open.size() >= 20);
    const auto most = open.begin() + static_cast<std::ptrdiff_t>(open.size() * 9 / 10);
    return Stops{{{Point3(-3.8, -1.0, 1.0), kPi}, {open.begin(), most}},
                 {{Point3(-3.8, 0.0, 1.0), kPi}, {most, open.end()}}};
  };
  for (const bool printed : {true, false}) {
    std::vector<Scripted::Question> asked;
    fly(box_world::World{}, box_world::starts(1)[0], {{route}, printed, &asked});
    CHECK(asked.size() >= 2 && asked[1].with_route == !printed);
    CHECK(asked.size() >= 2 && (asked[1].at.y() > -0.1) == printed);
  }
}
TEST(utility_is_checked_between_stops_of_a_printed_route) {
  // All that the route is for is seen from its start, if that takes a while.
  const auto route = [](const SurfaceSituation& s) {
    return Stops{{{s.team[0].at.position + Eigen::Vector3d(0.0, 2.5, 0.0), 0.0}, by_height(s)}};
  };
  std::vector<Scripted::Question> asked;
  const MissionResult r = fly(box_world::World{}, box_world::starts(1)[0], {{route}, true, &asked});
  CHECK(asked.size() >= 2 && asked[1].at.y() > 1.4 && r.emergency_stops == 0);
}
TEST(every_stop_of_a_printed_route_is_flown_to) {
  for (const bool printed : {true, false}) {
    std::vector<Scripted::Question> asked;
    const MissionResult r =
        fly(box_world::World{}, box_world::starts(1)[0],
            {{[](const SurfaceSituation&) {
               return Stops{{{Point3(-3.5, 0.5, 1.0), 0.0}, {VoxelIndex(0, 0, 90)}}};  // complete
             }},
             printed,
             &asked});
    CHECK((end_of(r).position.y() > 0.4) == printed);
  }
}
TEST(robots_on_printed_routes_turn_to_their_goals_heading_alone) {
  for (const bool printed : {true, false}) {
    std::vector<Scripted::Question> asked;
    const MissionResult r = fly(box_world::World{}, box_world::starts(1)[0],
                                {{[](const SurfaceSituation&) {
                                   return Stops{{{Point3(-3.5, 1.5, 1.0), -0.6}, {}}};
                                 }},
                                 printed,
                                 &asked});
    double farthest = 0.0;  // from the goal's heading, past the box, long after it set out
    for (const TimedConfiguration& t : r.trajectories[0])
      if (t.configuration.position.y() > 0.2)
        farthest = std::max(farthest, std::abs(t.configuration.yaw + 0.6));
    CHECK((farthest < 0.05) == printed);
  }
}

TEST(printed_planners_are_flown_on_voxels_of_the_whole_weight) {
  box_world::World world;
  const MissionOptions o = box_world::options(world);
  const auto share = [&](const char* name) {
    return Simulation<AnyPlanner, box_world::World>(o, world, box_world::starts(1),
                                                    make_planner(name))
        .belief()
        .options()
        .observed_share;
  };
  for (const NamedPlanner& p : kPlanners)
    CHECK(share(p.name.data()) == (p.as_printed ? 1.0 : o.belief.observed_share));
}

TEST(nnb_chooses_at_every_map_and_for_every_robot) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.max_time = 60.0;
  Simulation<AnyPlanner, box_world::World> mission(o, world, box_world::starts(2),
                                                   make_planner("nnb", {.standoff = 2.0}));
  std::uint64_t last = 0, planned = 0;
  std::size_t plans = 0, maps = 0, missed = 0, longest = 0;
  bool all = true;
  mission.observer.on_plan = [&](const SurfaceSituation& s, const Plan& plan) {
    ++plans;
    planned = s.belief.known().grid().revision();
    all = all && s.asked.size() == 2;
    for (const auto& [robot, route] : plan.routes) longest = std::max(longest, route.size());
  };
  mission.observer.on_step = [&](const MissionStep& step) {
    const std::uint64_t now = step.belief.known().grid().revision();
    if (plans > 0 && now != last) {
      ++maps;
      missed += planned == now ? 0 : 1;
    }
    last = now;
  };
  const MissionResult r = mission.run();
  CHECK(maps > 20 && missed == 0 && all && plans >= maps);
  CHECK(longest > 0 && r.total_path_length() > 3.0);
}
}  // namespace
