// SPDX-License-Identifier: MIT
/// @file
/// @brief One robot's order of clusters, its value, and the set functions that value a set of
/// clusters by the best order found for it.
#pragma once

#include <algorithm>
#include <concepts>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/allocation/cluster_graph.hpp>
#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/allocation/tour.hpp>

namespace surfleet {
/// The clusters of one robot in the order of their visit.
struct Route {
  std::vector<int> order;
  double value = 0.0;    ///< What the set function says of this set.
  double utility = 0.0;  ///< Sum of f_UV along the order.
  double length = 0.0;   ///< Travel between and inside the clusters [m].
};

/// Utility and length of visiting `order`, each visit starting where the one before ended.
/// `value` is left at zero. O(n) hops.
template <ClusterRouting G>
Route follow(const G& graph, int robot, std::vector<int> order) {
  Route route;
  int state = -1;
  for (const int cluster : order) {
    const Hop h = graph.hop(robot, state, cluster);
    route.utility += h.utility;
    route.length += h.length();
    state = h.state;
  }
  route.order = std::move(order);
  return route;
}

/// The value of a route: its utility, or its shortness. `measure(route)`, the greater the better.
template <typename M>
concept RouteMeasure = std::copyable<M> && requires(const M& m, const Route& route) {
  { m(route) } -> std::convertible_to<double>;
  { m.of_hop(Hop{}) } -> std::convertible_to<double>;
};
struct RouteUtility {
  double operator()(const Route& route) const { return route.utility; }
  double of_hop(const Hop& hop) const { return hop.utility; }
};
struct RouteShortness {
  double operator()(const Route& route) const { return -route.length; }
  double of_hop(const Hop& hop) const { return -std::min(hop.length(), 1e9); }
};
static_assert(RouteMeasure<RouteUtility> && RouteMeasure<RouteShortness>);

/// What an allocator asks of a set function: the value of a robot's set of clusters is that of the
/// best order known for it. `arrange(graph, robot, order)` values the set, beginning with the order
/// given; `extend(graph, robot, route, cluster)` values the set with one cluster more.
/// Models: `TourValue`, `InsertionValue`.
template <typename F, typename G>
concept RouteSetFunction = std::copyable<F> &&
    requires(const F& f, const G& graph, const Route& route, int i, std::vector<int> order) {
  { f.arrange(graph, i, order) } -> std::same_as<Route>;
  { f.extend(graph, i, route, i) } -> std::same_as<Route>;
};

namespace detail {
/// `order` with `cluster` where its value is greatest, by exact valuation of every place. The
/// visits behind the new one are followed only until they end where they ended before. O(n) to
/// O(n²) hops.
template <ClusterRouting G, RouteMeasure Measure>
Route best_insertion(const G& graph, int robot, std::span<const int> order, int cluster,
                     Measure measure) {
  const int n = static_cast<int>(order.size());
  // Before the visit k: the state, and the value so far.
  std::vector<int> state(n + 1, -1);
  std::vector<double> value(n + 1, 0.0);
  for (int k = 0; k < n; ++k) {
    const Hop h = graph.hop(robot, state[k], order[k]);
    state[k + 1] = h.state;
    value[k + 1] = value[k] + measure.of_hop(h);
  }
  int best = n;
  double most = -std::numeric_limits<double>::infinity();
  for (int place = n; place >= 0; --place) {
    Hop h = graph.hop(robot, state[place], cluster);
    double total = value[place] + measure.of_hop(h);
    int k = place;
    for (; k < n && h.state != state[k]; ++k) {
      h = graph.hop(robot, h.state, order[k]);
      total += measure.of_hop(h);
    }
    total += value[n] - value[k];
    if (total > most) most = total, best = place;
  }
  std::vector<int> extended(order.begin(), order.end());
  extended.insert(extended.begin() + best, cluster);
  Route route = follow(graph, robot, std::move(extended));
  route.value = measure(route);
  return route;
}

/// Takes every cluster of a route out and puts it back where the value is greatest.
template <ClusterRouting G, RouteMeasure Measure>
void reinsert(const G& graph, int robot, Route& route, Measure measure) {
  std::vector<int> rest;
  for (const int cluster : std::vector<int>(route.order)) {
    rest = route.order;
    std::erase(rest, cluster);
    Route other = best_insertion(graph, robot, rest, cluster, measure);
    if (other.value > route.value) route = std::move(other);
  }
}

/// The same solver in a hurry, if it knows how.
template <typename Solver>
Solver brief(Solver solver) {
  if constexpr (requires { solver.search.max_iterations; }) solver.search.max_iterations = 0;
  if constexpr (requires { solver.quick_bound; }) solver.quick_bound = true;
  return solver;
}
}  // namespace detail

/// The value of a set is that of its best tour found by `Solver` [000 §2.5.2]: with
/// `RouteUtility`, maxATSP.
///
/// The tour problem takes every cluster's exit from the route at hand, so its arcs are exact where
/// the order stays and near where it changes; the order it returns is followed exactly, and kept
/// only if it is better than the route at hand. Hence a set's value never falls below that of the
/// best insertion, and with `RouteUtility` the function is monotone.
///
/// `extend`, which allocators call for every robot and cluster, searches briefly (`quick`);
/// `arrange`, which they call once a route is settled, thoroughly (`solver`).
template <TourSolver Solver = LinKernighan, RouteMeasure Measure = RouteUtility>
struct TourValue {
  Solver solver{};
  Solver quick = detail::brief(Solver{});
  Measure measure{};

  template <ClusterRouting G>
  Route arrange(const G& graph, int robot, std::vector<int> order) const {
    Route route = follow(graph, robot, std::move(order));
    route.value = measure(route);
    for (int round = 0; round < kRounds; ++round) {
      const double before = route.value;
      improve(graph, robot, route, solver);
      detail::reinsert(graph, robot, route, measure);
      if (route.value <= before) break;
    }
    return route;
  }
  template <ClusterRouting G>
  Route extend(const G& graph, int robot, const Route& route, int cluster) const {
    Route longer = detail::best_insertion(graph, robot, route.order, cluster, measure);
    improve(graph, robot, longer, quick);
    return longer;
  }

 private:
  template <ClusterRouting G>
  void improve(const G& graph, int robot, Route& route, const Solver& with) const {
    const int n = static_cast<int>(route.order.size());
    if (n < 2) return;
    TourProblem problem;
    problem.costs = CostMatrix(n + 1);
    problem.maximize = true;
    problem.open = true;
    problem.start = 0;
    int state = -1;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j < n; ++j)
        if (j + 1 != i)
          problem.costs(i, j + 1) = measure.of_hop(graph.hop(robot, state, route.order[j]));
      if (i < n) state = graph.hop(robot, state, route.order[i]).state;
    }
    std::vector<int> order;
    for (const int node : solve(problem, with).order)
      if (node > 0) order.push_back(route.order[node - 1]);
    Route other = follow(graph, robot, std::move(order));
    other.value = measure(other);
    if (other.value > route.value) route = std::move(other);
  }
  static constexpr int kRounds = 5;

  static Tour solve(const TourProblem& problem, const Solver& with) {
    if constexpr (WarmStartedTourSolver<Solver>) {
      std::vector<int> as_it_is(problem.costs.size());
      for (int i = 0; i < problem.costs.size(); ++i) as_it_is[i] = i;
      return with(problem, as_it_is);
    } else {
      return with(problem);
    }
  }
};
/// maxATSP [000 §2.5.2].
template <TourSolver Solver = LinKernighan>
using TourUtility = TourValue<Solver, RouteUtility>;
/// Minus the length of the shortest open tour.
template <TourSolver Solver = LinKernighan>
using TourShortness = TourValue<Solver, RouteShortness>;

/// The value of a set is that of the order in which best insertion built it: the classical rule,
/// which never rearranges.
template <RouteMeasure Measure = RouteUtility>
struct InsertionValue {
  Measure measure{};

  /// The better of the order given and the one that inserting its clusters in turn builds.
  template <ClusterRouting G>
  Route arrange(const G& graph, int robot, std::vector<int> order) const {
    Route built;
    for (const int cluster : order)
      built = detail::best_insertion(graph, robot, built.order, cluster, measure);
    Route route = follow(graph, robot, std::move(order));
    route.value = measure(route);
    return built.value > route.value ? built : route;
  }
  template <ClusterRouting G>
  Route extend(const G& graph, int robot, const Route& route, int cluster) const {
    return detail::best_insertion(graph, robot, route.order, cluster, measure);
  }
};
static_assert(RouteSetFunction<TourUtility<>, MatrixRouting> &&
              RouteSetFunction<InsertionValue<>, MatrixRouting>);
}  // namespace surfleet
