// SPDX-License-Identifier: MIT
/// @file
/// @brief What all variants of hybrid coverage share [004 ch. 4]: settings, timed paths, and the
/// count of covered ground over time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/coverage_grid.hpp>
#include <surfleet/geometry/polygon_geodesic.hpp>

namespace surfleet {
/// The robots of [004 §4.4.1]: single integrators at constant speed with a circular footprint.
struct HybridOptions {
  double speed = 0.05;      ///< [m/s]
  double footprint = 0.03;  ///< Radius [m].
  double lane = 0.0595;     ///< Distance between passes, a bit less than twice the radius [m].
  double cell = 0.02;       ///< Of the grid that coverage is counted on [m].
};
inline void require_valid(const HybridOptions& o) {
  require(o.speed > 0.0 && o.footprint > 0.0 && o.lane > 0.0 && o.cell > 0.0,
          "hybrid coverage: speed, footprint, lane and cell size must be positive");
  require(o.lane <= 2.0 * o.footprint,
          "hybrid coverage: lanes farther apart than twice the footprint radius leave gaps");
}

struct TimedPoint {
  double time;  ///< [s]
  Point2 point;
};
/// Where one robot is at any time: straight at even speed between its entries, at rest after them.
class TimedPath {
 public:
  explicit TimedPath(const Point2& start, double time = 0.0) : points_{{time, start}} {}
  const std::vector<TimedPoint>& points() const { return points_; }
  const Point2& end() const { return points_.back().point; }
  double end_time() const { return points_.back().time; }

  void move_to(const Point2& p, double speed) {
    const double length = (p - end()).norm();
    if (length > 0.0) points_.push_back({end_time() + length / speed, p});
  }
  void follow(std::span<const Point2> path, double speed) {
    for (const Point2& p : path) move_to(p, speed);
  }
  void arrive(const Point2& p, double time) { points_.push_back({std::max(time, end_time()), p}); }
  void wait_until(double time) {
    if (time > end_time()) points_.push_back({time, end()});
  }
  void rotate(double angle) {  ///< About the origin [rad].
    const Eigen::Rotation2Dd r(angle);
    for (TimedPoint& p : points_) p.point = r * p.point;
  }
  double length() const {
    double sum = 0.0;
    for (std::size_t i = 1; i < points_.size(); ++i)
      sum += (points_[i].point - points_[i - 1].point).norm();
    return sum;
  }

 private:
  std::vector<TimedPoint> points_;
};

/// The share of the ground covered, at ascending times.
struct CoverageHistory {
  std::vector<double> time;      ///< [s]
  std::vector<double> fraction;  ///< In [0, 1].
  /// When a share was first covered; nothing if never.
  std::optional<double> time_to(double share) const {
    for (std::size_t i = 0; i < time.size(); ++i)
      if (fraction[i] >= share) return time[i];
    return std::nullopt;
  }
};

/// Runs all robots along their paths and counts the covered cells every `dt` [s].
/// `moved(robot, from, to, time)` sees every small straight motion in order of time.
template <typename Moved>
CoverageHistory replay(const Polygon& domain, std::span<const TimedPath> paths,
                       const HybridOptions& options, double dt, Moved&& moved) {
  require_valid(options);
  require(dt > 0.0, "replay: the time step must be positive");
  CoverageGrid grid(domain, options.cell);
  CoverageHistory history;
  double end = 0.0;
  for (const TimedPath& p : paths) end = std::max(end, p.end_time());
  std::vector<std::size_t> next(paths.size(), 1);
  std::vector<Point2> at;
  for (const TimedPath& p : paths) {
    at.push_back(p.points()[0].point);
    grid.cover(at.back(), at.back(), options.footprint);
  }
  history.time.push_back(0.0);
  history.fraction.push_back(grid.fraction());
  const auto steps = static_cast<std::size_t>(std::ceil(end / dt - 1e-9));
  for (std::size_t s = 1; s <= steps; ++s) {
    const double now = static_cast<double>(s) * dt;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const auto& points = paths[i].points();
      const auto go = [&](const Point2& to, double time) {
        if (to == at[i]) return;
        grid.cover(at[i], to, options.footprint);
        moved(i, at[i], to, time);
        at[i] = to;
      };
      while (next[i] < points.size() && points[next[i]].time <= now) {
        go(points[next[i]].point, points[next[i]].time);
        ++next[i];
      }
      if (next[i] < points.size()) {
        const TimedPoint &a = points[next[i] - 1], &b = points[next[i]];
        if (a.time < now)
          go(a.point + (now - a.time) / (b.time - a.time) * (b.point - a.point), now);
      }
    }
    history.time.push_back(now);
    history.fraction.push_back(grid.fraction());
  }
  return history;
}
inline CoverageHistory replay(const Polygon& domain, std::span<const TimedPath> paths,
                              const HybridOptions& options, double dt = 1.0) {
  return replay(domain, paths, options, dt,
                [](std::size_t, const Point2&, const Point2&, double) {});
}
}  // namespace surfleet
