// SPDX-License-Identifier: MIT
/// @file
/// @brief The map that a perfect survey of a known mesh would give.
#pragma once

#include <cmath>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet {
/// Every voxel that meets `bounds` is known, with weight 1: occupied if its centre is within half a
/// diagonal of the mesh, so that every voxel the surface touches is, else empty.
///
/// Solids are hollow: their insides are empty but cannot be reached. O(blocks + voxels near the
/// surface · log triangles). Throws `Error` on empty bounds or more than 2^24 blocks.
inline TsdfMap map_from_mesh(const Bvh& mesh, const Box3& bounds, double voxel_size) {
  require(!bounds.isEmpty() && bounds.sizes().allFinite(), "map of a mesh: expected a finite box");
  TsdfMap map({.voxel_size = voxel_size});
  const BlockIndex low = TsdfMap::block_of(map.index_of(bounds.min()));
  const BlockIndex high = TsdfMap::block_of(map.index_of(bounds.max()));
  const Eigen::Vector3d count = (high - low).cast<double>() + Eigen::Vector3d::Ones();
  require(count.prod() <= 1 << 24, "map of a mesh: expected larger voxels or a smaller box");
  const double half_diagonal = 0.5 * std::sqrt(3.0) * voxel_size;
  const double block_reach = half_diagonal * (TsdfMap::kBlockSide + 1);
  for_each_index(low, high, [&](const VoxelIndex& b) {
    const std::uint32_t slot = map.ensure_slot(b);
    TsdfMap::Block& block = map.block(slot);
    const Point3 center =
        (block.origin().cast<double>() + Eigen::Vector3d::Constant(0.5 * TsdfMap::kBlockSide)) *
        voxel_size;
    const bool near = mesh.closest_point(center, block_reach).has_value();
    for (std::size_t i = 0; i < TsdfMap::kBlockVoxels; ++i) {
      const Point3 p = map.center(TsdfMap::index_in(block, i));
      const bool touched = near && mesh.closest_point(p, half_diagonal).has_value();
      block.voxels[i] = {static_cast<float>(touched ? -voxel_size : voxel_size), 1.0F};
    }
    map.mark_changed(slot);
  });
  return map;
}
}  // namespace surfleet
