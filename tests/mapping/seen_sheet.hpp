// SPDX-License-Identifier: MIT
/// @file
/// @brief Depth images of simple bodies by closed forms, and a sheet seen from both sides.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>

namespace surfleet::test {
inline PinholeCamera sheet_camera() {
  return PinholeCamera::from_fov(radians(80.0), radians(60.0), 160, 110, 0.3, 8.0);
}
/// A camera at `eye` whose optical axis is `forward`, not vertical.
inline Pose facing(const Point3& eye, const Eigen::Vector3d& forward) {
  const Eigen::Vector3d z = forward.normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Pose T = Pose::Identity();
  T.linear().col(0) = x;
  T.linear().col(1) = z.cross(x);
  T.linear().col(2) = z;
  T.translation() = eye;
  return T;
}
/// `cast(origin, direction)` is the parameter at which a ray meets the body; without one the pixel
/// says that its ray is free to the range.
template <typename Cast>
DepthImage render(const PinholeCamera& camera, const Pose& T_world_camera, Cast&& cast) {
  DepthImage image(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const std::optional<double> t =
          cast(Point3(T_world_camera.translation()),
               Eigen::Vector3d(T_world_camera.linear() * camera.ray(u, v)));
      image(u, v) = static_cast<float>(t && *t < camera.max_range ? *t : 2.0 * camera.max_range);
    }
  return image;
}
/// The square |y|, |z| ≤ 1 in the plane x = `at`: a sheet without thickness.
inline auto sheet(double at) {
  return [at](const Point3& o, const Eigen::Vector3d& d) -> std::optional<double> {
    const double t = (at - o.x()) / d.x();
    const Point3 p = o + t * d;
    if (!(t > 0.0) || std::abs(p.y()) > 1.0 || std::abs(p.z()) > 1.0) return std::nullopt;
    return t;
  };
}
/// A vertical cylinder about the origin's axis.
inline auto post(double radius) {
  return [radius](const Point3& o, const Eigen::Vector3d& d) -> std::optional<double> {
    const double a = d.head<2>().squaredNorm(), b = o.head<2>().dot(d.head<2>());
    const double c = o.head<2>().squaredNorm() - radius * radius, q = b * b - a * c;
    if (q < 0.0 || b > 0.0) return std::nullopt;
    return (-b - std::sqrt(q)) / a;
  };
}
/// What a map holds after `body` was seen from `rounds` places on a circle about it.
template <typename Body>
TsdfMap seen_from_around(const Body& body, double distance, int rounds, double voxel_size,
                         TsdfOptions options = {}) {
  TsdfMap map({.voxel_size = voxel_size});
  options.truncation = 3.0 * voxel_size;
  TsdfIntegrator<DropOffWeight<>> integrate(options,
                                            {.full = voxel_size, .zero = 1.5 * voxel_size});
  for (int i = 0; i < rounds; ++i) {
    const double a = 2.0 * kPi * (i + 0.37) / rounds;
    const Point3 eye(distance * std::cos(a), distance * std::sin(a), 0.13);
    const Pose T = facing(eye, -eye);
    integrate(render(sheet_camera(), T, body), sheet_camera(), T, map);
  }
  return map;
}
}  // namespace surfleet::test
