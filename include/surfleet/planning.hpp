// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the planning room: what is believed, what a planner is asked, and planners.
#pragma once

#include <surfleet/planning/fwd.hpp>

#include <surfleet/planning/cluster_gain.hpp>
#include <surfleet/planning/coverage_tour.hpp>
#include <surfleet/planning/default_planner.hpp>
#include <surfleet/planning/interest.hpp>
#include <surfleet/planning/lattice_views.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/planning/opening_view.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/planner_settings.hpp>
#include <surfleet/planning/robot_kind.hpp>
#include <surfleet/planning/rolling_tours.hpp>
#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/planning/team_tour.hpp>
#include <surfleet/planning/tour_planner.hpp>
#include <surfleet/planning/with_frontier_views.hpp>
