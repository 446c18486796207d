// SPDX-License-Identifier: MIT
/// @file
/// @brief The optimal tour of a few nodes by dynamic programming.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <surfleet/allocation/tour.hpp>

namespace surfleet {
namespace detail {
/// The cheapest closed tour over all nodes [Held & Karp 1962]. O(2ⁿ n²) time, O(2ⁿ n) memory.
inline std::vector<int> held_karp(const CostMatrix& costs) {
  const int n = costs.size();
  std::vector<int> cycle;
  if (n == 0) return cycle;
  const int m = n - 1;  // all nodes but the last, which the tour is opened at
  const std::size_t sets = std::size_t{1} << m;
  const auto at = [m](std::size_t set, int last) {
    return set * static_cast<std::size_t>(m) + last;
  };
  // best[set, last]: cheapest path from node m through `set`, ending in `last`.
  std::vector<double> best(sets * static_cast<std::size_t>(m),
                           std::numeric_limits<double>::infinity());
  for (int i = 0; i < m; ++i) best[at(std::size_t{1} << i, i)] = costs(m, i);
  for (std::size_t set = 1; set < sets; ++set) {
    for (int last = 0; last < m; ++last) {
      if ((set >> last & 1U) == 0U) continue;
      const double here = best[at(set, last)];
      for (int next = 0; next < m; ++next) {
        if ((set >> next & 1U) != 0U) continue;
        double& there = best[at(set | std::size_t{1} << next, next)];
        there = std::min(there, here + costs(last, next));
      }
    }
  }
  cycle.push_back(m);
  int after = m;
  for (std::size_t set = sets - 1; set != 0;) {
    int choice = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int last = 0; last < m; ++last) {
      if ((set >> last & 1U) == 0U) continue;
      const double total = best[at(set, last)] + costs(last, after);
      if (choice < 0 || total < least) choice = last, least = total;
    }
    cycle.push_back(choice);
    set &= ~(std::size_t{1} << choice);
    after = choice;
  }
  std::reverse(cycle.begin() + 1, cycle.end());
  return cycle;
}
}  // namespace detail

/// The optimum, for problems of at most `max_nodes` nodes. Its bound is its length.
struct ExactTour {
  int max_nodes = 15;  ///< At most 20: memory doubles with every node (5 MB at 15).

  /// Throws `Error` for a larger problem. O(2ⁿ n²).
  Tour operator()(const TourProblem& problem) const {
    require(max_nodes >= 0 && max_nodes <= 20,
            "exact tour: max_nodes " + std::to_string(max_nodes) + "; expected 0 to 20");
    require(problem.costs.size() <= max_nodes,
            "exact tour: " + std::to_string(problem.costs.size()) + " nodes; expected at most " +
                std::to_string(max_nodes));
    const detail::CycleProblem cycle = detail::cycle_problem(problem);
    std::vector<int> order = detail::held_karp(cycle.costs);
    const double length = detail::cycle_length(cycle.costs, order);
    return detail::to_tour(problem, std::move(order), length);
  }
};
static_assert(TourSolver<ExactTour>);
}  // namespace surfleet
