// SPDX-License-Identifier: MIT
/// @file  The library's one point cloud.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// Points with optional attributes; an attribute is empty or has one entry a point.
struct PointCloud {
  std::vector<Point3> points;                       ///< [m].
  std::vector<Eigen::Vector3f> normals;             ///< Unit length.
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< sRGB.
  std::size_t size() const { return points.size(); }
};
}  // namespace surfleet
