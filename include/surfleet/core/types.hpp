// SPDX-License-Identifier: MIT
/// @file
/// @brief The handful of names every room shares: points, boxes, poses and angles.
///
/// World frame: right-handed, z up, metres, radians, seconds. Camera frame: x right, y down,
/// z forward. A pose `T_target_source` takes points from source to target:
/// `p_target = T_target_source * p_source`.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace surfleet {
using Point2 = Eigen::Vector2d;
using Point3 = Eigen::Vector3d;
using Box2 = Eigen::AlignedBox2d;
using Box3 = Eigen::AlignedBox3d;
using Pose = Eigen::Isometry3d;

constexpr double kPi = std::numbers::pi;

constexpr double degrees(double rad) { return rad * 180.0 / kPi; }
constexpr double radians(double deg) { return deg * kPi / 180.0; }

/// The angle equal to `a` modulo 2π, in (−π, π].
inline double wrap_angle(double a) {
  a = std::remainder(a, 2.0 * kPi);
  return a <= -kPi ? a + 2.0 * kPi : a;
}

/// A configuration of a robot with four degrees of freedom: a position and a heading.
struct Configuration {
  Point3 position = Point3::Zero();  ///< World frame [m].
  double yaw = 0.0;                  ///< About +z from +x [rad].
  double pitch = 0.0;  ///< By which a gimbal tilts the camera down, beyond its mount [rad].

  bool operator==(const Configuration& o) const {
    return position == o.position && yaw == o.yaw && pitch == o.pitch;
  }

  /// The body's pose: x forward along the heading, z up. The gimbal does not move it.
  Pose pose() const {
    Pose T_world_body = Pose::Identity();
    T_world_body.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    T_world_body.translation() = position;
    return T_world_body;
  }
};

/// Straight-line distance between points or configurations [m].
struct EuclideanDistance {
  double operator()(const Point2& a, const Point2& b) const { return (a - b).norm(); }
  double operator()(const Point3& a, const Point3& b) const { return (a - b).norm(); }
  double operator()(const Configuration& a, const Configuration& b) const {
    return (a.position - b.position).norm();
  }
};

/// `T_body_camera` of a camera whose optical axis is the body's x axis, tilted down by `pitch`
/// [rad].
inline Pose forward_camera_mount(double pitch = 0.0, const Point3& offset = Point3::Zero()) {
  Eigen::Matrix3d optical;  // columns: camera x (right), y (down), z (forward) in the body frame
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()).toRotationMatrix() * optical;
  T.translation() = offset;
  return T;
}
/// `T_body_camera` of a mounted camera that a gimbal has tilted down by `pitch` [rad], about the
/// body's y axis and its own centre.
inline Pose tilted_mount(const Pose& T_body_camera, double pitch) {
  if (pitch == 0.0) return T_body_camera;
  Pose T = T_body_camera;
  T.linear() = Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()).toRotationMatrix() * T.linear();
  return T;
}
/// `T_world_camera`: body, gimbal and mount.
inline Pose camera_pose(const Configuration& q, const Pose& T_body_camera) {
  return q.pose() * tilted_mount(T_body_camera, q.pitch);
}
}  // namespace surfleet
