// SPDX-License-Identifier: MIT
/// @file
/// @brief Moving along a polyline within speed and acceleration limits, corners rounded.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
struct FollowerLimits {
  double speed = 0.6;             ///< Largest [m/s].
  double acceleration = 1.0;      ///< Largest, along and across together [m/s²].
  double braking = 1.5;           ///< Of the emergency stop [m/s²].
  double corner_tolerance = 0.1;  ///< The rounded path leaves the polyline by no more [m].
  /// Largest turning rate of the direction of travel [rad/s]; bounds the speed in corners.
  double turn_rate = 1e9;
  /// Corners sharper than this are not rounded: one stops there [rad].
  double pivot_angle = radians(170.0);

  /// How a corner is taken: the arc begins `tangent` before it and ends as far behind.
  struct Corner {
    double speed = 0.0;    ///< 0: one stops there [m/s].
    double tangent = 0.0;  ///< [m]
    double radius = 0.0;   ///< 0: no arc [m].
  };
  /// The corner that turns by `turn` [rad] between legs so long [m].
  Corner corner(double turn, double before, double after) const {
    if (turn >= pivot_angle) return {};
    if (turn <= 1e-6) return {.speed = speed};
    const double c = std::cos(0.5 * turn), t = std::tan(0.5 * turn);
    const double tangent =
        std::min({corner_tolerance * c / (1.0 - c) * t, 0.5 * before, 0.5 * after});
    const double radius = tangent / t;
    if (radius < 1e-6) return {};
    return {.speed = std::min(
                {speed, turn_rate * radius, std::sqrt(acceleration * std::sqrt(0.5) * radius)}),
            .tangent = tangent,
            .radius = radius};
  }
};

/// A point that moves along a polyline whose corners are replaced by tangent arcs.
///
/// Time-optimal under the limits for the rounded path: it accelerates, cruises and brakes so as to
/// pass every arc at no more than its speed and to stand still at the end. Exact integration: the
/// motion does not depend on how time is cut into steps but for rounding. O(pieces passed) a step.
class PathFollower {
 public:
  explicit PathFollower(FollowerLimits limits = {}) : limits_(limits) {
    require(limits.speed > 0.0 && limits.acceleration > 0.0 && limits.braking > 0.0 &&
                limits.corner_tolerance >= 0.0 && limits.turn_rate > 0.0,
            "kinematic limits: expected positive speed, acceleration, braking and turning rate");
  }

  const FollowerLimits& limits() const { return limits_; }

  /// Starts on `points` from the first one at `speed`, which has the first leg's direction.
  void start(std::span<const Point3> points, double speed = 0.0) {
    build(points);
    speed_ = std::clamp(speed, 0.0, limits_.speed);
    braking_ = false;
  }
  /// Moves on for `dt` [s]. Returns the time that was left when a pivot or the end was reached.
  double advance(double dt) {
    while (dt > 0.0) {
      if (braking_) {
        const double time = std::min(dt, speed_ / limits_.braking);
        travel(speed_ * time - 0.5 * limits_.braking * time * time);
        speed_ = std::max(0.0, speed_ - limits_.braking * time);
        return 0.0;
      }
      if (at_end()) {
        speed_ = 0.0;
        return dt;
      }
      const Piece& p = pieces_[piece_];
      const double left = p.length - along_;
      double a = limits_.acceleration * (p.radius > 0.0 ? std::sqrt(0.5) : 1.0);
      const double end = p.end_speed;
      if (left <= 1e-12) {
        next_piece();
        if (p.end_speed <= 0.0 && !at_end()) {
          speed_ = 0.0;
          return dt;  // at a pivot: the caller may turn before it goes on
        }
        continue;
      }
      if (speed_ * speed_ > end * end + 2.0 * a * left)  // cannot brake in time but harder
        a = (speed_ * speed_ - end * end) / (2.0 * left);
      const double peak = std::max(
          speed_, std::min(p.limit, std::sqrt(0.5 * (speed_ * speed_ + end * end) + a * left)));
      const double up = (peak - speed_) / a, up_length = 0.5 * (peak + speed_) * up;
      const double down = (peak - end) / a, down_length = 0.5 * (peak + end) * down;
      const double cruise = std::max(0.0, left - up_length - down_length) / peak;
      double t = dt;
      if (t < up) {
        along_ += speed_ * t + 0.5 * a * t * t;
        speed_ += a * t;
        return 0.0;
      }
      t -= up;
      if (t < cruise) {
        along_ += up_length + peak * t;
        speed_ = peak;
        return 0.0;
      }
      t -= cruise;
      if (t < down) {
        along_ = p.length - down_length + peak * t - 0.5 * a * t * t;
        speed_ = peak - a * t;
        return 0.0;
      }
      dt = t - down;
      along_ = p.length;
      speed_ = end;
    }
    return 0.0;
  }
  /// Brakes as hard as it may, on the path; the follower then stands until `start` or `resume`.
  void stop() { braking_ = true; }
  void resume() { braking_ = false; }
  bool braking() const { return braking_; }

  bool at_end() const {
    return piece_ >= pieces_.size() ||
           (piece_ + 1 == pieces_.size() && along_ >= pieces_[piece_].length);
  }
  double speed() const { return speed_; }
  /// Distance to a stand by `stop()` [m].
  double stopping_distance() const { return speed_ * speed_ / (2.0 * limits_.braking); }
  Point3 position() const {
    if (pieces_.empty()) return vertices_.empty() ? Point3::Zero() : vertices_.front();
    if (piece_ >= pieces_.size()) return vertices_.back();
    return pieces_[piece_].at(along_);
  }
  /// Unit direction of travel; at the end the last one; zero for a path of one point.
  Eigen::Vector3d direction() const {
    if (pieces_.empty()) return Eigen::Vector3d::Zero();
    const Piece& p = pieces_[std::min(piece_, pieces_.size() - 1)];
    if (p.radius <= 0.0) return p.direction;
    const double phi = std::min(along_, p.length) / p.radius;
    return std::cos(phi) * p.direction + std::sin(phi) * p.inward;
  }
  /// The path that is left: the position, the rest of an arc under way, and the vertices ahead.
  std::vector<Point3> remaining() const {
    std::vector<Point3> points{position()};
    if (at_end()) return points;
    if (pieces_[piece_].radius > 0.0) {
      const Piece& arc = pieces_[piece_];
      const double left = (arc.length - along_) / arc.radius;
      const int chords = std::max(1, static_cast<int>(std::ceil(left / kChord)));
      for (int k = 1; k <= chords; ++k)
        points.push_back(arc.at(along_ + (arc.length - along_) * k / chords));
    }
    for (std::size_t i = pieces_[piece_].next_vertex; i < vertices_.size(); ++i)
      points.push_back(vertices_[i]);
    return points;
  }

 private:
  struct Piece {
    Point3 start;
    Eigen::Vector3d direction;                         // at the start, unit length
    Eigen::Vector3d inward = Eigen::Vector3d::Zero();  // towards an arc's centre, unit length
    double length = 0.0;
    double radius = 0.0;  // 0: straight
    double limit = 0.0;   // of the speed
    double end_speed = 0.0;
    std::size_t next_vertex = 0;

    Point3 at(double along) const {
      if (radius <= 0.0) return start + direction * along;
      const double phi = along / radius;
      return start + radius * (std::sin(phi) * direction + (1.0 - std::cos(phi)) * inward);
    }
  };
  static constexpr double kChord = radians(20.0);  ///< Of an arc's turn, in `remaining`.

  void next_piece() {
    ++piece_;
    along_ = 0.0;
  }
  void travel(double distance) {
    while (piece_ < pieces_.size()) {
      const double left = pieces_[piece_].length - along_;
      if (distance < left || piece_ + 1 == pieces_.size()) {
        along_ = std::min(along_ + distance, pieces_[piece_].length);
        return;
      }
      distance -= left;
      next_piece();
    }
  }

  void build(std::span<const Point3> points) {
    vertices_.clear();
    pieces_.clear();
    piece_ = 0;
    along_ = 0.0;
    for (const Point3& p : points)
      if (vertices_.empty() || (p - vertices_.back()).norm() > 1e-9) vertices_.push_back(p);
    const std::size_t n = vertices_.size();
    if (n < 2) return;
    double cut = 0.0;  // of the leg's beginning, by the arc before it
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const Eigen::Vector3d leg = vertices_[i + 1] - vertices_[i];
      const double length = leg.norm();
      const Eigen::Vector3d d = leg / length;
      Piece line{.start = vertices_[i] + d * cut, .direction = d};
      line.limit = limits_.speed;
      line.next_vertex = i + 1;
      FollowerLimits::Corner corner;
      Piece arc;
      if (i + 2 < n) {
        const Eigen::Vector3d on = vertices_[i + 2] - vertices_[i + 1];
        const Eigen::Vector3d e = on.normalized();
        const double turn = std::atan2(d.cross(e).norm(), d.dot(e));
        corner = limits_.corner(turn, length, on.norm());
        if (corner.radius > 0.0) {
          arc.start = vertices_[i + 1] - d * corner.tangent;
          arc.direction = d;
          arc.inward = (e - d.dot(e) * d).normalized();
          arc.radius = corner.radius;
          arc.length = corner.radius * turn;
          arc.limit = corner.speed;
          arc.next_vertex = i + 2;
        }
      }
      line.length = std::max(0.0, length - cut - corner.tangent);
      line.end_speed = corner.speed > 0.0 ? limits_.speed : 0.0;
      pieces_.push_back(line);
      if (corner.tangent > 0.0) {
        arc.end_speed = limits_.speed;
        pieces_.push_back(arc);
      }
      cut = corner.tangent;
    }
    pieces_.back().end_speed = 0.0;
    for (std::size_t i = pieces_.size() - 1; i-- > 0;) {
      const Piece& after = pieces_[i + 1];
      const double a = limits_.acceleration * (after.radius > 0.0 ? std::sqrt(0.5) : 1.0);
      pieces_[i].end_speed =
          std::min({pieces_[i].end_speed, pieces_[i].limit, after.limit,
                    std::sqrt(after.end_speed * after.end_speed + 2.0 * a * after.length)});
    }
  }

  FollowerLimits limits_;
  std::vector<Point3> vertices_;
  std::vector<Piece> pieces_;
  std::size_t piece_ = 0;
  double along_ = 0.0, speed_ = 0.0;
  bool braking_ = false;
};
}  // namespace surfleet
