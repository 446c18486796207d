// SPDX-License-Identifier: MIT
/// @file
/// @brief How good a deployment can be: a Lagrangian lower bound (Beasley 1993) and the best
/// solution that a long search finds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/coverage/p_median.hpp>

namespace surfleet {
struct PMedianBound {
  double lower = 0.0;                ///< No choice of p places costs less.
  double best = 0.0;                 ///< The cheapest choice found.
  std::vector<std::int32_t> chosen;  ///< That choice.
};

/// The Lagrangian relaxation of "every client is served once", by subgradient steps.
///
/// For multipliers λ the relaxed problem takes the p places of least Σ min(0, c − λ): a bound
/// from below, for any λ. `upper` is the cost of a known solution. O(n²) an iteration.
inline double p_median_lower_bound(const PMedianProblem& problem, std::size_t p, double upper,
                                   int iterations = 400) {
  const std::size_t n = problem.places(), m = problem.clients();
  require(p >= 1 && p <= n, "p-median bound: p must be 1 to the number of places");
  // Start where a client pays about what its nearest of p places costs: the mean share.
  std::vector<double> lambda(m, upper / static_cast<double>(m)), reduced(n);
  std::vector<std::size_t> order(n);
  std::vector<double> served(m);
  double best = 0.0, step = 1.5;
  int stale = 0;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = problem.row(i);
      double sum = 0.0;
      for (std::size_t j = 0; j < m; ++j) sum += std::min(0.0, row[j] - lambda[j]);
      reduced[i] = sum;
      order[i] = i;
    }
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(p), order.end(),
                      [&](std::size_t a, std::size_t b) {
                        return reduced[a] != reduced[b] ? reduced[a] < reduced[b] : a < b;
                      });
    double bound = 0.0;
    for (const double l : lambda) bound += l;
    std::fill(served.begin(), served.end(), 1.0);
    for (std::size_t k = 0; k < p; ++k) {
      bound += reduced[order[k]];
      const auto row = problem.row(order[k]);
      for (std::size_t j = 0; j < m; ++j)
        if (row[j] < lambda[j]) served[j] -= 1.0;
    }
    if (bound > best * (1.0 + 1e-9)) {
      best = bound;
      stale = 0;
    } else if (++stale >= 15) {
      step *= 0.6;
      stale = 0;
    }
    double squared = 0.0;
    for (const double s : served) squared += s * s;
    if (squared == 0.0 || step < 1e-4) break;
    const double size = step * (1.02 * upper - bound) / squared;
    for (std::size_t j = 0; j < m; ++j) lambda[j] = std::max(0.0, lambda[j] + size * served[j]);
  }
  return std::min(best, upper);
}

/// The best of `starts` searches of `rounds` rounds each, with its lower bound.
inline PMedianBound bound_p_median(const PMedianProblem& problem, std::size_t p, int starts,
                                   int rounds, std::uint64_t seed, int iterations = 400) {
  require(p >= 1 && p <= problem.places(), "p-median bound: p must be 1 to the number of places");
  PMedianBound bound;
  for (int start = 0; start < std::max(starts, 1); ++start) {
    Random random = Random(seed).fork(static_cast<std::uint64_t>(start));
    std::vector<std::int32_t> places(problem.places());
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = static_cast<std::int32_t>(i);
    random.shuffle(places);
    places.resize(p);
    PMedianSolution solution(problem, std::move(places));
    search_medians(problem, solution, rounds, random);
    if (start > 0 && solution.cost() >= bound.best) continue;
    bound.best = solution.cost();
    bound.chosen = solution.chosen();
  }
  bound.lower = p_median_lower_bound(problem, p, bound.best, iterations);
  return bound;
}
}  // namespace surfleet
