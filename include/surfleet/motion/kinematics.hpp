// SPDX-License-Identifier: MIT
/// @file
/// @brief How robots move: an aerial robot with four degrees of freedom and a planar unicycle.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <functional>
#include <span>
#include <vector>

#include <surfleet/motion/path_follower.hpp>

namespace surfleet {
/// A robot that moves along paths. (`Mission` flies `AerialMotion`, whose courses it bends and
/// whose heading it leads in flight, beyond what is asked here.)
///
/// `follow(points, yaw)` sets out along a polyline that begins where the robot is, to stand at its
/// end with heading `yaw`; `advance(dt)` lets time pass and returns the configuration; `stop()`
/// brakes at once, within `stopping_distance()`; `remaining()` is the polyline still ahead,
/// beginning at the robot. Deterministic.
template <typename M>
concept KinematicModel = std::copyable<M> &&
    requires(M& m, const M& c, std::span<const Point3> points, double x) {
  { c.configuration() } -> std::convertible_to<Configuration>;
  { c.velocity() } -> std::convertible_to<Eigen::Vector3d>;
  { c.stopping_distance() } -> std::convertible_to<double>;
  { c.finished() } -> std::convertible_to<bool>;
  { c.standing() } -> std::convertible_to<bool>;
  { c.remaining() } -> std::convertible_to<std::vector<Point3>>;
  m.follow(points, x);
  { m.advance(x) } -> std::convertible_to<Configuration>;
  m.stop();
};

/// A heading that turns towards a target within a rate and an acceleration.
class HeadingControl {
 public:
  double rate_limit = 0.8;          ///< [rad/s]
  double acceleration_limit = 2.0;  ///< [rad/s²]
  double yaw = 0.0;                 ///< [rad]
  double rate = 0.0;                ///< [rad/s]

  /// Turns for `dt` towards `target`, by the smaller angle, so as to arrive at rest.
  void advance(double target, double dt) {
    const int steps = std::max(1, static_cast<int>(std::ceil(dt / kStep - 1e-9)));
    const double h = dt / steps;
    if (!(h > 0.0)) return;
    for (int i = 0; i < steps; ++i) {
      const double error = wrap_angle(target - yaw);
      const double change = acceleration_limit * h;
      if (std::abs(error) <= 0.5 * change * h + 1e-12 && std::abs(rate) <= change) {
        yaw = wrap_angle(target);
        rate = 0.0;
        continue;
      }
      // The rate from which it can still come to rest on the target, one step's delay allowed for.
      const double arrive =
          std::sqrt(2.0 * acceleration_limit * std::abs(error) + 0.25 * change * change) -
          0.5 * change;
      const double wanted =
          std::copysign(std::min({rate_limit, arrive, std::abs(error) / h}), error);
      rate += std::clamp(wanted - rate, -change, change);
      yaw = wrap_angle(yaw + rate * h);
    }
  }
  bool at(double target) const {
    return std::abs(wrap_angle(target - yaw)) < 1e-3 && std::abs(rate) < 1e-2;
  }

 private:
  static constexpr double kStep = 0.02;
};

struct AerialLimits {
  double speed = 0.6;             ///< [m/s]
  double acceleration = 1.0;      ///< [m/s²]
  double braking = 1.5;           ///< Of the emergency stop [m/s²].
  double yaw_rate = 0.8;          ///< [rad/s]
  double yaw_acceleration = 2.0;  ///< [rad/s²]
  double corner_tolerance = 0.1;  ///< How far corners are cut [m].
  // Of a gimbal, if there is one:
  double pitch_rate = 1.0;          ///< [rad/s]
  double pitch_acceleration = 4.0;  ///< [rad/s²]
};

/// Position and heading move independently; the heading may be anything in flight.
class AerialMotion {
 public:
  /// The heading while under way, from position and direction of travel; yaw [rad].
  using YawLaw = std::function<double(const Point3&, const Eigen::Vector3d&)>;

  explicit AerialMotion(const Configuration& at = {}, AerialLimits limits = {})
      : follower_({.speed = limits.speed,
                   .acceleration = limits.acceleration,
                   .braking = limits.braking,
                   .corner_tolerance = limits.corner_tolerance}) {
    require(limits.yaw_rate > 0.0 && limits.yaw_acceleration > 0.0,
            "yaw limits: expected a positive rate and acceleration");
    heading_.rate_limit = limits.yaw_rate;
    heading_.acceleration_limit = limits.yaw_acceleration;
    heading_.yaw = goal_yaw_ = at.yaw;
    follower_.start(std::span<const Point3>(&at.position, 1));
  }

  /// Sets out along `points`; the first is taken to be where the robot is. Under way in another
  /// direction, the robot first brakes along its old one as far as the turn asks for, which leads
  /// it off the new path by at most its braking distance; `stop` and wait to avoid that. `yaw_law`
  /// decides the heading until the path's end; without it the robot turns to `yaw` at once.
  void follow(std::span<const Point3> points, double yaw, YawLaw yaw_law = {}) {
    goal_yaw_ = yaw;
    yaw_law_ = std::move(yaw_law);
    follower_.start(path_onto(points), follower_.speed());
  }
  /// The path that `follow` would take onto `points`: on along the old course, as little as it
  /// takes to slow down for the corner that leads to the next point, and from there along `points`.
  std::vector<Point3> path_onto(std::span<const Point3> points) const {
    const double v = follower_.speed(), a = follower_.limits().acceleration;
    const Eigen::Vector3d heading = follower_.direction();
    std::vector<Point3> path{follower_.position()};
    const double stop = 0.5 * v * v / a;
    if (points.size() < 2) {
      if (v > 1e-6) path.push_back(path[0] + heading * stop);
      return path;
    }
    const auto turn_after = [&](double leg) {
      const Eigen::Vector3d on = points[1] - path[0] - heading * leg;
      return std::atan2(heading.cross(on).norm(), heading.dot(on));
    };
    if (v > 1e-6 && turn_after(0.0) > 0.02) {
      // The least that will do, in steps; after the corner there may be a stop at once.
      const auto will_do = [&](double leg) {
        const double next = (points[1] - path[0] - heading * leg).norm();
        const auto corner = follower_.limits().corner(turn_after(leg), leg, next);
        const double left = std::max(0.0, next - corner.tangent);
        const double end = std::min(corner.speed * corner.speed, 2.0 * a * left);
        return v * v <= end + 2.0 * a * (leg - corner.tangent);
      };
      constexpr int kSteps = 64;
      const double longest = 2.0 * stop;  // an arc begins in the second half of its leg
      double leg = longest / kSteps;
      while (leg < longest && !will_do(leg)) leg += longest / kSteps;
      path.push_back(path[0] + heading * leg);
    }
    path.insert(path.end(), points.begin() + 1, points.end());
    return path;
  }

  Configuration advance(double dt) {
    // Position and heading in short steps, so that a heading towards a point follows the motion.
    const int steps = std::max(1, static_cast<int>(std::ceil(dt / 0.1 - 1e-9)));
    for (int i = 0; i < steps; ++i) {
      const double h = dt / steps;
      for (double left = follower_.advance(h); left > 0.0 && !follower_.at_end();)
        left = follower_.advance(left);
      const bool arriving = follower_.at_end() || !yaw_law_;
      heading_.advance(arriving ? goal_yaw_ : yaw_law_(follower_.position(), follower_.direction()),
                       h);
    }
    return configuration();
  }
  void stop() { follower_.stop(); }
  /// Goes on along the path it was stopped on.
  void resume() { follower_.resume(); }

  Configuration configuration() const { return {follower_.position(), heading_.yaw}; }
  Eigen::Vector3d velocity() const { return follower_.direction() * follower_.speed(); }
  double stopping_distance() const { return follower_.stopping_distance(); }
  bool braking() const { return follower_.braking(); }
  bool standing() const { return follower_.speed() <= 0.0; }
  /// At the end of the path with the goal's heading.
  bool finished() const { return follower_.at_end() && heading_.at(goal_yaw_); }
  std::vector<Point3> remaining() const { return follower_.remaining(); }

 private:
  PathFollower follower_;
  HeadingControl heading_;
  YawLaw yaw_law_;
  double goal_yaw_ = 0.0;
};

struct UnicycleLimits {
  double speed = 0.5;              ///< [m/s]
  double acceleration = 0.8;       ///< [m/s²]
  double braking = 1.5;            ///< Of the emergency stop [m/s²].
  double yaw_rate = 1.0;           ///< [rad/s]
  double yaw_acceleration = 3.0;   ///< Of turns on the spot [rad/s²].
  double corner_tolerance = 0.05;  ///< How far corners are cut [m].
};

/// A planar nonholonomic robot: it moves only along its heading, in the plane z = const.
///
/// It turns on the spot before it sets out, at sharp corners and at the goal; gentler corners it
/// takes as arcs.
class UnicycleMotion {
 public:
  explicit UnicycleMotion(const Configuration& at = {}, UnicycleLimits limits = {})
      : follower_({.speed = limits.speed,
                   .acceleration = limits.acceleration,
                   .braking = limits.braking,
                   .corner_tolerance = limits.corner_tolerance,
                   .turn_rate = limits.yaw_rate,
                   .pivot_angle = radians(80.0)}) {
    require(limits.yaw_rate > 0.0 && limits.yaw_acceleration > 0.0,
            "yaw limits: expected a positive rate and acceleration");
    heading_.rate_limit = limits.yaw_rate;
    heading_.acceleration_limit = limits.yaw_acceleration;
    heading_.yaw = goal_yaw_ = at.yaw;
    follower_.start(std::span<const Point3>(&at.position, 1));
  }

  /// Sets out along `points`, whose height is ignored. Under way, the robot first comes to a stand
  /// on its old course, unless the new one continues it.
  void follow(std::span<const Point3> points, double yaw) {
    next_.assign(points.begin(), points.end());
    for (Point3& p : next_) p.z() = follower_.position().z();
    next_yaw_ = yaw;
    pending_ = true;
    held_ = false;
    if (standing()) return set_out();
    if (next_.size() > 1) {
      const Eigen::Vector3d first = next_[1] - follower_.position();
      const Eigen::Vector3d course = follower_.direction();
      if (std::atan2(course.cross(first).norm(), course.dot(first)) < 0.02) return set_out();
    }
    follower_.stop();
  }

  Configuration advance(double dt) {
    const int steps = std::max(1, static_cast<int>(std::ceil(dt / 0.02 - 1e-9)));
    const double h = dt / steps;
    for (int i = 0; i < steps; ++i) {
      if (pending_ && !held_ && standing()) set_out();
      if (follower_.at_end()) {
        heading_.advance(goal_yaw_, h);
        continue;
      }
      const double course = std::atan2(follower_.direction().y(), follower_.direction().x());
      if (standing() && !follower_.braking() && !heading_.at(course)) {
        heading_.advance(course, h);  // on the spot
        continue;
      }
      follower_.advance(h);
      if (standing()) continue;
      const double now = std::atan2(follower_.direction().y(), follower_.direction().x());
      heading_.rate = wrap_angle(now - heading_.yaw) / h;
      heading_.yaw = now;
    }
    return configuration();
  }
  void stop() {
    held_ = true;
    follower_.stop();
  }
  void resume() {
    held_ = false;
    // A course that is to be left is not gone on with.
    if (!pending_) follower_.resume();
  }

  Configuration configuration() const { return {follower_.position(), heading_.yaw}; }
  Eigen::Vector3d velocity() const { return follower_.direction() * follower_.speed(); }
  double stopping_distance() const { return follower_.stopping_distance(); }
  bool standing() const { return follower_.speed() <= 0.0; }
  bool finished() const { return !pending_ && follower_.at_end() && heading_.at(goal_yaw_); }
  std::vector<Point3> remaining() const { return pending_ ? next_ : follower_.remaining(); }

 private:
  void set_out() {
    const double v = follower_.speed();
    if (next_.empty()) next_.push_back(follower_.position());
    next_.front() = follower_.position();
    follower_.start(next_, v);
    goal_yaw_ = next_yaw_;
    if (v <= 0.0) heading_.rate = 0.0;
    pending_ = false;
  }
  PathFollower follower_;
  HeadingControl heading_;
  std::vector<Point3> next_;
  double goal_yaw_ = 0.0, next_yaw_ = 0.0;
  bool pending_ = false;  // `next_` waits for the robot to stand
  bool held_ = false;     // by `stop`
};

static_assert(KinematicModel<AerialMotion> && KinematicModel<UnicycleMotion>);
}  // namespace surfleet
