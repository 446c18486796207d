// SPDX-License-Identifier: MIT
/// @file
/// @brief A mesh from the zero set of a signed distance by moving least squares, the method ECM of
/// [004 §7.2.2], kept to where points are.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/mapping/marching_cubes.hpp>
#include <surfleet/surface/scan.hpp>

namespace surfleet {
/// A weight of points: `k(t)` for the distance t in units of the support, 0 to 1.
template <typename K>
concept DistanceKernel = std::copyable<K> && requires(const K& k, double t) {
  { k(t) } -> std::convertible_to<double>;
};
/// The C² function of compact support of Wendland (1995): 0 with its slope at the support's end.
struct WendlandKernel {
  double operator()(double t) const {
    const double s = 1.0 - t;
    return s * s * s * s * (4.0 * t + 1.0);
  }
};
/// Cut off at three standard deviations.
struct GaussianKernel {
  double operator()(double t) const { return std::exp(-4.5 * t * t); }
};
static_assert(DistanceKernel<WendlandKernel> && DistanceKernel<GaussianKernel>);

struct MovingLeastSquaresOptions {
  double support = 0.12;             ///< Farthest points that count at a place [m].
  double voxel = 0.03;               ///< Side of the cubes marched [m].
  std::optional<double> reach = {};  ///< Of points over cubes' centres [m]; else 1.5 voxels.
  double least_part = 0.05;          ///< Parts with a lesser share of the largest go.
  OrientedCloudOptions cloud = {};   ///< How the scans are made one cloud; its spacing included.
  int threads = 1;                   ///< The mesh is the same for any number.
};

/// f(x) = Σ w(|x − pᵢ|) nᵢ · (x − pᵢ) / Σ w, and marching cubes over the cubes near points alone:
/// an opening as wide as a few cubes stays open, where a closed implicit surface would fill it.
///
/// Averages noise away over its support, and rounds what bends within it: on a cylinder of radius
/// R it lies off by about a tenth of support²/R. Sheets nearer than the support mix. Every edge has
/// two triangles at most. O(n log n + cubes · points in support).
template <DistanceKernel Kernel = WendlandKernel>
struct MovingLeastSquares {
  MovingLeastSquaresOptions options = {};
  [[no_unique_address]] Kernel kernel = {};

  TriangleMesh operator()(std::span<const Scan> scans) const {
    return (*this)(oriented_cloud(scans, options.cloud));
  }

  /// From points with unit normals.
  TriangleMesh operator()(const PointCloud& cloud) const {
    const double voxel = options.voxel, reach = options.reach.value_or(1.5 * voxel);
    require(options.support > 0.0 && voxel > 0.0 && reach > 0.0 && std::isfinite(options.support),
            "moving least squares: expected a support, voxels and a reach of more than 0 m");
    require(options.support >= voxel + reach,
            "moving least squares: expected a support of at least a voxel and the reach, so that "
            "every cube near a point has points about its corners");
    require(cloud.normals.size() == cloud.size(),
            "moving least squares: expected a normal for every point");
    detail::check_finite(cloud.points, "moving least squares");
    if (cloud.points.empty()) return {};
    Box3 box;
    for (const Point3& p : cloud.points) box.extend(p);
    const Point3 origin = box.min() - Point3::Constant(reach + 1.5 * voxel);
    require((box.max() - origin).maxCoeff() / voxel + 8.0 < static_cast<double>(kSide),
            "moving least squares: the voxels are too small for the cloud's size");

    // Cubes near points, by the number of their lowest corner.
    std::vector<std::uint64_t> cubes;
    const auto steps = static_cast<std::int64_t>(std::ceil(reach / voxel)) + 1;
    for (const Point3& p : cloud.points) {
      const Eigen::Vector3d at = (p - origin) / voxel;
      const Eigen::Matrix<std::int64_t, 3, 1> base = at.array().floor().cast<std::int64_t>();
      for (std::int64_t z = -steps; z <= steps; ++z)
        for (std::int64_t y = -steps; y <= steps; ++y)
          for (std::int64_t x = -steps; x <= steps; ++x) {
            const Eigen::Matrix<std::int64_t, 3, 1> c =
                base + Eigen::Matrix<std::int64_t, 3, 1>(x, y, z);
            if ((c.minCoeff() < 0) ||
                (c.template cast<double>() + Eigen::Vector3d::Constant(0.5) - at).norm() * voxel >
                    reach)
              continue;
            cubes.push_back(key(c.x(), c.y(), c.z()));
          }
      if (cubes.size() > 4 * distinct_) distinct(cubes);
    }
    distinct(cubes);

    std::vector<std::uint64_t> corners;
    for (const std::uint64_t c : cubes)
      for (std::uint64_t k = 0; k < 8; ++k)
        corners.push_back(c + (k & 1) + ((k >> 1 & 1) << kBits) + ((k >> 2) << (2 * kBits)));
    distinct(corners);
    const KdTree tree(cloud.points);
    const auto place = [&](std::uint64_t c) -> Point3 {
      const auto part = [&](int shift) { return static_cast<double>(c >> shift & (kSide - 1)); };
      return origin + voxel * Point3(part(0), part(kBits), part(2 * kBits));
    };
    std::vector<double> value(corners.size());
    parallel_for(
        corners.size(), options.threads,
        [&](std::size_t i) { value[i] = distance(cloud, tree, place(corners[i])); }, 256);

    TriangleMesh mesh;
    std::unordered_map<std::uint64_t, std::int32_t> crossing;  // by corner and axis
    const auto number = [&](std::uint64_t c) {
      return static_cast<std::size_t>(std::lower_bound(corners.begin(), corners.end(), c) -
                                      corners.begin());
    };
    for (const std::uint64_t c : cubes) {
      std::array<std::uint64_t, 8> corner;
      std::array<double, 8> f;
      unsigned solid = 0;
      bool known = true;
      for (std::uint64_t k = 0; k < 8; ++k) {
        corner[k] = c + (k & 1) + ((k >> 1 & 1) << kBits) + ((k >> 2) << (2 * kBits));
        f[k] = value[number(corner[k])];
        known = known && std::isfinite(f[k]);
        if (f[k] < 0.0) solid |= 1U << k;
      }
      if (!known || solid == 0 || solid == 255) continue;
      const CubeTriangles& pattern = cube_triangles()[solid];
      for (std::size_t n = 0; n < pattern.count; ++n) {
        Triangle t{};
        for (std::size_t k = 0; k < 3; ++k) {
          const CubeEdge e = cube_edge(pattern.triangles[n][k]);
          const auto made = crossing.try_emplace(4 * corner[e.lower] + e.axis,
                                                 static_cast<std::int32_t>(mesh.vertices.size()));
          if (made.second) {
            const double s = std::clamp(f[e.lower] / (f[e.lower] - f[e.upper]), 0.001, 0.999);
            mesh.vertices.push_back(place(corner[e.lower]) + s * voxel * Point3::Unit(e.axis));
          }
          t[k] = made.first->second;
        }
        mesh.triangles.push_back(t);
      }
    }
    return without_small_parts(mesh, options.least_part);
  }

  /// f at a place [m], positive on the side of the normals; NaN where fewer than three points
  /// count.
  double distance(const PointCloud& cloud, const KdTree& tree, const Point3& x) const {
    double sum = 0.0, weight = 0.0;
    int count = 0;
    tree.for_each_within(x, options.support, [&](const Neighbor& n) {
      const auto i = static_cast<std::size_t>(n.index);
      const double w = kernel(n.distance() / options.support);
      sum += w * cloud.normals[i].template cast<double>().dot(x - cloud.points[i]);
      weight += w;
      ++count;
    });
    return count >= 3 && weight > 0.0 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  static constexpr int kBits = 20;
  static constexpr std::uint64_t kSide = std::uint64_t{1} << kBits;
  static constexpr std::size_t distinct_ = 1U << 22;
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x) | static_cast<std::uint64_t>(y) << kBits |
           static_cast<std::uint64_t>(z) << (2 * kBits);
  }
  static void distinct(std::vector<std::uint64_t>& keys) {
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  }
};
static_assert(SurfaceReconstruction<MovingLeastSquares<>> &&
              SurfaceReconstruction<MovingLeastSquares<GaussianKernel>>);
}  // namespace surfleet
