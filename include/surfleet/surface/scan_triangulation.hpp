// SPDX-License-Identifier: MIT
/// @file
/// @brief A scan's points joined as the sensor sees them: the irregular triangular mesh (ITM) of
/// [004 §7.2.2].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/delaunay.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/scan.hpp>

namespace surfleet {
/// The Delaunay triangulation of the directions (φ, θ) in which points were seen, with their ranges
/// put back. Azimuths go round: points near the cut stand on both of its sides, and are one again
/// in the mesh.
///
/// Keeps every point where it is, noise and all. Triangles that a sensor cannot have seen, because
/// they are long or nearly in line with the beam, are left out; so borders of what hides something
/// stay open. Several scans give a mesh each, in one soup that is not joined. Each scan needs its
/// sensor. Edges have two triangles at most. O(n log n).
struct ScanTriangulation {
  double longest_edge = 0.25;                 ///< Of a triangle kept [m].
  double greatest_incidence = radians(80.0);  ///< Of the beam on a triangle kept [rad].
  double min_range = 0.01;                    ///< Points nearer to the sensor go [m].

  TriangleMesh operator()(std::span<const Scan> scans) const {
    require(longest_edge > 0.0 && greatest_incidence > 0.0 && min_range >= 0.0,
            "scan triangulation: expected positive limits");
    TriangleMesh mesh;
    for (std::size_t s = 0; s < scans.size(); ++s) {
      require(scans[s].sensor.has_value() && scans[s].sensor->allFinite(),
              "scan triangulation: scan " + std::to_string(s) +
                  " has no place of its sensor; expected one for each scan");
      append(mesh, one(scans[s].points, *scans[s].sensor));
    }
    return mesh;
  }

 private:
  static constexpr double kSeam = 0.5;  // the band that stands on both sides of the cut [rad]
  /// Directions are told apart to 2⁻²⁶ rad, so that differences are exact and beams of a regular
  /// scanner are concyclic to the last bit.
  static double snapped(double angle) { return std::ldexp(std::round(std::ldexp(angle, 26)), -26); }

  TriangleMesh one(std::span<const Point3> points, const Point3& sensor) const {
    detail::check_finite(points, "scan triangulation");
    TriangleMesh whole;
    whole.vertices.assign(points.begin(), points.end());
    const double turn = snapped(2.0 * kPi), half = 0.5 * turn;
    std::vector<Point2> directions;
    std::vector<std::int32_t> point;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d d = points[i] - sensor;
      if (!(d.norm() > min_range)) continue;
      double azimuth = snapped(std::atan2(d.y(), d.x()));
      if (azimuth >= half) azimuth -= turn;
      const double elevation = snapped(std::atan2(d.z(), d.head<2>().norm()));
      const auto stand = [&](double at) {
        directions.emplace_back(at, elevation);
        point.push_back(static_cast<std::int32_t>(i));
      };
      stand(azimuth);
      if (azimuth < kSeam - half) stand(azimuth + turn);
      if (azimuth > half - kSeam) stand(azimuth - turn);
    }
    for (const Triangle& t : delaunay(directions)) {
      // Of the copies of a triangle, the one that begins within the turn.
      double first = half;
      for (const std::int32_t v : t)
        first = std::min(first, directions[static_cast<std::size_t>(v)].x());
      if (first < -half || first >= half) continue;
      const auto at = [&](std::size_t k) { return point[static_cast<std::size_t>(t[k])]; };
      if (at(0) == at(1) || at(1) == at(2) || at(2) == at(0)) continue;
      // Azimuth runs to the left as seen by the sensor, so what turns left here turns right there.
      whole.triangles.push_back({at(0), at(2), at(1)});
    }
    const double least_cosine = std::cos(greatest_incidence);
    return selected(whole, [&](std::size_t t) {
      for (std::size_t k = 0; k < 3; ++k)
        if ((whole.corner(t, k) - whole.corner(t, (k + 1) % 3)).norm() > longest_edge) return false;
      const Eigen::Vector3d n = whole.area_vector(t), beam = sensor - whole.centroid(t);
      return n.dot(beam) > least_cosine * n.norm() * beam.norm();
    });
  }
};
static_assert(SurfaceReconstruction<ScanTriangulation>);
}  // namespace surfleet
