// SPDX-License-Identifier: MIT
/// @file
/// @brief Paths that keep clear of teammates that stand.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/triangle_queries.hpp>
#include <surfleet/motion/path.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
namespace detail {
/// The first of `standing` that a path passes within `apart` of; its end if it passes none.
inline std::size_t first_beside(std::span<const Point3> path, std::span<const Point3> standing,
                                double apart) {
  for (std::size_t i = 1; i < path.size(); ++i)
    for (std::size_t k = 0; k < standing.size(); ++k)
      if ((closest_on_segment(standing[k], path[i - 1], path[i]) - standing[k]).norm() < apart)
        return k;
  return standing.size();
}
}  // namespace detail

/// The roadmap's path from one place to another, or one around the places of `standing` mates that
/// it would pass within `apart` of [m], over a place beside each; the roadmap's where there is none
/// around them. Mates within that of either end are passed as they are. Nothing if there is no path
/// at all. O(48 queries for each mate passed).
inline std::optional<Path> path_around(const KindSpace& space, const Point3& from, const Point3& to,
                                       std::span<const Point3> standing, double apart) {
  constexpr int kSides = 8, kRings = 3;
  std::vector<Point3> obstacles;
  for (const Point3& mate : standing)
    if (std::min((mate - from).norm(), (mate - to).norm()) >= apart) obstacles.push_back(mate);
  const std::optional<Path> straight = space.roadmap.query(from, to);
  std::optional<Path> path = straight;
  Path clear;  // up to where `path` begins
  const auto add = [&clear](const Path& next) {
    clear.length += next.length;
    clear.points.insert(clear.points.end(), next.points.begin() + (clear.empty() ? 0 : 1),
                        next.points.end());
  };
  for (std::size_t passed = 0; path; ++passed) {
    const std::size_t hit = detail::first_beside(path->points, obstacles, apart);
    if (hit == obstacles.size()) {
      add(*path);
      return clear;
    }
    if (passed == obstacles.size()) break;
    const Point3 here = path->points.front();
    const Eigen::Vector3d along = (path->points.back() - here).normalized();
    const Eigen::Vector3d u = along.unitOrthogonal(), v = along.cross(u);
    std::optional<Path> best, rest;
    for (int k = 0; k < kRings * kSides; ++k) {
      if (best && k % kSides == 0) break;  // a nearer ring has one
      // A robot that starts near a mate has to pass it farther out.
      const double turn = 2.0 * kPi * k / kSides, out = apart * (1.2 + 0.5 * (k / kSides));
      const Point3 beside = obstacles[hit] + out * (std::cos(turn) * u + std::sin(turn) * v);
      if (!space.free.is_free(beside)) continue;
      const auto there = space.roadmap.query(here, beside);
      if (!there || detail::first_beside(there->points, obstacles, apart) < obstacles.size())
        continue;
      const auto onward = space.roadmap.query(beside, to);
      if (!onward || (best && there->length + onward->length >= best->length + rest->length))
        continue;
      best = there;
      rest = onward;
    }
    if (!best) break;
    add(*best);
    path = rest;
  }
  return straight;
}
}  // namespace surfleet
