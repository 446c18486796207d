// SPDX-License-Identifier: MIT
/// @file
/// @brief The shapes a robot may have when it is checked against the map [000 §2.5.3].
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// A ball in the world [m].
struct Sphere {
  Point3 center = Point3::Zero();
  double radius = 0.0;
};

/// What a collision check asks of a robot's body.
///
/// `inscribed_radius()` and `bounding_radius()` are the balls about the configuration's position
/// that lie within the body and hold it, whatever the heading; most checks end with one of them.
/// `touches(q, ball)` says whether the body at configuration `q` meets a ball; it may say yes too
/// early but never too late. Pure.
template <typename B>
concept CollisionBody = std::copyable<B> &&
    requires(const B& b, const Configuration& q, const Sphere& ball) {
  { b.inscribed_radius() } -> std::convertible_to<double>;
  { b.bounding_radius() } -> std::convertible_to<double>;
  { b.touches(q, ball) } -> std::convertible_to<bool>;
};

/// The safe space of an aerial robot.
struct SphereBody {
  double radius = 1.0;  ///< [m]
  double inscribed_radius() const { return radius; }
  double bounding_radius() const { return radius; }
  bool touches(const Configuration& q, const Sphere& ball) const {
    return (ball.center - q.position).squaredNorm() <
           (radius + ball.radius) * (radius + ball.radius);
  }
};

/// The safe space of a ground robot: an ellipsoid whose first axis lies along the heading.
struct EllipsoidBody {
  Eigen::Vector3d semi_axes{0.55, 0.25, 0.25};  ///< Forward, left, up; all positive [m].
  double inscribed_radius() const { return semi_axes.minCoeff(); }
  double bounding_radius() const { return semi_axes.maxCoeff(); }
  bool touches(const Configuration& q, const Sphere& ball) const {
    const Eigen::Vector3d p =
        Eigen::AngleAxisd(-q.yaw, Eigen::Vector3d::UnitZ()) * (ball.center - q.position);
    return distance_to(p) < ball.radius;
  }

 private:
  /// Distance of a point in the body's frame to the ellipsoid, 0 inside (Newton's method on the
  /// closest point's multiplier; the function is convex and falling, so it converges from below).
  double distance_to(const Eigen::Vector3d& p) const {
    const Eigen::Array3d a = semi_axes.array(), a2 = a * a, y = p.array().abs();
    if ((y / a).matrix().squaredNorm() <= 1.0) return 0.0;
    double t = 0.0;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Array3d s = a * y / (a2 + t);
      const double f = (s * s).sum() - 1.0;
      const double slope = -2.0 * (s * s / (a2 + t)).sum();
      const double next = t - f / slope;
      if (!(next > t * (1.0 + 1e-12) + 1e-15)) break;
      t = next;
    }
    const Eigen::Array3d closest = a2 * y / (a2 + t);
    return (y - closest).matrix().norm();
  }
};

static_assert(CollisionBody<SphereBody> && CollisionBody<EllipsoidBody>);
}  // namespace surfleet
