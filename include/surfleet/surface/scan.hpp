// SPDX-License-Identifier: MIT
/// @file
/// @brief Scans, what makes meshes from them, and one cloud with normals out of many [004 §7.2.2].
///
///     const std::vector<Scan> scans{{points, sensor}};
///     const TriangleMesh mesh = ScanTriangulation{}(scans);  // or MovingLeastSquares<>{}(scans)
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/cloud_filters.hpp>
#include <surfleet/geometry/cloud_normals.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// Points in the world [m], and where the sensor stood that saw them, if that is known.
struct Scan {
  std::vector<Point3> points;
  std::optional<Point3> sensor = std::nullopt;
};

/// What makes a mesh from scans: a surface that may be open, triangles anticlockwise seen from
/// where the sensor stood. Empty where the points make no triangle; `Error` where they are not
/// usable.
template <typename R>
concept SurfaceReconstruction = requires(const R& reconstruct, std::span<const Scan> scans) {
  { reconstruct(scans) } -> std::same_as<TriangleMesh>;
};

struct OrientedCloudOptions {
  double spacing = 0.0;        ///< Least between points kept [m]; 0 keeps all.
  double outliers = 3.0;       ///< Points so many deviations lonelier than the mean go; 0: none.
  std::size_t neighbors = 30;  ///< That a normal comes from.
  std::uint64_t seed = 1;      ///< Of the choice among crowded points.
  int threads = 1;
};

/// All scans in one cloud, thinned, without outliers, with the normals of planes through neighbours
/// turned to the sensors; over a minimum spanning tree where a scan's sensor is not known. Throws
/// `Error` where a point is not finite. O(n log n).
inline PointCloud oriented_cloud(std::span<const Scan> scans,
                                 const OrientedCloudOptions& options = {}) {
  PointCloud all;
  std::vector<std::int32_t> from;
  bool seen = true;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    all.points.insert(all.points.end(), scans[s].points.begin(), scans[s].points.end());
    from.resize(all.points.size(), static_cast<std::int32_t>(s));
    seen = seen && scans[s].sensor.has_value();
  }
  detail::check_finite(all.points, "scans");
  const auto keep = [&](const std::vector<std::size_t>& kept) {
    all = selected(all, kept);
    std::vector<std::int32_t> part;
    for (const std::size_t i : kept) part.push_back(from[i]);
    from = std::move(part);
  };
  if (options.spacing > 0.0) keep(evenly_spaced(all.points, options.spacing, options.seed));
  if (options.outliers > 0.0)
    keep(inliers(all.points, {.deviations = options.outliers, .threads = options.threads}));
  all.normals = plane_normals(all.points, {options.neighbors, options.threads});
  if (!seen) {
    turn_consistently(all.points, 12, all.normals);
  } else {
    for (std::size_t i = 0; i < all.size(); ++i)
      turn_to_sensor(all.points[i], *scans[static_cast<std::size_t>(from[i])].sensor,
                     all.normals[i]);
  }
  return all;
}

/// Without the parts of a mesh that have fewer than `share` of the largest one's triangles: the
/// spurious sheets that outliers and abrupt changes of density leave [004 §7.3.1]. O(n α(n)).
inline TriangleMesh without_small_parts(const TriangleMesh& mesh, double share) {
  require(share >= 0.0 && share <= 1.0, "parts of a mesh: expected a share of 0 to 1");
  const MeshComponents parts = connected_components(mesh);
  std::vector<std::size_t> size(parts.count, 0);
  std::size_t most = 0;
  for (const std::int32_t p : parts.of_triangle)
    most = std::max(most, ++size[static_cast<std::size_t>(p)]);
  const double least = share * static_cast<double>(most);
  return selected(mesh, [&](std::size_t t) {
    return static_cast<double>(size[static_cast<std::size_t>(parts.of_triangle[t])]) >= least;
  });
}
}  // namespace surfleet
