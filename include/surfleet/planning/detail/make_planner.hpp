// SPDX-License-Identifier: MIT
/// @file
/// @brief How the planners that have names are made.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <surfleet/core/compiled.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/planning/default_planner.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/planning/tour_planner.hpp>

namespace surfleet {
namespace detail {
/// What both have.
inline TourPlannerOptions tours_by(const PlannerSettings& s) {
  TourPlannerOptions tours;
  tours.distance = s.standoff;
  tours.clusters = {.radius = s.cluster_radius, .max_radius = s.cluster_max_radius};
  tours.by_path = s.cluster_by_path;
  return tours;
}
inline TourPlannerOptions printed_tours(const PlannerSettings& s) {
  TourPlannerOptions tours = tours_by(s);
  tours.asynchronous = true;
  tours.replan.utility_share = s.utility_share.value_or(s.printed_share);
  tours.replan.as_printed = true;
  return tours;
}
/// With bounded clusters, and plans for all at once.
inline TourPlannerOptions own_tours(const PlannerSettings& s) {
  TourPlannerOptions tours = tours_by(s);
  tours.clusters.max_extent = 2.0 * s.cluster_max_radius;
  tours.replan.utility_share = s.utility_share;
  return tours;
}
/// Finer clusters, stops put in order by what they cost.
inline TourPlannerOptions reordered_tours(const PlannerSettings& s) {
  TourPlannerOptions tours = own_tours(s);
  tours.reorder_stops = true;
  tours.least_clusters = 8;
  // A stop takes some two seconds, with the braking before it and the images there.
  tours.cost = {.stop = 2.0 * s.speed, .turn = s.speed / s.yaw_rate};
  return tours;
}
}  // namespace detail

SURFLEET_INLINE AnyPlanner make_planner(std::string_view name, const PlannerSettings& settings) {
  const NamedPlanner& named = planner_by_name(name);
  const auto made = [&](auto planner) {
    if constexpr (requires { planner.select.merge; }) planner.select.merge = settings.merge;
    planner.utility = {.lambda_tc = settings.lambda_tc, .lambda_ic = settings.lambda_ic};
    planner.gain.ends_at_unknown = named.as_printed;
    if (!named.as_printed)
      return AnyPlanner(WithFrontierViews(std::move(planner),
                                          FrontierViewsOptions{.distance = settings.standoff}));
    AnyPlanner printed(std::move(planner));
    printed.observed_share = 1.0;
    return printed;
  };
  if (name == "surfleet") return default_planner(settings);
  if (name == "tsga") return made(TsgaPlanner(detail::printed_tours(settings)));
  if (name == "nnb") {
    // Every robot chooses for itself, and two may choose the same cluster.
    TourPlannerOptions tours = detail::printed_tours(settings);
    tours.exclusive = false;
    tours.replan.every_map = true;
    NnbPlanner planner(tours);
    planner.allocate.rule.exclusive = false;
    return made(std::move(planner));
  }
  if (name == "tsga-plus") return made(ImprovedTsgaPlanner(detail::own_tours(settings)));
  if (name == "nnb-plus") {
    TourPlannerOptions tours = detail::own_tours(settings);
    tours.asynchronous = true;
    return made(NnbPlanner(tours));
  }
  if (name == "makespan") return made(MakespanPlanner(detail::own_tours(settings)));
  if (name == "tours") return made(CoverPlanner(detail::reordered_tours(settings)));
  throw Error("planner " + std::string(name) + ": named, but not made");
}
}  // namespace surfleet
