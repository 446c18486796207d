// SPDX-License-Identifier: MIT
/// @file
/// @brief The planners behind the names that the binaries know.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/planner_names.hpp"

#include <surfleet/core/error.hpp>
#include <surfleet/fleet/rate_planner.hpp>
#include <surfleet/fleet/rate_then_tours.hpp>
#include <surfleet/fleet/tour_planner.hpp>
#include <surfleet/fleet/tours_behind.hpp>
#include <surfleet/fleet/with_space_looks.hpp>

namespace surfleet::examples {
/// What the planners are made with.
struct PlannerSettings {
  TourPlannerOptions tours;
  StopDistance cost;  ///< What our own tours take a stop for.
  MergeOptions merge;
  RatePlannerOptions rate;
  std::optional<double> utility_share;  ///< For those that have one of their own, too.
};

/// Throws `Error` for a name that is not among `kPlanners`.
inline AnyPlanner make_planner(std::string_view name, const PlannerSettings& settings) {
  planner_by_name(name);
  const TourPlannerOptions& tours = settings.tours;
  TourPlannerOptions asynchronous = tours;
  asynchronous.asynchronous = true;
  const auto made = [&](auto planner) {
    if constexpr (requires { planner.select.merge; }) planner.select.merge = settings.merge;
    return AnyPlanner(
        WithSpaceLooks(std::move(planner), SpaceLooksOptions{.distance = tours.distance}));
  };
  if (name == "tsga") return made(TsgaPlanner(tours));
  if (name == "nnb-exclusive") return made(NnbPlanner(asynchronous));
  if (name == "nnb") {
    // As printed: every robot chooses for itself, and two may choose the same cluster.
    asynchronous.exclusive = false;
    // It chooses anew "every time the ISE map is updated" [000 §3.6.1].
    asynchronous.replan.utility_share = settings.utility_share.value_or(0.1);
    NnbPlanner planner(asynchronous);
    planner.allocate.rule.exclusive = false;
    return made(std::move(planner));
  }
  if (name == "tsga-async") return made(TsgaPlanner(asynchronous));
  if (name == "tsga-improved") return made(ImprovedTsgaPlanner(tours));
  if (name == "makespan") return made(MakespanPlanner(tours));
  TourPlannerOptions reordered = tours;
  reordered.reorder_stops = true;
  reordered.least_clusters = 8;
  reordered.cost = settings.cost;
  TourPlannerOptions reordered_asynchronous = reordered;
  reordered_asynchronous.asynchronous = true;
  if (name == "tours") return made(CoverPlanner(reordered));
  RatePlannerOptions rate = settings.rate;
  if (settings.utility_share) rate.climb_alone.utility_share = *settings.utility_share;
  if (name == "rate") return made(RatePlanner(rate));
  if (name == "surfleet") {
    RateThenTours front{RatePlanner(rate), CoverPlanner(reordered)};
    if (settings.utility_share)
      front.team_utility_share = front.lone_utility_share = *settings.utility_share;
    return made(ToursBehind(std::move(front), CoverPlanner(reordered_asynchronous)));
  }
  throw Error("planner " + std::string(name) + ": named, but not made");
}
}  // namespace surfleet::examples
