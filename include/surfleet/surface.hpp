// SPDX-License-Identifier: MIT
/// @file
/// @brief Driving on surfaces: walks, triangle strips, fields, vehicles, point clouds.
#pragma once

#include <surfleet/surface/fwd.hpp>

#include <surfleet/surface/cloud_tokens.hpp>
#include <surfleet/surface/creases.hpp>
#include <surfleet/surface/dense_planner.hpp>
#include <surfleet/surface/drive_path.hpp>
#include <surfleet/surface/feature_maps.hpp>
#include <surfleet/surface/follow_field.hpp>
#include <surfleet/surface/geodesic_strip.hpp>
#include <surfleet/surface/greedy_projection.hpp>
#include <surfleet/surface/moving_least_squares.hpp>
#include <surfleet/surface/patch_drive.hpp>
#include <surfleet/surface/quadric_patch.hpp>
#include <surfleet/surface/scan.hpp>
#include <surfleet/surface/scan_triangulation.hpp>
#include <surfleet/surface/sheet_tokens.hpp>
#include <surfleet/surface/single_strip.hpp>
#include <surfleet/surface/smooth_path.hpp>
#include <surfleet/surface/sparse_planner.hpp>
#include <surfleet/surface/strip_field.hpp>
#include <surfleet/surface/strip_path.hpp>
#include <surfleet/surface/strip_replanning.hpp>
#include <surfleet/surface/strip_search.hpp>
#include <surfleet/surface/surface_point.hpp>
#include <surfleet/surface/surface_vehicles.hpp>
#include <surfleet/surface/surface_walk.hpp>
#include <surfleet/surface/tensor_voting.hpp>
#include <surfleet/surface/tracking_control.hpp>
#include <surfleet/surface/triangle_strip.hpp>
