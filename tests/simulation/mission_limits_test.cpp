// SPDX-License-Identifier: MIT
#include <surfleet/fleet/endurance.hpp>

#include <algorithm>
#include <optional>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/fleet/coverage_goal.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/fly_distributed.hpp>
#include <surfleet/simulation/fly_mission.hpp>

namespace {
using namespace surfleet;

FlownMission fly_within(const MissionLimits& limits, int robots, const TsdfMap* begun = nullptr,
                        double max_time = 600.0) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.limits = limits;
  o.begun = begun;
  o.max_time = max_time;
  return fly_mission(o, world, box_world::starts(robots),
                     make_planner("surfleet", {.standoff = 2.0}));
}
DistributedResult fly_distributed_within(const MissionLimits& limits, int robots,
                                         const std::vector<FleetEvent>& events = {},
                                         double max_time = 600.0) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.limits = limits;
  o.max_time = max_time;
  return fly_distributed(o, {.network = NetworkConditions::named("wifi"), .events = events}, world,
                         box_world::starts(robots),
                         [](RobotId) { return make_planner("surfleet", {.standoff = 2.0}); })
      .result;
}
/// Every robot has ended where it started.
void check_home(const MissionResult& result) {
  for (const auto& t : result.trajectories)
    CHECK((t.back().configuration.position - t.front().configuration.position).norm() < 0.06);
}

TEST(a_charge_brings_every_robot_home) {
  for (const double metres : {3.0, 8.0, 15.0})
    for (const int robots : {1, 2}) {
      const MissionResult result = fly_within({.endurance = {.distance = metres}}, robots).result;
      check_home(result);
      bool spent = false;
      for (std::size_t r = 0; r < result.path_length.size(); ++r) {
        CHECK(result.path_length[r] <= metres);
        CHECK(result.path_at_work[r] <= result.path_length[r] + 1e-9);
        spent = spent || result.stop_reasons[r] == StopReason::endurance;
      }
      CHECK(spent == !result.complete);
      CHECK(result.enough());
      if (metres < 10.0) CHECK(spent && result.left_area > 0.0);
    }
  for (const double seconds : {40.0, 90.0}) {
    const MissionResult result = fly_within({.endurance = {.time = seconds}}, 2).result;
    check_home(result);
    CHECK(result.completion_time <= seconds);
  }
  CHECK_THROWS(Error, fly_within({.endurance = {.distance = -1.0}}, 1));
}
TEST(a_goal_of_coverage_ends_a_mission) {
  const MissionResult all = fly_within({}, 1).result;
  CHECK(all.complete && all.stop_reasons[0] == StopReason::complete);
  CHECK_NEAR(all.path_at_work[0], all.path_length[0], 1e-6);
  const MissionResult part = fly_within({.coverage_goal = 0.5}, 1).result;
  check_home(part);
  CHECK(!part.complete && part.enough() && part.stop_reasons[0] == StopReason::coverage_goal);
  CHECK(part.coverage.share() >= 0.5 && part.path_at_work[0] < all.path_at_work[0]);
}
/// When a robot, which flies home at the end, was last in flight [s].
double last_flight(const std::vector<TimedConfiguration>& path) {
  for (std::size_t k = path.size(); k-- > 1;)
    if ((path[k].configuration.position - path[k - 1].configuration.position).norm() > 0.01)
      return path[k].time;
  return 0.0;
}
TEST(a_robot_cut_short_on_its_flight_home_says_that_time_was_up) {
  const MissionLimits limits{.least_gain = 2.0};
  const auto cut = [](const MissionResult& whole) {
    return last_flight(whole.trajectories[0]) - 1.0;
  };
  const MissionResult alone = fly_within(limits, 1).result;
  const MissionResult part = fly_within(limits, 1, nullptr, cut(alone)).result;
  CHECK(alone.enough() && !part.enough() && part.stop_reasons[0] == StopReason::ended);

  const MissionResult fleet = fly_distributed_within(limits, 1).mission;
  CHECK(fleet.enough() && fleet.stop_reasons[0] == StopReason::enough);
  const MissionResult short_of_home = fly_distributed_within(limits, 1, {}, cut(fleet)).mission;
  CHECK(!short_of_home.enough() && !short_of_home.complete);
  CHECK(short_of_home.stop_reasons[0] == StopReason::ended);
}
TEST(who_is_lost_has_not_ended_and_its_team_has) {
  const DistributedResult r =
      fly_distributed_within({}, 2, {{.time = 10.0, .robot = 1, .kind = FleetEvent::Kind::killed}});
  CHECK(r.mission.complete && r.mission.enough());
  CHECK(r.mission.stop_reasons[0] == StopReason::complete);
  CHECK(r.mission.stop_reasons[1] == StopReason::lost);
  MissionResult none;
  none.stop_reasons = {StopReason::lost, StopReason::lost};
  CHECK(!none.enough());
  for (const StopReason reason : kStopReasons)
    CHECK(is_enough(reason) == (reason != StopReason::stranded && reason != StopReason::ended &&
                                reason != StopReason::lost));
}
TEST(a_goal_of_coverage_is_noticed_as_soon_as_it_is_reached) {
  struct Account {
    double time, share;
  };
  const auto fly_to = [](std::optional<double> share, const MissionObserver& observer) {
    box_world::World world;
    MissionOptions o = box_world::options(world);
    o.limits.coverage_goal = share;
    return fly_mission(o, world, box_world::starts(1), make_planner("surfleet", {.standoff = 2.0}),
                       {}, observer)
        .result;
  };
  // Until it is noticed, a mission with a goal is as one without.
  std::vector<Account> all;
  MissionObserver account;
  account.on_step = [&](const MissionStep& step) {
    all.push_back({step.time, step.belief.estimate_coverage().share()});
  };
  fly_to({}, account);
  int goals = 0;
  for (const double part : {0.3, 0.5, 0.7}) {
    // More than there ever was until then: the first views know of little that they lack.
    double share = 0.0, reached = 0.0;
    for (const Account& a : all) {
      if (a.time <= part * all.back().time)
        share = std::max(share, a.share + 1e-3);
      else if (reached == 0.0 && a.share >= share)
        reached = a.time;
    }
    if (reached == 0.0) continue;
    ++goals;
    CoverageGoal goal(share);
    double noticed = 0.0;
    std::size_t accounts = 0;
    MissionObserver watch;
    watch.on_step = [&](const MissionStep& step) {
      if (noticed == 0.0 && goal.is_reached(step.belief, step.time)) {
        noticed = step.time;
        accounts = goal.accounts();
      }
    };
    const MissionResult r = fly_to(share, watch);
    CHECK(r.stop_reasons[0] == StopReason::coverage_goal);
    CHECK(noticed >= reached && noticed <= reached + 2.0);
    CHECK(static_cast<double>(accounts) <= noticed + 1.0);  // one in a second at the most
    double worked = 0.0;
    const auto& path = r.trajectories[0];
    for (std::size_t k = 1; k < path.size() && path[k].time <= reached + 2.0; ++k)
      worked += (path[k].configuration.position - path[k - 1].configuration.position).norm();
    CHECK(r.path_at_work[0] <= worked + 1e-6);
  }
  CHECK(goals > 0);
}
TEST(robots_go_home_when_what_is_left_pays_too_little) {
  const MissionResult none = fly_within({.least_gain = 1e6}, 2).result;
  check_home(none);
  for (const StopReason r : none.stop_reasons) CHECK(r == StopReason::enough);
  CHECK(none.left_out && none.left_out->gain < 1e6 * none.left_out->distance);
  const MissionResult all = fly_within({.least_gain = 1e-9}, 1).result;
  check_home(all);
  CHECK(all.complete && all.path_length[0] > all.path_at_work[0] && !all.left_out);
  // No robot goes home as long as there is work for another that pays.
  const MissionResult some = fly_within({.least_gain = 2.0}, 2).result;
  check_home(some);
  CHECK(!some.complete && some.enough() && some.left_area > 0.0);
  CHECK(some.left_out && some.left_out->gain < 2.0 * some.left_out->distance);
  CHECK(some.coverage.share() > none.coverage.share());
}
TEST(robots_that_plan_for_themselves_go_home_once_all_agree) {
  for (const double least_gain : {1e-9, 2.0, 1e6}) {
    const DistributedResult r = fly_distributed_within({.least_gain = least_gain}, 2);
    check_home(r.mission);
    CHECK(r.maps_equal && r.mission.enough());
    const bool all = least_gain < 1.0;
    CHECK(r.mission.complete == all && r.mission.left_out.has_value() != all);
    for (const StopReason reason : r.mission.stop_reasons)
      CHECK(reason == (all ? StopReason::complete : StopReason::enough));
  }
}
TEST(a_robot_that_begins_anew_goes_back_to_where_it_first_started) {
  const DistributedResult r = fly_distributed_within(
      {.least_gain = 1e-9}, 2, {{.time = 20.0, .robot = 1, .kind = FleetEvent::Kind::restarted}});
  check_home(r.mission);
  CHECK(r.maps_equal && r.mission.complete);
}
TEST(robots_that_plan_for_themselves_end_within_their_limits) {
  for (const double metres : {3.0, 8.0}) {
    const DistributedResult r = fly_distributed_within({.endurance = {.distance = metres}}, 2);
    check_home(r.mission);
    CHECK(r.maps_equal && r.mission.enough() && r.mission.completion_time < 300.0);
    bool spent = false;
    for (std::size_t k = 0; k < 2; ++k) {
      CHECK(r.mission.path_length[k] <= metres);
      spent = spent || r.mission.stop_reasons[k] == StopReason::endurance;
    }
    CHECK(spent == !r.mission.complete);
    if (metres < 5.0) CHECK(spent);
  }
  const DistributedResult part = fly_distributed_within({.coverage_goal = 0.5}, 2);
  check_home(part.mission);
  CHECK(part.maps_equal && !part.mission.complete && part.mission.coverage.share() >= 0.5);
  for (const StopReason reason : part.mission.stop_reasons)
    CHECK(reason == StopReason::coverage_goal);
}
TEST(a_mission_goes_on_from_the_map_of_another) {
  const FlownMission first = fly_within({.endurance = {.distance = 8.0}}, 1);
  CHECK(!first.result.complete);
  const FlownMission second = fly_within({}, 1, &first.map);
  CHECK(second.result.complete);
  CHECK(second.result.coverage.share() > first.result.coverage.share());
  const FlownMission third = fly_within({}, 1, &second.map);
  CHECK(third.result.complete && third.result.path_length[0] < 0.5 * second.result.path_length[0]);
}
}  // namespace
