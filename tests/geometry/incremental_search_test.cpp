// SPDX-License-Identifier: MIT
#include <surfleet/geometry/incremental_search.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Places in the plane and all arcs between them; infinite lengths are closed.
struct DenseGraph {
  std::vector<Point2> places;
  std::vector<std::vector<Arc>> out, into;
  explicit DenseGraph(std::vector<Point2> at)
      : places(std::move(at)), out(places.size()), into(places.size()) {
    for (std::size_t a = 0; a < size(); ++a)
      for (std::size_t b = 0; b < size(); ++b) {
        out[a].push_back({static_cast<std::int32_t>(b), ShortestPaths::kUnreached});
        into[b].push_back({static_cast<std::int32_t>(a), ShortestPaths::kUnreached});
      }
  }
  std::size_t size() const { return places.size(); }
  const std::vector<Arc>& arcs(std::int32_t n) const { return out[static_cast<std::size_t>(n)]; }
  const std::vector<Arc>& arcs_into(std::int32_t n) const {
    return into[static_cast<std::size_t>(n)];
  }
  void set(std::size_t a, std::size_t b, double length) {
    out[a][b].length = into[b][a].length = length;
  }
};
static_assert(ReversibleGraph<DenseGraph> && !ReversibleGraph<Graph>);

/// By relaxing every arc as often as there are nodes.
std::vector<double> by_brute_force(const DenseGraph& g, std::size_t goal) {
  std::vector<double> left(g.size(), ShortestPaths::kUnreached);
  left[goal] = 0.0;
  for (std::size_t round = 0; round < g.size(); ++round)
    for (std::size_t a = 0; a < g.size(); ++a)
      for (std::size_t b = 0; b < g.size(); ++b)
        left[a] = std::min(left[a], g.out[a][b].length + left[b]);
  return left;
}
}  // namespace

TEST(an_incremental_search_knows_what_a_new_one_finds) {
  Random random(35);
  for (int trial = 0; trial < 20; ++trial) {
    const std::size_t n = 5 + random.below(12);
    std::vector<Point2> places;
    for (std::size_t i = 0; i < n; ++i) places.emplace_back(random.uniform(), random.uniform());
    DenseGraph graph(places);
    const auto change = [&](std::size_t a, std::size_t b) {
      const bool open = a != b && random.uniform() < 0.3;
      const double straight = (places[a] - places[b]).norm();
      graph.set(a, b, open ? straight * random.uniform(1.0, 2.0) : ShortestPaths::kUnreached);
    };
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) change(a, b);
    const Source goal{static_cast<std::int32_t>(random.below(n)), 0.0};
    IncrementalSearch search(graph, std::span<const Source>(&goal, 1));
    std::size_t robot = random.below(n);
    for (int question = 0; question < 30; ++question) {
      const std::size_t before = robot;
      robot = random.below(n);
      for (std::size_t k = random.below(4); k > 0; --k) {
        const std::size_t tail = random.below(n);
        change(tail, random.below(n));
        search.changed(static_cast<std::int32_t>(tail));
      }
      const Source start{static_cast<std::int32_t>(robot), 0.0};
      const double found = search.distance(
          std::span<const Source>(&start, 1),
          [&](std::int32_t node) {
            return (places[robot] - places[static_cast<std::size_t>(node)]).norm();
          },
          (places[robot] - places[before]).norm());
      const auto truth = by_brute_force(graph, static_cast<std::size_t>(goal.first));
      CHECK(std::isinf(found) == std::isinf(truth[robot]));
      if (std::isinf(found)) continue;
      CHECK_NEAR(found, truth[robot], 1e-9);
      const auto path = search.path(start.first);
      double length = 0.0;
      for (std::size_t i = 1; i < path.size(); ++i)
        length +=
            graph.out[static_cast<std::size_t>(path[i - 1])][static_cast<std::size_t>(path[i])]
                .length;
      CHECK(!path.empty() && path.front() == start.first && path.back() == goal.first);
      CHECK_NEAR(length, found, 1e-9);
    }
  }
}
