// SPDX-License-Identifier: MIT
#include <surfleet/fleet/redundancy.hpp>

#include <algorithm>
#include <map>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

Stop stop_at(double x, double y, double yaw = 0.0, std::vector<VoxelIndex> targets = {}) {
  return {{Point3(x, y, 2.0), yaw}, std::move(targets)};
}
RobotState robot_at(RobotId id, double x, double y, Stops route) {
  RobotState r;
  r.id = id;
  r.at = {Point3(x, y, 2.0), 0.0};
  r.idle = route.empty();
  r.route = std::move(route);
  return r;
}
bool leaves(const RobotState& self, std::span<const RobotState> team) {
  return RedundancyCheck{}(self, team);
}

TEST(stops_are_the_same_by_place_or_by_what_they_are_for) {
  const RedundancyCheck check;
  const std::vector<VoxelIndex> three{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  CHECK(check.same(stop_at(0, 0), stop_at(0.9, 0, radians(40.0))));
  CHECK(!check.same(stop_at(0, 0), stop_at(1.1, 0)));
  CHECK(!check.same(stop_at(0, 0), stop_at(0.5, 0, radians(50.0))));
  CHECK(check.same(stop_at(0, 0, radians(170.0)), stop_at(0, 0, radians(-170.0))));
  CHECK(check.same(stop_at(0, 0, 0.0, three), stop_at(9, 0, 3.0, {{2, 0, 0}, {7, 0, 0}})));
  CHECK(!check.same(stop_at(0, 0, 0.0, three),
                    stop_at(9, 0, 3.0, {{2, 0, 0}, {7, 0, 0}, {8, 0, 0}})));
  CHECK(!check.same(stop_at(0, 0, 0.0, three), stop_at(9, 0, 3.0)));
}
TEST(situation_1_fewer_steps_go_first) {
  // The first robot's next stop is the second one's last: near as the second may be, it goes on
  // with its own stops, and the first with the stop they share.
  const Stop shared = stop_at(20, 0);
  const std::vector<RobotState> team{robot_at(0, 0, 0, {shared, stop_at(30, 0)}),
                                     robot_at(1, 18, 0, {stop_at(18, 5), stop_at(22, 5), shared})};
  CHECK(!leaves(team[0], team) && !leaves(team[1], team));
  // Come to the stop before it, the second waits for a plan, as the first is nearer.
  std::vector<RobotState> later{robot_at(0, 17, 0, {shared, stop_at(30, 0)}),
                                robot_at(1, 22, 5, {shared})};
  CHECK(!leaves(later[0], later) && leaves(later[1], later));
  // A robot that has the right of way and has turned to something else loses it.
  later[0].route = {stop_at(10, 10), shared};
  CHECK(!leaves(later[0], later) && !leaves(later[1], later));
}
TEST(situation_2_of_those_that_arrive_at_once_the_nearer_goes_then_the_lower_id) {
  const Stop shared = stop_at(20, 0);
  std::vector<RobotState> team{robot_at(3, 10, 0, {shared}), robot_at(5, 25, 0, {shared})};
  CHECK(leaves(team[0], team) && !leaves(team[1], team));
  team[1].at.position.x() = 30.0;  // as near
  CHECK(!leaves(team[0], team) && leaves(team[1], team));
  // News of oneself, as relayed by others, and mates without a route change nothing.
  team.push_back(robot_at(5, 20, 0, {shared}));
  team.push_back(robot_at(1, 20, 0, {}));
  CHECK(!leaves(team[0], std::span(team).subspan(1, 1)));
  CHECK(!leaves(team[2], std::span(team).subspan(1)));
}
TEST(a_mate_on_its_way_home_takes_no_stop_from_others) {
  std::vector<RobotState> team{robot_at(0, 10, 0, {stop_at(0.5, 0, 0.0, {{1, 2, 3}})}),
                               robot_at(1, 1, 0, {stop_at(0, 0)})};
  team[1].first = true;
  CHECK(!leaves(team[0], team));
}
/// Robots that each have all stops in an order of their own, told a tick late. Which stops were
/// visited, how often; a robot that leaves a stop to another has a plan without it.
std::map<std::size_t, int> visits(std::vector<RobotState> team, std::size_t stops) {
  std::map<std::size_t, int> count;
  for (int tick = 0; tick < 2000; ++tick) {
    const std::vector<RobotState> told = team;
    bool any = false;
    for (RobotState& r : team) {
      if (r.route.empty()) continue;
      any = true;
      if (leaves(r, told)) {
        r.route.erase(r.route.begin());
        continue;
      }
      const Point3 to = r.route.front().configuration.position - r.at.position;
      r.at.position += std::min(1.0, 0.15 / std::max(to.norm(), 1e-9)) * to;
      if (to.norm() > 0.15) continue;
      // What was seen there nobody wants to see again.
      const VoxelIndex seen = r.route.front().targets.front();
      ++count[static_cast<std::size_t>(seen.x())];
      for (RobotState& mate : team)
        std::erase_if(mate.route, [&](const Stop& s) { return s.targets.front() == seen; });
    }
    if (!any) break;
  }
  for (const RobotState& r : team) CHECK(r.route.empty());
  CHECK(count.size() <= stops);
  return count;
}
TEST(conflicts_of_three_and_four_robots_end_with_one_of_them_there) {
  for (const int robots : {2, 3, 4})
    for (int trial = 0; trial < 200; ++trial) {
      Random random(static_cast<std::uint64_t>(1000 * robots + trial));
      // All at once on the same stop, every other time exactly as far from it.
      std::vector<RobotState> team;
      for (int r = 0; r < robots; ++r) {
        const double turn = 2.0 * kPi * r / robots;
        const double far = trial % 2 == 0 ? 5.0 : random.uniform(1.0, 5.0);
        team.push_back(robot_at(static_cast<RobotId>(r), far * std::cos(turn), far * std::sin(turn),
                                {stop_at(0, 0, 0.0, {{0, 0, 0}})}));
      }
      const auto going = std::count_if(team.begin(), team.end(),
                                       [&](const RobotState& r) { return !leaves(r, team); });
      CHECK(going == 1);
      CHECK(visits(team, 1) == (std::map<std::size_t, int>{{0, 1}}));
      // Four stops, each robot's in another order: none is visited twice, and the first come first.
      for (RobotState& r : team) {
        r.route.clear();
        for (int k = 0; k < 4; ++k)
          r.route.push_back(stop_at(6.0 * k + random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2),
                                    random.uniform(-0.3, 0.3), {{k, 0, 0}}));
        for (std::size_t k = 3; k > 0; --k)
          std::swap(r.route[k], r.route[static_cast<std::size_t>(
                                    random.uniform(0.0, 1.0 + static_cast<double>(k) - 1e-9))]);
      }
      for (const auto& [stop, times] : visits(team, 4)) CHECK(times == 1);
    }
}
}  // namespace
