// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/viewpoint_clustering.hpp>

#include <algorithm>
#include <limits>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

std::vector<Viewpoint> random_views(std::uint64_t seed, int n, double size) {
  Random random(seed);
  std::vector<Viewpoint> views(static_cast<std::size_t>(n));
  for (Viewpoint& v : views)
    v.configuration.position = {random.uniform(0, size), random.uniform(0, size),
                                random.uniform(0, 0.2 * size)};
  return views;
}

/// A wall at x = 10 with a door at y = 0 that every path goes through.
struct AroundTheWall {
  std::optional<double> operator()(const Configuration& a, const Configuration& b) const {
    if ((a.position.x() < 10) == (b.position.x() < 10)) return (a.position - b.position).norm();
    const Point3 door(10, 0, 0);
    return (a.position - door).norm() + (b.position - door).norm();
  }
};
struct NoPaths {
  std::optional<double> operator()(const Configuration&, const Configuration&) const {
    return std::nullopt;
  }
};
struct PlainLength {
  double operator()(const Configuration& a, const Configuration& b) {
    return (a.position - b.position).norm();
  }
};
static_assert(PathDistance<AroundTheWall> && PathDistance<PlainLength> && !PathDistance<int>);

/// The definition by closure over all pairs, and the growth of the radius in order of length.
template <typename D>
std::vector<std::vector<std::int32_t>> by_definition(const std::vector<Viewpoint>& views,
                                                     D distance, const ClusterOptions& o) {
  const std::size_t n = views.size();
  std::vector<std::size_t> label(n);
  for (std::size_t i = 0; i < n; ++i) label[i] = i;
  const auto relabel = [&](std::size_t from, std::size_t to) {
    for (std::size_t& l : label)
      if (l == from) l = to;
  };
  const auto d = [&](std::size_t i, std::size_t j) {
    const std::optional<double> l = distance(views[i].configuration, views[j].configuration);
    return l ? *l : std::numeric_limits<double>::infinity();
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (i != j && d(i, j) < o.radius) relabel(label[j], label[i]);
  const auto alone = [&](std::size_t i) {
    return std::count(label.begin(), label.end(), label[i]) == 1;
  };
  for (;;) {
    double best = o.max_radius;
    std::size_t from = n, to = n;
    for (std::size_t i = 0; i < n; ++i) {
      if (!alone(i)) continue;
      for (std::size_t j = 0; j < n; ++j)
        if (j != i && d(i, j) < best) {
          best = d(i, j);
          from = i;
          to = j;
        }
    }
    if (from == n) break;
    label[from] = label[to];
  }
  std::vector<std::vector<std::int32_t>> clusters;
  for (std::size_t l = 0; l < n; ++l) {
    std::vector<std::int32_t> own;
    for (std::size_t i = 0; i < n; ++i)
      if (label[i] == l) own.push_back(static_cast<std::int32_t>(i));
    if (!own.empty()) clusters.push_back(own);
  }
  std::sort(clusters.begin(), clusters.end());
  return clusters;
}

template <typename D>
void agrees_with_definition(D distance) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto views = random_views(seed, 20 + 12 * static_cast<int>(seed), 25.0);
    const ClusterOptions options{.radius = 2.0, .max_radius = 5.0};
    std::vector<std::vector<std::int32_t>> found;
    for (const ViewpointCluster& c : cluster_viewpoints(views, distance, options))
      found.push_back(c.views);
    CHECK(found == by_definition(views, distance, options));
  }
}

TEST(agrees_with_definition_euclidean) { agrees_with_definition(EuclideanDistance{}); }
TEST(agrees_with_definition_by_path) { agrees_with_definition(AroundTheWall{}); }
TEST(agrees_with_definition_plain) { agrees_with_definition(PlainLength{}); }
TEST(without_paths_everyone_is_alone) {
  agrees_with_definition(NoPaths{});
  const auto views = random_views(1, 30, 3.0);
  CHECK(cluster_viewpoints(views, NoPaths{}).size() == 30);
}

TEST(a_wall_parts_what_is_near_as_the_crow_flies) {
  std::vector<Viewpoint> views(4);
  views[0].configuration.position = {9.5, 20, 0};
  views[1].configuration.position = {9.5, 21, 0};
  views[2].configuration.position = {10.5, 20, 0};
  views[3].configuration.position = {10.5, 21, 0};
  CHECK(cluster_viewpoints(views).size() == 1);
  const auto parted = cluster_viewpoints(views, AroundTheWall{}, {});
  CHECK(parted.size() == 2);
  CHECK(parted[0].views == std::vector<std::int32_t>({0, 1}));
}

TEST(the_extent_bounds_chains) {
  std::vector<Viewpoint> views(100);
  for (std::size_t i = 0; i < views.size(); ++i)
    views[i].configuration.position = {static_cast<double>(i), 0, 0};
  CHECK(cluster_viewpoints(views).size() == 1);
  const auto parts =
      cluster_viewpoints(views, {.radius = 2.0, .max_radius = 5.0, .max_extent = 9.5});
  CHECK(parts.size() == 10);
  for (const ViewpointCluster& c : parts) CHECK(c.views.size() == 10);
}

TEST(empty_single_and_coincident) {
  CHECK(cluster_viewpoints(std::span<const Viewpoint>()).empty());
  CHECK(cluster_viewpoints(std::vector<Viewpoint>(1)).size() == 1);
  CHECK(cluster_viewpoints(std::vector<Viewpoint>(5)).size() == 1);
  CHECK_THROWS(Error, cluster_viewpoints(std::vector<Viewpoint>(1), {.radius = 0.0}));
  CHECK_THROWS(Error, cluster_viewpoints(std::vector<Viewpoint>(1), {.radius = 6.0}));
}
}  // namespace
