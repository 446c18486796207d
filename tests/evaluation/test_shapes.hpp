// SPDX-License-Identifier: MIT
/// @file
/// @brief Meshes with closed forms for the tests of this room.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include <surfleet/geometry/triangle_mesh.hpp>

namespace test_shapes {
using surfleet::Point3;
using surfleet::TriangleMesh;

/// A square of the given side around the z axis at height z, facing up, in n × n cells.
inline TriangleMesh plane(double side, int n, double z) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      mesh.vertices.emplace_back(side * (static_cast<double>(i) / n - 0.5),
                                 side * (static_cast<double>(j) / n - 0.5), z);
  const auto at = [n](int i, int j) { return static_cast<std::int32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// A sphere around the origin: an octahedron subdivided `levels` times.
inline TriangleMesh sphere(double radius, int levels) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [it, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                   static_cast<std::int32_t>(mesh.vertices.size()));
      if (fresh)
        mesh.vertices.push_back((mesh.vertices[static_cast<std::size_t>(a)] +
                                 mesh.vertices[static_cast<std::size_t>(b)])
                                    .normalized());
      return it->second;
    };
    std::vector<surfleet::Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Point3& v : mesh.vertices) v *= radius;
  return mesh;
}

/// An axis-aligned box; facing inwards if asked.
inline TriangleMesh box(const Point3& low, const Point3& high, bool inward = false) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.emplace_back((k & 1) != 0 ? high.x() : low.x(), (k & 2) != 0 ? high.y() : low.y(),
                               (k & 4) != 0 ? high.z() : low.z());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  if (inward)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}
}  // namespace test_shapes
