// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the allocation room: tours, cluster graphs, and which robot visits what.
#pragma once

#include <surfleet/allocation/fwd.hpp>

#include <surfleet/allocation/assignment.hpp>
#include <surfleet/allocation/cheapest_insertion.hpp>
#include <surfleet/allocation/cluster_graph.hpp>
#include <surfleet/allocation/cost_matrix.hpp>
#include <surfleet/allocation/exact_tour.hpp>
#include <surfleet/allocation/greedy_allocator.hpp>
#include <surfleet/allocation/hamiltonian_path.hpp>
#include <surfleet/allocation/improve_allocation.hpp>
#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/allocation/route.hpp>
#include <surfleet/allocation/three_opt.hpp>
#include <surfleet/allocation/tour.hpp>
#include <surfleet/allocation/tsplib.hpp>
