// SPDX-License-Identifier: MIT
/// @file
/// @brief The borders of a mesh: one for every opening, and for every end of an open surface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// The vertices of each border that hangs together, ascending; borders by their least vertex. Two
/// that touch at a vertex are one. O(n log n).
inline std::vector<std::vector<std::int32_t>> mesh_borders(const TriangleMesh& mesh) {
  const MeshAdjacency adjacency(mesh);
  DisjointSets sets(mesh.vertices.size());
  std::vector<std::int32_t> on;
  for (const std::int32_t e : adjacency.boundary_edges()) {
    const auto& v = adjacency.edges()[static_cast<std::size_t>(e)].vertices;
    sets.unite(v[0], v[1]);
    on.insert(on.end(), {v[0], v[1]});
  }
  std::sort(on.begin(), on.end());
  on.erase(std::unique(on.begin(), on.end()), on.end());
  std::vector<std::vector<std::int32_t>> borders;
  std::vector<std::int32_t> number(mesh.vertices.size(), -1);
  for (const std::int32_t v : on) {
    auto& n = number[static_cast<std::size_t>(sets.find(v))];
    if (n < 0) {
      n = static_cast<std::int32_t>(borders.size());
      borders.emplace_back();
    }
    borders[static_cast<std::size_t>(n)].push_back(v);
  }
  return borders;
}
}  // namespace surfleet
