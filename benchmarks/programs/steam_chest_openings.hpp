// SPDX-License-Identifier: MIT
/// @file
/// @brief Whether a mesh of the steam chest has its openings.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/simulation/steam_chest.hpp>

namespace surfleet::benchmarks {
/// Openings of the steam chest with a border all round them, within 10 cm.
inline int steam_chest_openings(const TriangleMesh& mesh,
                                const std::vector<std::vector<std::int32_t>>& borders) {
  int open = 0;
  const auto count = [&](const Point3& at, const Eigen::Vector3d& axis, double radius) {
    for (const auto& border : borders) {
      std::vector<int> sectors(12, 0);
      const Eigen::Vector3d n = axis.normalized(), u = n.unitOrthogonal(), v = n.cross(u);
      for (const std::int32_t vertex : border) {
        const Eigen::Vector3d d = mesh.vertices[static_cast<std::size_t>(vertex)] - at;
        if (std::abs(d.dot(n)) > 0.1 || std::abs(std::hypot(d.dot(u), d.dot(v)) - radius) > 0.1)
          continue;
        const double turn = (std::atan2(d.dot(v), d.dot(u)) + kPi) / (2.0 * kPi);
        sectors[std::min<std::size_t>(11, static_cast<std::size_t>(12.0 * turn))] = 1;
      }
      if (std::count(sectors.begin(), sectors.end(), 1) == 12) {
        ++open;
        return;
      }
    }
  };
  for (const Tube& t : steam_chest_tubes()) {
    if (t.open_a) count(t.a, t.a - t.b, t.radius_a);
    if (t.open_b) count(t.b, t.b - t.a, t.radius_b);
  }
  return open;
}
}  // namespace surfleet::benchmarks
