// SPDX-License-Identifier: MIT
/// @file
/// @brief A long wall with buttresses on flat ground, and a camera that flies along it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <surfleet/mapping/tsdf_integrator.hpp>

namespace survey {
using namespace surfleet;

/// The seeds' camera: 90° × 60°, 1.6 to 8 m [000 Table 3.1].
inline PinholeCamera camera() {
  return PinholeCamera::from_fov(radians(90), radians(60), 320, 240, 1.6, 8.0);
}

/// Along the ray, to the ground z = 0, the wall y = 0 or a buttress: 1 m wide, 1.5 m deep, 8 m
/// high, one every 5 m.
inline double cast(const Point3& o, const Eigen::Vector3d& d) {
  double t = std::numeric_limits<double>::infinity();
  if (d.z() < 0.0) t = std::min(t, -o.z() / d.z());
  if (d.y() > 0.0) t = std::min(t, -o.y() / d.y());
  const double first = std::floor((o.x() - 15.0) / 5.0) * 5.0;
  for (int k = 0; k < 7; ++k) {
    const Point3 low(first + 5.0 * k, -1.5, 0.0), high(low.x() + 1.0, 0.0, 8.0);
    const Eigen::Vector3d a = (low - o).cwiseQuotient(d), b = (high - o).cwiseQuotient(d);
    const double enter = a.cwiseMin(b).maxCoeff(), leave = a.cwiseMax(b).minCoeff();
    if (enter > 0.0 && enter < leave) t = std::min(t, enter);
  }
  return t;
}

/// The pose of step `i`, half a metre further along the wall than the last one.
inline Configuration step(int i) {
  return {Point3(0.5 * i, -5.5, 4.0 + std::sin(0.1 * i)), kPi / 2 + 0.4 * std::sin(0.7 * i)};
}

inline DepthImage image_at(const PinholeCamera& c, const Pose& T_world_camera) {
  DepthImage image(c.width, c.height);
  for (int v = 0; v < c.height; ++v)
    for (int u = 0; u < c.width; ++u) {
      const double t = cast(T_world_camera.translation(), T_world_camera.linear() * c.ray(u, v));
      image(u, v) = static_cast<float>(std::min(t, 1000.0));
    }
  return image;
}

/// Flies the steps [from, to) and folds every image into the map.
class Survey {
 public:
  explicit Survey(double voxel_size)
      : map({.voxel_size = voxel_size}), integrate({.truncation = 3.0 * voxel_size}) {}

  void fly(int count) {
    for (int i = 0; i < count; ++i, ++next) {
      const Pose T_world_camera = step(next).pose() * forward_camera_mount();
      const DepthImage image = image_at(camera(), T_world_camera);
      integrate(image, camera(), T_world_camera, map);
    }
  }

  TsdfMap map;
  TsdfIntegrator<> integrate;
  int next = 0;
};
}  // namespace survey
