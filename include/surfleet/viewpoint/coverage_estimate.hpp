// SPDX-License-Identifier: MIT
/// @file
/// @brief How complete a reconstruction is by its own account, without the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/mapping/surface_mesh.hpp>
#include <surfleet/mapping/surface_points.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>

namespace surfleet {
/// Areas of one side of the surface [m²].
struct CoverageEstimate {
  double mesh = 0.0;      ///< What would be handed over.
  double unmeshed = 0.0;  ///< Where rays ended and the mesh is not: a voxel's face each.
  double open = 0.0;      ///< Open faces of incomplete elements: one each.

  /// Share of the surface met or expected that the mesh holds; 0 before anything was met.
  double share() const {
    const double all = mesh + unmeshed + open;
    return all > 0.0 ? mesh / all : 0.0;
  }
};

/// Weighs `mesh`, as extracted from `map` at W_th `known_weight`, against what it lacks: hits
/// inside `region` (empty: everywhere) with no triangle of their side within a voxel, and
/// `incomplete` elements. A hit counts once it is a glimpse, a sixteenth of what makes it known;
/// more hits of one side in a voxel's neighbourhood are noise of the same surface, so that each
/// voxel counts once for the side its hits weigh most on. O(hits + triangles).
inline CoverageEstimate estimate_coverage(const TsdfMap& map, const TriangleMesh& mesh,
                                          const IncompleteSurface& incomplete, double known_weight,
                                          const Box3& region = {}) {
  constexpr double kGlimpse = 1.0 / 16.0;
  constexpr double kOpposite = -0.5;  // cosine of normals below which sides are two
  const double h = map.voxel_size();
  CoverageEstimate e;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (region.isEmpty() || region.contains(mesh.centroid(t))) e.mesh += mesh.area(t);
  e.open = static_cast<double>(incomplete.size()) * h * h;
  const detail::TriangleCells cells(mesh, h);
  map.for_each_block([&](const TsdfMap::Block& block) {
    const auto hits = block.layer.hits();
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const SurfaceHit& hit = hits[i];
      const Eigen::Vector3d normal = hit.mean_normal();
      if (!hit.is_solid(kGlimpse * known_weight)) continue;
      bool own_side = true;
      for (const SurfaceHit& other : block.layer.of_voxel(hit.voxel()))
        if (other.weight > hit.weight || (other.weight == hit.weight && other.key < hit.key))
          own_side = own_side && other.mean_normal().dot(normal) < kOpposite;
      if (!own_side) continue;
      const VoxelIndex v = TsdfMap::index_in(block, hit.voxel());
      const Point3 p = map.center(v) + hit.mean_offset(h);
      if (!region.isEmpty() && !region.contains(p)) continue;
      // What an element stands for is counted there.
      if (incomplete.contains(v)) continue;
      if (!cells.near(p, normal, 0.999 * h)) e.unmeshed += h * h;
    }
  });
  return e;
}
}  // namespace surfleet
