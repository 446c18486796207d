// SPDX-License-Identifier: MIT
/// @file
/// @brief What a camera or a LiDAR has in view of a point once its level body has turned towards
/// the point.
#pragma once

#include <algorithm>
#include <cmath>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/lidar_model.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>

namespace surfleet {
/// What a camera on a level body has in view once the body has turned so that the optical axis lies
/// in the vertical plane of the point (a camera that faces straight up or down: the body's x axis).
/// A LiDAR that stands upright in the body has all between its lowest and its highest beam in view,
/// gaps between beams not counted, with the body's x axis in that plane.
class BestHeadingView {
 public:
  BestHeadingView(const PinholeCamera& camera, const Pose& T_body_camera)
      : camera_(camera),
        offset_(T_body_camera.translation()),
        R_camera_body_(T_body_camera.linear().transpose()) {
    const Eigen::Vector3d axis = T_body_camera.linear().col(2);
    const double level = axis.head<2>().norm();
    if (level > 1e-6) heading_ = axis.head<2>() / level;
    // The point stands in the middle column unless the camera is rolled or pitched.
    const bool upright = level > 1e-6 && std::abs(T_body_camera.linear()(2, 0)) < 1e-9;
    for (const double u : {-0.5, camera.width - 0.5})
      for (const double v : {-0.5, camera.height - 0.5})
        reach_ = std::max(reach_, camera.ray(upright ? camera.cx : u, v).norm());
    reach_ = camera.max_range * reach_ + 2.0 * offset_.norm();
  }

  BestHeadingView(const LidarModel& lidar, const Point3& place)
      : offset_(place),
        R_camera_body_(Eigen::Matrix3d::Identity()),
        lidar_(true),
        sin_lowest_(std::sin(lidar.lowest)),
        sin_highest_(std::sin(lidar.highest)) {
    camera_.min_range = lidar.min_range;
    camera_.max_range = lidar.max_range;
    reach_ = lidar.max_range + 2.0 * offset_.norm();
  }

  /// No point farther than this from the body is in view [m].
  double reach() const { return reach_; }

  /// Whether `sample` is in range and in the image from `position`; occlusion is not tested.
  bool sees(const Point3& position, const Point3& sample) const {
    const Eigen::Vector3d to_sample = sample - position;
    const double level = to_sample.head<2>().norm();
    const Eigen::Vector3d in_body(level * heading_.x(), level * heading_.y(), to_sample.z());
    const Point3 p_camera = R_camera_body_ * (in_body - offset_);
    if (lidar_) {
      const double r = p_camera.norm();
      return r >= camera_.min_range && r <= camera_.max_range && p_camera.z() >= sin_lowest_ * r &&
             p_camera.z() <= sin_highest_ * r;
    }
    return p_camera.z() >= camera_.min_range && p_camera.z() <= camera_.max_range &&
           camera_.project(p_camera).has_value();
  }
  /// Where the camera or LiDAR is then.
  Point3 eye(const Point3& position, const Point3& sample) const {
    const Eigen::Vector2d to_sample = (sample - position).head<2>();
    const double level = to_sample.norm();
    if (level < 1e-12) return position + offset_;
    const Eigen::Vector2d d = to_sample / level;
    // Turning the heading onto the direction of the point.
    const double c = heading_.dot(d), s = heading_.x() * d.y() - heading_.y() * d.x();
    return position + Point3(c * offset_.x() - s * offset_.y(), s * offset_.x() + c * offset_.y(),
                             offset_.z());
  }

 private:
  PinholeCamera camera_;
  Eigen::Vector3d offset_;
  Eigen::Matrix3d R_camera_body_;
  Eigen::Vector2d heading_ = Eigen::Vector2d::UnitX();
  double reach_ = 0.0;
  bool lidar_ = false;  // of the camera nothing but the range counts then
  double sin_lowest_ = 0.0, sin_highest_ = 0.0;
};
}  // namespace surfleet
