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

#include <surfleet/fleet/plan.hpp>

namespace surfleet {
/// A planner that advances first and says when it has come to touring what is left, and by which
/// rule it is to be asked again.
template <typename P>
concept AdvancingPlanner = FleetPlanner<P> && requires(const P& planner, const PlanRequest& r) {
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

  PlanResult operator()(const PlanRequest& request) {
    if (request.robots.size() < options.least_team || front.touring() ||
        request.relative_height() < options.least_height)
      return everyone(request);
    std::vector<RobotRequest> robots(request.robots.begin(), request.robots.end());
    const std::vector<IncompleteElement> left = left_behind(request);
    recruit(request, left, robots);
    PlanResult tours = tour(request, left, robots);
    const auto waits = [](const RobotRequest& r) { return r.idle; };
    if (std::none_of(robots.begin(), robots.end(), waits)) return tours;
    PlanRequest ahead = request;
    ahead.robots = robots;
    PlanResult result = ask(front, ahead);
    if (front.touring()) {
      crew_.clear();
      return result;
    }
    for (const std::size_t r : crew_)
      if (tours.routes[r]) result.routes[r] = std::move(tours.routes[r]);
    return result;
  }
  /// The robots that tour behind the front, in the order they were taken.
  const std::vector<std::size_t>& crew() const { return crew_; }

 private:
  PlanResult everyone(const PlanRequest& request) {
    crew_.clear();
    return ask(front, request);
  }
  bool tours_behind(std::size_t robot) const {
    return std::find(crew_.begin(), crew_.end(), robot) != crew_.end();
  }

  /// The elements apart from every robot of the front. O(elements · robots).
  std::vector<IncompleteElement> left_behind(const PlanRequest& request) const {
    const double apart = options.apart * request.camera.max_range;
    std::vector<Point3> ahead;
    for (std::size_t r = 0; r < request.robots.size(); ++r)
      if (!tours_behind(r)) ahead.push_back(request.robots[r].configuration.position);
    std::vector<IncompleteElement> left;
    for (const IncompleteElement& e : request.work)
      if (std::none_of(ahead.begin(), ahead.end(), [&](const Point3& p) {
            return (p - e.position).squaredNorm() < apart * apart;
          }))
        left.push_back(e);
    return left;
  }
  /// One robot more, the nearest to the middle of what is left, if that is more than the share of
  /// those who are at it.
  void recruit(const PlanRequest& request, const std::vector<IncompleteElement>& left,
               std::vector<RobotRequest>& robots) {
    const auto team = static_cast<double>(robots.size());
    const auto next = static_cast<double>(crew_.size() + 1);
    const double fair = options.fair_share * static_cast<double>(request.work.size()) / team;
    if (next > options.most * team ||
        static_cast<double>(left.size()) <= static_cast<double>(in_vain_) + next * fair)
      return;
    Point3 middle = Point3::Zero();
    for (const IncompleteElement& e : left) middle += e.position;
    middle /= static_cast<double>(left.size());
    std::size_t nearest = robots.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < robots.size(); ++r) {
      const double d = (robots[r].configuration.position - middle).squaredNorm();
      if (tours_behind(r) || d >= least) continue;
      least = d;
      nearest = r;
    }
    crew_.push_back(nearest);
    robots[nearest].idle = true;
    robots[nearest].remaining.clear();
  }
  /// Routes for those of the crew who wait for one; to the front they are all busy then. Whoever is
  /// left without leaves the crew.
  PlanResult tour(const PlanRequest& request, const std::vector<IncompleteElement>& left,
                  std::vector<RobotRequest>& robots) {
    PlanResult result;
    result.routes.resize(robots.size());
    result.replan = front.rule(request);
    std::vector<RobotRequest> crew;
    for (const std::size_t r : crew_) crew.push_back(robots[r]);
    if (std::any_of(crew.begin(), crew.end(), [](const RobotRequest& r) { return r.idle; })) {
      PlanRequest rear = request;
      rear.work = left;
      rear.robots = crew;
      PlanResult tours = ask(behind, rear);
      result.impossible = std::move(tours.impossible);
      std::vector<std::size_t> stay;
      for (std::size_t k = 0; k < crew.size(); ++k) {
        if (tours.routes[k] && tours.routes[k]->empty()) {
          in_vain_ = left.size();
          continue;
        }
        stay.push_back(crew_[k]);
        result.routes[crew_[k]] = std::move(tours.routes[k]);
      }
      crew_ = std::move(stay);
    }
    for (const std::size_t r : crew_) {
      robots[r].idle = false;
      if (result.routes[r]) robots[r].remaining = *result.routes[r];
    }
    return result;
  }

  std::vector<std::size_t> crew_;
  std::size_t in_vain_ = 0;  // elements behind when one of the crew was last left without a route
};
}  // namespace surfleet
