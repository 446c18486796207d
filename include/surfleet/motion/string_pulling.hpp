// SPDX-License-Identifier: MIT
/// @file
/// @brief String pulling: a short path by places that need not be met exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// The vertices of a short path from `start` that passes within `slack` [m] of each place in order:
/// as a string through rings, pulled tight.
///
/// In every sweep each vertex moves to where its ball comes nearest to the straight line between
/// its neighbours, the last one towards the one before it. Obstacles are not considered.
/// O(places · sweeps). Throws `Error` if `slack` is negative or not finite.
inline std::vector<Point3> pulled_string(const Point3& start, std::span<const Point3> places,
                                         double slack, int sweeps = 20) {
  require(slack >= 0.0 && std::isfinite(slack), "slack of a path: expected 0 m or more");
  std::vector<Point3> path(places.begin(), places.end());
  for (int sweep = 0; sweep < sweeps && slack > 0.0; ++sweep)
    for (std::size_t k = 0; k < path.size(); ++k) {
      const Point3& before = k == 0 ? start : path[k - 1];
      Point3 nearest = before;
      if (k + 1 < path.size()) {
        const Eigen::Vector3d line = path[k + 1] - before;
        const double squared = line.squaredNorm();
        const double along = squared > 0.0 ? (places[k] - before).dot(line) / squared : 0.0;
        nearest = before + std::clamp(along, 0.0, 1.0) * line;
      }
      const Eigen::Vector3d off = nearest - places[k];
      const double distance = off.norm();
      path[k] = distance > slack ? Point3(places[k] + off * (slack / distance)) : nearest;
    }
  return path;
}
}  // namespace surfleet
