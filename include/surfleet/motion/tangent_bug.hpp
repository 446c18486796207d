// SPDX-License-Identifier: MIT
/// @file
/// @brief TangentBug: a point robot that reaches a goal among polygons it knows only by a range
/// sensor [004 Alg. 3].
///
/// ```cpp
/// TangentBug bug{domain, start, goal, {.range = 2.0}};
/// while (!bug.arrived()) bug.advance(0.05);
/// ```
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/polygon.hpp>
#include <surfleet/geometry/polygon_visibility.hpp>

namespace surfleet {
struct TangentBugOptions {
  double range = std::numeric_limits<double>::infinity();  ///< Of the sensor [m]; 0: contact only.
};

/// The planner and the robot it moves.
///
/// The robot heads for the goal, or for the corner it senses that promises the shortest detour, as
/// long as one is nearer to the goal than itself. In a local minimum it follows the boundary that
/// stops it, keeping the smallest distance to the goal that it has sensed there, and leaves once
/// it senses a point that is nearer. Having gone round a whole boundary in vain it knows that the
/// goal cannot be reached and drives to the point of that boundary that is nearest to the goal: the
/// goal projection of [004 eq. 5.7]. A decision costs O(n²) for n vertices.
class TangentBug {
 public:
  enum class Phase { ToGoal, Following, Leaving, ToProjection, Arrived };

  /// `domain` must outlive this object; `start` must lie in it, `goal` may lie anywhere.
  TangentBug(const Polygon& domain, const Point2& start, const Point2& goal,
             TangentBugOptions options = {})
      : domain_(&domain),
        options_(options),
        position_(start),
        goal_(goal),
        eps_(4.0 * visibility_tolerance(domain)) {
    require(options.range >= 0.0, "TangentBug: the sensor range must not be negative");
    require(surfleet::contains(domain, start, eps_),
            "TangentBug: the start lies outside the domain or in an obstacle");
  }

  const Point2& position() const { return position_; }
  const Point2& goal() const { return goal_; }
  Phase phase() const { return phase_; }
  bool arrived() const { return phase_ == Phase::Arrived; }
  /// Where the robot will end instead of the goal, once it has found the goal out of reach.
  const std::optional<Point2>& projection() const { return projection_; }
  double travelled() const { return travelled_; }  ///< [m]

  /// Moves the robot by up to `distance` [m] along its path; less only when it arrives.
  void advance(double distance) {
    for (int idle = 0; distance > 1e-3 * eps_ && !arrived();) {
      const Point2 before = position_;
      switch (phase_) {
        case Phase::ToGoal:
          to_goal(distance);
          break;
        case Phase::Following:
          follow(distance);
          break;
        case Phase::Leaving:
          leave(distance);
          break;
        case Phase::ToProjection:
          to_projection(distance);
          break;
        case Phase::Arrived:
          break;
      }
      const double moved = (position_ - before).norm();
      distance -= moved;
      travelled_ += moved;
      // Decisions take no distance; rounding must not let two of them alternate for ever.
      idle = moved > 0.0 ? 0 : idle + 1;
      if (idle == 8 && phase_ != Phase::Following) start_following();
      if (idle > 32) break;
    }
  }

 private:
  double to(const Point2& p) const { return (goal_ - p).norm(); }

  void move_towards(const Point2& target, double distance) {
    const Point2 step = target - position_;
    const double length = step.norm();
    position_ = length <= distance ? target : Point2(position_ + distance / length * step);
  }
  /// How far the straight line to the goal is sensed to be free.
  double free_ahead() const {
    const double length = to(position_);
    if (length <= eps_) return length;
    return std::min({free_distance(*domain_, position_, (goal_ - position_) / length), length,
                     std::max(options_.range, eps_)});
  }
  bool senses(const Point2& v) const {
    const double d = (v - position_).norm();
    return d > eps_ && d <= options_.range && sees(*domain_, position_, v);
  }
  /// The sensed node of the local tangent graph with the shortest path by it to the goal, among
  /// those nearer to the goal than `limit`: corners, and where the sensor's circle cuts the walls.
  std::optional<Point2> best_node(double limit) const {
    std::optional<Point2> best;
    double shortest = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Point2& v) {
      const double length = (v - position_).norm() + to(v);
      if (to(v) < limit - eps_ && length < shortest && senses(v)) {
        best = v;
        shortest = length;
      }
    };
    const double reach = options_.range * (1.0 - 1e-9);
    for_each_edge(*domain_, [&](const Point2& a, const Point2& b) {
      consider(a);
      if (!std::isfinite(reach)) return;
      const Point2 u = b - a, w = a - position_;
      const double c2 = u.squaredNorm(), c1 = w.dot(u), c0 = w.squaredNorm() - reach * reach;
      const double root = c1 * c1 - c2 * c0;
      if (root <= 0.0) return;
      for (const double t : {(-c1 - std::sqrt(root)) / c2, (-c1 + std::sqrt(root)) / c2})
        if (t > 0.0 && t < 1.0) consider(a + t * u);
    });
    return best;
  }

  void to_goal(double distance) {
    if (to(position_) <= eps_) {
      position_ = goal_;
      phase_ = Phase::Arrived;
      return;
    }
    const double free = free_ahead();
    const double wanted = std::min(to(position_), std::max(options_.range, eps_));
    if (free >= wanted - 0.5 * eps_) {
      waypoint_.reset();
      // A contact sensor stops the robot where it touches something, not before.
      const double clear = options_.range > eps_ ? free
                                                 : free_distance(*domain_, position_,
                                                                 (goal_ - position_).normalized());
      move_towards(goal_, std::min(distance, std::max(clear, free)));
      return;
    }
    if (!waypoint_) waypoint_ = best_node(to(position_));
    if (waypoint_) {
      move_towards(*waypoint_, distance);
      if (position_ == *waypoint_) waypoint_.reset();
    } else if (free > eps_) {
      move_towards(goal_, std::min(distance, free));
    } else {
      start_following();
    }
  }

  const Ring& ring() const { return domain_->ring(ring_); }
  Point2 edge_start() const { return ring()[edge_]; }
  Point2 edge_end() const { return ring()[(edge_ + 1) % ring().size()]; }

  void start_following() {
    const BoundaryPoint at = closest_boundary_point(*domain_, position_);
    ring_ = at.ring;
    edge_ = at.edge;
    position_ = at.point;
    forward_ = (edge_end() - edge_start()).dot(goal_ - position_) >= 0.0;
    around_ = perimeter(ring());
    followed_ = best_at_ = 0.0;
    best_ = position_;
    nearest_ = to(position_);
    waypoint_.reset();
    phase_ = Phase::Following;
  }
  /// Goes along the followed ring, at most to the end of the edge; returns the distance.
  double walk(double distance) {
    Point2 end = forward_ ? edge_end() : edge_start();
    if (position_ == end) {
      const std::size_t n = ring().size();
      edge_ = forward_ ? (edge_ + 1) % n : (edge_ + n - 1) % n;
      end = forward_ ? edge_end() : edge_start();
    }
    const Point2 from = position_;
    move_towards(end, distance);
    return (position_ - from).norm();
  }
  void follow(double distance) {
    if (followed_ >= around_ - eps_) {
      projection_ = best_;
      // The loop is closed where it began; back to the recorded point by the shorter side.
      if (best_at_ > 0.5 * around_) forward_ = !forward_;
      phase_ = Phase::ToProjection;
      return;
    }
    // The nearest point to the goal must not be stepped over: the leaving path may begin there.
    const Point2 end = forward_ ? edge_end() : edge_start();
    const double ahead = (closest_on_segment(position_, end, goal_) - position_).norm();
    double step = std::min(distance, around_ - followed_);
    if (ahead > eps_) step = std::min(step, ahead);
    const Point2 from = position_;
    const double moved = walk(step);
    followed_ += moved;
    if (to(position_) <= eps_) {
      phase_ = Phase::ToGoal;
      return;
    }
    const Point2 nearest = closest_on_segment(from, position_, goal_);
    if (to(nearest) < to(best_)) {
      best_ = nearest;
      best_at_ = followed_;
    }
    nearest_ = std::min(nearest_, to(nearest));
    if (options_.range > eps_)
      for_each_edge(ring(), [&](const Point2& a, const Point2& b) {
        const Point2 c = closest_on_segment(a, b, goal_);
        if (to(c) < nearest_ && senses(c)) nearest_ = to(c);
      });
    const double free = free_ahead();
    if (free > 0.5 * eps_) {
      const Point2 node = position_ + free / to(position_) * (goal_ - position_);
      if (to(node) < nearest_ - 0.25 * eps_) {
        waypoint_ = to(node) <= eps_ ? goal_ : node;
        phase_ = Phase::Leaving;
        return;
      }
    }
    if (options_.range > eps_) {
      waypoint_ = best_node(nearest_);
      if (waypoint_) phase_ = Phase::Leaving;
    }
  }
  void leave(double distance) {
    move_towards(*waypoint_, distance);
    if (to(position_) < nearest_ || position_ == *waypoint_) {
      waypoint_.reset();
      phase_ = Phase::ToGoal;
    }
  }
  void to_projection(double distance) {
    if (sees(*domain_, position_, *projection_)) {
      move_towards(*projection_, distance);
      if (position_ == *projection_) phase_ = Phase::Arrived;
    } else {
      walk(distance);
    }
  }

  const Polygon* domain_;
  TangentBugOptions options_;
  Point2 position_, goal_;
  double eps_;
  Phase phase_ = Phase::ToGoal;
  double travelled_ = 0.0;
  std::optional<Point2> waypoint_, projection_;
  std::size_t ring_ = 0, edge_ = 0;
  bool forward_ = true;
  double around_ = 0.0, followed_ = 0.0, best_at_ = 0.0, nearest_ = 0.0;
  Point2 best_ = Point2::Zero();
};
}  // namespace surfleet
