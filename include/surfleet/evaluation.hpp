// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the room `evaluation`: metrics, statistics, pictures, plots and reports.
#pragma once

#include <surfleet/evaluation/fwd.hpp>

#include <surfleet/evaluation/best_heading_view.hpp>
#include <surfleet/evaluation/color_map.hpp>
#include <surfleet/evaluation/image.hpp>
#include <surfleet/evaluation/m3c2.hpp>
#include <surfleet/evaluation/observable_surface.hpp>
#include <surfleet/evaluation/oriented_coverage.hpp>
#include <surfleet/evaluation/plot.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/evaluation/reachable_lattice.hpp>
#include <surfleet/evaluation/reconstruction_metrics.hpp>
#include <surfleet/evaluation/render_view.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/evaluation/surface_sampling.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
