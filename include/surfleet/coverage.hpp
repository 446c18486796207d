// SPDX-License-Identifier: MIT
/// @file  Voronoi coverage: the plane, obstacles, unknown ground, curved surfaces; sweeps.
#pragma once

#include <surfleet/coverage/centroid.hpp>
#include <surfleet/coverage/coverage_network.hpp>
#include <surfleet/coverage/density.hpp>
#include <surfleet/coverage/lloyd.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>
