// SPDX-License-Identifier: MIT
/// @file
/// @brief What a tour problem is, what a tour solver must provide, and the exact reductions of
/// open, maximising and fixed-start problems to the cheapest closed tour.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/allocation/assignment.hpp>
#include <surfleet/allocation/cost_matrix.hpp>

namespace surfleet {
/// Visit every node once [000 §2.5.2, app. B.2]. `maxATSP` of the source is
/// `{utilities, .maximize = true, .open = true, .start = 0}`.
struct TourProblem {
  CostMatrix costs;            ///< Finite off the diagonal.
  bool maximize = false;       ///< The largest sum of arcs instead of the smallest.
  bool open = false;           ///< A path: nothing returns to where it began.
  std::optional<int> start{};  ///< The node the tour begins with; free if not given.
};

/// A solution, and how far from the optimum it can be at most.
struct Tour {
  std::vector<int> order;  ///< Every node once, first the start.
  double length = 0.0;     ///< Sum of the arcs, the closing one included if the problem is closed.
  double bound = 0.0;      ///< No tour is shorter (when maximising: longer), up to rounding.

  /// |length − bound| / |bound|; zero if they are equal.
  double gap() const {
    const double difference = std::abs(length - bound);
    return difference == 0.0 ? 0.0 : difference / std::abs(bound);
  }
};

/// How long a heuristic may search. With an iteration limit alone the result depends on the seed
/// alone; with a time limit it depends on the machine too. Whichever is met first ends the search.
struct TourSearch {
  std::int64_t max_iterations = 1000;  ///< Perturbations tried; 0 is one descent.
  double time_limit_s = std::numeric_limits<double>::infinity();
  std::uint64_t seed = 1;
};

/// What the planners ask of a tour solver: a call that takes a problem and returns a tour that
/// visits every node, begins with the start if there is one, and carries a valid bound.
/// Models: `ExactTour`, `ThreeOpt`, `LinKernighan`.
template <typename S>
concept TourSolver = std::copyable<S> && requires(const S& solver, const TourProblem& problem) {
  { solver(problem) } -> std::same_as<Tour>;
};

/// A tour solver that can begin from a tour at hand and never returns a worse one.
template <typename S>
concept WarmStartedTourSolver = TourSolver<S> &&
    requires(const S& s, const TourProblem& p, std::span<const int> order) {
  { s(p, order) } -> std::same_as<Tour>;
};

/// The sum of the arcs of `order`, with the arc back to its first node if the problem is closed.
inline double tour_length(const TourProblem& problem, std::span<const int> order) {
  double sum = 0.0;
  for (std::size_t k = 1; k < order.size(); ++k) sum += problem.costs(order[k - 1], order[k]);
  if (!problem.open && order.size() > 1) sum += problem.costs(order.back(), order.front());
  return sum;
}

/// True if `order` visits each of the problem's nodes once and begins with its start.
inline bool is_tour(const TourProblem& problem, std::span<const int> order) {
  const int n = problem.costs.size();
  if (static_cast<int>(order.size()) != n) return false;
  std::vector<char> seen(n, 0);
  for (const int node : order) {
    if (node < 0 || node >= n || seen[node] != 0) return false;
    seen[node] = 1;
  }
  return !problem.start || n == 0 || order.front() == *problem.start;
}

namespace detail {
/// The cheapest closed tour to which a problem reduces: maximising negates, an open path with a
/// start returns to it for nothing, one without closes through a node that costs nothing.
struct CycleProblem {
  CostMatrix costs;
  bool has_dummy = false;  ///< The last node is no node of the problem.
};

inline CycleProblem cycle_problem(const TourProblem& problem) {
  const int n = problem.costs.size();
  require(!problem.start || (*problem.start >= 0 && *problem.start < std::max(n, 1)),
          "tour: start node " + std::to_string(problem.start.value_or(0)) + "; expected 0 to " +
              std::to_string(n - 1));
  CycleProblem cycle;
  cycle.has_dummy = problem.open && !problem.start && n > 0;
  cycle.costs = CostMatrix(n + (cycle.has_dummy ? 1 : 0));
  const double sign = problem.maximize ? -1.0 : 1.0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (i == j) continue;
      const double c = problem.costs(i, j);
      if (!std::isfinite(c))
        throw Error("tour: cost of arc " + std::to_string(i) + " -> " + std::to_string(j) +
                    " is not finite; expected a number");
      const bool free_return = problem.open && problem.start && j == *problem.start;
      cycle.costs(i, j) = free_return ? 0.0 : sign * c;
    }
  }
  return cycle;
}

/// The length of a closed tour.
inline double cycle_length(const CostMatrix& costs, std::span<const int> cycle) {
  double sum = 0.0;
  for (std::size_t k = 0; k < cycle.size(); ++k)
    sum += costs(cycle[k], cycle[k + 1 < cycle.size() ? k + 1 : 0]);
  return cycle.size() > 1 ? sum : 0.0;
}

/// Lower bound on any closed tour by the assignment relaxation; with the prices.
inline Assignment cycle_relaxation(const CostMatrix& costs) {
  return costs.size() > 1 ? solve_assignment(costs, true) : Assignment{{0}, {0.0}, {0.0}, 0.0};
}

/// Turns a closed tour of the reduced problem into a tour of the problem.
inline Tour to_tour(const TourProblem& problem, std::vector<int> cycle, double cycle_bound) {
  Tour tour;
  const int n = problem.costs.size();
  const int first = problem.start ? *problem.start : problem.open ? n : 0;
  const auto at = std::find(cycle.begin(), cycle.end(), first);
  if (at != cycle.end()) std::rotate(cycle.begin(), at, cycle.end());
  if (!cycle.empty() && cycle.front() == n) cycle.erase(cycle.begin());
  tour.length = tour_length(problem, cycle);
  tour.order = std::move(cycle);
  // A bound that differs from the length by rounding alone is the length.
  double scale = 0.0;
  for (std::size_t k = 0; k < tour.order.size(); ++k)
    scale += std::abs(problem.costs(tour.order[k], tour.order[(k + 1) % tour.order.size()]));
  const double bound = problem.maximize ? -cycle_bound : cycle_bound;
  const double slack = problem.maximize ? bound - tour.length : tour.length - bound;
  tour.bound = slack <= 1e-11 * scale ? tour.length : bound;
  return tour;
}

/// The cycle of the reduced problem that a tour of the problem stands for.
inline std::vector<int> to_cycle(const TourProblem& problem, const CycleProblem& cycle,
                                 std::span<const int> order) {
  require(is_tour(problem, order),
          "tour: the initial order does not visit every node once from the start");
  std::vector<int> result(order.begin(), order.end());
  if (cycle.has_dummy) result.push_back(problem.costs.size());
  return result;
}
}  // namespace detail
}  // namespace surfleet
