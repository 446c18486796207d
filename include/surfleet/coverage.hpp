// SPDX-License-Identifier: MIT
/// @file  Voronoi coverage: the plane, obstacles, unknown ground, curved surfaces; sweeps.
#pragma once

#include <surfleet/coverage/centroid.hpp>
#include <surfleet/coverage/coverage_network.hpp>
#include <surfleet/coverage/density.hpp>
#include <surfleet/coverage/lloyd.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/metric_field.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>
#include <surfleet/coverage/wavefront_propagation.hpp>
