// SPDX-License-Identifier: MIT
/// @file
/// @brief Which robot goes, which waits and which steps aside when they meet [000 §3.5.2 item 5].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/triangle_queries.hpp>

namespace surfleet {
namespace detail {
/// The point `distance` [m] along a polyline, or its end.
inline Point3 point_along(std::span<const Point3> path, double distance) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double leg = (path[i] - path[i - 1]).norm();
    if (distance <= leg && leg > 0.0)
      return path[i - 1] + (path[i] - path[i - 1]) * (distance / leg);
    distance -= leg;
  }
  return path.back();
}
/// The first `distance` [m] of a polyline.
inline std::vector<Point3> head_of(std::span<const Point3> path, double distance) {
  std::vector<Point3> head{path.front()};
  for (std::size_t i = 1; i < path.size() && distance > 0.0; ++i) {
    const double leg = (path[i] - path[i - 1]).norm();
    head.push_back(distance >= leg
                       ? path[i]
                       : Point3(path[i - 1] + (path[i] - path[i - 1]) * (distance / leg)));
    distance -= leg;
  }
  return head;
}
/// Distance between the segments ab and cd, either of which may be a point.
inline double segment_distance(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  const Eigen::Vector3d u = b - a, v = d - c, w = a - c;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w),
               vw = v.dot(w), det = uu * vv - uv * uv;
  double s = det > 1e-12 * uu * vv ? std::clamp((uv * vw - vv * uw) / det, 0.0, 1.0) : 0.0;
  double t = vv > 0.0 ? (uv * s + vw) / vv : 0.0;
  if (!(vv > 0.0) || t < 0.0 || t > 1.0) {
    t = std::clamp(t, 0.0, 1.0);
    s = uu > 0.0 ? std::clamp((uv * t - uw) / uu, 0.0, 1.0) : 0.0;
  }
  return (w + s * u - t * v).norm();
}
inline double polyline_distance(std::span<const Point3> p, std::span<const Point3> q) {
  double best = std::numeric_limits<double>::infinity();
  const auto last = [](std::span<const Point3> x, std::size_t i) {
    return std::min(i + 1, x.size() - 1);
  };
  for (std::size_t i = 0; i + (p.size() > 1 ? 1 : 0) < p.size(); ++i)
    for (std::size_t k = 0; k + (q.size() > 1 ? 1 : 0) < q.size(); ++k)
      best = std::min(best, segment_distance(p[i], p[last(p, i)], q[k], q[last(q, k)]));
  return best;
}
}  // namespace detail

/// What a robot tells its teammates about its motion.
struct TrafficAgent {
  int id = 0;             ///< Unique; decides between equal priorities, the lower goes first.
  double priority = 0.0;  ///< The higher goes first.
  Point3 position = Point3::Zero();
  std::vector<Point3> path{};  ///< Still ahead, from `position` on; may be empty.
  double radius = 1.0;         ///< Of the body [m].
  double speed = 0.6;          ///< Its cruising speed [m/s].
  bool idle = false;           ///< Has no task: gives way to every robot that has.
  bool cornered = false;       ///< Could not give way: all others give way to it.
  /// Stands, and will ask again before it moves on. Robots decide at once, on what was told before:
  /// to a senior such a robot stands, a junior counts on its going on unless it is itself in the
  /// way, so that of two that wait for each other's first step just one takes it.
  bool held = false;
  double age = 0.0;  ///< Of this news; it may have moved on since [s].

  static constexpr double kMostStray = 5.0;  ///< [m]

  /// Radius of what holds its body, about one of `places()` [m]. It grows with the news' age up to
  /// a limit, so that a mate not heard of for long does not bar everything around it.
  double extent() const { return radius + std::min(kMostStray, speed * age); }
  /// How far along its path it may be beyond `extent()` [m].
  double strayed() const { return path.size() < 2 ? 0.0 : std::max(0.0, speed * age - kMostStray); }
  /// Where it may be: at `position`, or on its path as far as it may have strayed.
  std::vector<Point3> places() const {
    return strayed() > 0.0 ? detail::head_of(path, strayed()) : std::vector<Point3>{position};
  }
  /// From `p` to the nearest of `places()` [m].
  double distance(const Point3& p) const { return (nearest(p) - p).norm(); }
  Point3 nearest(const Point3& p) const {
    Point3 best = position;
    if (!(strayed() > 0.0)) return best;
    const std::vector<Point3> all = places();
    for (std::size_t i = 1; i < all.size(); ++i)
      if (const Point3 q = closest_on_segment(p, all[i - 1], all[i]);
          (q - p).squaredNorm() < (best - p).squaredNorm())
        best = q;
    return best;
  }
};

/// What a robot should do now.
struct Maneuver {
  enum class Kind { none, stop, step_aside };
  Kind kind = Kind::none;
  Point3 target = Point3::Zero();  ///< Where to step aside to, straight.
  int because_of = -1;             ///< The teammate's id.
};

struct TrafficOptions {
  double clearance = 0.5;       ///< Kept between bodies where there is a choice [m].
  double least_gap = 0.05;      ///< Kept between bodies always [m].
  double horizon = 15.0;        ///< How far ahead paths are compared [s].
  double period = 0.2;          ///< The longest time between two decisions [s].
  double braking = 1.5;         ///< Of the emergency stop [m/s²].
  double longest_step = 8.0;    ///< How far a robot steps aside [m].
  double cornered_time = 30.0;  ///< How long a cornered robot keeps the right of way [s].

  /// Between the bodies of two that stand, for both to have come there and stay [m].
  double standing_gap() const { return clearance + 2.0 * least_gap; }
};

/// One robot's view of the traffic; every robot runs its own, on what the others tell.
///
/// Right of way: cornered robots, then those with a task, then the higher priority, then the lower
/// id. A robot whose path and a senior's come closer than the clearance allows, at the times they
/// would be there, goes on as far as it can still wait off the senior's path. If it stands on that
/// path, it steps aside to the nearest free place that is out of it; without any it stays, says it
/// is cornered and has the right of way for a while. Whatever the rank, no robot closes in on
/// another so far that both could not brake: two robots that both keep this rule never touch, the
/// senior included. The highest-ranked robot waits for none that can make room, so it arrives; then
/// the next one does.
class TrafficPolicy {
 public:
  TrafficOptions options;

  explicit TrafficPolicy(TrafficOptions o = {}) : options(o) {
    require(o.clearance >= o.least_gap && o.least_gap >= 0.0 && o.horizon > 0.0 && o.period > 0.0 &&
                o.braking > 0.0,
            "traffic settings: expected clearance >= least_gap >= 0 and positive times");
  }

  /// Decides for `self`, whose path is the one it wants to take, at time `now` [s].
  /// `free(a, b)` tells whether the segment is free of obstacles. O(others · horizon), more when it
  /// has to search for a place.
  template <typename Free>
  Maneuver operator()(const TrafficAgent& self, std::span<const TrafficAgent> others,
                      const Free& free, double now) {
    TrafficAgent me = self;
    me.cornered = cornered(now);
    Maneuver none;
    const TrafficAgent* conflict = nullptr;
    bool in_the_way = false;
    for (const TrafficAgent& o : others) {
      if (o.id == me.id || !before(o, me)) continue;
      const double keep = me.radius + o.extent() + options.clearance;
      if (comes_closer(me, o, keep, false) && conflict == nullptr) conflict = &o;
      if (comes_closer(me, o, keep - 0.2 * options.clearance, true)) {
        if (!in_the_way) conflict = &o;
        in_the_way = true;
      }
    }
    if (in_the_way) {
      if (const auto target = place_aside(me, others, free); target.second)
        return {Maneuver::Kind::step_aside, target.first, conflict->id};
      cornered_until_ = now + options.cornered_time;
      return {Maneuver::Kind::stop, me.position, conflict->id};
    }
    if (conflict != nullptr && !may_go_on(me, others))
      return {Maneuver::Kind::stop, me.position, conflict->id};
    if (const int id = too_close(me, others); id >= 0)
      return {Maneuver::Kind::stop, me.position, id};
    return none;
  }

  /// Whether to tell the others that this robot is cornered.
  bool cornered(double now) const { return now < cornered_until_; }

  /// The rule above all: the id of a teammate that `self` must not come any closer to on its path,
  /// whatever its goal, or −1. To be asked every `period` while moving.
  int too_close(const TrafficAgent& self, std::span<const TrafficAgent> others) const {
    if (self.path.size() < 2) return -1;
    const auto mine = reach(self);
    for (const TrafficAgent& o : others) {
      if (o.id == self.id) continue;
      const auto its = stays(o, self) ? o.places() : reach(o);
      if (closes_in(self, mine, o, its)) return o.id;
    }
    return -1;
  }

 private:
  /// The path of a moving robot until it would stand, told so at the next decision.
  std::vector<Point3> reach(const TrafficAgent& a) const {
    return detail::head_of(
        a.path, a.strayed() + a.speed * options.period + 0.5 * a.speed * a.speed / options.braking);
  }
  /// Whether `a` on its path `mine` comes too near to `o`, on its path `its`, and nearer than it
  /// is.
  bool closes_in(const TrafficAgent& a, std::span<const Point3> mine, const TrafficAgent& o,
                 std::span<const Point3> its) const {
    if (detail::polyline_distance(mine, its) >= a.extent() + o.extent() + options.least_gap)
      return false;
    bool closing = false;
    for (std::size_t i = 1; i < mine.size(); ++i)
      closing = closing || (mine[i] - mine[i - 1]).dot(o.nearest(mine[i - 1]) - mine[i - 1]) > 0.0;
    return closing;
  }
  /// Whether `self` may count on `o` not to move until the next decision.
  bool stays(const TrafficAgent& o, const TrafficAgent& self) const {
    if (o.path.size() < 2) return true;
    if (!o.held) return false;
    // A senior that waits, too, stays if it is `self`, standing, that it waits for.
    const std::array<Point3, 1> here{self.position};
    return before(self, o) || (self.held && closes_in(o, reach(o), self, here));
  }
  static bool before(const TrafficAgent& a, const TrafficAgent& b) {
    if (a.cornered != b.cornered) return a.cornered;
    if (a.idle != b.idle) return b.idle;
    if (a.priority != b.priority) return a.priority > b.priority;
    return a.id < b.id;
  }
  /// Whether the two come closer than `keep`, and closer than they are, within the horizon, each
  /// going on along its path, or with `me` standing.
  bool comes_closer(const TrafficAgent& me, const TrafficAgent& o, double keep,
                    bool standing) const {
    const double limit = std::min(keep, o.distance(me.position) - 1e-3);
    constexpr double kStep = 0.25;
    for (double t = kStep; t <= options.horizon; t += kStep) {
      const Point3 p =
          standing || me.path.size() < 2 ? me.position : detail::point_along(me.path, me.speed * t);
      // One that may have strayed may as well stand.
      const double gap =
          o.strayed() > 0.0
              ? detail::polyline_distance(std::array<Point3, 1>{p},
                                          detail::head_of(o.path, o.strayed() + o.speed * t))
              : (p - (o.path.size() < 2 ? o.position : detail::point_along(o.path, o.speed * t)))
                    .norm();
      if (gap < limit) return true;
    }
    return false;
  }
  /// Whether `me` could wait as well where it would come to a stand if told so at the next
  /// decision.
  bool may_go_on(const TrafficAgent& me, std::span<const TrafficAgent> others) const {
    if (me.path.size() < 2) return true;
    TrafficAgent later = me;
    later.position = detail::point_along(
        me.path, 2.0 * me.speed * options.period + 0.5 * me.speed * me.speed / options.braking);
    return std::none_of(others.begin(), others.end(), [&](const TrafficAgent& o) {
      if (o.id == me.id || !before(o, me)) return false;
      const double keep = me.radius + o.extent() + options.clearance;
      const double gap = o.distance(later.position);
      return gap < std::min(keep, o.distance(me.position)) || comes_closer(later, o, keep, true);
    });
  }
  template <typename Free>
  std::pair<Point3, bool> place_aside(const TrafficAgent& me, std::span<const TrafficAgent> others,
                                      const Free& free) const {
    std::vector<std::vector<Point3>> places(others.size()), paths(others.size());
    for (std::size_t i = 0; i < others.size(); ++i) {
      const TrafficAgent& o = others[i];
      places[i] = o.places();
      paths[i] = o.path.size() < 2 || !before(o, me) ? places[i] : o.path;
    }
    for (double distance = 0.5; distance <= options.longest_step; distance += 0.5)
      for (int k = 0; k < 40; ++k) {
        // 16 directions in the plane, 12 above and 12 below it.
        const int ring = k < 16 ? 16 : 12;
        const double elevation = k < 16 ? 0.0 : k < 28 ? 0.8 : -0.8;
        const double azimuth = 2.0 * kPi * (k < 16 ? k : (k - 16) % 12) / ring;
        const Point3 target =
            me.position + distance * Point3(std::cos(azimuth) * std::cos(elevation),
                                            std::sin(azimuth) * std::cos(elevation),
                                            std::sin(elevation));
        bool good = true;
        for (std::size_t i = 0; good && i < others.size(); ++i) {
          const TrafficAgent& o = others[i];
          if (o.id == me.id) continue;
          const double gap = me.radius + o.extent() + options.least_gap;
          const double keep = before(o, me) ? me.radius + o.extent() + options.clearance : gap;
          const std::array<Point3, 1> end{target};
          const std::array<Point3, 2> move{me.position, target};
          good = detail::polyline_distance(end, paths[i]) >= keep &&
                 detail::polyline_distance(move, places[i]) >=
                     std::min(gap, o.distance(me.position) - 1e-6);
        }
        if (good && free(me.position, target)) return {target, true};
      }
    return {me.position, false};
  }

  double cornered_until_ = -std::numeric_limits<double>::infinity();
};
}  // namespace surfleet
