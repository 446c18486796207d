// SPDX-License-Identifier: MIT
/// @file
/// @brief Local search over whole fleet plans: clusters move and change places between robots.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include <surfleet/allocation/greedy_allocator.hpp>

namespace surfleet {
/// What the improvement of a plan asks of an objective: `o(routes)` is a pair to be compared in
/// lexicographic order, the less the better. Models: `TotalValue`, `Makespan`, `MakespanAndMean`.
template <typename O>
concept FleetObjective = std::copyable<O> && requires(const O& o, const std::vector<Route>& r) {
  { o(r) } -> std::same_as<std::pair<double, double>>;
};
/// The largest sum of values: the objective of TSGA [000 eq. 3.1]; then the shortest total length.
struct TotalValue {
  std::pair<double, double> operator()(const std::vector<Route>& routes) const {
    double value = 0.0, length = 0.0;
    for (const Route& r : routes) value += r.value, length += r.length;
    return {-value, length};
  }
};
/// The shortest time of the robot that takes longest; then the shortest total time.
struct Makespan {
  RouteTime time{};
  std::pair<double, double> operator()(const std::vector<Route>& routes) const {
    double longest = 0.0, total = 0.0;
    for (std::size_t r = 0; r < routes.size(); ++r) {
      const double t = time(static_cast<int>(r), routes[r]);
      longest = std::max(longest, t);
      total += t;
    }
    return {longest, total};
  }
};
/// The longest time plus `mean_weight` times the mean of all: for plans that are made anew before
/// they end, where distance saved counts later, and flying far only to be even does not pay.
struct MakespanAndMean {
  RouteTime time{};
  double mean_weight = 3.0;
  std::pair<double, double> operator()(const std::vector<Route>& routes) const {
    const auto [longest, total] = Makespan{time}(routes);
    const auto robots = static_cast<double>(std::max<std::size_t>(routes.size(), 1));
    return {longest + mean_weight * total / robots, total};
  }
};
static_assert(FleetObjective<TotalValue> && FleetObjective<Makespan> &&
              FleetObjective<MakespanAndMean>);

/// Improves a plan until no cluster can move to another robot, no two change places, and no two
/// robots exchange the ends of their routes, to the objective's advantage.
///
/// Candidates are built by best insertion; a route that changed is then arranged anew by the set
/// function. First improvement, in a fixed order: deterministic. A pass is O(clusters²)
/// insertions. `AlreadyAssigned` robots keep what they have.
template <FleetObjective Objective = TotalValue, typename SetFunction = TourUtility<LinKernighan>,
          AllocationConstraint Constraint = PartitionMatroid>
struct ImproveAllocation {
  Objective objective{};
  SetFunction value{};
  Constraint constraint{};
  int max_passes = 10;

  /// Never worse than `plan`, and over the same clusters.
  template <ClusterRouting G>
  requires RouteSetFunction<SetFunction, G> FleetPlan
  operator()(const G& graph, const FleetPlan& plan, const AlreadyAssigned& assigned = {}) const {
    detail::check_partition(graph, plan.routes);
    Search<G> search{graph, *this, {}, {}, {}};
    for (int robot = 0; robot < graph.robots(); ++robot) {
      const bool busy = !assigned.routes.empty() && !assigned.routes.at(robot).empty();
      search.is_free.push_back(busy ? 0 : 1);
      search.routes.push_back(search.plain(robot, plan.routes[robot]));
    }
    search.score = objective(search.routes);
    for (int passes = 0, improved = 1; improved != 0;) {
      while (passes < max_passes && search.pass()) ++passes;
      improved = 0;
      for (int robot = 0; robot < graph.robots(); ++robot)
        if (search.is_free[robot] != 0 && search.arrange(robot)) improved = 1;
      if (++passes > max_passes) break;
    }
    return detail::fleet_plan(std::move(search.routes), graph.clusters());
  }

 private:
  template <typename G>
  struct Search {
    const G& graph;
    const ImproveAllocation& owner;
    std::vector<char> is_free;
    std::vector<Route> routes;
    std::pair<double, double> score;

    Route plain(int robot, std::vector<int> order) const {
      Route route = follow(graph, robot, std::move(order));
      route.value = owner.value.measure(route);
      return route;
    }
    Route without(int robot, std::size_t k) const {
      std::vector<int> order = routes[robot].order;
      order.erase(order.begin() + static_cast<std::ptrdiff_t>(k));
      return plain(robot, std::move(order));
    }
    Route with(int robot, const Route& route, int cluster) const {
      return detail::best_insertion(graph, robot, route.order, cluster, owner.value.measure);
    }
    bool permits(int robot, int cluster, const Route& route) const {
      return std::isfinite(travel_of_hop(graph, robot, -1, cluster)) &&
             owner.constraint.permits(robot, cluster, route);
    }
    static bool better(const std::pair<double, double>& a, const std::pair<double, double>& b) {
      const double margin = 1e-9 * (1.0 + std::abs(b.first));
      if (a.first < b.first - margin) return true;
      return a.first <= b.first && a.second < b.second - 1e-9 * (1.0 + std::abs(b.second));
    }
    bool arrange(int robot) {
      Route other = owner.value.arrange(graph, robot, routes[robot].order);
      return accept(robot, std::move(other), -1, {});
    }
    /// Takes the new routes of one or two robots if the objective likes them.
    bool accept(int a, Route route_a, int b, Route route_b) {
      if (!owner.constraint.admits(a, route_a) || (b >= 0 && !owner.constraint.admits(b, route_b)))
        return false;
      std::swap(routes[a], route_a);
      if (b >= 0) std::swap(routes[b], route_b);
      const auto other = owner.objective(routes);
      if (better(other, score)) {
        score = other;
        return true;
      }
      std::swap(routes[a], route_a);
      if (b >= 0) std::swap(routes[b], route_b);
      return false;
    }
    bool accept_and_settle(int a, Route route_a, int b, Route route_b) {
      if (!accept(a, std::move(route_a), b, std::move(route_b))) return false;
      for (const int robot : {a, b}) {
        Route other = routes[robot];
        detail::reinsert(graph, robot, other, owner.value.measure);
        accept(robot, std::move(other), -1, {});
      }
      return true;
    }
    bool pass() {
      bool improved = false;
      for (int a = 0; a < graph.robots(); ++a)
        for (int b = 0; b < graph.robots(); ++b)
          if (a != b && is_free[a] != 0 && is_free[b] != 0)
            improved = moves(a, b) || (a < b && swaps(a, b)) || (a < b && tails(a, b)) || improved;
      return improved;
    }
    bool moves(int a, int b) {
      bool improved = false;
      for (std::size_t k = 0; k < routes[a].order.size();) {
        const int cluster = routes[a].order[k];
        if (permits(b, cluster, routes[b]) &&
            accept_and_settle(a, without(a, k), b, with(b, routes[b], cluster))) {
          improved = true;
        } else {
          ++k;
        }
      }
      return improved;
    }
    bool swaps(int a, int b) {
      for (std::size_t i = 0; i < routes[a].order.size(); ++i) {
        const int from_a = routes[a].order[i];
        const Route rest_a = without(a, i);
        for (std::size_t j = 0; j < routes[b].order.size(); ++j) {
          const int from_b = routes[b].order[j];
          if (!permits(a, from_b, rest_a)) continue;
          const Route rest_b = without(b, j);
          if (!permits(b, from_a, rest_b)) continue;
          if (accept_and_settle(a, with(a, rest_a, from_b), b, with(b, rest_b, from_a)))
            return true;
        }
      }
      return false;
    }
    bool tails(int a, int b) {
      const std::vector<int> x = routes[a].order, y = routes[b].order;
      for (std::size_t i = 0; i <= x.size(); ++i) {
        for (std::size_t j = 0; j <= y.size(); ++j) {
          if ((i == x.size() && j == y.size()) || (i == 0 && j == 0)) continue;
          const auto joined = [&](int robot, const std::vector<int>& head, std::size_t h,
                                  const std::vector<int>& tail, std::size_t t) {
            std::vector<int> order(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(h));
            Route so_far;
            so_far.order = order;
            for (std::size_t k = t; k < tail.size(); ++k) {
              if (!permits(robot, tail[k], so_far)) return std::optional<Route>{};
              so_far.order.push_back(tail[k]);
            }
            return std::optional<Route>{plain(robot, std::move(so_far.order))};
          };
          auto route_a = joined(a, x, i, y, j);
          if (!route_a) continue;
          auto route_b = joined(b, y, j, x, i);
          if (!route_b) continue;
          if (accept_and_settle(a, std::move(*route_a), b, std::move(*route_b))) return true;
        }
      }
      return false;
    }
  };
};
}  // namespace surfleet
