// SPDX-License-Identifier: MIT
/// @file
/// @brief Tracking a path on a surface in the plane: unwrapped waypoints, a B-spline through them
/// for a virtual reference to run on, and nonlinear feedback of the error [004 §8.2.4].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/predicates.hpp>
#include <surfleet/surface/surface_vehicles.hpp>

namespace surfleet {
/// A waypoint and the surface's normal there.
struct OrientedPoint {
  Point3 position = Point3::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};
/// A pose in the control plane.
struct PlanarPose {
  Point2 position = Point2::Zero();
  double heading = 0.0;  ///< [rad]
};

/// A path laid into the plane by eq. 8.5: every step keeps its length, and turns as its projection
/// on the tangent plane of the mean normal does; to the left is positive.
class UnwrappedPath {
 public:
  /// Points that repeat the one before are left out. Throws `Error` where fewer than two are left.
  explicit UnwrappedPath(std::span<const OrientedPoint> path) {
    for (const OrientedPoint& p : path)
      if (waypoints_.empty() || (p.position - waypoints_.back().position).norm() > 1e-12)
        waypoints_.push_back(p);
    require(waypoints_.size() >= 2, "unwrapped path: expected two points or more that differ");
    flat_.push_back(Point2::Zero());
    double heading = 0.0;
    for (std::size_t i = 0; i + 1 < waypoints_.size(); ++i) {
      const Eigen::Vector3d m = waypoints_[i + 1].position - waypoints_[i].position;
      if (i > 0) {
        const Eigen::Vector3d h = waypoints_[i].position - waypoints_[i - 1].position;
        heading += turn(h, m, waypoints_[i].normal);
      }
      heading_.push_back(heading);
      flat_.push_back(flat_.back() + m.norm() * Point2(std::cos(heading), std::sin(heading)));
    }
  }
  const std::vector<Point2>& points() const { return flat_; }
  const std::vector<OrientedPoint>& waypoints() const { return waypoints_; }

  /// The angle from `h` to `m` about `normal`, both seen along it [rad].
  static double turn(const Eigen::Vector3d& h, const Eigen::Vector3d& m,
                     const Eigen::Vector3d& normal) {
    const Eigen::Vector3d a = h - h.dot(normal) * normal, b = m - m.dot(normal) * normal;
    return std::atan2(a.cross(b).dot(normal), a.dot(b));
  }

  /// Distance to the path near piece `hint`, which becomes the nearest one [m].
  double distance(const Point3& position, std::size_t& hint) const {
    constexpr std::size_t kAhead = 30, kBehind = 5;
    const std::size_t first = hint > kBehind ? hint - kBehind : 0, end = hint + kAhead;
    double best = 1e300;
    for (std::size_t i = first; i + 1 < waypoints_.size() && i < end; ++i) {
      const Eigen::Vector3d m = waypoints_[i + 1].position - waypoints_[i].position;
      const double s =
          std::clamp((position - waypoints_[i].position).dot(m) / m.squaredNorm(), 0.0, 1.0);
      const double d = (waypoints_[i].position + s * m - position).squaredNorm();
      if (d < best - 1e-15) {
        best = d;
        hint = i;
      }
    }
    return std::sqrt(best);
  }

  /// A pose on the surface as the control plane has it, by the nearest piece of the path from
  /// `hint` on, which moves along: position and heading relative to that piece.
  PlanarPose pose(const Point3& position, const Eigen::Vector3d& forward, std::size_t& hint) const {
    distance(position, hint);
    const std::size_t i = hint;
    const Eigen::Vector3d m = (waypoints_[i + 1].position - waypoints_[i].position).normalized();
    Eigen::Vector3d n = waypoints_[i].normal + waypoints_[i + 1].normal;
    n = (n - n.dot(m) * m).normalized();
    const Eigen::Vector3d left = n.cross(m), off = position - waypoints_[i].position;
    const Point2 along(std::cos(heading_[i]), std::sin(heading_[i]));
    return {flat_[i] + off.dot(m) * along + off.dot(left) * Point2(-along.y(), along.x()),
            heading_[i] + std::atan2(forward.dot(left), forward.dot(m))};
  }

 private:
  std::vector<OrientedPoint> waypoints_;
  std::vector<Point2> flat_;
  std::vector<double> heading_;
};

/// A cubic B-spline with a polyline's points, taken at equal spacing, as its control points, run at
/// constant speed. It begins and ends where the polyline does.
class SplineReference {
 public:
  /// Throws `Error` for fewer than two points or a spacing that is not positive.
  SplineReference(std::span<const Point2> polyline, double spacing) {
    require(polyline.size() >= 2 && spacing > 0.0,
            "spline: expected two points or more and a positive spacing");
    std::vector<double> at{0.0};
    for (std::size_t i = 1; i < polyline.size(); ++i)
      at.push_back(at.back() + (polyline[i] - polyline[i - 1]).norm());
    const auto pieces =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(at.back() / spacing)));
    std::size_t i = 0;
    std::vector<Point2> control;
    for (std::size_t k = 0; k <= pieces; ++k) {
      const double s = at.back() * static_cast<double>(k) / static_cast<double>(pieces);
      while (i + 2 < at.size() && at[i + 1] < s) ++i;
      const double share = at[i + 1] > at[i] ? (s - at[i]) / (at[i + 1] - at[i]) : 0.0;
      control.push_back(polyline[i] +
                        std::clamp(share, 0.0, 1.0) * (polyline[i + 1] - polyline[i]));
    }
    // A point mirrored beyond either end takes the spline through that end.
    control_.push_back(2.0 * control[0] - control[1]);
    control_.insert(control_.end(), control.begin(), control.end());
    control_.push_back(2.0 * control[pieces] - control[pieces - 1]);
    constexpr int kSamples = 8;
    for (std::size_t k = 0; k < pieces * kSamples; ++k) {
      const double u = static_cast<double>(k) / kSamples;
      if (k == 0) length_.push_back(0.0);
      length_.push_back(length_.back() + (position(u + 1.0 / kSamples) - position(u)).norm());
    }
    samples_ = kSamples;
  }
  double length() const { return length_.back(); }
  struct State {
    PlanarPose pose;
    double curvature = 0.0;  ///< To the left [1/m].
  };
  /// The state after `s` [m].
  State operator()(double s) const {
    s = std::clamp(s, 0.0, length());
    const auto above = std::upper_bound(length_.begin(), length_.end() - 1, s);
    const auto k = static_cast<std::size_t>(above - length_.begin()) - 1;
    const double step = length_[k + 1] - length_[k];
    const double u =
        (static_cast<double>(k) + (step > 0.0 ? (s - length_[k]) / step : 0.0)) / samples_;
    const Point2 d = derivative(u), dd = second(u);
    State state;
    state.pose = {position(u), std::atan2(d.y(), d.x())};
    const double speed = d.norm();
    if (speed > 0.0) state.curvature = cross2(d, dd) / (speed * speed * speed);
    return state;
  }

 private:
  struct Piece {
    std::array<Point2, 4> p;
    double t;
  };
  Piece piece(double u) const {
    const double last = static_cast<double>(control_.size()) - 4.0;
    const auto k = static_cast<std::size_t>(std::clamp(std::floor(u), 0.0, last));
    return {{control_[k], control_[k + 1], control_[k + 2], control_[k + 3]},
            u - static_cast<double>(k)};
  }
  Point2 position(double u) const {
    const auto [p, t] = piece(u);
    const double r = 1.0 - t;
    return (r * r * r * p[0] + (3 * t * t * t - 6 * t * t + 4) * p[1] +
            (3 * r * r * r - 6 * r * r + 4) * p[2] + t * t * t * p[3]) /
           6.0;
  }
  Point2 derivative(double u) const {
    const auto [p, t] = piece(u);
    const double r = 1.0 - t;
    return 0.5 * (r * r * (p[1] - p[0]) + (1 + 2 * t * r) * (p[2] - p[1]) + t * t * (p[3] - p[2]));
  }
  Point2 second(double u) const {
    const auto [p, t] = piece(u);
    return (1.0 - t) * (p[2] - 2.0 * p[1] + p[0]) + t * (p[3] - 2.0 * p[2] + p[1]);
  }
  std::vector<Point2> control_;
  std::vector<double> length_;
  double samples_ = 8.0;
};

/// Eq. 8.6, after Samson and Ait-Abderrahim (1991). All gains positive but k6, k4² < k5.
///
/// Small errors sideways obey ÿ + (k3/k2) ẏ + (k1/k2) v² y = 0: at the defaults and 10 cm/s they
/// die away, critically damped, over 10 cm of path.
struct TrackingControl {
  double k1 = 1.0;
  double k2 = 0.01;     ///< [m²]
  double k3 = 0.02;     ///< [m²/s]
  double k4 = 0.0;      ///< [1/m]
  double k5 = 100.0;    ///< [1/m²]
  double k6 = 0.0;      ///< [m/s]
  double offset = 0.0;  ///< δx, of the control point ahead of the rear wheel [m].

  /// What `robot` is to drive to meet `reference`, which moves by `feedforward`.
  Twist operator()(const PlanarPose& robot, const PlanarPose& reference,
                   const Twist& feedforward) const {
    const Point2 d = reference.position - robot.position;
    const double c = std::cos(robot.heading), s = std::sin(robot.heading);
    const double x = c * d.x() + s * d.y(), y = c * d.y() - s * d.x();
    const double e = wrap_angle(robot.heading - reference.heading);
    const bool small = std::abs(e) < 1e-6;
    const double sine = small ? 1.0 : std::sin(e) / e;
    const double cosine = small ? -0.5 * e : (std::cos(e) - 1.0) / e;
    const double v = feedforward.v, w = feedforward.w;
    Twist twist;
    twist.w = w - k3 / k2 * e + k6 / k2 * x -
              k1 / k2 * (offset * w * cosine - v * sine) * (y + offset * e);
    twist.v = v + k3 * k5 * x + (2.0 * k3 * k4 + (v * cosine + offset * w * sine) + k6) * e +
              ((1.0 - k1) * y - k1 * offset * e) * twist.w;
    return twist;
  }
};
}  // namespace surfleet
