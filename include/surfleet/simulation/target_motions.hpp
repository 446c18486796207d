// SPDX-License-Identifier: MIT
/// @file
/// @brief How a camera moves about a target: by hand, on a drone, and as a robot sweeps the ground
/// below it [004 §9.5].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// `T_world_camera` of a camera at `eye` whose optical axis passes through `at`, turned about it by
/// `roll` [rad].
inline Pose look_at(const Point3& eye, const Point3& at, double roll = 0.0) {
  const Eigen::Vector3d z = (at - eye).normalized();
  Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ());
  if (x.squaredNorm() < 1e-12) x = Eigen::Vector3d::UnitX();
  x.normalize();
  Pose T;
  T.setIdentity();
  T.linear().col(0) = x;
  T.linear().col(1) = z.cross(x);
  T.linear().col(2) = z;
  T.linear() = T.linear() * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = eye;
  return T;
}

struct CameraMotionOptions {
  double nearest = 0.68, farthest = 1.74;  ///< From the target's middle [m].
  double tilt = radians(40.0);             ///< Off the vertical, at most [rad].
  double period = 9.0;                     ///< Of the slowest part of the motion [s].
  double aim = 0.10;               ///< The optical axis passes the middle by up to this [m].
  Point3 middle{0.0, 0.0, 0.135};  ///< Of the markers [m].
};
/// As printed: held by hand, and on a quadrotor up to 3 m above ground.
inline CameraMotionOptions handheld_motion() { return {}; }
inline CameraMotionOptions flight_motion() {
  return {.nearest = 0.90, .farthest = 3.02, .tilt = radians(30.0), .period = 14.0, .aim = 0.15};
}

/// A smooth motion above a target that stands on the ground. A pure function of time and seed.
class CameraMotion {
 public:
  explicit CameraMotion(CameraMotionOptions options = {}, std::uint64_t seed = 1)
      : options_(options) {
    Random random(seed);
    for (double& p : phase_) p = random.uniform(0.0, 2.0 * kPi);
    for (double& f : rate_) f = 2.0 * kPi / options_.period * random.uniform(0.8, 1.6);
  }

  /// `T_camera_target` at time t [s].
  Pose operator()(double t) const {
    const auto wave = [&](std::size_t k) { return std::sin(rate_[k] * t + phase_[k]); };
    const double distance = 0.5 * (options_.nearest + options_.farthest) +
                            0.5 * (options_.farthest - options_.nearest) * wave(0);
    const double tilt = options_.tilt * wave(1), around = rate_[2] * t + phase_[2];
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    // Turned about the vertical, tilted about an axis of the ground, then straight down: so
    // that passing over the top is smooth.
    const Eigen::Vector3d axis(-std::sin(around), std::cos(around), 0.0);
    const Eigen::Matrix3d lean =
        (Eigen::AngleAxisd(tilt, axis) * Eigen::AngleAxisd(kPi * wave(5), up)).toRotationMatrix();
    Pose T_target_camera = Pose::Identity();
    T_target_camera.linear().col(0) = lean.col(0);
    T_target_camera.linear().col(1) = -lean.col(1);
    T_target_camera.linear().col(2) = -lean.col(2);
    const Eigen::Vector3d aside =
        options_.aim * std::min(1.0, distance) * (wave(3) * lean.col(0) + wave(4) * lean.col(1));
    T_target_camera.translation() =
        options_.middle + std::sqrt(distance * distance - aside.squaredNorm()) * lean.col(2) +
        aside;
    return T_target_camera.inverse();
  }

 private:
  CameraMotionOptions options_;
  std::array<double, 6> phase_{}, rate_{};
};

/// Back and forth over a rectangle, lane by lane, and home again: where a robot is after `distance`
/// [m].
inline Point2 sweep_place(double width, double height, int lanes, double distance) {
  const double step = lanes > 1 ? height / (lanes - 1) : 0.0;
  const double length = lanes * width + (lanes - 1) * step;
  distance = std::fmod(distance, 2.0 * length);
  if (distance > length) distance = 2.0 * length - distance;
  for (int lane = 0; lane < lanes; ++lane) {
    const bool forth = lane % 2 == 0;
    if (distance <= width)
      return {(forth ? distance : width - distance) - 0.5 * width, lane * step - 0.5 * height};
    distance -= width;
    if (distance <= step)
      return {(forth ? 0.5 : -0.5) * width, lane * step + distance - 0.5 * height};
    distance -= step;
  }
  return {lanes % 2 == 1 ? 0.5 * width : -0.5 * width, 0.5 * height};
}
}  // namespace surfleet
