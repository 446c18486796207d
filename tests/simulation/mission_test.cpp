// SPDX-License-Identifier: MIT
#include <surfleet/simulation/simulation.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/planning/rolling_tours.hpp>
#include <surfleet/planning/tour_planner.hpp>
#include <surfleet/planning/with_frontier_views.hpp>

namespace {
using namespace surfleet;
using box_world::World;

/// The same for the whole team.
Plan for_all(const SurfaceSituation& situation, const Stops& route) {
  Plan plan;
  for (const RobotState& robot : situation.team) plan.routes[robot.id] = route;
  return plan;
}
struct NoPlan {
  Plan operator()(const SurfaceSituation& situation) { return for_all(situation, {}); }
};
static_assert(FleetPlanner<NoPlan> && !FleetPlanner<int>);
static_assert(WorldModel<World> && !WorldModel<NoPlan>);
static_assert(FleetPlanner<RollingTours> && FleetPlanner<TsgaPlanner>);
static_assert(FleetPlanner<WithFrontierViews<NoPlan>>);

/// Compiled once for all planners; `NoPlan` flies a mission of its own type.
using AnyMission = Simulation<AnyPlanner, World>;

/// What every planner is held to: the box is reconstructed, by every robot, and nothing is hit.
MissionResult fly(int robots, const AnyPlanner& planner, int threads, double least,
                  TsdfMap* map = nullptr) {
  World world;
  MissionOptions o = box_world::options(world);
  o.threads = threads;
  AnyMission mission(o, world, box_world::starts(robots), planner);
  MissionResult result = mission.run();
  // No robot hits the box or a teammate.
  for (std::size_t r = 0; r < result.trajectories.size(); ++r)
    for (std::size_t k = 0; k < result.trajectories[r].size(); ++k) {
      const Point3& p = result.trajectories[r][k].configuration.position;
      CHECK(world.bvh.distance(p) > 0.4);
      CHECK(o.kind.bounds.contains(p));
      for (std::size_t s = 0; s < r; ++s)
        CHECK((result.trajectories[s][k].configuration.position - p).norm() > 0.8);
    }
  CHECK(box_world::mapped_share(world, mission.map(), 1e-6F) > least);
  CHECK(result.complete && result.plans > 0);
  for (const double length : result.path_length) CHECK(length > 2.0);
  // Nothing is left untried.
  CHECK(result.reasons.count(LeftReason::not_attempted) == 0);
  std::size_t reasons = 0;
  for (const auto& [reason, count] : result.reasons) reasons += count;
  CHECK(reasons == result.remaining);
  if (map != nullptr)
    mission.map().for_each_block(
        [&](const TsdfMap::Block& b) { map->ensure_block(b.index).voxels = b.voxels; });
  return result;
}

TourPlannerOptions tour_options() {
  TourPlannerOptions o;
  o.distance = 2.0;
  o.clusters = {.radius = 1.0, .max_radius = 2.0};
  return o;
}

TEST(two_robots_reconstruct_a_box_by_tsga) { fly(2, TsgaPlanner(tour_options()), 1, 0.97); }
TEST(two_robots_reconstruct_a_box_by_gain_of_volume_a_metre) {
  fly(2,
      TourPlanner<GreedyAllocator<>, KeepAllocation, MergeNearby, RatioUtility, UnknownInSight>(
          tour_options()),
      1, 0.98);
}
TEST(three_robots_reconstruct_a_box_by_even_tours) {
  fly(3, MakespanPlanner(tour_options()), 1, 0.98);
}
TEST(three_robots_reconstruct_a_box_by_rolling_tours) { fly(3, RollingTours(), 1, 0.95); }
TEST(threads_change_nothing) {
  TsdfMap a({.voxel_size = 0.2}), b({.voxel_size = 0.2});
  const MissionResult one = fly(2, RollingTours(), 1, 0.9, &a),
                      two = fly(2, RollingTours(), 2, 0.9, &b);
  CHECK(one.completion_time == two.completion_time);
  CHECK(one.path_length == two.path_length);
  CHECK(a.block_count() == b.block_count());
  a.for_each_block([&](const TsdfMap::Block& block) {
    const TsdfMap::Block* other = b.find_block(block.index);
    CHECK(other != nullptr);
    if (other == nullptr) return;
    bool same = true;
    for (std::size_t i = 0; i < TsdfMap::kBlockVoxels; ++i)
      same = same && block.voxels[i].distance == other->voxels[i].distance &&
             block.voxels[i].weight == other->voxels[i].weight;
    CHECK(same);
  });
}
TEST(a_planner_without_plans_ends_the_mission_with_reasons) {
  for (const int robots : {1, 3}) {
    World world;
    Simulation<NoPlan, World> mission(box_world::options(world), world, box_world::starts(robots));
    const MissionResult result = mission.run();
    CHECK(result.complete);
    CHECK(result.remaining > 0);
    CHECK(result.reasons.at(LeftReason::not_attempted) == result.remaining);
    // And it meets nothing of what the others are held to.
    CHECK(box_world::mapped_share(world, mission.map(), 1e-6F) < 0.7);
    for (const double length : result.path_length) CHECK(length == 0.0);
  }
}
TEST(a_planner_that_answers_amiss_is_refused) {
  World world;
  const auto fly = [&](AnyPlanner planner) {
    AnyMission mission(box_world::options(world), world, box_world::starts(2), std::move(planner));
    mission.run();
  };
  CHECK_THROWS(Error, fly([](const SurfaceSituation&) { return Plan{}; }));
  CHECK_THROWS(Error, fly(AnyPlanner()));
  CHECK_THROWS(Error, fly(WithFrontierViews([](const SurfaceSituation&) { return Plan{}; })));
}
TEST(a_centralised_fleet_counts_images_poses_and_routes) {
  World world;
  const MissionOptions o = box_world::options(world);
  for (const int robots : {1, 2}) {
    std::uint64_t told = 0;
    AnyMission mission(o, world, box_world::starts(robots), TsgaPlanner(tour_options()));
    mission.observer.on_plan = [&](const SurfaceSituation&, const Plan& plan) {
      for (const auto& [robot, route] : plan.routes)
        told += encode_routes({{.head = {.robot = robot}, .route = route}}).size();
    };
    const MissionResult result = mission.run();
    const std::uint64_t images = robots > 1 ? result.images : 0;
    const auto pixels = static_cast<std::uint64_t>(o.kind.camera.width * o.kind.camera.height);
    CHECK(told > 0 && result.images > 100);
    CHECK(result.traffic.images == 2 * images * pixels);
    CHECK(result.traffic.poses == 56 * images);
    CHECK(result.traffic.routes == (robots > 1 ? told : 0));
  }
}
TEST(a_stop_that_may_not_last_as_long_as_it_should_is_a_view_in_vain) {
  box_world::Glass world;
  MissionOptions options = box_world::options(world);
  options.agent.image_period = 4.0;  // three images in the longest stay
  options.max_time = 2000.0;
  Simulation<AnyPlanner, box_world::Glass> mission(options, world, box_world::starts(1),
                                                   TsgaPlanner(tour_options()));
  const MissionResult result = mission.run();
  CHECK(result.complete && result.path_length[0] > 2.0);
  CHECK(result.reasons.count(LeftReason::not_attempted) == 0);
  CHECK(result.reasons.size() > 0);  // the glass, which was viewed
}
TEST(frontier_views_widen_what_is_known_and_come_to_an_end) {
  World world;
  const MissionOptions o = box_world::options(world);
  Simulation<NoPlan, World> still(o, world, box_world::starts(2));
  still.run();
  WithFrontierViews<NoPlan> views(NoPlan{}, {.distance = 2.0});
  AnyMission mission(o, world, box_world::starts(2), std::ref(views));
  const MissionResult result = mission.run();
  CHECK(result.complete);
  CHECK(views.views_ordered() > 0);
  CHECK(result.total_path_length() > 1.0);
  CHECK(mission.map().block_count() > still.map().block_count());
}
TEST(a_part_that_stands_by_itself_is_found_by_frontiers) {
  World world;
  // Out of the camera's range from anywhere that the first box is viewed from.
  const Point3 middle(12.0, 0.0, 1.0);
  append(world.mesh, make_box({middle - Point3::Ones(), middle + Point3::Ones()}));
  world.bvh = Bvh(world.mesh);
  MissionOptions o = box_world::options(world);
  o.belief.region.max().x() = 13.5;
  o.kind.bounds.max().x() = 17.0;
  const auto finds_it = [&](double frontier_gain) {
    RollingToursOptions options;
    options.interest.frontier_gain = frontier_gain;
    AnyMission mission(o, world, box_world::starts(1), RollingTours(options));
    CHECK(mission.run().complete);
    return Bvh(extract_mesh(mission.map(), {.min_weight = 1e-6F})).distance(middle) < 1.2;
  };
  CHECK(finds_it(InterestOptions{}.frontier_gain));
  CHECK(!finds_it(0.0));
}
/// Says how often in a row robots are sent to view once more from where they have just viewed.
struct Again {
  RollingTours inner;
  int* longest = nullptr;
  int row = 0;
  Plan operator()(const SurfaceSituation& situation) {
    Plan result = inner(situation);
    for (const RobotId r : situation.asked) {
      if (result.routes.at(r).empty()) continue;
      const Configuration& to = result.routes.at(r).front().configuration;
      const Configuration& at = situation.robot(r).at;
      row = (to.position - at.position).norm() < 1e-6 && std::abs(to.yaw - at.yaw) < 1e-6 ? row + 1
                                                                                          : 0;
      *longest = std::max(*longest, row);
    }
    return result;
  }
};
TEST(one_robot_reconstructs_a_box_by_rolling_tours_and_does_not_view_twice_from_one_place) {
  int longest = 0;
  fly(1, Again{RollingTours(), &longest}, 1, 0.8);
  CHECK(longest <= 1);
}
/// Where no robot can be, for so many plans; then what a planner that works says.
struct NowhereFirst {
  int wrong = 0;
  int* calls = nullptr;
  RollingTours then;
  Plan operator()(const SurfaceSituation& situation) {
    if (++*calls > wrong) return then(situation);
    Stop inside_the_box{{box_world::box().center(), 0.0}, {}};
    for (const IncompleteElement& e :
         situation.goals.first(std::min<std::size_t>(5, situation.goals.size())))
      inside_the_box.targets.push_back(e.voxel);
    return for_all(situation, Stops{inside_the_box});
  }
};
TEST(a_plan_that_cannot_be_flown_is_not_the_last_word) {
  for (const int wrong : {2, 1000000}) {
    int calls = 0;
    World world;
    AnyMission mission(box_world::options(world), world, box_world::starts(1),
                       NowhereFirst{wrong, &calls, RollingTours()});
    const MissionResult result = mission.run();
    CHECK(result.complete);
    if (wrong == 2) {
      CHECK(result.path_length[0] > 5.0);  // asked again, and flown after all
    } else {
      CHECK(result.path_length[0] < 1.0);  // no use in asking for ever
      CHECK(calls < 20);
    }
  }
}
/// Sends the first robot to one side and, asked again by the other's idling, on by `then`.
struct SecondThoughts {
  Eigen::Vector3d then;
  bool turn_in_flight;
  std::vector<double>* asked;
  Plan operator()(const SurfaceSituation& situation) {
    Plan r = for_all(situation, {});
    r.replan.turn_in_flight = turn_in_flight;
    const std::array<Eigen::Vector3d, 2> aside{Eigen::Vector3d(0, -3, 0), then};
    if (asked->size() < aside.size())
      r.routes[0] = Stops{{{situation.team[0].at.position + aside[asked->size()], 0.0}, {}}};
    asked->push_back(situation.time);
    return r;
  }
};
TEST(a_robot_turns_in_flight_to_what_lies_ahead) {
  const auto arrival = [](const Eigen::Vector3d& then, bool turn, bool brakes) {
    World world;
    const MissionOptions o = box_world::options(world);
    std::vector<double> asked;
    AnyMission mission(o, world, box_world::starts(2), SecondThoughts{then, turn, &asked});
    const MissionResult result = mission.run();
    CHECK(result.complete && asked.size() > 2 && asked[1] < asked[0] + 2.5);
    double slowest = 1e9;  // of the steps from the change of mind until the robot has arrived
    double last = 0.0;
    const auto& t = result.trajectories[0];
    const Point3 goal = t.back().configuration.position;
    for (std::size_t k = 1; k < t.size(); ++k) {
      const Point3 &p = t[k - 1].configuration.position, &q = t[k].configuration.position;
      if (t[k - 1].time < asked[1] || (q - goal).norm() < 0.2) continue;
      slowest = std::min(slowest, (q - p).norm());
      last = t[k].time;
    }
    CHECK((slowest < 0.06) == brakes && slowest < 1.0);
    return last;
  };
  const Eigen::Vector3d ahead(0.6, -0.9, 0.0), back(0.6, 0.9, 0.0);
  CHECK(arrival(ahead, true, false) < arrival(ahead, false, true));
  CHECK(arrival(back, true, true) == arrival(back, false, true));
}
/// The same tours with and without a last ordering of their stops.
struct Twice {
  TsgaPlanner as_clustered{tour_options()}, reordered{tour_options()};
  double* saved = nullptr;
  Plan operator()(const SurfaceSituation& situation) {
    reordered.options.reorder_stops = true;
    const Plan a = as_clustered(situation);
    Plan b = reordered(situation);
    const auto places = [](const Stops& route) {
      std::vector<std::array<double, 4>> list;
      for (const Stop& s : route) {
        const Point3& p = s.configuration.position;
        list.push_back({p.x(), p.y(), p.z(), s.configuration.yaw});
      }
      std::sort(list.begin(), list.end());
      return list;
    };
    CHECK(a.routes.size() == b.routes.size());
    for (const auto& [robot, route] : b.routes) {
      const Stops& other = a.routes.at(robot);
      CHECK(places(other) == places(route));
      const Point3 start = situation.robot(robot).at.position;
      const auto length = [&](const Stops& stops) {
        std::vector<Point3> points{start};
        for (const Stop& stop : stops) points.push_back(stop.configuration.position);
        return polyline_length(points);
      };
      CHECK(length(route) <= length(other) + 1e-9);
      *saved += length(other) - length(route);
    }
    return b;
  }
};
TEST(reordered_stops_are_the_same_stops_on_a_shorter_path) {
  double saved = 0.0;
  World world;
  Twice planner;
  planner.saved = &saved;
  AnyMission mission(box_world::options(world), world, box_world::starts(2), planner);
  CHECK(mission.run().complete);
  CHECK(saved > 0.5);
}
TEST(progress_can_end_a_mission) {
  World world;
  AnyMission mission(box_world::options(world), world, box_world::starts(1), RollingTours());
  int calls = 0;
  mission.on_progress = [&](const MissionProgress&) { return ++calls < 3; };
  const MissionResult result = mission.run();
  CHECK(!result.complete);
  CHECK(calls == 3);
}
TEST(bad_options_are_refused) {
  World world;
  const auto with = [&](auto change, int robots) {
    MissionOptions o = box_world::options(world);
    change(o);
    const auto starts = box_world::starts(robots);
    Simulation<NoPlan, World> mission(o, world, starts);
  };
  CHECK_THROWS(Error, with([](MissionOptions&) {}, 0));
  CHECK_THROWS(Error, with([](MissionOptions& o) { o.belief.voxel_size = -0.3; }, 1));
  CHECK_THROWS(Error, with([](MissionOptions& o) { o.agent.image_period = 0.0; }, 1));
  CHECK_THROWS(Error, with([](MissionOptions& o) { o.kind.bounds = Box3(); }, 1));
  CHECK_THROWS(Error, with([](MissionOptions& o) { o.kind.limits.speed = 0.0; }, 1));
}
}  // namespace
