// SPDX-License-Identifier: MIT
/// @file
/// @brief The library's one triangle mesh: an indexed face set with optional attributes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// Three vertex indices, anticlockwise seen from outside.
using Triangle = std::array<std::int32_t, 3>;

/// An indexed triangle set. Any soup is a valid value: open, non-manifold, degenerate or empty.
///
/// Attributes are empty or have one entry a vertex.
struct TriangleMesh {
  std::vector<Point3> vertices;                     ///< World frame [m].
  std::vector<Triangle> triangles;                  ///< Indices into `vertices`.
  std::vector<Eigen::Vector3f> normals;             ///< Unit length, outward.
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< sRGB.

  bool empty() const { return triangles.empty(); }
  /// Adds a polygon of these vertices, as a fan of triangles around the first.
  void add_fan(std::span<const std::int32_t> polygon) {
    for (std::size_t k = 2; k < polygon.size(); ++k)
      triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
  }
  const Point3& corner(std::size_t triangle, std::size_t k) const {
    return vertices[static_cast<std::size_t>(triangles[triangle][k])];
  }
  Point3 centroid(std::size_t triangle) const {
    return (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3.0;
  }
  /// Twice the area times the unit normal.
  Eigen::Vector3d area_vector(std::size_t triangle) const {
    const Point3& a = corner(triangle, 0);
    return (corner(triangle, 1) - a).cross(corner(triangle, 2) - a);
  }
  double area(std::size_t triangle) const { return 0.5 * area_vector(triangle).norm(); }
  double area() const {
    double sum = 0.0;
    for (std::size_t t = 0; t < triangles.size(); ++t) sum += area(t);
    return sum;
  }
  Box3 bounds() const {
    Box3 box;
    for (const Point3& v : vertices) box.extend(v);
    return box;
  }
};

/// Appends `part` to `mesh`. Attributes survive where both meshes have them.
inline void append(TriangleMesh& mesh, const TriangleMesh& part) {
  const auto base = static_cast<std::int32_t>(mesh.vertices.size());
  const auto merge = [&](auto& into, const auto& from) {
    const bool keep = into.size() == mesh.vertices.size() && from.size() == part.vertices.size();
    if (keep)
      into.insert(into.end(), from.begin(), from.end());
    else
      into.clear();
  };
  merge(mesh.normals, part.normals);
  merge(mesh.colors, part.colors);
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const Triangle& t : part.triangles)
    mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

/// The triangles that `keep(triangle)` is true of, with the vertices they use and their attributes.
template <typename Keep>
TriangleMesh selected(const TriangleMesh& mesh, Keep&& keep) {
  TriangleMesh part;
  std::vector<std::int32_t> renamed(mesh.vertices.size(), -1);
  const bool has_normals = mesh.normals.size() == mesh.vertices.size();
  const bool has_colors = mesh.colors.size() == mesh.vertices.size();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!keep(t)) continue;
    Triangle kept;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(mesh.triangles[t][k]);
      if (renamed[v] < 0) {
        renamed[v] = static_cast<std::int32_t>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[v]);
        if (has_normals) part.normals.push_back(mesh.normals[v]);
        if (has_colors) part.colors.push_back(mesh.colors[v]);
      }
      kept[k] = renamed[v];
    }
    part.triangles.push_back(kept);
  }
  return part;
}

/// The triangles whose centroid lies in `box`, with the vertices they use and their attributes.
inline TriangleMesh cropped(const TriangleMesh& mesh, const Box3& box) {
  return selected(mesh, [&](std::size_t t) { return box.contains(mesh.centroid(t)); });
}

/// Area-weighted vertex normals; zero at a vertex that belongs to no proper triangle.
inline std::vector<Eigen::Vector3f> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> sum(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t v : mesh.triangles[t])
      sum[static_cast<std::size_t>(v)] += mesh.area_vector(t);
  std::vector<Eigen::Vector3f> normals(sum.size());
  for (std::size_t i = 0; i < sum.size(); ++i) normals[i] = sum[i].stableNormalized().cast<float>();
  return normals;
}
}  // namespace surfleet
