// SPDX-License-Identifier: MIT
/// @file
/// @brief Kinematic vehicles on a mesh: point, unicycle, bicycles [004 §3.5.1].
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/surface/surface_point.hpp>
#include <surfleet/surface/surface_walk.hpp>

namespace surfleet {
/// How a vehicle's reference point is to move.
struct Twist {
  double v = 0.0;  ///< Forward [m/s].
  double w = 0.0;  ///< To the left [rad/s].
};

/// A vehicle with a heading, asked to drive a twist: it takes as much of it as it can for `dt` [s],
/// changing its pose and whatever it keeps of its own. It returns what it drove.
template <typename V>
concept SurfaceVehicle = requires(V& vehicle, const SurfaceWalk& walk, SurfacePose& pose,
                                  const Twist& twist, double dt) {
  { vehicle.drive(walk, pose, twist, dt) } -> std::convertible_to<Twist>;
};

/// Moves a pose along the arc of a twist in chords of at most 5°. The pose stays at a border.
inline void drive_arc(const SurfaceWalk& walk, SurfacePose& pose, const Twist& twist, double dt) {
  const int pieces = 1 + static_cast<int>(std::abs(twist.w * dt) / radians(5.0));
  const double angle = twist.w * dt / pieces, half = 0.5 * angle;
  // The chord of the arc.
  const double chord =
      twist.v * dt / pieces * (std::abs(half) > 1e-9 ? std::sin(half) / half : 1.0);
  for (int k = 0; k < pieces; ++k) {
    pose = walk(pose.turned(half), {chord, 0.0}).pose;
    pose = pose.turned(half);
  }
}

/// Eq. 3.17: turns on the spot if it is asked to.
struct Unicycle {
  double max_speed = 0.13;  ///< [m/s]
  double max_turn = 4.0;    ///< [rad/s]
  Twist drive(const SurfaceWalk& walk, SurfacePose& pose, const Twist& twist, double dt) const {
    const Twist done{std::clamp(twist.v, -max_speed, max_speed),
                     std::clamp(twist.w, -max_turn, max_turn)};
    drive_arc(walk, pose, done, dt);
    return done;
  }
};

/// What the two bicycles have in common. The reference point is the rear wheel's.
struct BicycleOptions {
  double wheelbase = 0.125;             ///< L [m].
  double max_speed = 0.1;               ///< Of the driven wheel [m/s].
  double max_steering = radians(85.0);  ///< To either side [rad], less than 90°.
  double steering_rate = 3.0;           ///< [rad/s]
};
namespace detail {
/// Steers towards the angle that a twist asks for, eq. 3.20 with tan for its misprinted cot.
inline double steered(const BicycleOptions& o, double steering, const Twist& twist, double dt) {
  require(o.wheelbase > 0.0 && o.max_steering < 0.5 * kPi && o.max_steering > 0.0,
          "bicycle: expected a positive wheelbase and steering below 90 degrees");
  const double side = twist.v < 0.0 ? -1.0 : 1.0;  // backwards the wheel points the other way
  const double wanted = std::atan2(side * twist.w * o.wheelbase, std::abs(twist.v));
  const double aim = std::clamp(wanted, -o.max_steering, o.max_steering);
  return steering + std::clamp(aim - steering, -o.steering_rate * dt, o.steering_rate * dt);
}
}  // namespace detail

/// Eq. 3.18.
struct RearDriveBicycle {
  BicycleOptions options = {};
  double steering = 0.0;  ///< φ [rad].
  Twist drive(const SurfaceWalk& walk, SurfacePose& pose, const Twist& twist, double dt) {
    steering = detail::steered(options, steering, twist, dt);
    const double v = std::clamp(twist.v, -options.max_speed, options.max_speed);
    const Twist done{v, v * std::tan(steering) / options.wheelbase};
    drive_arc(walk, pose, done, dt);
    return done;
  }
};

/// Eq. 3.19: the front wheel has the speed, so that the rear one may stand while it turns.
struct FrontDriveBicycle {
  BicycleOptions options = {};
  double steering = 0.0;  ///< φ [rad].
  Twist drive(const SurfaceWalk& walk, SurfacePose& pose, const Twist& twist, double dt) {
    steering = detail::steered(options, steering, twist, dt);
    const double side = twist.v < 0.0 ? -1.0 : 1.0;
    const double asked = side * std::hypot(twist.v, twist.w * options.wheelbase);
    const double front = std::clamp(asked, -options.max_speed, options.max_speed);
    const Twist done{front * std::cos(steering), front * std::sin(steering) / options.wheelbase};
    drive_arc(walk, pose, done, dt);
    return done;
  }
};
static_assert(SurfaceVehicle<Unicycle> && SurfaceVehicle<RearDriveBicycle> &&
              SurfaceVehicle<FrontDriveBicycle>);

/// The twist that moves the point `ahead` [m] in front of a vehicle by (forward, left) = `u` [m/s]:
/// v = uₓ, ω = u_y / d [004 §7.2.4].
inline Twist linearized(const Eigen::Vector2d& u, double ahead) { return {u.x(), u.y() / ahead}; }
}  // namespace surfleet
