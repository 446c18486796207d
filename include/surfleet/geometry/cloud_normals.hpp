// SPDX-License-Identifier: MIT
/// @file
/// @brief Normals of a point cloud: of the plane through each point's neighbours, then turned all
/// to one side [004 §7.2.2].
///
///     cloud.normals = plane_normals(cloud.points);
///     turn_to_sensor(cloud.points, sensor, cloud.normals);      // a single scan, or
///     turn_consistently(cloud.points, 12, cloud.normals);       // over a minimum spanning tree
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/cloud_filters.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/point_moments.hpp>

namespace surfleet {
struct PlaneNormalOptions {
  std::size_t neighbors = 20;  ///< The nearest points that the plane goes through, itself included.
  int threads = 1;
};

/// The direction of least variance among each point's nearest neighbours (PCA), of either sign;
/// +z where fewer than three points lie apart. O(n log n).
inline std::vector<Eigen::Vector3f> plane_normals(std::span<const Point3> points,
                                                  const PlaneNormalOptions& options = {}) {
  require(options.neighbors >= 3, "normals: expected three neighbours or more");
  detail::check_finite(points, "normals");
  const KdTree tree(points);
  std::vector<Eigen::Vector3f> normals(points.size(), Eigen::Vector3f::UnitZ());
  parallel_for(
      points.size(), options.threads,
      [&](std::size_t i) {
        PointMoments moments;
        for (const Neighbor& n : tree.k_nearest(points[i], options.neighbors))
          moments.add(points[static_cast<std::size_t>(n.index)] - points[i]);
        const PrincipalAxes axes(moments.covariance());
        if (moments.weight >= 3.0 && axes.values[2] > 0.0)
          normals[i] = axes.vectors.col(0).cast<float>();
      },
      64);
  return normals;
}

/// Turns a normal to the side of the sensor that saw its point.
inline void turn_to_sensor(const Point3& point, const Point3& sensor, Eigen::Vector3f& normal) {
  if (normal.cast<double>().dot(sensor - point) < 0.0) normal = -normal;
}
/// The same for every normal of one scan.
inline void turn_to_sensor(std::span<const Point3> points, const Point3& sensor,
                           std::span<Eigen::Vector3f> normals) {
  require(points.size() == normals.size(), "normals: expected one a point");
  for (std::size_t i = 0; i < points.size(); ++i) turn_to_sensor(points[i], sensor, normals[i]);
}

/// Turns the normals to one side along a minimum spanning tree of 1 − |nᵢ · nⱼ| over each point's
/// `neighbors` nearest (Hoppe et al. 1992). In every connected part the highest point's normal
/// looks up. O(n k log n).
inline void turn_consistently(std::span<const Point3> points, std::size_t neighbors,
                              std::span<Eigen::Vector3f> normals) {
  require(points.size() == normals.size(), "normals: expected one a point");
  require(neighbors >= 1, "normals: expected one neighbour or more");
  detail::check_finite(points, "normals");
  const std::size_t n = points.size();
  const KdTree tree(points);
  std::vector<std::tuple<double, std::int32_t, std::int32_t>> links;
  for (std::size_t i = 0; i < n; ++i)
    for (const Neighbor& j : tree.k_nearest(points[i], neighbors + 1)) {
      const auto a = static_cast<std::int32_t>(i);
      if (a == j.index) continue;
      const double cosine =
          static_cast<double>(normals[i].dot(normals[static_cast<std::size_t>(j.index)]));
      links.emplace_back(1.0 - std::abs(cosine), std::min(a, j.index), std::max(a, j.index));
    }
  std::sort(links.begin(), links.end());
  DisjointSets parts(n);  // Kruskal's
  std::vector<std::pair<std::int32_t, Arc>> kept;
  for (const auto& [weight, a, b] : links) {
    if (!parts.unite(a, b)) continue;
    kept.push_back({a, {b, weight}});
    kept.push_back({b, {a, weight}});
  }
  const Graph spanning(n, kept);

  std::vector<std::size_t> order(n);  // roots: the highest point of a part comes first
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points[a].z() > points[b].z(); });
  std::vector<std::uint8_t> done(n, 0);
  std::vector<std::int32_t> stack;
  for (const std::size_t root : order) {
    if (done[root] != 0) continue;
    if (normals[root].z() < 0.0F) normals[root] = -normals[root];
    done[root] = 1;
    stack.assign(1, static_cast<std::int32_t>(root));
    while (!stack.empty()) {
      const std::int32_t v = stack.back();
      stack.pop_back();
      for (const Arc& arc : spanning.arcs(v)) {
        const auto j = static_cast<std::size_t>(arc.to);
        if (done[j] != 0) continue;
        if (normals[j].dot(normals[static_cast<std::size_t>(v)]) < 0.0F) normals[j] = -normals[j];
        done[j] = 1;
        stack.push_back(arc.to);
      }
    }
  }
}
}  // namespace surfleet
