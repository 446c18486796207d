// SPDX-License-Identifier: MIT
/// @file
/// @brief Greedy allocation of clusters to robots over a set function [000 §3.5, 3.6.1].
///
/// `GreedyAllocator<>` is the TSP-greedy allocation TSGA [000 Alg. 2]; with the rule
/// `NearestNeighbour` it is NNB [000 Alg. 4]; with `MakespanAware` it evens out the robots' times.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/allocation/cluster_graph.hpp>
#include <surfleet/allocation/route.hpp>

namespace surfleet {
/// Which robot visits what.
struct FleetPlan {
  std::vector<std::vector<int>> routes;  ///< Clusters in the order of their visit, per robot.
  std::vector<double> utilities;         ///< p^i, per robot.
  std::vector<double> lengths;           ///< Travel between and inside clusters, per robot [m].
  std::vector<int> unassigned;           ///< Clusters that no robot took, ascending.

  double total_utility() const {
    double sum = 0.0;
    for (const double u : utilities) sum += u;
    return sum;
  }
  double total_length() const {
    double sum = 0.0;
    for (const double l : lengths) sum += l;
    return sum;
  }
  double longest() const {
    return lengths.empty() ? 0.0 : *std::max_element(lengths.begin(), lengths.end());
  }
};

/// The order in which a greedy rule is offered the clusters.
template <typename O, typename G>
concept ElementOrder = std::copyable<O> && requires(const O& o, const G& graph) {
  { o(graph) } -> std::same_as<std::vector<int>>;
};
/// By the distance to the nearest robot, ascending [000 §3.5.1]; ties by number.
struct NearestFirst {
  template <ClusterRouting G>
  std::vector<int> operator()(const G& graph) const {
    std::vector<std::pair<double, int>> keys;
    for (int c = 0; c < graph.clusters(); ++c) {
      double least = std::numeric_limits<double>::infinity();
      for (int r = 0; r < graph.robots(); ++r)
        least = std::min(least, travel_of_hop(graph, r, -1, c));
      keys.emplace_back(least, c);
    }
    std::sort(keys.begin(), keys.end());
    std::vector<int> order;
    for (const auto& key : keys) order.push_back(key.second);
    return order;
  }
};
/// By gain, descending; ties by number.
struct LargestGainFirst {
  template <ClusterRouting G>
  std::vector<int> operator()(const G& graph) const {
    std::vector<std::pair<double, int>> keys;
    for (int c = 0; c < graph.clusters(); ++c) keys.emplace_back(-graph.gain(c), c);
    std::sort(keys.begin(), keys.end());
    std::vector<int> order;
    for (const auto& key : keys) order.push_back(key.second);
    return order;
  }
};

/// Which allocations are permitted, beyond that a cluster goes to one robot at most.
/// `permits(robot, cluster, route)` is asked before a cluster is tried with a robot that has
/// `route`; `admits(robot, extended)` of the route that came of it.
template <typename C>
concept AllocationConstraint = std::copyable<C> && requires(const C& c, int i, const Route& r) {
  { c.permits(i, i, r) } -> std::convertible_to<bool>;
  { c.admits(i, r) } -> std::convertible_to<bool>;
};
/// Every cluster to one robot that may take it, and a robot to no more than its capacity.
struct PartitionMatroid {
  int capacity = std::numeric_limits<int>::max();  ///< Clusters per robot.
  /// `allowed[robot][cluster]`: non-zero if this robot can see this cluster; empty: all can.
  std::vector<std::vector<char>> allowed{};

  bool permits(int robot, int cluster, const Route& route) const {
    if (static_cast<int>(route.order.size()) >= capacity) return false;
    return allowed.empty() || allowed.at(robot).at(cluster) != 0;
  }
  bool admits(int /*robot*/, const Route& /*extended*/) const { return true; }
};
/// No robot travels further than its range: a battery's knapsack, not a matroid.
struct RangeLimit {
  std::vector<double> range;  ///< Per robot [m]; the last one stands for all that follow.

  bool permits(int /*robot*/, int /*cluster*/, const Route& /*route*/) const { return true; }
  bool admits(int robot, const Route& extended) const {
    if (range.empty()) return true;
    return extended.length <= range[std::min(static_cast<std::size_t>(robot), range.size() - 1)];
  }
};
static_assert(AllocationConstraint<PartitionMatroid> && AllocationConstraint<RangeLimit>);

/// The time a route takes: its length at the robot's speed, and a stop at every cluster.
struct RouteTime {
  std::vector<double> speed{};  ///< Per robot [m/s]; empty: 1 for all. Positive.
  double stop = 0.0;            ///< At every cluster [s].

  double operator()(int robot, const Route& route) const {
    const double v = speed.empty() ? 1.0 : speed.at(robot);
    return route.length / v + stop * static_cast<double>(route.order.size());
  }
};

/// How clusters are given away. `rule(graph, value, constraint, order, is_free, routes)` extends
/// the routes of the robots that are free by clusters of `order`, none of them twice.
/// Models: `BestMarginal`, `NearestNeighbour`, `MakespanAware`.
struct BestMarginal {
  /// To each cluster in turn the robot whose value grows most [000 Alg. 2]; ties to the lower
  /// robot.
  template <ClusterRouting G, RouteSetFunction<G> Value, AllocationConstraint Constraint>
  void operator()(const G& graph, const Value& value, const Constraint& constraint,
                  std::span<const int> order, std::span<const char> is_free,
                  std::vector<Route>& routes) const {
    if (std::count(is_free.begin(), is_free.end(), 0) + 1 == graph.robots() &&
        give_all(graph, value, constraint, order, is_free, routes))
      return;
    for (const int cluster : order) {
      int best = -1;
      Route best_route;
      double most = 0.0;
      for (int robot = 0; robot < graph.robots(); ++robot) {
        Route& route = routes[robot];
        if (is_free[robot] == 0 || !constraint.permits(robot, cluster, route)) continue;
        Route extended = value.extend(graph, robot, route, cluster);
        if (!constraint.admits(robot, extended)) continue;
        const double growth = extended.value - route.value;
        if (best < 0 || growth > most) {
          best = robot;
          most = growth;
          best_route = std::move(extended);
        }
      }
      if (best >= 0) routes[best] = std::move(best_route);
    }
  }

 private:
  // To the only free robot goes every cluster it may take, whatever the order: one tour to solve.
  template <typename G, typename Value, typename Constraint>
  bool give_all(const G& graph, const Value& value, const Constraint& constraint,
                std::span<const int> order, std::span<const char> is_free,
                std::vector<Route>& routes) const {
    const int robot = static_cast<int>(
        std::find_if(is_free.begin(), is_free.end(), [](char f) { return f != 0; }) -
        is_free.begin());
    Route all = routes[robot];
    for (const int cluster : order)
      if (constraint.permits(robot, cluster, all)) all.order.push_back(cluster);
    all = value.arrange(graph, robot, std::move(all.order));
    if (!constraint.admits(robot, all)) return false;
    routes[robot] = std::move(all);
    return true;
  }
};
struct NearestNeighbour {
  /// Whether a cluster that one robot has taken is left to it. The printed algorithm lets every
  /// robot choose by itself, and two may choose the same.
  bool exclusive = true;

  /// To each robot in turn the one cluster with the largest f from where it is [000 Alg. 4].
  template <ClusterRouting G, RouteSetFunction<G> Value, AllocationConstraint Constraint>
  void operator()(const G& graph, const Value& value, const Constraint& constraint,
                  std::span<const int> order, std::span<const char> is_free,
                  std::vector<Route>& routes) const {
    std::vector<char> taken(graph.clusters(), 0);
    for (int robot = 0; robot < graph.robots(); ++robot) {
      if (is_free[robot] == 0) continue;
      int best = -1;
      double most = 0.0;
      for (const int cluster : order) {
        if (taken[cluster] != 0 || !constraint.permits(robot, cluster, routes[robot])) continue;
        if (best >= 0 && most_utility_of_hop(graph, robot, -1, cluster) < most) continue;
        const Hop h = graph.hop(robot, -1, cluster);
        if (best < 0 || h.utility > most) best = cluster, most = h.utility;
      }
      if (best < 0) continue;
      Route route = value.extend(graph, robot, routes[robot], best);
      if (!constraint.admits(robot, route)) continue;
      routes[robot] = std::move(route);
      taken[best] = exclusive ? 1 : 0;
    }
  }
};
struct MakespanAware {
  RouteTime time{};
  /// To each cluster in turn the robot with which the longest time of all grows least; ties to the
  /// one whose own time grows least, then to the lower robot.
  template <ClusterRouting G, RouteSetFunction<G> Value, AllocationConstraint Constraint>
  void operator()(const G& graph, const Value& value, const Constraint& constraint,
                  std::span<const int> order, std::span<const char> is_free,
                  std::vector<Route>& routes) const {
    double longest = 0.0;
    for (int robot = 0; robot < graph.robots(); ++robot)
      longest = std::max(longest, time(robot, routes[robot]));
    for (const int cluster : order) {
      int best = -1;
      Route best_route;
      std::pair<double, double> least;
      for (int robot = 0; robot < graph.robots(); ++robot) {
        Route& route = routes[robot];
        if (is_free[robot] == 0 || !constraint.permits(robot, cluster, route)) continue;
        Route extended = value.extend(graph, robot, route, cluster);
        if (!constraint.admits(robot, extended)) continue;
        const double after = time(robot, extended);
        const std::pair<double, double> key(std::max(longest, after), after - time(robot, route));
        if (best < 0 || key < least) {
          best = robot;
          least = key;
          best_route = std::move(extended);
        }
      }
      if (best < 0) continue;
      routes[best] = std::move(best_route);
      longest = least.first;
    }
  }
};

/// What robots still under way have been given before: one route per robot, empty for a robot that
/// is free.
struct AlreadyAssigned {
  std::vector<std::vector<int>> routes;
};

namespace detail {
/// The plan that routes amount to.
inline FleetPlan fleet_plan(std::vector<Route> routes, int clusters) {
  FleetPlan plan;
  std::vector<char> taken(clusters, 0);
  for (Route& route : routes) {
    for (const int c : route.order) taken[c] = 1;
    plan.utilities.push_back(route.utility);
    plan.lengths.push_back(route.length);
    plan.routes.push_back(std::move(route.order));
  }
  for (int c = 0; c < clusters; ++c)
    if (taken[c] == 0) plan.unassigned.push_back(c);
  return plan;
}
/// Throws `Error` unless the routes are one per robot and name every cluster once at most.
template <ClusterRouting G>
void check_partition(const G& graph, const std::vector<std::vector<int>>& routes) {
  require(static_cast<int>(routes.size()) == graph.robots(),
          "allocation: " + std::to_string(routes.size()) +
              " routes given; expected one for each of " + std::to_string(graph.robots()) +
              " robots");
  std::vector<char> seen(graph.clusters(), 0);
  for (const auto& route : routes) {
    for (const int c : route) {
      require(c >= 0 && c < graph.clusters() && seen[c] == 0,
              "allocation: cluster " + std::to_string(c) +
                  " in the routes given; expected clusters of the graph, each once at most");
      seen[c] = 1;
    }
  }
}
}  // namespace detail

/// Gives clusters to robots one after the other, each where the rule likes it best.
///
/// A cluster to which a robot has no path (infinite travel from its start) is not offered to that
/// robot. TSGA solves O(robots · clusters) tours; with one robot to serve it solves one.
template <typename SetFunction = TourUtility<LinKernighan>, typename Order = NearestFirst,
          AllocationConstraint Constraint = PartitionMatroid, typename Rule = BestMarginal>
struct GreedyAllocator {
  SetFunction value{};
  Order order{};
  Constraint constraint{};
  Rule rule{};

  /// The plan for all robots; or, where some are under way, for the free ones with the clusters
  /// that no robot has: the routes given stay as they are [000 §3.5.1, asynchronous allocation].
  template <ClusterRouting G>
  requires RouteSetFunction<SetFunction, G> && ElementOrder<Order, G> FleetPlan
  operator()(const G& graph, const AlreadyAssigned& assigned = {}) const {
    std::vector<Route> routes(graph.robots());
    std::vector<char> is_free(graph.robots(), 1), taken(graph.clusters(), 0);
    if (!assigned.routes.empty()) {
      detail::check_partition(graph, assigned.routes);
      for (int robot = 0; robot < graph.robots(); ++robot) {
        if (assigned.routes[robot].empty()) continue;
        is_free[robot] = 0;
        routes[robot] = follow(graph, robot, assigned.routes[robot]);
        for (const int c : assigned.routes[robot]) taken[c] = 1;
      }
    }
    std::vector<int> elements = order(graph);
    std::erase_if(elements, [&](int c) { return taken[c] != 0; });
    rule(graph, value, Reachable<G>{graph, constraint}, elements, is_free, routes);
    for (int robot = 0; robot < graph.robots(); ++robot) {
      if (is_free[robot] == 0) continue;
      Route settled = value.arrange(graph, robot, routes[robot].order);
      if (settled.value > routes[robot].value && constraint.admits(robot, settled))
        routes[robot] = std::move(settled);
    }
    return detail::fleet_plan(std::move(routes), graph.clusters());
  }

  /// From clusters and the robots' configurations, with straight-line distances.
  template <typename P>
  FleetPlan operator()(const std::vector<ConfigurationCluster<P>>& clusters,
                       const std::vector<P>& robots, const AlreadyAssigned& assigned = {}) const {
    return (*this)(ClusterGraph<P>(clusters, robots), assigned);
  }

 private:
  /// The constraint, and that there is a path.
  template <typename G>
  struct Reachable {
    std::reference_wrapper<const G> graph;
    Constraint inner;
    bool permits(int robot, int cluster, const Route& route) const {
      return std::isfinite(travel_of_hop(graph.get(), robot, -1, cluster)) &&
             inner.permits(robot, cluster, route);
    }
    bool admits(int robot, const Route& extended) const { return inner.admits(robot, extended); }
  };
};

/// TSGA [000 Alg. 2], NNB [000 Alg. 4], and an allocation that evens out times along shortest
/// tours.
using TspGreedyAllocator = GreedyAllocator<>;
using NearestNeighbourAllocator =
    GreedyAllocator<InsertionValue<>, NearestFirst, PartitionMatroid, NearestNeighbour>;
using MakespanAllocator =
    GreedyAllocator<TourShortness<LinKernighan>, NearestFirst, PartitionMatroid, MakespanAware>;
}  // namespace surfleet
