// SPDX-License-Identifier: MIT
/// Poses at random and what a camera sees of a target there.
#pragma once

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/camera_models.hpp>
#include <surfleet/localization/marker_target.hpp>
#include <surfleet/localization/observation.hpp>

#include <cmath>
#include <vector>

namespace scenes {
using namespace surfleet;

/// 752 × 480, 90° wide: f 376 px, as printed [004 §9.5.1].
inline PinholeCamera printed_camera() {
  return PinholeCamera::from_fov(radians(90.0), 2.0 * std::atan(240.0 / 376.0), 752, 480, 0.1, 10);
}
inline Eigen::Matrix3d random_rotation(Random& random) {
  const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
  return q.normalized().toRotationMatrix();
}
/// A pose at which the camera sees all markers, at a distance in [near, far].
template <CameraModel Camera>
Pose random_view(const Camera& camera, const MarkerTarget& target, double near, double far,
                 Random& random) {
  for (;;) {
    Pose T = Pose::Identity();
    T.linear() = random_rotation(random);
    const Eigen::Vector2d px(random.uniform(0, camera.width - 1.0),
                             random.uniform(0, camera.height - 1.0));
    T.translation() = random.uniform(near, far) * bearing(camera, px);
    bool all = true;
    for (const Point3& m : target.markers) all = all && camera.project(T * m).has_value();
    if (all) return T;
  }
}
/// The markers' pixels, each off by `noise` [px].
template <CameraModel Camera>
std::vector<Eigen::Vector2d> see(const Camera& camera, const MarkerTarget& target, const Pose& T,
                                 double noise, Random& random) {
  std::vector<Eigen::Vector2d> pixels;
  for (const Point3& m : target.markers)
    pixels.push_back(*camera.project(T * m) +
                     noise * Eigen::Vector2d(random.normal(), random.normal()));
  return pixels;
}
inline double angle_between(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}
inline double distance_between(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}
}  // namespace scenes
