// SPDX-License-Identifier: MIT
/// @file
/// @brief Test structures for climbing robots: the mock-up of [004 §2.1.2], an L of two plates, a
/// tube with a hole [004 Fig. 8.11].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
namespace detail {
inline int cells(double length, double edge) {
  return std::max(1, static_cast<int>(std::ceil(length / edge - 1e-9)));
}
/// A surface of revolution about the x axis over a profile of (x, radius), in `around` columns,
/// normals away from the axis where x grows. Neighbouring points of the profile are ring by ring.
inline TriangleMesh revolved(const std::vector<Point2>& profile, int around) {
  TriangleMesh mesh;
  for (const Point2& p : profile)
    for (int j = 0; j < around; ++j) {
      const double a = 2.0 * kPi * j / around;
      mesh.vertices.push_back({p.x(), p.y() * std::cos(a), p.y() * std::sin(a)});
    }
  for (int i = 0; i + 1 < static_cast<int>(profile.size()); ++i)
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j, b = i * around + (j + 1) % around;
      mesh.triangles.push_back({a, b, a + around});
      mesh.triangles.push_back({b, b + around, a + around});
    }
  return mesh;
}
/// The profile with points at most `edge` apart.
inline std::vector<Point2> refined(const std::vector<Point2>& corners, double edge) {
  std::vector<Point2> profile{corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Point2 step = corners[i] - corners[i - 1];
    const int parts = cells(step.norm(), edge);
    for (int k = 1; k <= parts; ++k) profile.push_back(corners[i - 1] + step * k / parts);
  }
  return profile;
}
}  // namespace detail

/// Two plates of `length` × `width` [m] at a right angle, their crease along y through the origin,
/// in cells of at most `edge`; normals on the convex side.
inline TriangleMesh l_shape(double edge = 0.05, double length = 0.8, double width = 1.0) {
  require(edge > 0.0 && length >= edge && width >= edge,
          "L shape: expected an edge of more than 0 m and at most its sides");
  const int along = detail::cells(length, edge), across = detail::cells(width, edge);
  TriangleMesh mesh;
  for (int i = -along; i <= along; ++i)  // down the upright plate, then along the level one
    for (int j = 0; j <= across; ++j) {
      const double s = length * i / along, y = width * j / across - 0.5 * width;
      mesh.vertices.push_back(i <= 0 ? Point3(0.0, y, s) : Point3(s, y, 0.0));
    }
  for (int i = 0; i < 2 * along; ++i)
    for (int j = 0; j < across; ++j) {
      const int a = i * (across + 1) + j;
      mesh.triangles.push_back({a, a + across + 1, a + 1});
      mesh.triangles.push_back({a + 1, a + across + 1, a + across + 2});
    }
  return mesh;
}

struct HoledTubeOptions {
  double edge = 0.05;         ///< [m]
  double radius = 0.35;       ///< [m]
  double length = 1.6;        ///< [m]
  double hole_radius = 0.15;  ///< On the wall, about the top of the middle; 0 for none [m].
};

/// An open tube along x with a round hole in its top; normals outward. The hole's rim follows the
/// triangles.
inline TriangleMesh holed_tube(const HoledTubeOptions& options = {}) {
  require(options.edge > 0.0 && options.radius > options.edge && options.length > options.edge &&
              options.hole_radius >= 0.0,
          "tube: expected sizes of more than 0 m, greater than the edge");
  const double half = 0.5 * options.length;
  const int around = std::max(8, detail::cells(2.0 * kPi * options.radius, options.edge));
  const TriangleMesh whole = detail::revolved(
      detail::refined({{-half, options.radius}, {half, options.radius}}, options.edge), around);
  return selected(whole, [&](std::size_t t) {
    const Point3 c = whole.centroid(t);
    return std::hypot(c.x(), options.radius * std::atan2(c.y(), c.z())) >= options.hole_radius;
  });
}

/// The mock-up: a tube Ø 0.8 × 1.9 m along x from the origin, a section Ø 1 × 0.5 m after it, a
/// branch Ø 0.4 m that ends 0.6 m from the wall of the tube, upward from x = 0.95 m. Both ends and
/// the branch are open, and so is the passage from one to the other; edges are sharp. Normals
/// outward.
inline TriangleMesh mock_up(double edge = 0.05) {
  require(edge >= 0.005 && edge <= 0.1, "mock-up: expected an edge of 0.005 to 0.1 m");
  constexpr double kRadius = 0.4, kBranch = 0.2, kAt = 0.95, kEnd = kRadius + 0.6;
  const int around = detail::cells(2.0 * kPi * kRadius, edge);
  TriangleMesh body = detail::revolved(
      detail::refined({{0.0, kRadius}, {1.9, kRadius}, {1.9, 0.5}, {2.4, 0.5}}, edge), around);
  // The wall is cut where the branch stands: cells whose middle lies inside go, and so does what is
  // left that would be drawn to a line, three of its vertices on the rim.
  const auto off_axis = [&](const Point3& p) {
    return p.z() > 0.0 ? std::hypot(p.x() - kAt, p.y()) : 1e9;
  };
  body = selected(body, [&](std::size_t t) { return off_axis(body.centroid(t)) >= kBranch; });
  const auto on_rim = [&](const TriangleMesh& mesh) {
    std::vector<std::uint8_t> marked(mesh.vertices.size(), 0);
    const MeshAdjacency adjacency(mesh);
    for (const std::int32_t e : adjacency.boundary_edges())
      for (const std::int32_t v : adjacency.edges()[static_cast<std::size_t>(e)].vertices)
        if (off_axis(mesh.vertices[static_cast<std::size_t>(v)]) < kBranch + 2.0 * edge)
          marked[static_cast<std::size_t>(v)] = 1;
    return marked;
  };
  for (bool drawn = true; drawn;) {
    const std::vector<std::uint8_t> marked = on_rim(body);
    const std::size_t before = body.triangles.size();
    body = selected(body, [&](std::size_t t) {
      const Triangle& v = body.triangles[t];
      return marked[static_cast<std::size_t>(v[0])] == 0 ||
             marked[static_cast<std::size_t>(v[1])] == 0 ||
             marked[static_cast<std::size_t>(v[2])] == 0;
    });
    drawn = body.triangles.size() < before;
  }
  // The branch rises from the rim that is left, vertex by vertex.
  std::vector<std::pair<double, std::int32_t>> rim;  // by bearing
  const std::vector<std::uint8_t> marked = on_rim(body);
  for (std::size_t v = 0; v < marked.size(); ++v)
    if (marked[v] != 0)
      rim.emplace_back(std::atan2(body.vertices[v].y(), body.vertices[v].x() - kAt),
                       static_cast<std::int32_t>(v));
  std::sort(rim.begin(), rim.end());
  for (const auto& [bearing, v] : rim) {  // onto the junction
    const double x = kAt + kBranch * std::cos(bearing), y = kBranch * std::sin(bearing);
    body.vertices[static_cast<std::size_t>(v)] = {x, y, std::sqrt(kRadius * kRadius - y * y)};
  }
  const int rows = detail::cells(0.6, edge);
  const auto columns = static_cast<std::int32_t>(rim.size());
  const auto base = static_cast<std::int32_t>(body.vertices.size());
  for (int i = 1; i <= rows; ++i)
    for (const auto& [bearing, v] : rim) {
      const Point3 bottom = body.vertices[static_cast<std::size_t>(v)];
      body.vertices.push_back(
          {bottom.x(), bottom.y(), bottom.z() + (kEnd - bottom.z()) * i / rows});
    }
  const auto at = [&](int row, std::int32_t column) {
    const std::int32_t c = column % columns;
    return row == 0 ? rim[static_cast<std::size_t>(c)].second : base + (row - 1) * columns + c;
  };
  for (int i = 0; i < rows; ++i)
    for (std::int32_t j = 0; j < columns; ++j) {
      body.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      body.triangles.push_back({at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
    }
  return body;
}
}  // namespace surfleet
