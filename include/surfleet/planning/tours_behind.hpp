// SPDX-License-Identifier: MIT
/// @file
/// @brief Some of a team tour what the others leave behind.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <surfleet/planning/plan.hpp>

namespace surfleet {
/// A planner that advances first and says when it has come to touring what is left, and by which
/// rule it is to be asked again.
template <typename P>
concept AdvancingPlanner = FleetPlanner<P> &&
    requires(const P& planner, const SurfaceSituation& r) {
  { planner.touring() } -> std::convertible_to<bool>;
  { planner.rule(r) } -> std::same_as<ReplanRule>;
};

struct ToursBehindOptions {
  double apart = 2.4;          ///< So far from the front is behind it, over the camera's range.
  double most = 0.6;           ///< Robots that tour behind at most, over the team's size.
  double fair_share = 1.0;     ///< Work behind for each of them, over what there is for each robot.
  std::size_t least_team = 3;  ///< In smaller ones nobody is taken from the front.
  double least_height = 4.0;   ///< Of the region, over the range, for a front to leave much below.
};

/// A front that advances, and robots that tour what it leaves behind.
///
/// A team that follows a structure up or along leaves single elements all over it, which pay least
/// as long as there is anything new; in the end all come back for them together, and meanwhile the
/// front is no faster for being crowded. So while `front` advances, robots are taken from it: k of
/// n once more than k/n of the elements are `apart` from every robot that stays. Those are given to
/// `behind`, asked for these elements and robots alone; who finds nothing to do there any more is
/// the front's again. When `front` tours, all are. Where the region is not high, robots come back
/// to what they left at little cost, and nobody is taken from the front. The elements that `behind`
/// is asked for come and go as robots fly, so it may remember nothing of which there are: a
/// `TourPlanner` must be asynchronous and exclusive.
template <AdvancingPlanner Front, FleetPlanner Behind>
class ToursBehind {
 public:
  Front front;
  Behind behind;
  ToursBehindOptions options;

  explicit ToursBehind(Front f = Front{}, Behind b = Behind{}, ToursBehindOptions o = {})
      : front(std::move(f)), behind(std::move(b)), options(o) {}

  Plan operator()(const SurfaceSituation& situation) {
    if (situation.team.size() < options.least_team || front.touring() ||
        relative_height(situation) < options.least_height)
      return everyone(situation);
    std::vector<RobotState> team(situation.team.begin(), situation.team.end());
    std::vector<RobotId> asked(situation.asked.begin(), situation.asked.end());
    const std::vector<IncompleteElement> left = left_behind(situation);
    recruit(situation, left, asked);
    Plan tours = tour(situation, left, team, asked);
    if (asked.empty()) return tours;
    SurfaceSituation ahead = situation;
    ahead.team = team;
    ahead.asked = asked;
    Plan result = ask(front, ahead);
    if (front.touring()) {
      crew_.clear();
      return result;
    }
    for (auto& [robot, route] : tours.routes) result.routes[robot] = std::move(route);
    return result;
  }
  /// The robots that tour behind the front, in the order they were taken.
  const std::vector<RobotId>& crew() const { return crew_; }

 private:
  Plan everyone(const SurfaceSituation& situation) {
    crew_.clear();
    return ask(front, situation);
  }
  bool tours_behind(RobotId robot) const {
    return std::find(crew_.begin(), crew_.end(), robot) != crew_.end();
  }

  /// The elements apart from every robot of the front. O(elements · robots).
  std::vector<IncompleteElement> left_behind(const SurfaceSituation& situation) const {
    const double apart = options.apart * situation.space().kind.camera.max_range;
    std::vector<Point3> ahead;
    for (const RobotState& robot : situation.team)
      if (!tours_behind(robot.id)) ahead.push_back(robot.at.position);
    std::vector<IncompleteElement> left;
    for (const IncompleteElement& e : situation.goals)
      if (std::none_of(ahead.begin(), ahead.end(), [&](const Point3& p) {
            return (p - e.position).squaredNorm() < apart * apart;
          }))
        left.push_back(e);
    return left;
  }
  /// One robot more, the nearest to the middle of what is left, if that is more than the share of
  /// those who are at it.
  void recruit(const SurfaceSituation& situation, const std::vector<IncompleteElement>& left,
               std::vector<RobotId>& asked) {
    const auto team = static_cast<double>(situation.team.size());
    const auto next = static_cast<double>(crew_.size() + 1);
    const double fair = options.fair_share * static_cast<double>(situation.goals.size()) / team;
    if (next > options.most * team ||
        static_cast<double>(left.size()) <= static_cast<double>(in_vain_) + next * fair)
      return;
    Point3 middle = Point3::Zero();
    for (const IncompleteElement& e : left) middle += e.position;
    middle /= static_cast<double>(left.size());
    const RobotState* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const RobotState& robot : situation.team) {
      const double d = (robot.at.position - middle).squaredNorm();
      if (tours_behind(robot.id) || d >= least) continue;
      least = d;
      nearest = &robot;
    }
    crew_.push_back(nearest->id);
    if (const auto at = std::lower_bound(asked.begin(), asked.end(), nearest->id);
        at == asked.end() || *at != nearest->id)
      asked.insert(at, nearest->id);
  }
  /// Routes for those of the crew who wait for one; to the front they are all busy then. Whoever is
  /// left without leaves the crew.
  Plan tour(const SurfaceSituation& situation, const std::vector<IncompleteElement>& left,
            std::vector<RobotState>& team, std::vector<RobotId>& asked) {
    Plan result;
    result.replan = front.rule(situation);
    std::vector<RobotState> crew;
    std::vector<RobotId> waiting;
    for (const RobotState& robot : team) {
      if (!tours_behind(robot.id)) continue;
      crew.push_back(robot);
      if (std::binary_search(asked.begin(), asked.end(), robot.id)) waiting.push_back(robot.id);
    }
    if (!waiting.empty()) {
      SurfaceSituation rear = situation;
      rear.goals = left;
      rear.team = crew;
      rear.asked = waiting;
      Plan tours = ask(behind, rear);
      result.impossible = std::move(tours.impossible);
      for (auto& [robot, route] : tours.routes) {
        if (route.empty()) {
          in_vain_ = left.size();
          std::erase(crew_, robot);
        } else {
          result.routes[robot] = std::move(route);
        }
      }
    }
    std::erase_if(asked, [this](RobotId robot) { return tours_behind(robot); });
    for (RobotState& robot : team)
      if (const auto route = result.routes.find(robot.id); route != result.routes.end())
        robot.route = route->second;
    return result;
  }

  std::vector<RobotId> crew_;
  std::size_t in_vain_ = 0;  // elements behind when one of the crew was last left without a route
};
}  // namespace surfleet
