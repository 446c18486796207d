// SPDX-License-Identifier: MIT
/// @file
/// @brief The way a robot would go home by, known at any time.
#pragma once

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/motion/low_level_planner.hpp>
#include <surfleet/motion/path.hpp>

namespace surfleet {
/// A path from the robot to its home through space that is known to be free.
///
/// It grows behind the robot as it moves and is pulled taut where the map lets it. Where the map
/// has closed it, another takes its place; if there is none, it stays as it was flown, as what was
/// flown through was free.
class WayHome {
 public:
  explicit WayHome(const Point3& home) : points_{home} {}

  const std::vector<Point3>& points() const { return points_; }  ///< The robot's place first.
  double length() const { return polyline_length(points_); }     ///< [m]

  void moved_to(const Point3& position) {
    if (position != points_.front()) points_.insert(points_.begin(), position);
  }
  /// Follows the map and the robot; to be called after either has changed. O(length), and a query
  /// where the way is closed.
  void update(const LazyPrmStar& roadmap) {
    while (points_.size() > 2) {
      const std::array<Point3, 2> past{points_[0], points_[2]};
      if (closed_(roadmap.space(), past, 0.0)) break;
      points_.erase(points_.begin() + 1);
    }
    if (is_open(roadmap.space())) return;
    if (auto path = roadmap.query(points_.front(), points_.back()))
      points_ = std::move(path->points);
  }
  /// Takes the roadmap's path if that is shorter.
  void shorten(const LazyPrmStar& roadmap) {
    auto path = roadmap.query(points_.front(), points_.back());
    if (path && path->length < length()) points_ = std::move(path->points);
  }
  /// Whether nothing that the map shows lies in it.
  bool is_open(const FreeSpace& free) const { return !closed_(free, points_, 0.0); }

 private:
  /// As a robot in flight has it, with regard to all of the way.
  ObstacleCheck closed_{.lookahead = std::numeric_limits<double>::infinity()};
  std::vector<Point3> points_;
};
}  // namespace surfleet
