// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the fleet room: planners and the missions that run them.
#pragma once

#include <surfleet/fleet/fwd.hpp>

#include <surfleet/fleet/agent.hpp>
#include <surfleet/fleet/central_planning.hpp>
#include <surfleet/fleet/coverage_tour.hpp>
#include <surfleet/fleet/opening_look.hpp>
#include <surfleet/fleet/plan.hpp>
#include <surfleet/fleet/rate_planner.hpp>
#include <surfleet/fleet/rate_then_tours.hpp>
#include <surfleet/fleet/robot_body.hpp>
#include <surfleet/fleet/robot_kind.hpp>
#include <surfleet/fleet/surface_belief.hpp>
#include <surfleet/fleet/tour_ahead.hpp>
#include <surfleet/fleet/tour_planner.hpp>
#include <surfleet/fleet/tours_behind.hpp>
#include <surfleet/fleet/with_space_looks.hpp>
