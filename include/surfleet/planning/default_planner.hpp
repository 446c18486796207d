// SPDX-License-Identifier: MIT
/// @file
/// @brief The planner to take where nothing speaks for another.
///
///     Simulation<DefaultPlanner, World> simulation(options, world, starts,
///                                                  default_planner({.standoff = 3.6}));
#pragma once

#include <utility>

#include <surfleet/planning/planner_settings.hpp>
#include <surfleet/planning/rate_planner.hpp>
#include <surfleet/planning/rate_then_tours.hpp>
#include <surfleet/planning/tour_planner.hpp>
#include <surfleet/planning/tours_behind.hpp>
#include <surfleet/planning/with_space_looks.hpp>

namespace surfleet {
/// Flights by marginal rate while there is much to discover, tours over the rest, tours behind the
/// front in high regions, and looks into unseen space when nothing else is left.
using DefaultPlanner =
    WithSpaceLooks<ToursBehind<RateThenTours<RatePlanner, CoverPlanner>, CoverPlanner>>;

/// Options of tours as the published method has them.
inline TourPlannerOptions published_tours(const PlannerSettings& s, bool bounded_clusters) {
  TourPlannerOptions tours;
  tours.distance = s.standoff;
  tours.clusters = {.radius = s.cluster_radius,
                    .max_radius = s.cluster_max_radius,
                    .max_extent = bounded_clusters ? 2.0 * s.cluster_max_radius : 0.0};
  tours.by_path = s.cluster_by_path;
  tours.utility = {.lambda_tc = s.lambda_tc, .lambda_ic = s.lambda_ic};
  return tours;
}
/// And as our own have them: finer clusters, stops put in order by what they cost.
inline TourPlannerOptions reordered_tours(const PlannerSettings& s) {
  TourPlannerOptions tours = published_tours(s, true);
  tours.reorder_stops = true;
  tours.least_clusters = 8;
  // A stop takes some two seconds, with the braking before it and the images there.
  tours.cost = {.stop = 2.0 * s.speed, .turn = s.speed / s.yaw_rate};
  return tours;
}

inline RatePlannerOptions rate_options(const PlannerSettings& s) {
  RatePlannerOptions rate;
  if (s.utility_share) rate.climb_alone.utility_share = *s.utility_share;
  return rate;
}

inline DefaultPlanner default_planner(const PlannerSettings& s = {}) {
  RateThenTours front{RatePlanner(rate_options(s)), CoverPlanner(reordered_tours(s))};
  if (s.utility_share) front.team_utility_share = front.lone_utility_share = *s.utility_share;
  TourPlannerOptions behind = reordered_tours(s);
  behind.asynchronous = true;
  return WithSpaceLooks(ToursBehind(std::move(front), CoverPlanner(behind)),
                        SpaceLooksOptions{.distance = s.standoff});
}
static_assert(FleetPlanner<DefaultPlanner>);
}  // namespace surfleet
