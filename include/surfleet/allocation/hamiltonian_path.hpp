// SPDX-License-Identifier: MIT
/// @file
/// @brief The shortest path through a set of points from one of them: the visit of one cluster.
#pragma once

#include <vector>

#include <surfleet/allocation/exact_tour.hpp>
#include <surfleet/allocation/three_opt.hpp>
#include <surfleet/allocation/tour.hpp>

namespace surfleet {
/// An open path through every node, and its length.
struct HamiltonianPath {
  std::vector<int> order;
  double length = 0.0;
};

/// The shortest Hamiltonian path that starts at node `start` and ends anywhere [000 §2.5.1].
///
/// Up to eight nodes the optimum, beyond that what `solver` finds; the source names 3-opt.
template <TourSolver Solver = ThreeOpt>
HamiltonianPath shortest_hamiltonian_path(const CostMatrix& lengths, int start,
                                          const Solver& solver = {}) {
  TourProblem problem;
  problem.costs = lengths;
  problem.open = true;
  problem.start = start;
  Tour tour = lengths.size() <= 8 ? ExactTour{}(problem) : solver(problem);
  return {std::move(tour.order), tour.length};
}
/// The same from node 0 for lengths that are told by `length(i, j)`, i > j, and symmetric.
template <TourSolver Solver = ThreeOpt, typename Length>
HamiltonianPath shortest_hamiltonian_path(int nodes, Length&& length, const Solver& solver = {}) {
  CostMatrix lengths(nodes);
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < i; ++j) lengths(i, j) = lengths(j, i) = length(i, j);
  return shortest_hamiltonian_path(lengths, 0, solver);
}
}  // namespace surfleet
