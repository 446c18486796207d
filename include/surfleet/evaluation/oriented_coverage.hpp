// SPDX-License-Identifier: MIT
/// @file
/// @brief The one yardstick of coverage: how much of a true surface a reconstruction comes near, on
///        the side it could be seen from.
///
/// @code
/// const PointCloud samples = oriented_samples(truth.cloud, observable_surface(truth.cloud, …));
/// const OrientedCoverage c = oriented_coverage(samples, OrientedSurface(mesh), {.e_max = 0.26});
/// use(c.share());
/// @endcode
///
/// A sample is covered when some part of the reconstruction lies within e_max of it and faces the
/// sample's side: its outward normal is less than 90° from the sample's normal. So the far wall of
/// something thin does not count for the near one, and the two sides of a sheet, two samples, are
/// covered one by one. Where a sample or a whole cloud has no normal, any side will do.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// A reconstruction to be asked how near it is: a mesh, by its triangles and their outward normals
/// (anticlockwise from outside), or a cloud, by its points and their normals if it has any.
///
/// Holds copies. Build O(n log n); queries are const and safe from many threads.
class OrientedSurface {
 public:
  OrientedSurface() = default;
  explicit OrientedSurface(const TriangleMesh& mesh) : bvh_(mesh) {
    normals_.reserve(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      normals_.push_back(mesh.area_vector(t).stableNormalized().cast<float>());
  }
  explicit OrientedSurface(const PointCloud& cloud) : tree_(cloud.points) {
    if (cloud.normals.size() == cloud.size()) normals_ = cloud.normals;
  }

  /// To the nearest part, whatever its side [m]; infinite if there is none.
  double distance(const Point3& p) const {
    if (bvh_.triangle_count() > 0) return bvh_.distance(p);
    const auto nearest = tree_.nearest(p);
    return nearest ? nearest->distance() : kNone;
  }

  /// To the nearest part that faces `side` [m]; infinite if none within `reach` [m] does. A `side`
  /// of zero, or a cloud without normals: whatever its side.
  double distance(const Point3& p, const Eigen::Vector3f& side, double reach) const {
    const bool any = normals_.empty() || side.squaredNorm() == 0.0F;
    const auto faces = [&](std::int32_t i) {
      return any || normals_[static_cast<std::size_t>(i)].dot(side) > 0.0F;
    };
    if (bvh_.triangle_count() > 0) {
      const auto nearest = bvh_.closest_point_where(p, reach, faces);
      return nearest ? nearest->distance : kNone;
    }
    double best2 = kNone;
    tree_.for_each_within(p, reach, [&](const Neighbor& n) {
      if (n.distance2 < best2 && faces(n.index)) best2 = n.distance2;
    });
    return std::sqrt(best2);
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  Bvh bvh_;
  KdTree tree_;
  std::vector<Eigen::Vector3f> normals_;  ///< Of the triangles or points; empty: not known.
};

struct OrientedCoverageOptions {
  double e_max = 0.2598;  ///< A sample is covered by what faces its side this near [m].
  double reach = 0.0;     ///< Distances are told up to this [m]; at least up to e_max.
  int threads = 1;        ///< The result is the same for any number.
};

struct OrientedCoverage {
  /// From each sample to the nearest part that faces its side [m]; infinite beyond the reach.
  std::vector<double> distance;
  std::size_t covered = 0;  ///< Samples with a distance of e_max or less.
  double share() const {
    return distance.empty() ? 0.0
                            : static_cast<double>(covered) / static_cast<double>(distance.size());
  }
};

/// Which of `samples` are covered by `surface`; their normals are the sides they are seen from.
/// Throws `Error` on an e_max that is not positive. O(samples · log n) where e_max is small.
inline OrientedCoverage oriented_coverage(const PointCloud& samples, const OrientedSurface& surface,
                                          const OrientedCoverageOptions& options = {}) {
  require(options.e_max > 0.0 && std::isfinite(options.e_max),
          "e_max: expected a positive length in metres");
  const bool sided = samples.normals.size() == samples.size();
  const double reach = std::max(options.e_max, options.reach);
  OrientedCoverage result;
  result.distance.resize(samples.size());
  parallel_for(
      samples.size(), options.threads,
      [&](std::size_t i) {
        const Eigen::Vector3f side = sided ? samples.normals[i] : Eigen::Vector3f::Zero();
        result.distance[i] = surface.distance(samples.points[i], side, reach);
      },
      256);
  for (const double d : result.distance) result.covered += d <= options.e_max ? 1 : 0;
  return result;
}

/// Every sample twice, the second time with its normal turned round: for a sheet of which both
/// sides are to be covered. Throws `Error` on samples without normals.
inline PointCloud with_both_sides(const PointCloud& samples) {
  require(samples.normals.size() == samples.size(), "both sides: expected samples with normals");
  PointCloud both;
  both.points.reserve(2 * samples.size());
  both.normals.reserve(2 * samples.size());
  for (const float sign : {1.0F, -1.0F}) {
    both.points.insert(both.points.end(), samples.points.begin(), samples.points.end());
    for (const Eigen::Vector3f& n : samples.normals) both.normals.push_back(sign * n);
  }
  return both;
}
}  // namespace surfleet
