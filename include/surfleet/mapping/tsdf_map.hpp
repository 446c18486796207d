// SPDX-License-Identifier: MIT
/// @file
/// @brief The voxel of a truncated signed distance field, and the map made of it.
#pragma once

#include <cstddef>
#include <cstdint>

#include <surfleet/mapping/surface_hits.hpp>
#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
/// Signed distance to the surface, positive in front of it, and how much was seen of it.
struct TsdfVoxel {
  float distance = 0.0F;  ///< In [−µ, µ] [m]; meaningless while the weight is zero.
  float weight = 0.0F;    ///< ≥ 0.
};

/// Distances, and beside them, where surface was met, the hits of either side.
using TsdfMap = VoxelGrid<TsdfVoxel, 8, SurfaceHits>;
static_assert(TsdfMap::kBlockVoxels <= SurfaceHits::kVoxels);

/// Whether two maps hold the same, every voxel and every hit; blocks that hold nothing do not
/// count. O(blocks).
inline bool equal_maps(const TsdfMap& a, const TsdfMap& b) {
  if (a.voxel_size() != b.voxel_size()) return false;
  static const TsdfMap::Block kNothing{};
  const auto covered = [](const TsdfMap& of, const TsdfMap& by) {
    bool equal = true;
    of.for_each_block([&](const TsdfMap::Block& x) {
      const TsdfMap::Block* y = by.find_block(x.index);
      if (y == nullptr) y = &kNothing;
      for (std::size_t i = 0; equal && i < x.voxels.size(); ++i)
        equal = x.voxels[i].weight == y->voxels[i].weight &&
                (x.voxels[i].weight == 0.0F || x.voxels[i].distance == y->voxels[i].distance);
      equal = equal && x.layer == y->layer;
    });
    return equal;
  };
  return covered(a, b) && covered(b, a);
}

/// What is known of a voxel [000 §2.4.1].
enum class VoxelState : std::uint8_t { unknown = 0, empty = 1, occupied = 2 };

/// Known from weight `known_weight` (W_th) on; then empty in front of the surface, else occupied.
inline VoxelState voxel_state(const TsdfVoxel& v, float known_weight) {
  // Without branches, so that loops over blocks become vector code.
  const int known = static_cast<int>(v.weight >= known_weight);
  return static_cast<VoxelState>(known * (2 - static_cast<int>(v.distance > 0.0F)));
}
}  // namespace surfleet
