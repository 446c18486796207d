// SPDX-License-Identifier: MIT
/// @file
/// @brief Questions to a planner, and when another would be in vain.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
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
  /// Routes that are expected to show less new surface for a metre flown are left out of plans
  /// [m²/m]; 0: none.
  double least_gain = 0.0;
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
    leave_out_what_does_not_pay(situation, plan);
    if (on_plan) on_plan(situation, plan);
    planned_revision_ = belief.known().grid().revision();
    every_map_ = plan.replan.every_map;
    nothing_planned_ = plan.nothing();
    impossible_ = std::move(plan.impossible);
    return plan;
  }
  /// Whether the last plan was made of this very map.
  bool up_to_date(const SurfaceBelief& belief) const {
    return planned_revision_ == belief.known().grid().revision();
  }
  /// Whether all are to be planned for, as the map is another than that of the last plan.
  bool is_due(const SurfaceBelief& belief) const { return every_map_ && !up_to_date(belief); }
  /// Whether, of this very map, it found nothing, or time after time nothing that can be reached.
  bool exhausted(const SurfaceBelief& belief) const {
    return up_to_date(belief) &&
           (nothing_planned_ || vain_plans_ > belief.options().ledger.max_failures);
  }

  /// What the routes that the last plan left out, as they did not pay, would have brought; nothing
  /// if there were none.
  const std::optional<Yield>& left_out() const { return left_out_; }
  /// The elements that the last plan had no view of.
  const std::vector<std::pair<VoxelIndex, LeftReason>>& impossible() const { return impossible_; }
  std::size_t plans() const { return plans_; }
  double planning_time() const { return planning_time_; }  ///< Of the machine [s].

 private:
  /// By what a route's stops are for, along straight lines. Stops that are for no element, but to
  /// see what is there, may gain anything.
  static std::optional<Outlook> by_targets(const SurfaceSituation& s, RobotId id,
                                           const Stops& route) {
    const double area = s.belief.voxel_size() * s.belief.voxel_size();
    Point3 here = s.robot(id).at.position;
    Outlook outlook;
    for (const Stop& stop : route) {
      if (stop.targets.empty()) return std::nullopt;
      outlook.add(area * static_cast<double>(stop.targets.size()),
                  (stop.configuration.position - here).norm());
      here = stop.configuration.position;
    }
    return outlook;
  }
  void leave_out_what_does_not_pay(const SurfaceSituation& s, Plan& plan) {
    left_out_.reset();
    if (!(least_gain > 0.0)) return;
    for (auto& [id, route] : plan.routes) {
      if (route.empty()) continue;
      const auto told = plan.outlook.find(id);
      const auto outlook =
          told != plan.outlook.end() ? std::optional(told->second) : by_targets(s, id, route);
      if (!outlook || outlook->best().gain >= least_gain * outlook->best().distance) continue;
      if (!left_out_) left_out_.emplace();
      left_out_->gain += outlook->whole().gain;
      left_out_->distance += outlook->whole().distance;
      route.clear();
    }
  }

  std::optional<Yield> left_out_;
  std::vector<std::pair<VoxelIndex, LeftReason>> impossible_;
  std::uint64_t planned_revision_ = ~std::uint64_t{0};
  bool nothing_planned_ = false, every_map_ = false;
  int vain_plans_ = 0;  // made with all at rest, since a robot last set out
  std::size_t departures_ = 0, plans_ = 0;
  double planning_time_ = 0.0;
};
}  // namespace surfleet
