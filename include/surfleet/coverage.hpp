// SPDX-License-Identifier: MIT
/// @file
/// @brief Voronoi coverage: the plane, obstacles, unknown ground, curved surfaces; sweeps.
#pragma once

#include <surfleet/coverage/fwd.hpp>

#include <surfleet/coverage/balance_regions.hpp>
#include <surfleet/coverage/centroid.hpp>
#include <surfleet/coverage/coverage_grid.hpp>
#include <surfleet/coverage/coverage_network.hpp>
#include <surfleet/coverage/covering_strip.hpp>
#include <surfleet/coverage/density.hpp>
#include <surfleet/coverage/discoverage.hpp>
#include <surfleet/coverage/geodesic_coverage.hpp>
#include <surfleet/coverage/gradient_projection.hpp>
#include <surfleet/coverage/hybrid_area_coverage.hpp>
#include <surfleet/coverage/hybrid_coverage.hpp>
#include <surfleet/coverage/hybrid_flocking.hpp>
#include <surfleet/coverage/hybrid_voronoi.hpp>
#include <surfleet/coverage/lloyd.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/metric_field.hpp>
#include <surfleet/coverage/nonconvex_coverage.hpp>
#include <surfleet/coverage/p_median.hpp>
#include <surfleet/coverage/p_median_bound.hpp>
#include <surfleet/coverage/pattern_formation.hpp>
#include <surfleet/coverage/prism_coverage.hpp>
#include <surfleet/coverage/random_coverage.hpp>
#include <surfleet/coverage/reeb_graph.hpp>
#include <surfleet/coverage/robotic_band.hpp>
#include <surfleet/coverage/surface_coverage.hpp>
#include <surfleet/coverage/surface_maps.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/coverage/surface_regions.hpp>
#include <surfleet/coverage/sweep_paths.hpp>
#include <surfleet/coverage/vertex_exchange.hpp>
#include <surfleet/coverage/vertex_substitution.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>
#include <surfleet/coverage/wavefront_propagation.hpp>
