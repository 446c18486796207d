// SPDX-License-Identifier: MIT
/// @file
/// @brief A triangle soup made a surface: vertices joined, triangles without area or twice dropped.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/geometry/graph_components.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// What `clean_surface` met.
struct SurfaceDefects {
  std::size_t removed_vertices = 0;   ///< At the very place of another, or without a triangle.
  std::size_t removed_triangles = 0;  ///< Without an area, or on the vertices of another.
  std::size_t nonmanifold_edges = 0;  ///< Kept: edges of three or more triangles.
  std::size_t components = 0;
};

/// A surface fit for coverage: vertices at one place merged, so that a soup becomes connected;
/// triangles without area or said twice dropped, vertices without triangles too. Throws `Error`
/// where nothing is left or the mesh is not valid. O(n log n).
inline TriangleMesh clean_surface(const TriangleMesh& mesh, SurfaceDefects* defects = nullptr) {
  require_valid_surface(mesh);
  TriangleMesh clean = weld_vertices(mesh);
  std::set<Triangle> met;
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < clean.triangles.size(); ++t) {
    Triangle key = clean.triangles[t];
    std::sort(key.begin(), key.end());
    double scale = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      scale = std::max(scale, (clean.corner(t, k) - clean.corner(t, (k + 1) % 3)).squaredNorm());
    if (clean.area_vector(t).norm() > 1e-12 * scale && met.insert(key).second)
      kept.push_back(clean.triangles[t]);
  }
  require(!kept.empty(), "mesh: no triangle with an area; expected a surface");
  const bool dropped = kept.size() != clean.triangles.size();
  clean.triangles = std::move(kept);
  if (dropped) clean = weld_vertices(clean);  // drops the vertices that are now without triangle
  if (defects != nullptr) {
    const MeshAdjacency adjacency(clean);
    *defects = {mesh.vertices.size() - clean.vertices.size(),
                mesh.triangles.size() - clean.triangles.size(),
                adjacency.non_manifold_edges().size(), 0};
    for (const std::int32_t c : connected_components(EdgeGeodesic{}(clean, EuclideanMetric{})))
      defects->components = std::max(defects->components, static_cast<std::size_t>(c) + 1);
  }
  return clean;
}
}  // namespace surfleet
