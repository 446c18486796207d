// SPDX-License-Identifier: MIT
/// @file
/// @brief An iterated Lin–Kernighan heuristic for asymmetric tours.
///
/// The steps of the descent exchange two neighbouring segments of the tour, which changes three
/// arcs and turns no arc round, so that asymmetric costs are as cheap to evaluate as symmetric
/// ones [Kanellakis & Papadimitriou 1980]. Steps are chained while the partial gain stays
/// positive; the first two (five arcs) are searched exhaustively among candidate arcs of small
/// reduced cost, the rest greedily. Where costs are nearly symmetric, reversals are tried as well.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/allocation/detail/candidate_arcs.hpp>
#include <surfleet/allocation/detail/lin_kernighan_search.hpp>
#include <surfleet/allocation/exact_tour.hpp>
#include <surfleet/allocation/tour.hpp>
#include <surfleet/core/random.hpp>

namespace surfleet {
/// Iterated Lin–Kernighan: descend, perturb a short stretch of the tour, keep what is not worse.
///
/// Stops early when the tour meets the assignment bound, which proves it optimal. Up to eight
/// nodes are solved exactly. Preparation O(n³) (in practice nearer n²) for the bound, O(n² log n)
/// for the candidates; an iteration costs some microseconds at a few hundred nodes.
struct LinKernighan {
  TourSearch search{};
  int candidates = 6;        ///< Arcs out of a node by reduced cost; some more join by cost.
  int longest_kick = 30;     ///< Nodes in each of the segments that a perturbation exchanges.
  bool quick_bound = false;  ///< Bound and candidates from row and column minima, in O(n²).

  Tour operator()(const TourProblem& problem) const { return solve(problem, {}); }
  /// From `initial`, a tour of the problem, which the result is never worse than.
  Tour operator()(const TourProblem& problem, std::span<const int> initial) const {
    return solve(problem, initial);
  }

 private:
  Tour solve(const TourProblem& problem, std::span<const int> initial) const {
    require(candidates >= 1 && longest_kick >= 1,
            "Lin-Kernighan: candidates and longest_kick must be at least 1");
    const detail::SearchClock clock(search.time_limit_s);
    const detail::CycleProblem cycle = detail::cycle_problem(problem);
    const CostMatrix& costs = cycle.costs;
    const int n = costs.size();
    if (n <= 8) {
      std::vector<int> order = detail::held_karp(costs);
      const double length = detail::cycle_length(costs, order);
      return detail::to_tour(problem, std::move(order), length);
    }
    const Assignment dual =
        quick_bound ? detail::reduced_prices(costs) : detail::cycle_relaxation(costs);
    const detail::CandidateArcs arcs(costs, dual, candidates, (candidates + 1) / 2);
    const bool symmetric = costs.symmetric();
    detail::LinKernighanSearch tour(costs, arcs, symmetric || nearly_symmetric(costs), symmetric);
    Random random(search.seed);
    tour.set(initial.empty() ? detail::priced_neighbour_cycle(costs, dual, 0)
                             : detail::to_cycle(problem, cycle, initial));
    std::vector<int> all = tour.cycle();
    random.shuffle(all);
    for (const int node : all) tour.enqueue(node);
    tour.descend();
    tour.commit();
    const double proven = dual.cost + n * tour.tolerance();
    for (std::int64_t i = 0; i < search.max_iterations; ++i) {
      if (tour.length() <= proven || (i % 16 == 0 && clock.expired())) break;
      const double before = tour.length();
      tour.kick(random, longest_kick);
      tour.descend();
      if (tour.length() <= before + tour.tolerance())
        tour.commit();
      else
        tour.undo();
    }
    return detail::to_tour(problem, tour.cycle(), dual.cost);
  }

  static bool nearly_symmetric(const CostMatrix& costs) {
    double difference = 0.0, spread = 0.0, mean = 0.0;
    const int n = costs.size();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (i != j) mean += costs(i, j);
    mean /= static_cast<double>(n) * (n - 1);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        if (i == j) continue;
        difference += std::abs(costs(i, j) - costs(j, i));
        spread += std::abs(costs(i, j) - mean);
      }
    }
    return difference < 0.2 * spread;
  }
};
static_assert(WarmStartedTourSolver<LinKernighan>);
}  // namespace surfleet
