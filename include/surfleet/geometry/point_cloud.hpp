// SPDX-License-Identifier: MIT
/// @file
/// @brief The library's one point cloud.
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

/// The points in `box`, with their attributes.
inline PointCloud cropped(const PointCloud& cloud, const Box3& box) {
  PointCloud part;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!box.contains(cloud.points[i])) continue;
    part.points.push_back(cloud.points[i]);
    if (cloud.normals.size() == cloud.size()) part.normals.push_back(cloud.normals[i]);
    if (cloud.colors.size() == cloud.size()) part.colors.push_back(cloud.colors[i]);
  }
  return part;
}
}  // namespace surfleet
