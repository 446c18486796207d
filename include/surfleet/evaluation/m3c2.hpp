// SPDX-License-Identifier: MIT
/// @file
/// @brief M3C2: the signed distance between two point clouds along local normals (Lague, Brodu and
/// Leroux, ISPRS J. Photogramm. 82, 2013), as the seeds measure reconstructions [000 §2.6.2].
///
/// @code
/// M3C2Options options{.projection_scale = 0.3, .max_depth = 0.5};
/// const M3C2Result r = m3c2(core_points, reference, reconstruction, options);
/// use(r.distance[0], r.statistics.mean);
/// @endcode
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/point_moments.hpp>

namespace surfleet {
/// Settings in the paper's words.
struct M3C2Options {
  double normal_scale = 0.5;        ///< D: diameter of the ball whose points give the normal [m].
  double projection_scale = 0.3;    ///< d: diameter of the projection cylinder [m].
  double max_depth = 0.6;           ///< The cylinder reaches so far to either side [m].
  double registration_error = 0.0;  ///< reg: added to the level of detection [m].
  std::size_t min_points = 4;       ///< Fewer points in a cylinder give no level of detection.
  bool median = false;              ///< Median and interquartile range for mean and deviation.
  /// Points of a cloud with normals count only where these are less than 90° from the axis, so that
  /// the two faces of a thin wall are not averaged. See `m3c2`.
  bool sided = true;
  int threads = 1;
};

/// Mean and spread of signed distances.
struct DistanceStatistics {
  std::size_t count = 0;
  double mean = 0.0;       ///< [m]
  double deviation = 0.0;  ///< Population deviation [m].
  double rmse = 0.0;       ///< Root of mean² + deviation² [m].
};

/// One entry a core point; NaN where a cylinder met no point of one of the clouds.
struct M3C2Result {
  std::vector<double> distance;  ///< Positive where `compared` lies on the normal's side [m].
  std::vector<double> level_of_detection;  ///< Half width of the 95 % interval [m]; NaN: unknown.
  DistanceStatistics statistics;           ///< Over all distances that are numbers.
  std::size_t significant = 0;             ///< |distance| above the level of detection.
};

/// Statistics of those `distance` that are numbers of magnitude at most `limit`.
inline DistanceStatistics distance_statistics(
    std::span<const double> distance, double limit = std::numeric_limits<double>::infinity()) {
  Moments m;
  for (const double d : distance)
    if (std::abs(d) <= limit) m.add(d);
  return {m.count(), m.mean(), m.population_deviation(), m.root_mean_square()};
}

/// Normals at `points` from the plane fitted (PCA) to the neighbours in `cloud` within half of
/// `scale`; zero where fewer than three points, or none of a definite plane, are near.
///
/// Turned to agree with the normal of the nearest point of `cloud` where the cloud has normals,
/// towards +z elsewhere. O(points × neighbours).
inline std::vector<Eigen::Vector3f> estimate_normals(std::span<const Point3> points,
                                                     const PointCloud& cloud, double scale,
                                                     int threads = 1) {
  require(scale > 0.0 && std::isfinite(scale), "normal scale: expected a positive length");
  const KdTree tree(cloud.points);
  const bool oriented = cloud.normals.size() == cloud.size();
  std::vector<Eigen::Vector3f> normals(points.size(), Eigen::Vector3f::Zero());
  parallel_for(
      points.size(), threads,
      [&](std::size_t i) {
        const Point3& p = points[i];
        PointMoments moments;
        Neighbor nearest{std::numeric_limits<double>::infinity(), 0};
        tree.for_each_within(p, 0.5 * scale, [&](const Neighbor& hit) {
          moments.add(cloud.points[static_cast<std::size_t>(hit.index)] - p);
          if (hit < nearest) nearest = hit;
        });
        if (moments.weight < 3.0) return;
        const PrincipalAxes axes(moments.covariance());
        if (!(axes.values[1] > 1e-9 * axes.values[2])) return;
        Eigen::Vector3d normal = axes.vectors.col(0);
        const Eigen::Vector3d side =
            oriented ? cloud.normals[static_cast<std::size_t>(nearest.index)].cast<double>().eval()
                     : Eigen::Vector3d::UnitZ();
        if (normal.dot(side) < 0.0) normal = -normal;
        normals[i] = normal.cast<float>();
      },
      64);
  return normals;
}

namespace detail {
/// Position and spread along the axis of the points inside one M3C2 cylinder.
struct CylinderStatistics {
  double position = 0.0, deviation = 0.0;
  std::size_t count = 0;
};

/// The points of `cloud` in the cylinder around the axis `origin + s axis`, |s| ≤ `half_length`,
/// for which `accept(index)` is true.
///
/// The cylinder is cut into slabs about as long as it is wide, each searched by the ball around it,
/// so a deep and slender cylinder does not pay for the ball around the whole.
template <typename Accept>
CylinderStatistics cylinder_statistics(const KdTree& tree, std::span<const Point3> cloud,
                                       const Point3& origin, const Eigen::Vector3d& axis,
                                       double radius, double half_length, bool median,
                                       std::vector<double>& scratch, Accept&& accept) {
  scratch.clear();
  const int slabs = static_cast<int>(std::clamp(std::ceil(half_length / radius), 1.0, 10000.0));
  const double slab = 2.0 * half_length / slabs;
  const double ball = std::hypot(radius, 0.5 * slab) * (1.0 + 1e-9);
  for (int k = 0; k < slabs; ++k) {
    const double middle = (k + 0.5) * slab - half_length;
    tree.for_each_within(origin + middle * axis, ball, [&](const Neighbor& hit) {
      const Eigen::Vector3d v = cloud[static_cast<std::size_t>(hit.index)] - origin;
      const double s = v.dot(axis);
      const double place = std::floor((s + half_length) / slab);
      const bool here = std::clamp(place, 0.0, slabs - 1.0) == k && std::abs(s) <= half_length;
      if (here && v.squaredNorm() - s * s <= radius * radius && accept(hit.index))
        scratch.push_back(s);
    });
  }
  CylinderStatistics result;
  result.count = scratch.size();
  if (scratch.empty()) return result;
  if (median) {
    std::sort(scratch.begin(), scratch.end());
    result.position = sorted_percentile(scratch, 0.5);
    // The interquartile range of a normal distribution is 1.349 standard deviations.
    result.deviation =
        (sorted_percentile(scratch, 0.75) - sorted_percentile(scratch, 0.25)) / 1.349;
  } else {
    const Moments m = moments(scratch);
    result.position = m.mean();
    result.deviation = m.sample_deviation();
  }
  return result;
}
}  // namespace detail

/// The distance from `reference` to `compared` at each core point.
///
/// A cylinder stands on the core point along its normal; the points of either cloud in it are
/// projected on its axis, and the distance is that of their means (or medians). The level of
/// detection is ±1.96 (√(σ₁²/n₁ + σ₂²/n₂) + reg). Normals are those of `core` if it has them and
/// otherwise estimated from `reference` at the normal scale.
///
/// Where the axes have a side (the core points or the reference have normals) and `sided` is set,
/// points whose normals are known count if they face it; where no point of the reference in a
/// cylinder does, all of them count there: a sheet has one normal and two sides, both of which are
/// where it is. Throws `Error` on scales that are
/// not positive. The same for any number of threads.
/// O(core × (log n + points in the cylinder)).
inline M3C2Result m3c2(const PointCloud& core, const PointCloud& reference,
                       const PointCloud& compared, const M3C2Options& options = {}) {
  const auto positive = [](double v) { return v > 0.0 && std::isfinite(v); };
  require(positive(options.projection_scale) && positive(options.max_depth),
          "M3C2: expected a positive projection scale and maximum depth");
  require(options.registration_error >= 0.0, "M3C2: expected a registration error of 0 or more");
  const bool given = core.normals.size() == core.size();
  const std::vector<Eigen::Vector3f> estimated =
      given ? std::vector<Eigen::Vector3f>{}
            : estimate_normals(core.points, reference, options.normal_scale, options.threads);
  const std::vector<Eigen::Vector3f>& normals = given ? core.normals : estimated;

  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  M3C2Result result;
  result.distance.assign(core.size(), kNone);
  result.level_of_detection.assign(core.size(), kNone);
  // One cloud after the other, so that there is never more than one tree: first the mean's place
  // in the compared cloud and its variance, then the same of the reference taken from it.
  const std::size_t fewest = std::max<std::size_t>(options.min_points, 2);
  const bool sided =
      options.sided &&
      (given || (reference.normals.size() == reference.size() && reference.size() > 0));
  // `take(i, cylinder)`; `cylinder(any)` has the statistics of what faces the axis, or of all.
  const auto measure = [&](const PointCloud& cloud, auto&& take) {
    const KdTree tree(cloud.points);
    const bool faces_known = sided && cloud.normals.size() == cloud.size();
    constexpr std::size_t kGrain = 256;
    parallel_for((core.size() + kGrain - 1) / kGrain, options.threads, [&](std::size_t chunk) {
      std::vector<double> scratch;
      for (std::size_t i = chunk * kGrain; i < std::min(core.size(), (chunk + 1) * kGrain); ++i) {
        const Eigen::Vector3d axis = normals[i].cast<double>().stableNormalized();
        if (!(axis.squaredNorm() > 0.5)) continue;
        const Eigen::Vector3f side = axis.cast<float>();
        take(i, [&](bool any) {
          return detail::cylinder_statistics(
              tree, cloud.points, core.points[i], axis, 0.5 * options.projection_scale,
              options.max_depth, options.median, scratch, [&](std::int32_t k) {
                return any || !faces_known ||
                       cloud.normals[static_cast<std::size_t>(k)].dot(side) > 0.0F;
              });
        });
      }
    });
  };
  const auto variance_of_mean = [&](const detail::CylinderStatistics& s) {
    return s.count < fewest ? kNone : s.deviation * s.deviation / static_cast<double>(s.count);
  };
  measure(compared, [&](std::size_t i, auto&& cylinder) {
    const detail::CylinderStatistics b = cylinder(false);
    if (b.count == 0) return;
    result.distance[i] = b.position;
    result.level_of_detection[i] = variance_of_mean(b);
  });
  measure(reference, [&](std::size_t i, auto&& cylinder) {
    if (std::isnan(result.distance[i])) return;
    detail::CylinderStatistics a = cylinder(false);
    if (a.count == 0) a = cylinder(true);
    result.distance[i] = a.count == 0 ? kNone : result.distance[i] - a.position;
    result.level_of_detection[i] =
        1.96 * (std::sqrt(variance_of_mean(a) + result.level_of_detection[i]) +
                options.registration_error);
  });
  result.statistics = distance_statistics(result.distance);
  for (std::size_t i = 0; i < core.size(); ++i)
    if (std::abs(result.distance[i]) > result.level_of_detection[i]) ++result.significant;
  return result;
}
}  // namespace surfleet
