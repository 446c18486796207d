// SPDX-License-Identifier: MIT
#include <surfleet/allocation/greedy_allocator.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <surfleet/allocation/improve_allocation.hpp>
#include <surfleet/core/random.hpp>

#include "check.hpp"
#include "random_clusters.hpp"

using namespace surfleet;
using namespace allocation_test;

namespace {
const Point3 kRoom(30, 20, 10);

template <ClusterRouting G>
void is_partition(const G& graph, const FleetPlan& plan) {
  CHECK(static_cast<int>(plan.routes.size()) == graph.robots());
  std::vector<int> all = plan.unassigned;
  for (int r = 0; r < graph.robots(); ++r) {
    all.insert(all.end(), plan.routes[r].begin(), plan.routes[r].end());
    const Route route = follow(graph, r, plan.routes[r]);
    CHECK_NEAR(plan.utilities[r], route.utility, 1e-12);
    CHECK_NEAR(plan.lengths[r], route.length, 1e-9);
  }
  std::sort(all.begin(), all.end());
  std::vector<int> expected(graph.clusters());
  std::iota(expected.begin(), expected.end(), 0);
  CHECK(all == expected);
}
/// The best value of any order of a set, by all permutations.
template <ClusterRouting G, RouteMeasure M>
double best_order(const G& graph, int robot, std::vector<int> set, const M& measure) {
  std::sort(set.begin(), set.end());
  double best = -std::numeric_limits<double>::infinity();
  do best = std::max(best, measure(follow(graph, robot, set)));
  while (std::next_permutation(set.begin(), set.end()));
  return best;
}
/// The largest total utility of any allocation.
template <ClusterRouting G>
double best_allocation(const G& graph) {
  const int n = graph.clusters(), robots = graph.robots();
  std::vector<std::vector<double>> value(robots, std::vector<double>(std::size_t{1} << n));
  for (int r = 0; r < robots; ++r) {
    for (std::size_t set = 0; set < value[r].size(); ++set) {
      std::vector<int> members;
      for (int c = 0; c < n; ++c)
        if ((set >> c & 1U) != 0U) members.push_back(c);
      value[r][set] = best_order(graph, r, members, RouteUtility{});
    }
  }
  std::vector<double> best = value[0];
  for (int r = 1; r < robots; ++r) {
    std::vector<double> next(best.size(), 0.0);
    for (std::size_t set = 0; set < best.size(); ++set)
      for (std::size_t part = set;; part = (part - 1) & set) {
        next[set] = std::max(next[set], best[set & ~part] + value[r][part]);
        if (part == 0) break;
      }
    best = next;
  }
  return best.back();
}
/// A routing and a set function with the bare minimum.
struct ArchetypeRouting {
  short clusters() const { return 3; }
  short robots() const { return 2; }
  float gain(int) const { return 1.0F; }
  Hop hop(int robot, int state, int cluster) const {
    const double d = std::abs((state < 0 ? 10.0 * robot : state) - cluster);
    return {cluster, 1.0 / (1.0 + d), d, 0.0};
  }
};
struct ArchetypeValue {
  template <typename G>
  Route arrange(const G& g, int robot, std::vector<int> order) const {
    Route r = follow(g, robot, std::move(order));
    r.value = static_cast<double>(r.order.size());
    return r;
  }
  template <typename G>
  Route extend(const G& g, int robot, const Route& route, int cluster) const {
    std::vector<int> order = route.order;
    order.push_back(cluster);
    return arrange(g, robot, std::move(order));
  }
};
static_assert(ClusterRouting<ArchetypeRouting>);
static_assert(ElementOrder<NearestFirst, ArchetypeRouting> &&
              ElementOrder<LargestGainFirst, ArchetypeRouting>);
static_assert(RouteSetFunction<ArchetypeValue, ArchetypeRouting>);
}  // namespace

TEST(best_insertion_is_the_best_of_all_places) {
  Random random(1);
  for (int trial = 0; trial < 30; ++trial) {
    const ClusterGraph<Point3> graph(random_clusters(random, kRoom, 7, 5),
                                     random_starts(random, kRoom, 1));
    const std::vector<int> order = {4, 2, 0, 5, 1};
    const auto check_measure = [&](const auto& measure) {
      double most = -std::numeric_limits<double>::infinity();
      for (std::size_t place = 0; place <= order.size(); ++place) {
        std::vector<int> longer = order;
        longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(place), 6);
        most = std::max(most, measure(follow(graph, 0, longer)));
      }
      CHECK_NEAR(detail::best_insertion(graph, 0, order, 6, measure).value, most, 1e-12);
    };
    check_measure(RouteUtility{});
    check_measure(RouteShortness{});
  }
}

TEST(tour_utility_is_monotone_and_near_the_best_order) {
  Random random(2);
  double found = 0.0, best = 0.0;
  for (int trial = 0; trial < 20; ++trial) {
    const ClusterGraph<Point3> graph(random_clusters(random, kRoom, 6, 4),
                                     random_starts(random, kRoom, 1));
    const TourUtility<> value{};
    Route route;
    for (int c = 0; c < 6; ++c) {
      const Route longer = value.extend(graph, 0, route, c);
      CHECK(longer.value > route.value);
      CHECK_NEAR(longer.value, follow(graph, 0, longer.order).utility, 1e-12);
      route = longer;
    }
    route = value.arrange(graph, 0, route.order);
    const double optimum = best_order(graph, 0, route.order, RouteUtility{});
    // A heuristic: which local optimum it finds may depend on the last bit of a cosine.
    CHECK(route.value <= optimum + 1e-12 && route.value >= 0.5 * optimum);
    found += route.value;
    best += optimum;
  }
  CHECK(found >= 0.93 * best);
}

TEST(tour_utility_is_exact_where_exits_do_not_depend_on_the_order) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const ClusterGraph<Point3> graph(random_clusters(random, kRoom, 6, 1),
                                     random_starts(random, kRoom, 1));
    std::vector<int> all(6);
    std::iota(all.begin(), all.end(), 0);
    CHECK_NEAR((TourUtility<>{}.arrange(graph, 0, all).value),
               best_order(graph, 0, all, RouteUtility{}), 1e-12);
    CHECK_NEAR((TourShortness<>{}.arrange(graph, 0, all).value),
               best_order(graph, 0, all, RouteShortness{}), 1e-9);
    CHECK_NEAR((TourUtility<ExactTour>{}.arrange(graph, 0, all).value),
               best_order(graph, 0, all, RouteUtility{}), 1e-12);
  }
}

TEST(tsga_reaches_half_of_the_optimum_and_usually_most_of_it) {
  Random random(4);
  double found = 0.0, improved = 0.0, best = 0.0;
  for (int trial = 0; trial < 25; ++trial) {
    const int robots = 1 + trial % 3;
    const ClusterGraph<Point3> graph(random_clusters(random, kRoom, 6, 1 + trial % 4),
                                     random_starts(random, kRoom, robots));
    const FleetPlan plan = TspGreedyAllocator{}(graph);
    is_partition(graph, plan);
    CHECK(plan.unassigned.empty());
    const double optimum = best_allocation(graph);
    CHECK(plan.total_utility() >= 0.5 * optimum && plan.total_utility() <= optimum + 1e-9);
    const FleetPlan better = ImproveAllocation<>{}(graph, plan);
    is_partition(graph, better);
    CHECK(better.total_utility() >= plan.total_utility() - 1e-12);
    CHECK(better.total_utility() <= optimum + 1e-9);
    found += plan.total_utility();
    improved += better.total_utility();
    best += optimum;
  }
  CHECK(found >= 0.85 * best);
  CHECK(improved >= 0.95 * best);
}

TEST(nnb_gives_every_robot_its_best_cluster) {
  Random random(5);
  const Clusters clusters = random_clusters(random, kRoom, 9, 4);
  const auto starts = random_starts(random, kRoom, 3);
  const ClusterGraph<Point3> graph(clusters, starts);
  const FleetPlan plan = NearestNeighbourAllocator{}(graph);
  is_partition(graph, plan);
  std::vector<char> taken(9, 0);
  for (int r = 0; r < 3; ++r) {
    CHECK(plan.routes[r].size() == 1);
    for (int c = 0; c < 9; ++c)
      if (taken[c] == 0)
        CHECK(graph.hop(r, -1, c).utility <= graph.hop(r, -1, plan.routes[r][0]).utility);
    taken[plan.routes[r][0]] = 1;
  }
  CHECK(plan.unassigned.size() == 6);
  CHECK(NearestNeighbourAllocator{}(clusters, starts).routes == plan.routes);

  NearestNeighbourAllocator as_printed;  // every robot for itself
  as_printed.rule.exclusive = false;
  const FleetPlan own = as_printed(graph);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 9; ++c)
      CHECK(graph.hop(r, -1, c).utility <= graph.hop(r, -1, own.routes[r].at(0)).utility);
}

TEST(makespan_aware_evens_out_and_improvement_never_hurts) {
  Random random(6);
  double greedy = 0.0, even = 0.0, improved = 0.0, total = 0.0, total_with_mean = 0.0;
  const auto sum = [](const FleetPlan& p) {
    return std::accumulate(p.lengths.begin(), p.lengths.end(), 0.0);
  };
  for (int trial = 0; trial < 8; ++trial) {
    const ClusterGraph<Point3> graph(random_clusters(random, kRoom, 24, 3),
                                     random_starts(random, kRoom, 3));
    const FleetPlan tsga = TspGreedyAllocator{}(graph);
    const FleetPlan plan = MakespanAllocator{}(graph);
    is_partition(graph, plan);
    const FleetPlan better = ImproveAllocation<Makespan, TourShortness<>>{}(graph, plan);
    is_partition(graph, better);
    CHECK(better.longest() <= plan.longest() + 1e-9);
    CHECK(better.unassigned.empty());
    const FleetPlan spare = ImproveAllocation<MakespanAndMean, TourShortness<>>{}(graph, plan);
    is_partition(graph, spare);
    CHECK(spare.longest() + sum(spare) <= plan.longest() + sum(plan) + 1e-9);  // 3 robots, weight 3
    total += sum(better);
    total_with_mean += sum(spare);
    greedy += tsga.longest();
    even += plan.longest();
    improved += better.longest();
  }
  CHECK(even < greedy);
  CHECK(improved < 0.98 * even);
  CHECK(total_with_mean < total);
}

TEST(robots_under_way_keep_their_routes) {
  Random random(8);
  const ClusterGraph<Point3> graph(random_clusters(random, kRoom, 14, 3),
                                   random_starts(random, kRoom, 3));
  const AlreadyAssigned assigned{{{3, 7, 1}, {}, {12, 0}}};
  const auto check_kept = [&](const FleetPlan& plan) {
    is_partition(graph, plan);
    CHECK(plan.routes[0] == assigned.routes[0] && plan.routes[2] == assigned.routes[2]);
  };
  const FleetPlan plan = TspGreedyAllocator{}(graph, assigned);
  check_kept(plan);
  CHECK(plan.routes[1].size() == 9);
  check_kept(MakespanAllocator{}(graph, assigned));
  check_kept(NearestNeighbourAllocator{}(graph, assigned));
  check_kept(ImproveAllocation<>{}(graph, plan, assigned));
  CHECK_THROWS(Error, TspGreedyAllocator{}(graph, {{{1}, {1}, {}}}));
  CHECK_THROWS(Error, TspGreedyAllocator{}(graph, {{{1}, {}}}));
  CHECK_THROWS(Error, TspGreedyAllocator{}(graph, {{{99}, {}, {}}}));
}

TEST(constraints_hold) {
  Random random(9);
  const ClusterGraph<Point3> graph(random_clusters(random, kRoom, 12, 3),
                                   random_starts(random, kRoom, 3));
  TspGreedyAllocator capped;
  capped.constraint.capacity = 3;
  FleetPlan plan = capped(graph);
  is_partition(graph, plan);
  CHECK(plan.unassigned.size() == 3);
  for (const auto& route : plan.routes) CHECK(route.size() == 3);

  TspGreedyAllocator split;  // robots on the ground take the even clusters
  split.constraint.allowed.assign(3, std::vector<char>(12, 0));
  for (int c = 0; c < 12; ++c) split.constraint.allowed[c % 2 == 0 ? 0 : 1][c] = 1;
  plan = split(graph);
  is_partition(graph, plan);
  CHECK(plan.routes[2].empty() && plan.unassigned.empty());
  for (const int c : plan.routes[0]) CHECK(c % 2 == 0);
  ImproveAllocation<> improve;
  improve.constraint = split.constraint;
  plan = improve(graph, plan);
  for (const int c : plan.routes[1]) CHECK(c % 2 == 1);

  GreedyAllocator<TourUtility<>, LargestGainFirst, RangeLimit> limited;
  limited.constraint.range = {40.0, 25.0};
  plan = limited(graph);
  is_partition(graph, plan);
  CHECK(plan.lengths[0] <= 40.0 && plan.lengths[1] <= 25.0 && plan.lengths[2] <= 25.0);
}

TEST(largest_gain_first_orders_by_gain) {
  Random random(10);
  const ClusterGraph<Point3> graph(random_clusters(random, kRoom, 12, 1),
                                   random_starts(random, kRoom, 2));
  const auto by_gain = LargestGainFirst{}(graph);
  const auto by_distance = NearestFirst{}(graph);
  const auto distance = [&](int c) {
    return std::min(graph.hop(0, -1, c).travel, graph.hop(1, -1, c).travel);
  };
  for (std::size_t k = 1; k < by_gain.size(); ++k) {
    CHECK(graph.gain(by_gain[k - 1]) >= graph.gain(by_gain[k]));
    CHECK(distance(by_distance[k - 1]) <= distance(by_distance[k]));
  }
}

TEST(clusters_nobody_can_reach_stay_unassigned) {
  const auto wall = [](const Point2& a, const Point2& b) {
    return (a.x() < 0) == (b.x() < 0) ? (a - b).norm() : std::numeric_limits<double>::infinity();
  };
  std::vector<ConfigurationCluster<Point2>> clusters(5);
  for (int c = 0; c < 5; ++c) clusters[c] = {{Point2(c - 2.5, 1.0)}, 0.1};
  const ClusterGraph<Point2, ExponentialUtility, decltype(wall)> graph(
      clusters, {Point2(1, 0), Point2(2, 0)}, {ExponentialUtility{}}, wall);
  const FleetPlan plan = TspGreedyAllocator{}(graph);
  is_partition(graph, plan);
  CHECK(plan.unassigned == (std::vector<int>{0, 1, 2}));
  CHECK(MakespanAllocator{}(graph).unassigned == plan.unassigned);
  CHECK(NearestNeighbourAllocator{}(graph).unassigned.size() == 3);
}

TEST(nothing_to_do_is_no_error) {
  const FleetPlan no_clusters = TspGreedyAllocator{}(Clusters{}, {Point3(0, 0, 0)});
  CHECK(no_clusters.routes.size() == 1 && no_clusters.routes[0].empty());
  Random random(1);
  const ClusterGraph<Point3> no_robots(random_clusters(random, kRoom, 3, 2), {});
  const FleetPlan plan = TspGreedyAllocator{}(no_robots);
  CHECK(plan.routes.empty() && plan.unassigned.size() == 3 && plan.longest() == 0.0);
  is_partition(no_robots, ImproveAllocation<>{}(no_robots, plan));
}

TEST(archetypes_and_matrices_are_enough) {
  const FleetPlan plan = GreedyAllocator<ArchetypeValue>{}(ArchetypeRouting{});
  is_partition(ArchetypeRouting{}, plan);
  MatrixRouting table{2, CostMatrix(5), CostMatrix(5)};
  for (int i = 0; i < 5; ++i)
    for (int j = 2; j < 5; ++j) {
      table.length(i, j) = std::abs((i < 2 ? 4.0 * i : i - 1.0) - (j - 1.0));
      table.utility(i, j) = std::exp(-table.length(i, j));
    }
  const FleetPlan by_table = TspGreedyAllocator{}(table);
  is_partition(table, by_table);
  CHECK(by_table.routes[0] == (std::vector<int>{0, 1}) || by_table.routes[0].size() == 3 ||
        by_table.routes[1].size() == 3 || by_table.routes[1].front() == 2);
  CHECK_NEAR(table.gain(0), std::exp(-1.0), 1e-12);
}

TEST(plans_repeat) {
  Random random(12);
  const Clusters clusters = random_clusters(random, kRoom, 40, 4);
  const auto starts = random_starts(random, kRoom, 4);
  const ClusterGraph<Point3> graph(clusters, starts), again(clusters, starts);
  CHECK(TspGreedyAllocator{}(graph).routes == TspGreedyAllocator{}(again).routes);
  CHECK(MakespanAllocator{}(graph).routes == MakespanAllocator{}(again).routes);
}
