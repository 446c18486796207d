// SPDX-License-Identifier: MIT
/// @file
/// @brief The planner to take where nothing speaks for another.
///
///     Simulation<DefaultPlanner, World> simulation(options, world, starts,
///                                                  default_planner({.standoff = 3.6}));
#pragma once

#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/planner_settings.hpp>
#include <surfleet/planning/rolling_tours.hpp>
#include <surfleet/planning/with_frontier_views.hpp>

namespace surfleet {
/// Rolling tours of the team, and views into unknown space when nothing else is left.
using DefaultPlanner = WithFrontierViews<RollingTours>;

inline DefaultPlanner default_planner(const PlannerSettings& s = {}) {
  RollingToursOptions tours;
  tours.threads = s.threads;
  if (s.utility_share) tours.utility_share = *s.utility_share;
  return WithFrontierViews(RollingTours(tours), FrontierViewsOptions{.distance = s.standoff});
}
static_assert(FleetPlanner<DefaultPlanner>);
}  // namespace surfleet
