// SPDX-License-Identifier: MIT
/// @file
/// @brief Which of two planners is asked: flights by rate or tours.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include <surfleet/planning/plan.hpp>

namespace surfleet {
/// A planner that says what its last plan was good for: `last_rate()` is the worth per metre of its
/// best stop [m²/m], `broadest_look()` the most that any look it tried would have shown [m²].
template <typename P>
concept RatingPlanner = FleetPlanner<P> && requires(const P& planner) {
  { planner.last_rate() } -> std::convertible_to<double>;
  { planner.broadest_look() } -> std::convertible_to<double>;
};

/// Fast flights while there is much to see, tours for what is left.
///
/// The second planner takes over once the first one's rate, averaged over its last few requests,
/// has sunk below a share of its mean over the mission and nothing broad is in sight anywhere, or
/// when it finds nothing. What the tours discover can be broad again: then the first one is back.
template <RatingPlanner First, FleetPlanner Then>
class RateThenTours {
 public:
  First first;
  Then then;
  /// Of the mean rate: in a team some have nothing good left long before the others.
  double team_share = 0.4, lone_share = 0.1;
  double broad = 0.3;  ///< Share of the broadest look of the mission that still counts as broad.
  /// Once tours have begun, nobody in a team leaves his for what is farther off than this, over the
  /// range: those who are there will have seen it by then.
  double far = 2.4;
  int memory = 4;  ///< Requests a robot that the recent rate is averaged over.
  /// When a new plan is wanted, whichever is asked, if the first planner does not say: in a team
  /// what one was sent for others see on their way, besides.
  double team_utility_share = 0.1, lone_utility_share = 0.2;

  explicit RateThenTours(First f = First{}, Then t = Then{})
      : first(std::move(f)), then(std::move(t)) {}

  Plan operator()(const SurfaceSituation& situation) {
    Plan result = choose(situation);
    result.replan = rule(situation);
    return result;
  }
  ReplanRule rule(const SurfaceSituation& situation) const {
    return {.utility_share = first_rule_.utility_share.value_or(
                !situation.alone() ? team_utility_share : lone_utility_share),
            .turn_in_flight = true,
            .watch_on = first_rule_.watch_on};
  }
  /// Whether the second planner is at work.
  bool touring() const { return touring_; }

 private:
  Plan choose(const SurfaceSituation& situation) {
    Plan result = ask(first, situation);
    first_rule_ = result.replan;
    const double rate = first.last_rate(), look = first.broadest_look();
    broadest_ = std::max(broadest_, look);
    const bool is_broad = look >= broad * broadest_ && rate > 0.0;
    if (touring_) {
      if (!is_broad) return ask(then, situation);
      touring_ = false;
      toured_ = true;
      recent_ = mean_;
      return without_far_goals(situation, std::move(result));
    }
    mean_ += (rate - mean_) / static_cast<double>(++count_);
    const double window = static_cast<double>(memory) * static_cast<double>(situation.team.size());
    recent_ += (rate - recent_) / std::min(window, static_cast<double>(count_));
    const bool all_idle = situation.asked.size() == situation.team.size();
    const double share = !situation.alone() ? team_share : lone_share;
    touring_ = (recent_ < share * mean_ && !is_broad) || (all_idle && rate <= 0.0);
    return touring_ ? ask(then, situation) : without_far_goals(situation, std::move(result));
  }
  /// In a team that has toured, gives those whose goal is far the tours they would be on.
  Plan without_far_goals(const SurfaceSituation& situation, Plan result) {
    if (!toured_ || situation.alone()) return result;
    std::vector<RobotId> robots;
    for (const auto& [r, route] : result.routes) {
      if (route.empty()) continue;
      const Point3& goal = route.front().configuration.position;
      if ((goal - situation.robot(r).at.position).norm() >
          far * situation.space().kind.camera.max_range)
        robots.push_back(r);
    }
    if (robots.empty()) return result;
    Plan tours = ask(then, situation);
    for (const RobotId r : robots)
      if (const auto tour = tours.routes.find(r);
          tour != tours.routes.end() && !tour->second.empty())
        result.routes[r] = std::move(tour->second);
    return result;
  }

  double mean_ = 0.0, recent_ = 0.0;  // rates [m²/m]
  double broadest_ = 0.0;             // look so far [m²]
  std::size_t count_ = 0;             // of requests to the first
  bool touring_ = false, toured_ = false;
  ReplanRule first_rule_;  // as the first planner would have it
};
}  // namespace surfleet
