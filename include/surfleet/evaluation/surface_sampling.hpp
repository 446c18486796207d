// SPDX-License-Identifier: MIT
/// @file
/// @brief Points spread evenly by area over a mesh.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
struct SurfaceSamplingOptions {
  double density = 25.0;  ///< Points per square metre.
  std::uint64_t seed = 1;
  std::size_t max_points = 100'000'000;  ///< More than this is refused.
};

/// Samples of a surface; each stands for `area_per_sample`.
struct SurfaceSamples {
  PointCloud cloud;                     ///< With the normals of the triangles.
  std::vector<std::int32_t> triangles;  ///< The triangle of each point.
  double area_per_sample = 0.0;         ///< [m²]

  std::size_t size() const { return cloud.size(); }
};

/// The samples for which `keep` is not zero; `keep` has one entry a sample.
inline SurfaceSamples select(const SurfaceSamples& samples, const std::vector<std::uint8_t>& keep) {
  require(keep.size() == samples.size(), "selection: expected one entry a sample");
  SurfaceSamples kept;
  kept.area_per_sample = samples.area_per_sample;
  const auto count =
      keep.size() - static_cast<std::size_t>(std::count(keep.begin(), keep.end(), 0));
  kept.cloud.points.reserve(count);
  kept.cloud.normals.reserve(count);
  kept.triangles.reserve(count);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (keep[i] == 0) continue;
    kept.cloud.points.push_back(samples.cloud.points[i]);
    kept.cloud.normals.push_back(samples.cloud.normals[i]);
    kept.triangles.push_back(samples.triangles[i]);
  }
  return kept;
}

/// Samples `mesh` uniformly by area, the same for the same seed.
///
/// The triangles' areas are laid end to end and cut into equal strata with one jittered sample in
/// each, so a part of area A gets its share to within one or two points. Within a triangle the
/// samples follow a low-discrepancy sequence (R2, Roberts 2018) from a random start. Triangles
/// without area get none; a mesh without area gives no samples. Throws `Error` on a density that
/// is not positive or asks for too many points. O(triangles + samples).
inline SurfaceSamples sample_surface(const TriangleMesh& mesh,
                                     const SurfaceSamplingOptions& options = {}) {
  require(options.density > 0.0 && std::isfinite(options.density),
          "sampling density: expected a positive number of points per square metre");
  SurfaceSamples samples;
  const double area = mesh.area();
  if (!(area > 0.0)) return samples;
  const double wanted = std::max(1.0, std::round(area * options.density));
  if (!(wanted <= static_cast<double>(options.max_points)))
    throw Error("sampling density " + std::to_string(options.density) + " per m² gives " +
                std::to_string(wanted) + " points; expected at most " +
                std::to_string(options.max_points));
  const auto count = static_cast<std::size_t>(wanted);
  samples.area_per_sample = area / wanted;
  samples.cloud.points.reserve(count);
  samples.cloud.normals.reserve(count);
  samples.triangles.reserve(count);

  Random random(mix64(options.seed) ^ 0x5a3dULL);
  double done = 0.0;  // area of the triangles before this one, in strata
  std::size_t stratum = 0;
  double next = random.uniform();
  for (std::size_t t = 0; t < mesh.triangles.size() && stratum < count; ++t) {
    const Eigen::Vector3d doubled = mesh.area_vector(t);
    const double strata = 0.5 * doubled.norm() / samples.area_per_sample;
    if (!(strata > 0.0)) continue;
    done += strata;
    if (next >= done) continue;
    const Point3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const Eigen::Vector3f normal = doubled.normalized().cast<float>();
    double u = random.uniform(), v = random.uniform();
    for (; next < done && stratum < count; next = static_cast<double>(stratum) + random.uniform()) {
      // The square folded along its diagonal covers the triangle evenly.
      const bool fold = u + v > 1.0;
      samples.cloud.points.push_back(a + (fold ? 1.0 - u : u) * (b - a) +
                                     (fold ? 1.0 - v : v) * (c - a));
      samples.cloud.normals.push_back(normal);
      samples.triangles.push_back(static_cast<std::int32_t>(t));
      u += 0.7548776662466927;
      v += 0.5698402909980532;
      u -= std::floor(u);
      v -= std::floor(v);
      ++stratum;
    }
  }
  return samples;
}
}  // namespace surfleet
