// SPDX-License-Identifier: MIT
#include <surfleet/simulation/simulation.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/planning/rate_planner.hpp>
#include <surfleet/planning/rate_then_tours.hpp>
#include <surfleet/planning/tour_planner.hpp>
#include <surfleet/planning/tours_behind.hpp>
#include <surfleet/planning/with_space_looks.hpp>

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
static_assert(FleetPlanner<RatePlanner> && FleetPlanner<TsgaPlanner>);
static_assert(FleetPlanner<WithSpaceLooks<NoPlan>>);

/// Compiled once for all planners; `NoPlan` flies a mission of its own type.
using AnyMission = Simulation<AnyPlanner, World>;

/// The share of the box's surface that is mapped within a voxel.
double mapped_share(const World& world, const TsdfMap& map) {
  const Bvh mapped(extract_mesh(map, {.min_weight = 1e-6F}));
  double near = 0.0, all = 0.0;
  for (std::size_t t = 0; t < world.mesh.triangles.size(); ++t)
    for (double u = 0.05; u < 1.0; u += 0.1)
      for (double v = 0.05; u + v < 1.0; v += 0.1) {
        const Point3 p = world.mesh.corner(t, 0) * (1.0 - u - v) + world.mesh.corner(t, 1) * u +
                         world.mesh.corner(t, 2) * v;
        all += 1.0;
        near += mapped.distance(p) < 0.2 ? 1.0 : 0.0;
      }
  return near / all;
}

/// What every planner is held to: the box is reconstructed, by every robot, and nothing is hit.
MissionResult fly(int robots, const AnyPlanner& planner, int threads, double least,
                  TsdfMap* map = nullptr) {
  World world;
  MissionOptions o = box_world::options(world);
  o.threads = threads;
  AnyMission mission(o, world, box_world::starts(robots), planner);
  MissionResult result = mission.run();
  // Nobody hits the box or a teammate.
  for (std::size_t r = 0; r < result.trajectories.size(); ++r)
    for (std::size_t k = 0; k < result.trajectories[r].size(); ++k) {
      const Point3& p = result.trajectories[r][k].configuration.position;
      CHECK(world.bvh.distance(p) > 0.4);
      CHECK(o.kind.bounds.contains(p));
      for (std::size_t s = 0; s < r; ++s)
        CHECK((result.trajectories[s][k].configuration.position - p).norm() > 0.8);
    }
  CHECK(mapped_share(world, mission.map()) > least);
  CHECK(result.complete && result.plans > 0);
  for (const double length : result.path_length) CHECK(length > 2.0);
  // Nothing is left that nobody tried.
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

TEST(two_robots_reconstruct_a_box_by_tsga) { fly(2, TsgaPlanner(tour_options()), 1, 0.98); }
TEST(three_robots_reconstruct_a_box_by_rate_then_tours) {
  fly(3,
      RateThenTours<RatePlanner, MakespanPlanner>(RatePlanner(), MakespanPlanner(tour_options())),
      1, 0.98);
}
TEST(threads_change_nothing) {
  TsdfMap a({.voxel_size = 0.2}), b({.voxel_size = 0.2});
  const MissionResult one = fly(2, RatePlanner(), 1, 0.9, &a),
                      two = fly(2, RatePlanner(), 2, 0.9, &b);
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
    CHECK(mapped_share(world, mission.map()) < 0.7);
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
  CHECK_THROWS(Error, fly(WithSpaceLooks([](const SurfaceSituation&) { return Plan{}; })));
}
/// A patch of one wall that no image shows.
struct Glass : World {
  DepthImage capture(std::size_t robot, std::uint64_t shot,
                     std::span<const Configuration> fleet) const {
    DepthImage image = World::capture(robot, shot, fleet);
    const Pose T = fleet[robot].pose() * forward_camera_mount();
    for (int v = 0; v < image.height; ++v)
      for (int u = 0; u < image.width; ++u) {
        const double depth = image(u, v);
        if (!(depth > 0.0) || depth > camera.max_range) continue;
        const Point3 p = T * (camera.ray(u, v) * depth);
        if (std::abs(p.y()) < 0.5 && std::abs(p.z() - 1.0) < 0.4 && p.x() < 0.0) image(u, v) = 0.0F;
      }
    return image;
  }
};
TEST(a_stop_that_may_not_last_as_long_as_it_should_is_a_look_in_vain) {
  Glass world;
  MissionOptions options = box_world::options(world);
  options.agent.image_period = 4.0;  // three images in the longest stay
  options.max_time = 2000.0;
  Simulation<AnyPlanner, Glass> mission(options, world, box_world::starts(1),
                                        TsgaPlanner(tour_options()));
  const MissionResult result = mission.run();
  CHECK(result.complete && result.path_length[0] > 2.0);
  CHECK(result.reasons.count(LeftReason::not_attempted) == 0);
  CHECK(result.reasons.size() > 0);  // the glass, which was looked at
}
TEST(looks_at_space_widen_what_is_known_and_come_to_an_end) {
  World world;
  const MissionOptions o = box_world::options(world);
  Simulation<NoPlan, World> still(o, world, box_world::starts(2));
  still.run();
  WithSpaceLooks<NoPlan> looks(NoPlan{}, {.distance = 2.0});
  AnyMission mission(o, world, box_world::starts(2), std::ref(looks));
  const MissionResult result = mission.run();
  CHECK(result.complete);
  CHECK(looks.looks() > 0);
  CHECK(result.total_path_length() > 1.0);
  CHECK(mission.map().block_count() > still.map().block_count());
}
TEST(a_part_that_stands_by_itself_is_found_in_unseen_space) {
  World world;
  // Out of the camera's range from anywhere that the first box is looked at from.
  const Point3 middle(12.0, 0.0, 1.0);
  append(world.mesh, make_box({middle - Point3::Ones(), middle + Point3::Ones()}));
  world.bvh = Bvh(world.mesh);
  MissionOptions o = box_world::options(world);
  o.belief.region.max().x() = 13.5;
  o.kind.bounds.max().x() = 17.0;
  const auto finds_it = [&](double space_worth) {
    RatePlanner planner;
    planner.options.space_worth = space_worth;
    AnyMission mission(o, world, box_world::starts(1), planner);
    CHECK(mission.run().complete);
    return Bvh(extract_mesh(mission.map(), {.min_weight = 1e-6F})).distance(middle) < 1.2;
  };
  CHECK(finds_it(RatePlannerOptions{}.space_worth));
  CHECK(!finds_it(0.0));
}
/// Says how often in a row robots are sent to look once more from where they have just looked.
struct Again {
  RatePlanner inner;
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
TEST(one_robot_reconstructs_a_box_by_rate_and_does_not_look_twice_from_one_place) {
  for (const double climb_height : {4.0, 0.0}) {  // the second is one that has to be climbed
    RatePlannerOptions options;
    options.climb_height = climb_height;
    int longest = 0;
    fly(1, Again{RatePlanner(options), &longest}, 1, 0.8);
    CHECK(longest <= 1);
  }
}
/// Where nobody can be, for so many plans; then what a planner that works says.
struct NowhereFirst {
  int wrong = 0;
  int* calls = nullptr;
  RatePlanner then;
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
                       NowhereFirst{wrong, &calls, RatePlanner()});
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
TEST(reordered_stops_are_the_same_stops_on_a_shorter_way) {
  double saved = 0.0;
  World world;
  Twice planner;
  planner.saved = &saved;
  AnyMission mission(box_world::options(world), world, box_world::starts(2), planner);
  CHECK(mission.run().complete);
  CHECK(saved > 0.5);
}
/// Rates and looks as they are told.
struct Scripted {
  double rate = 1.0, look = 1.0;
  std::optional<double> utility_share;
  double last_rate() const { return rate; }
  double broadest_look() const { return look; }
  Plan operator()(const SurfaceSituation& situation) {
    Plan plan = for_all(situation, Stops{Stop{}});
    plan.replan = {.utility_share = utility_share, .watch_on = true};
    return plan;
  }
};
/// Passes a request on to planners of its own.
struct AskedOnce {
  Plan operator()(const SurfaceSituation& situation) {
    using Planner = RateThenTours<Scripted, NoPlan>;
    const auto ask = [&](Planner& p, double rate, double look, int times) {
      p.first.rate = rate;
      p.first.look = look;
      bool all = true, any = false;
      for (int i = 0; i < times; ++i) {
        const Plan result = p(situation);
        const bool toured = result.routes.at(0).empty();
        CHECK(toured == p.touring());
        // Whichever was asked.
        CHECK(result.replan.utility_share == p.first.utility_share.value_or(p.lone_utility_share));
        CHECK(result.replan.watch_on);
        all = all && toured;
        any = any || toured;
      }
      return std::pair(all, any);
    };
    Planner p;
    CHECK(!ask(p, 4.0, 40.0, 20).second);
    CHECK(!ask(p, 0.1, 20.0, 60).second);  // low rates, but something broad far away
    CHECK(ask(p, 0.1, 4.0, 40).second);    // nothing broad any more
    CHECK(ask(p, 0.1, 4.0, 5).first);
    p.first.utility_share = 0.7;
    CHECK(ask(p, 0.1, 4.0, 5).first);
    CHECK(!ask(p, 0.2, 30.0, 5).second);  // the tours came upon something
    CHECK(ask(p, 0.05, 4.0, 60).second);
    Planner q;
    CHECK(!ask(q, 4.0, 40.0, 1).second);
    CHECK(ask(q, 0.0, 0.0, 1).first);  // nothing at all
    return for_all(situation, {});
  }
};
TEST(tours_take_over_when_nothing_broad_is_left_and_give_way_again) {
  World world;
  AnyMission mission(box_world::options(world), world, box_world::starts(1), AskedOnce());
  CHECK(mission.run().complete);
}
/// An advancing planner, or one of tours: a stop for whoever waits, or none; counts who did.
struct Counting {
  bool tours = false, finds = true;
  std::size_t asked = 0, work = 0;
  bool touring() const { return tours; }
  ReplanRule rule(const SurfaceSituation&) const { return {.utility_share = 0.25}; }
  Plan operator()(const SurfaceSituation& situation) {
    Plan result;
    result.replan = rule(situation);
    asked = situation.asked.size();
    work = situation.goals.size();
    for (const RobotId r : situation.asked) result.routes[r] = Stops(finds ? 1 : 0);
    return result;
  }
};
/// Asks on behalf of five robots, 100 m from where the work is left, with so much work there and
/// with themselves.
struct AskedForFive {
  Plan operator()(const SurfaceSituation& still) {
    std::vector<RobotState> robots(5);
    for (RobotId r = 0; r < 5; ++r) robots[r] = {.id = r, .at = {Point3(100.0 + r, 0, 0), 0.0}};
    const std::vector<RobotId> all{0, 1, 2, 3, 4};
    std::vector<IncompleteElement> work;
    const auto ask = [&](auto& planner, int behind, int ahead, bool waiting = true) {
      work.assign(static_cast<std::size_t>(behind), {});
      work.resize(static_cast<std::size_t>(behind + ahead), {.position = Point3(101, 0, 0)});
      SurfaceSituation situation = still;
      situation.goals = work;
      situation.team = robots;
      situation.asked = std::span(all).first(waiting ? robots.size() : 0);
      return planner(situation);
    };
    using Crew = std::vector<RobotId>;
    ToursBehind<Counting, Counting> p;
    ask(p, 10, 0);
    CHECK(p.crew().empty() && p.front.asked == 5);  // the box is no tower
    p.options.least_height = 0.0;
    ask(p, 2, 8);
    CHECK(p.crew().empty() && p.front.asked == 5);
    Plan result = ask(p, 3, 7);  // more than a fifth
    CHECK(p.crew() == Crew{0});  // the nearest
    CHECK(p.behind.asked == 1 && p.behind.work == 3);
    CHECK(p.front.asked == 4 && p.front.work == 10);
    CHECK(result.routes.size() == 5);
    for (const auto& [robot, route] : result.routes) CHECK(route.size() == 1);
    CHECK(result.replan.utility_share == 0.25);
    ask(p, 4, 6);
    CHECK(p.crew() == Crew{0});
    result = ask(p, 5, 5, false);  // nobody waits, but a second one is wanted there
    CHECK((p.crew() == Crew{0, 1}));
    CHECK(result.routes.size() == 1 && result.routes.contains(1));
    CHECK(result.replan.utility_share == 0.25);
    ask(p, 10, 0);
    ask(p, 10, 0);
    CHECK((p.crew() == Crew{0, 1, 2}));  // at most three of five
    p.behind.finds = false;
    result = ask(p, 10, 0);
    CHECK(p.crew().empty() && p.front.asked == 5);  // those with nothing to do there come back
    CHECK(result.routes.size() == 5);
    for (const auto& [robot, route] : result.routes) CHECK(route.size() == 1);
    p.behind.finds = true;
    ask(p, 10, 0);
    CHECK(p.crew().empty());  // not for what nothing could be done about
    ask(p, 20, 0);
    CHECK(p.crew().size() == 1);
    p.front.tours = true;
    ask(p, 20, 0);
    CHECK(p.crew().empty() && p.front.asked == 5);
    robots.resize(2);
    ToursBehind<Counting, Counting> two;
    two.options.least_height = 0.0;
    ask(two, 10, 0);
    CHECK(two.crew().empty() && two.front.asked == 2);
    return for_all(still, {});
  }
};
TEST(some_of_a_team_tour_what_is_left_behind) {
  World world;
  AnyMission mission(box_world::options(world), world, box_world::starts(1), AskedForFive());
  CHECK(mission.run().complete);
}
TEST(progress_can_end_a_mission) {
  World world;
  AnyMission mission(box_world::options(world), world, box_world::starts(1), RatePlanner());
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
