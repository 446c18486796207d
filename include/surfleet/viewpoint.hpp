// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the viewpoint room.
#pragma once

#include <surfleet/viewpoint/fwd.hpp>

#include <surfleet/viewpoint/coverage_estimate.hpp>
#include <surfleet/viewpoint/frontier_view.hpp>
#include <surfleet/viewpoint/frontiers.hpp>
#include <surfleet/viewpoint/gain.hpp>
#include <surfleet/viewpoint/gain_around.hpp>
#include <surfleet/viewpoint/incomplete_element.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/left_reason.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>
#include <surfleet/viewpoint/surface_prediction.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/view_ledger.hpp>
#include <surfleet/viewpoint/view_limits.hpp>
#include <surfleet/viewpoint/view_memory.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>
#include <surfleet/viewpoint/viewpoint_clustering.hpp>
#include <surfleet/viewpoint/viewpoint_cover.hpp>
#include <surfleet/viewpoint/viewpoint_generation.hpp>
#include <surfleet/viewpoint/viewpoint_merging.hpp>
#include <surfleet/viewpoint/viewpoint_predicates.hpp>
#include <surfleet/viewpoint/visibility.hpp>
