// SPDX-License-Identifier: MIT
/// @file
/// @brief Point clouds made ready for meshing and voting [004 §7.2.2]: even density, no outliers.
/// `cropped` of point_cloud.hpp trims to a box.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/point_cloud.hpp>

namespace surfleet {
namespace detail {
inline void check_finite(std::span<const Point3> points, const char* what) {
  for (std::size_t i = 0; i < points.size(); ++i)
    require(points[i].allFinite(), std::string(what) + ": point " + std::to_string(i) +
                                       " is not finite; expected finite coordinates");
}
}  // namespace detail

/// The points of these indices, in this order, with their attributes.
inline PointCloud selected(const PointCloud& cloud, std::span<const std::size_t> indices) {
  PointCloud part;
  for (const std::size_t i : indices) {
    part.points.push_back(cloud.points[i]);
    if (cloud.normals.size() == cloud.size()) part.normals.push_back(cloud.normals[i]);
    if (cloud.colors.size() == cloud.size()) part.colors.push_back(cloud.colors[i]);
  }
  return part;
}

/// The indices of finite points, ascending.
inline std::vector<std::size_t> finite_points(std::span<const Point3> points) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].allFinite()) kept.push_back(i);
  return kept;
}

/// Equalises the density: points taken in an order shuffled by `seed`, each dropping the others
/// nearer than `spacing` [m]. No two of the kept ones, ascending, are nearer than that and every
/// other point is nearer than that to one. O(n (log n + k)) with k points in reach.
inline std::vector<std::size_t> evenly_spaced(std::span<const Point3> points, double spacing,
                                              std::uint64_t seed = 1) {
  require(spacing >= 0.0 && std::isfinite(spacing), "spacing of points: expected 0 m or more");
  detail::check_finite(points, "spacing of points");
  std::vector<std::size_t> order(points.size()), kept;
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random(mix64(seed) ^ 0xe7e9ULL).shuffle(order);
  const KdTree tree(points);
  std::vector<std::uint8_t> dropped(points.size(), 0);
  for (const std::size_t i : order) {
    if (dropped[i] != 0) continue;
    kept.push_back(i);
    tree.for_each_within(points[i], spacing, [&](const Neighbor& n) {
      if (n.distance2 < spacing * spacing) dropped[static_cast<std::size_t>(n.index)] = 1;
    });
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

struct OutlierOptions {
  std::size_t neighbors = 16;  ///< Over which the distance is meaned.
  double deviations = 2.0;     ///< Above the mean of all points' means, in standard deviations.
  int threads = 1;
};

/// The indices of points whose mean distance to their nearest neighbours is not out of the common:
/// at most the mean over the cloud plus so many standard deviations. Clouds of no more points than
/// neighbours keep all. O(n log n).
inline std::vector<std::size_t> inliers(std::span<const Point3> points,
                                        const OutlierOptions& options = {}) {
  require(options.neighbors >= 1 && options.deviations >= 0.0,
          "outliers: expected one neighbour or more and 0 deviations or more");
  detail::check_finite(points, "outliers");
  std::vector<std::size_t> kept(points.size());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  if (points.size() <= options.neighbors) return kept;
  const KdTree tree(points);
  std::vector<double> mean(points.size(), 0.0);
  parallel_for(
      points.size(), options.threads,
      [&](std::size_t i) {
        double sum = 0.0;  // the point itself adds nothing
        for (const Neighbor& n : tree.k_nearest(points[i], options.neighbors + 1))
          sum += n.distance();
        mean[i] = sum / static_cast<double>(options.neighbors);
      },
      64);
  const auto n = static_cast<double>(points.size());
  const double centre = std::accumulate(mean.begin(), mean.end(), 0.0) / n;
  double squares = 0.0;
  for (const double m : mean) squares += (m - centre) * (m - centre);
  const double limit = centre + options.deviations * std::sqrt(squares / n);
  std::erase_if(kept, [&](std::size_t i) { return mean[i] > limit; });
  return kept;
}

/// The median distance of a point to its nearest other [m]; 0 for fewer than two points. O(n log
/// n).
inline double median_spacing(std::span<const Point3> points) {
  detail::check_finite(points, "spacing of points");
  if (points.size() < 2) return 0.0;
  const KdTree tree(points);
  std::vector<double> nearest;
  for (const Point3& p : points) nearest.push_back(tree.k_nearest(p, 2).back().distance());
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}
}  // namespace surfleet
