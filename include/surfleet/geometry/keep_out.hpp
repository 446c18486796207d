// SPDX-License-Identifier: MIT
/// @file
/// @brief Boxes that no robot's body may enter.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// Space that is closed to robots and to nothing else: it blocks no view and holds no surface.
/// Axis-aligned boxes in the world frame [m]. O(boxes) a query.
struct KeepOut {
  std::vector<Box3> boxes;

  bool empty() const { return boxes.empty(); }
  /// Distance from `p` to the nearest box [m]: 0 inside one, infinite if there is none. A body that
  /// is a ball stays out where this is its radius or more.
  double distance(const Point3& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Box3& box : boxes) least = std::min(least, box.exteriorDistance(p));
    return least;
  }
};
}  // namespace surfleet
