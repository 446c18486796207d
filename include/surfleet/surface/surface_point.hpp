// SPDX-License-Identifier: MIT
/// @file
/// @brief A place on a triangle mesh, and a robot's pose there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// A point of a mesh: a triangle and weights of its corners, none below 0, that sum to 1.
struct SurfacePoint {
  std::int32_t triangle = -1;
  Eigen::Vector3d weights = Eigen::Vector3d::Constant(1.0 / 3.0);

  Point3 position(const TriangleMesh& mesh) const {
    const auto t = static_cast<std::size_t>(triangle);
    return weights[0] * mesh.corner(t, 0) + weights[1] * mesh.corner(t, 1) +
           weights[2] * mesh.corner(t, 2);
  }
};

/// The point of triangle `t` nearest to `p` by its plane, pushed into the triangle where it falls
/// outside: exact for points of the triangle.
inline SurfacePoint surface_point(const TriangleMesh& mesh, std::int32_t t, const Point3& p) {
  const auto i = static_cast<std::size_t>(t);
  const Eigen::Vector3d n = mesh.area_vector(i);
  const double whole = n.squaredNorm();
  SurfacePoint at{t, Eigen::Vector3d::Constant(1.0 / 3.0)};
  if (!(whole > 0.0)) return at;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d side = mesh.corner(i, (k + 2) % 3) - mesh.corner(i, (k + 1) % 3);
    at.weights[static_cast<Eigen::Index>(k)] =
        std::max(0.0, side.cross(p - mesh.corner(i, (k + 1) % 3)).dot(n) / whole);
  }
  at.weights /= at.weights.sum();
  return at;
}

/// The surface point nearest to `p` within `max_distance` [m]; nothing if there is none.
inline std::optional<SurfacePoint> nearest_surface_point(
    const TriangleMesh& mesh, const Bvh& bvh, const Point3& p,
    double max_distance = std::numeric_limits<double>::infinity()) {
  const auto hit = bvh.closest_point(p, max_distance);
  if (!hit) return std::nullopt;
  return surface_point(mesh, hit->triangle, hit->point);
}

/// Where a robot stands on a mesh and how it is turned.
struct SurfacePose {
  SurfacePoint at;
  Eigen::Vector3d forward = Eigen::Vector3d::UnitX();  ///< Unit length, in the triangle's plane.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< The triangle's normal on the robot's side.

  Eigen::Vector3d left() const { return up.cross(forward); }
  /// x forward, y left, z up.
  Pose T_world_body(const TriangleMesh& mesh) const {
    Pose T = Pose::Identity();
    T.linear() << forward, left(), up;
    T.translation() = at.position(mesh);
    return T;
  }
  /// Turned by `angle` [rad] to the left.
  SurfacePose turned(double angle) const {
    SurfacePose pose = *this;
    pose.forward = (std::cos(angle) * forward + std::sin(angle) * left()).normalized();
    return pose;
  }
};

/// A pose at `at` on the outer side, its heading the part of `heading` along the surface; any
/// where nothing is left of it.
inline SurfacePose surface_pose(const TriangleMesh& mesh, const SurfacePoint& at,
                                const Eigen::Vector3d& heading) {
  SurfacePose pose;
  pose.at = at;
  pose.up = mesh.area_vector(static_cast<std::size_t>(at.triangle)).normalized();
  const Eigen::Vector3d along = heading - heading.dot(pose.up) * pose.up;
  pose.forward = along.norm() > 1e-9 * heading.norm() && heading.norm() > 0.0
                     ? Eigen::Vector3d(along.normalized())
                     : Eigen::Vector3d(pose.up.unitOrthogonal());
  return pose;
}
}  // namespace surfleet
