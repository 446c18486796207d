// SPDX-License-Identifier: MIT
/// @file
/// @brief A path in space as a polyline, and how to shorten one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// Length of a polyline [m].
inline double polyline_length(std::span<const Point3> points) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

/// A polyline from start to goal.
struct Path {
  std::vector<Point3> points;
  double length = 0.0;  ///< [m]

  Path() = default;
  explicit Path(std::vector<Point3> p) : points(std::move(p)), length(polyline_length(points)) {}
  bool empty() const { return points.empty(); }
};
}  // namespace surfleet
