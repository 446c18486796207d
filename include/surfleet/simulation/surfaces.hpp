// SPDX-License-Identifier: MIT
/// @file
/// @brief The bundled bumpy slope of [004 §2.1.2]. Spheres and tori are in
/// geometry/mesh_primitives.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
struct BumpySlopeOptions {
  double edge = 0.05;        ///< Edge length on the ground plan [m].
  double size = 1.2;         ///< Side of the square base [m].
  bool hole = false;         ///< Cuts the middle out.
  double hole_radius = 0.3;  ///< [m]
};

/// A tilted plate with three bumps and a hollow over a square base; near-equilateral triangles.
inline TriangleMesh bumpy_slope(const BumpySlopeOptions& options = {}) {
  require(options.edge > 0.0 && options.size >= 2.0 * options.edge && options.edge >= 1e-3,
          "bumpy slope: edge must be at least 1 mm and at most half the size");
  const auto columns = static_cast<std::int32_t>(std::lround(options.size / options.edge));
  const auto rows = static_cast<std::int32_t>(
      std::max(1L, std::lround(options.size / (options.edge * std::sqrt(0.75)))));
  const double s = options.size;
  const auto height = [&](double x, double y) {
    const auto bump = [&](double cx, double cy, double h, double r) {
      const double dx = x / s - cx, dy = y / s - cy;
      return h * s * std::exp(-(dx * dx + dy * dy) / (2.0 * r * r));
    };
    return 0.25 * x + bump(0.3, 0.35, 0.16, 0.11) + bump(0.72, 0.68, 0.20, 0.13) +
           bump(0.75, 0.2, 0.1, 0.09) - bump(0.25, 0.8, 0.12, 0.12);
  };
  TriangleMesh mesh;
  std::vector<std::int32_t> first;
  for (std::int32_t j = 0; j <= rows; ++j) {
    first.push_back(static_cast<std::int32_t>(mesh.vertices.size()));
    const double y = s * j / rows;
    const std::int32_t count = columns + 1 + j % 2;  // odd rows are shifted by half an edge
    for (std::int32_t i = 0; i < count; ++i) {
      const double at = j % 2 == 0 ? i : std::min(std::max(i - 0.5, 0.0), double(columns));
      const double x = s * at / columns;
      mesh.vertices.push_back({x, y, height(x, y)});
    }
  }
  for (std::int32_t j = 0; j < rows; ++j) {
    const bool even = j % 2 == 0;
    const std::int32_t narrow =
        even ? first[static_cast<std::size_t>(j)] : first[static_cast<std::size_t>(j) + 1];
    const std::int32_t wide =
        even ? first[static_cast<std::size_t>(j) + 1] : first[static_cast<std::size_t>(j)];
    const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
      mesh.triangles.push_back(even ? Triangle{a, b, c} : Triangle{a, c, b});
    };
    for (std::int32_t i = 0; i <= columns; ++i) {
      add(narrow + i, wide + i + 1, wide + i);
      if (i < columns) add(narrow + i, narrow + i + 1, wide + i + 1);
    }
  }
  if (!options.hole) return mesh;
  return selected(mesh, [&](std::size_t t) {
    const Point3 c = mesh.centroid(t);
    return std::hypot(c.x() - s / 2, c.y() - s / 2) >= options.hole_radius;
  });
}
}  // namespace surfleet
