// SPDX-License-Identifier: MIT
#include <surfleet/allocation/cluster_graph.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <surfleet/core/random.hpp>

#include "check.hpp"
#include "random_clusters.hpp"

using namespace surfleet;
using namespace allocation_test;

namespace {
struct ArchetypeUtility {
  float operator()(double gain, double, double) const { return static_cast<float>(gain); }
};
static_assert(UtilityPolicy<ArchetypeUtility> && !UtilityPolicy<int>);

template <UtilityPolicy U>
void utility_laws(const U& u) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (double d = 0.0; d < 50.0; d += 0.7) {
    CHECK(u(0.5, d, 1.0) > 0.0);
    CHECK(u(0.5, d + 1.0, 1.0) < u(0.5, d, 1.0));
    CHECK(u(0.5, 1.0, d + 1.0) < u(0.5, 1.0, d));
    CHECK(u(0.6, d, d) > u(0.5, d, d));
  }
  CHECK(u(1.0, infinity, 0.0) == 0.0);
}
}  // namespace

TEST(utilities_reward_gain_and_penalise_length) {
  utility_laws(ExponentialUtility{});
  utility_laws(ExponentialUtility{0.17, 0.15});
  utility_laws(RatioUtility{});
  CHECK_NEAR((ExponentialUtility{0.3, 0.03}(0.2, 2.0, 5.0)), 0.2 * std::exp(-0.6 - 0.15), 1e-12);
}

TEST(edges_are_the_six_tuple) {
  Random random(7);
  const auto clusters = random_clusters(random, Point3(60, 40, 15), 8, 6);
  const std::vector<Point3> starts = {Point3(0, 0, 0), Point3(60, 40, 0)};
  const ExponentialUtility u;
  const ClusterGraph<Point3> graph(clusters, starts);
  CHECK(graph.clusters() == 8 && graph.robots() == 2);
  for (int from = -2; from < graph.configurations(); ++from) {
    for (int v = 0; v < 8; ++v) {
      const int robot = from == -2 ? 1 : 0;
      const ClusterEdge e = graph.edge(robot, std::max(from, -1), v);
      const Point3 p = from < 0 ? starts[robot] : graph.configuration(from);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Point3& q : clusters[v].configurations)
        nearest = std::min(nearest, (p - q).norm());
      CHECK_NEAR(e.travel, nearest, 1e-12);
      CHECK_NEAR((p - graph.configuration(e.entry)).norm(), nearest, 1e-12);
      // The path inside visits every configuration of the cluster once and is as long as it says.
      const auto path = graph.inside_path(e.entry);
      CHECK(path.size() == clusters[v].configurations.size());
      CHECK(path.front() == e.entry && path.back() == e.end);
      std::vector<int> sorted(path.begin(), path.end());
      std::sort(sorted.begin(), sorted.end());
      CHECK(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
      double inside = 0.0;
      for (std::size_t k = 1; k < path.size(); ++k)
        inside += (graph.configuration(path[k]) - graph.configuration(path[k - 1])).norm();
      for (const int k : path) CHECK(graph.cluster_of(k) == v);
      CHECK_NEAR(e.inside, inside, 1e-9);
      CHECK_NEAR(e.utility, u(clusters[v].gain, e.travel, e.inside), 1e-12);
      const Hop h = graph.hop(robot, std::max(from, -1), v);
      CHECK(h.state == e.end && h.utility == e.utility && h.length() == e.travel + e.inside);
    }
  }
}

TEST(a_visit_is_bounded_before_its_path_is_known) {
  Random random(11);
  const std::vector<ExponentialUtility> utilities = {{0.3, 0.03}, {0.1, 0.2}};
  for (int i = 0; i < 20; ++i) {
    const auto clusters = random_clusters(random, Point3(60, 40, 15), 6, 1 + i);
    const ClusterGraph<Point3> graph(clusters, {Point3(3, 2, 1), Point3(60, 40, 0)}, utilities);
    for (int robot = 0; robot < 2; ++robot)
      for (int c = 0; c < graph.clusters(); ++c) {
        const double travel = graph.travel(robot, -1, c);
        const double most = graph.most_utility(robot, -1, c);
        const Hop h = graph.hop(robot, -1, c);
        CHECK(travel == h.travel && most >= h.utility);
        CHECK(most <= utilities[robot](clusters[c].gain, travel, 0.0));
        CHECK(graph.most_utility(robot, -1, c) == h.utility);
        // A chain of points is its own spanning tree.
        if (clusters[c].configurations.size() == 2) CHECK_NEAR(most, h.utility, 1e-6 * h.utility);
      }
  }
}

TEST(utility_depends_on_where_the_visit_before_ended) {
  // U is a row from x = 0 to 4; V lies behind its far end.
  std::vector<ConfigurationCluster<Point2>> clusters(2);
  for (int k = 0; k < 5; ++k) clusters[0].configurations.emplace_back(k, 0.0);
  clusters[1].configurations.emplace_back(6.0, 0.0);
  clusters[0].gain = clusters[1].gain = 0.5;
  const ClusterGraph<Point2> graph(clusters, {Point2(-1, 0), Point2(5, 0)});
  const Hop from_left = graph.hop(0, -1, 0), from_right = graph.hop(1, -1, 0);
  CHECK_NEAR(graph.hop(0, from_left.state, 1).travel, 2.0, 1e-12);
  CHECK_NEAR(graph.hop(1, from_right.state, 1).travel, 6.0, 1e-12);
  const std::vector<int> route = {0, 1};
  const auto views = graph.viewpoints(0, route);
  CHECK(views == (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

TEST(robots_may_have_utilities_of_their_own) {
  std::vector<ConfigurationCluster<Point2>> clusters(1);
  clusters[0] = {{Point2(3, 0)}, 0.5};
  const std::vector<Point2> starts(2, Point2(0, 0));
  const ClusterGraph<Point2> graph(clusters, starts,
                                   {ExponentialUtility{0.1, 0.0}, ExponentialUtility{1.0, 0.0}});
  CHECK(graph.hop(0, -1, 0).utility > graph.hop(1, -1, 0).utility);
  using Graph = ClusterGraph<Point2>;
  CHECK_THROWS(Error, Graph(clusters, starts, {{}, {}, {}}));
}

TEST(unreachable_clusters_have_no_utility) {
  const auto wall = [](const Point2& a, const Point2& b) {
    return (a.x() < 0) == (b.x() < 0) ? (a - b).norm() : std::numeric_limits<double>::infinity();
  };
  std::vector<ConfigurationCluster<Point2>> clusters(1);
  clusters[0] = {{Point2(-3, 0), Point2(-4, 0)}, 0.5};
  const ClusterGraph<Point2, RatioUtility, decltype(wall)> graph(clusters, {Point2(3, 0)},
                                                                 {RatioUtility{}}, wall);
  const Hop h = graph.hop(0, -1, 0);
  CHECK(std::isinf(h.travel) && h.utility == 0.0);
}

TEST(bad_clusters_are_refused) {
  using Graph = ClusterGraph<Point2>;
  std::vector<ConfigurationCluster<Point2>> clusters(1);
  clusters[0].gain = 1.0;
  CHECK_THROWS(Error, Graph(clusters, {}));
  clusters[0].configurations.emplace_back(0, 0);
  CHECK(Graph(clusters, {}).robots() == 0);
  for (const double gain : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    clusters[0].gain = gain;
    CHECK_THROWS(Error, Graph(clusters, {}));
  }
}
