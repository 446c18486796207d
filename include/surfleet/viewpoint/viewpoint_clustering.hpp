// SPDX-License-Identifier: MIT
/// @file
/// @brief Clusters of viewpoints that lie a short path apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/viewpoint/detail/point_cells.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>

namespace surfleet {
/// The length of a path between two configurations [m], or nothing if there is none.
///
/// `d(a, b)` is never less than the straight distance, which is what neighbours are found by,
/// and is asked at most O(1) times for each pair of neighbours. A roadmap's shortest path is one;
/// wrap it in a lambda.
template <typename D>
concept PathDistance = requires(D& d, const Configuration& q) {
  { d(q, q) } -> std::convertible_to<std::optional<double>>;
};
static_assert(PathDistance<EuclideanDistance>);

/// Viewpoints that are visited together.
struct ViewpointCluster {
  std::vector<std::int32_t> views;  ///< Indices of viewpoints, ascending.
  double gain = 0.0;                ///< g(U) of eq. 2.1; see `assign_gains`.
};

struct ClusterOptions {
  double radius = 2.0;      ///< d_ν: paths shorter than this join viewpoints [m].
  double max_radius = 5.0;  ///< d_ν^max: up to which a lone viewpoint seeks neighbours [m].
  /// Farthest from a cluster's first viewpoint, straight [m]. Viewpoints that would be alone join
  /// the nearest all the same.
  double max_extent = std::numeric_limits<double>::infinity();
};

/// Puts every viewpoint in exactly one cluster [000 §2.4.3].
///
/// A viewpoint belongs to a cluster if a path shorter than `radius` joins it to one of its members.
/// One that stays alone lets the radius grow, continuously up to `max_radius`, until it meets the
/// first other viewpoint, whose cluster it joins. `max_extent` keeps chains from becoming one
/// cluster around the whole structure; the seeds set no such bound. Clusters come in the order of
/// their lowest viewpoint. O(viewpoints × viewpoints within reach).
template <PathDistance Distance>
std::vector<ViewpointCluster> cluster_viewpoints(std::span<const Viewpoint> views,
                                                 Distance&& distance,
                                                 const ClusterOptions& options = {}) {
  require(options.radius > 0.0 && options.max_radius >= options.radius &&
              std::isfinite(options.max_radius),
          "cluster radius: expected 0 < radius <= largest radius");
  const std::size_t n = views.size();
  const auto position = [&](std::size_t i) -> const Point3& {
    return views[i].configuration.position;
  };
  const auto path = [&](std::size_t a, std::size_t b) -> std::optional<double> {
    return distance(views[a].configuration, views[b].configuration);
  };
  detail::PointCells cells(options.radius);
  for (std::size_t i = 0; i < n; ++i) cells.insert(position(i), static_cast<std::int32_t>(i));

  constexpr std::int32_t kNone = -1;
  std::vector<std::int32_t> cluster_of(n, kNone);
  std::vector<ViewpointCluster> clusters;
  std::vector<std::size_t> queue;
  std::vector<std::int32_t> near;
  for (std::size_t first = 0; first < n; ++first) {
    if (cluster_of[first] != kNone) continue;
    const auto id = static_cast<std::int32_t>(clusters.size());
    clusters.emplace_back();
    cluster_of[first] = id;
    queue.assign(1, first);
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const std::size_t i = queue[head];
      near.clear();
      cells.for_each_within(position(i), options.radius, [&](std::int32_t j, double) {
        const auto k = static_cast<std::size_t>(j);
        if (cluster_of[k] == kNone && (position(k) - position(first)).norm() <= options.max_extent)
          near.push_back(j);
      });
      std::sort(near.begin(), near.end());
      for (const std::int32_t j : near) {
        const auto k = static_cast<std::size_t>(j);
        const auto d = path(i, k);
        if (!d || *d >= options.radius) continue;
        cluster_of[k] = id;
        queue.push_back(k);
      }
    }
    for (const std::size_t i : queue) clusters.back().views.push_back(static_cast<std::int32_t>(i));
  }

  struct Join {
    double length;
    std::size_t alone, other;
  };
  std::vector<Join> joins;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    if (clusters[c].views.size() != 1) continue;
    const auto i = static_cast<std::size_t>(clusters[c].views[0]);
    std::vector<std::pair<double, std::int32_t>> around;
    cells.for_each_within(position(i), options.max_radius, [&](std::int32_t j, double d2) {
      if (static_cast<std::size_t>(j) != i) around.emplace_back(std::sqrt(d2), j);
    });
    std::sort(around.begin(), around.end());
    std::optional<Join> best;
    for (const auto& [straight, j] : around) {
      if (best && straight > best->length) break;
      const auto d = path(i, static_cast<std::size_t>(j));
      if (d && *d < options.max_radius && (!best || *d < best->length))
        best = Join{*d, i, static_cast<std::size_t>(j)};
    }
    if (best) joins.push_back(*best);
  }
  std::sort(joins.begin(), joins.end(), [](const Join& a, const Join& b) {
    return a.length != b.length ? a.length < b.length : a.alone < b.alone;
  });
  for (const Join& join : joins) {
    auto& own = clusters[static_cast<std::size_t>(cluster_of[join.alone])].views;
    if (own.size() != 1) continue;
    own.clear();
    cluster_of[join.alone] = cluster_of[join.other];
    clusters[static_cast<std::size_t>(cluster_of[join.other])].views.push_back(
        static_cast<std::int32_t>(join.alone));
  }
  std::erase_if(clusters, [](const ViewpointCluster& c) { return c.views.empty(); });
  for (ViewpointCluster& c : clusters) std::sort(c.views.begin(), c.views.end());
  std::sort(clusters.begin(), clusters.end(),
            [](const auto& a, const auto& b) { return a.views[0] < b.views[0]; });
  return clusters;
}
/// The same with straight distances.
inline std::vector<ViewpointCluster> cluster_viewpoints(std::span<const Viewpoint> views,
                                                        const ClusterOptions& options = {}) {
  return cluster_viewpoints(views, EuclideanDistance{}, options);
}
}  // namespace surfleet
