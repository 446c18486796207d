// SPDX-License-Identifier: MIT
/// @file
/// @brief Questions to a planner, and when another would be in vain.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
/// A planner with what is remembered of its plans, whoever owns the belief and asks.
template <FleetPlanner Planner>
class PlanRequests {
 public:
  Planner planner;
  /// Told of every question and its answer, before the answer is carried out.
  std::function<void(const SurfaceSituation&, const Plan&)> on_plan;

  explicit PlanRequests(Planner p = {}) : planner(std::move(p)) {}

  /// Asks. `departures` says how often the robots have set out so far, `at_rest` that none of them
  /// has anything to do. What is impossible is kept here, not in the plan.
  Plan operator()(const SurfaceBelief& belief, std::span<const RobotId> asked,
                  std::span<const RobotState> team, std::size_t departures, bool at_rest,
                  double time) {
    if (std::exchange(departures_, departures) != departures) vain_plans_ = 0;
    if (at_rest) ++vain_plans_;
    const SurfaceSituation situation{.belief = belief,
                                     .goals = belief.goals(),
                                     .asked = asked,
                                     .team = team,
                                     .time = time,
                                     .seed = plans_};
    const auto before = std::chrono::steady_clock::now();
    Plan plan = ask(planner, situation);
    planning_time_ +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    ++plans_;
    if (on_plan) on_plan(situation, plan);
    planned_revision_ = belief.known().grid().revision();
    nothing_planned_ = plan.nothing();
    impossible_ = std::move(plan.impossible);
    return plan;
  }
  /// Whether the last plan was made of this very map.
  bool up_to_date(const SurfaceBelief& belief) const {
    return planned_revision_ == belief.known().grid().revision();
  }
  /// Whether, of this very map, it found nothing, or time after time nothing that can be reached.
  bool exhausted(const SurfaceBelief& belief) const {
    return up_to_date(belief) &&
           (nothing_planned_ || vain_plans_ > belief.options().looks.max_failures);
  }

  /// The elements that the last plan had no way to see.
  const std::vector<std::pair<VoxelIndex, LeftReason>>& impossible() const { return impossible_; }
  std::size_t plans() const { return plans_; }
  double planning_time() const { return planning_time_; }  ///< Of the machine [s].

 private:
  std::vector<std::pair<VoxelIndex, LeftReason>> impossible_;
  std::uint64_t planned_revision_ = ~std::uint64_t{0};
  bool nothing_planned_ = false;
  int vain_plans_ = 0;  // made with all at rest, since a robot last set out
  std::size_t departures_ = 0, plans_ = 0;
  double planning_time_ = 0.0;
};
}  // namespace surfleet
