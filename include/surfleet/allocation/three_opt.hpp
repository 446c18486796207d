// SPDX-License-Identifier: MIT
/// @file
/// @brief The complete 3-opt neighbourhood on asymmetric costs.
#pragma once

#include <chrono>
#include <limits>
#include <vector>

#include <surfleet/allocation/tour.hpp>
#include <surfleet/core/random.hpp>

namespace surfleet {
namespace detail {
/// Seconds left of a limit that began with the object.
class SearchClock {
 public:
  explicit SearchClock(double limit_s) : limit_s_(limit_s) {}
  bool expired() const {
    if (limit_s_ == std::numeric_limits<double>::infinity()) return false;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() >=
           limit_s_;
  }

 private:
  double limit_s_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// What a gain must exceed to be more than rounding.
inline double gain_tolerance(const CostMatrix& costs) {
  double largest = 0.0;
  for (int i = 0; i < costs.size(); ++i)
    for (int j = 0; j < costs.size(); ++j)
      if (i != j) largest = std::max(largest, std::abs(costs(i, j)));
  return 1e-10 * largest;
}

/// From `first`, always on to the cheapest node not visited yet. O(n²).
inline std::vector<int> nearest_neighbour_cycle(const CostMatrix& costs, int first) {
  const int n = costs.size();
  std::vector<int> cycle;
  std::vector<char> seen(n, 0);
  for (int at = first; n > 0;) {
    cycle.push_back(at);
    seen[at] = 1;
    int next = -1;
    for (int j = 0; j < n; ++j)
      if (seen[j] == 0 && (next < 0 || costs(at, j) < costs(at, next))) next = j;
    if (next < 0) break;
    at = next;
  }
  return cycle;
}

/// Improves `cycle` in place until no exchange of two or three arcs, with or without reversals,
/// shortens it. A reversal is priced in O(1) by prefix sums, so a pass is O(n³) on any costs.
inline void three_opt_descent(const CostMatrix& costs, std::vector<int>& cycle,
                              const SearchClock& clock) {
  const int n = costs.size();
  if (n < 3) return;
  const double tolerance = gain_tolerance(costs);
  // forward[k], backward[k]: cost of the first k arcs of the tour, and of the same arcs reversed.
  std::vector<double> forward(n), backward(n);
  const auto price = [&] {
    for (int k = 1; k < n; ++k) {
      forward[k] = forward[k - 1] + costs(cycle[k - 1], cycle[k]);
      backward[k] = backward[k - 1] + costs(cycle[k], cycle[k - 1]);
    }
  };
  // What reversing positions [a, b] adds to the inside of that segment.
  const auto turn = [&](int a, int b) {
    return (backward[b] - backward[a]) - (forward[b] - forward[a]);
  };
  // Cuts after positions i < j < k: segments A = (i, j], B = (j, k]. With j = k there is no B.
  const auto improve_from = [&](int i) {
    const int a0 = cycle[i], a1 = cycle[i + 1];
    for (int j = i + 1; j < n; ++j) {
      const int b0 = cycle[j], after_j = cycle[j + 1 < n ? j + 1 : 0];
      const double removed_two = costs(a0, a1) + costs(b0, after_j);
      if (costs(a0, b0) + costs(a1, after_j) + turn(i + 1, j) < removed_two - tolerance) {
        std::reverse(cycle.begin() + i + 1, cycle.begin() + j + 1);
        return true;
      }
      for (int k = j + 1; k < n; ++k) {
        const int b1 = after_j, c0 = cycle[k], c1 = cycle[k + 1 < n ? k + 1 : 0];
        const double removed = removed_two + costs(c0, c1) - tolerance;
        const double turn_a = turn(i + 1, j), turn_b = turn(j + 1, k);
        // B A, B A', B' A, A' B' (primes are reversals); B' A' is two 2-exchanges' business.
        const double exchange[4] = {
            costs(a0, b1) + costs(c0, a1) + costs(b0, c1),
            costs(a0, b1) + costs(c0, b0) + costs(a1, c1) + turn_a,
            costs(a0, c0) + costs(b1, a1) + costs(b0, c1) + turn_b,
            costs(a0, b0) + costs(a1, c0) + costs(b1, c1) + turn_a + turn_b};
        int best = 0;
        for (int e = 1; e < 4; ++e)
          if (exchange[e] < exchange[best]) best = e;
        if (exchange[best] >= removed) continue;
        const auto first = cycle.begin() + i + 1, middle = cycle.begin() + j + 1,
                   last = cycle.begin() + k + 1;
        if (best == 1 || best == 3) std::reverse(first, middle);
        if (best == 2 || best == 3) std::reverse(middle, last);
        if (best != 3) std::rotate(first, middle, last);
        return true;
      }
    }
    return false;
  };
  price();
  for (int i = 0, clean = 0; clean < n - 1 && !clock.expired(); i = i + 1 < n - 1 ? i + 1 : 0) {
    ++clean;
    while (!clock.expired() && improve_from(i)) {
      price();
      clean = 0;
    }
  }
}
}  // namespace detail

/// Local search over all exchanges of two or three arcs, from several nearest-neighbour tours.
///
/// One iteration is one more start. O(n³) a pass: meant for up to about a hundred nodes, and as
/// the reference that faster solvers are held against.
struct ThreeOpt {
  TourSearch search{.max_iterations = 3};

  Tour operator()(const TourProblem& problem) const {
    const detail::CycleProblem cycle = detail::cycle_problem(problem);
    const int n = cycle.costs.size();
    std::vector<int> best = detail::nearest_neighbour_cycle(cycle.costs, 0);
    return improve(problem, cycle, std::move(best), n);
  }
  /// From `initial`, a tour of the problem, which the result is never worse than.
  Tour operator()(const TourProblem& problem, std::span<const int> initial) const {
    const detail::CycleProblem cycle = detail::cycle_problem(problem);
    return improve(problem, cycle, detail::to_cycle(problem, cycle, initial), cycle.costs.size());
  }

 private:
  Tour improve(const TourProblem& problem, const detail::CycleProblem& cycle, std::vector<int> best,
               int n) const {
    const detail::SearchClock clock(search.time_limit_s);
    Random random(search.seed);
    const double bound = detail::cycle_relaxation(cycle.costs).cost;
    const double tolerance = detail::gain_tolerance(cycle.costs);
    detail::three_opt_descent(cycle.costs, best, clock);
    double length = detail::cycle_length(cycle.costs, best);
    for (std::int64_t i = 0; i < search.max_iterations && n > 3; ++i) {
      if (length <= bound + tolerance || clock.expired()) break;
      auto other = detail::nearest_neighbour_cycle(
          cycle.costs, static_cast<int>(random.below(static_cast<std::uint64_t>(n))));
      detail::three_opt_descent(cycle.costs, other, clock);
      const double other_length = detail::cycle_length(cycle.costs, other);
      if (other_length < length - tolerance) best = std::move(other), length = other_length;
    }
    return detail::to_tour(problem, std::move(best), bound);
  }
};
static_assert(WarmStartedTourSolver<ThreeOpt>);
}  // namespace surfleet
