// SPDX-License-Identifier: MIT
/// @file
/// @brief The voxel of a truncated signed distance field, and the map made of it.
#pragma once

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

/// What is known of a voxel [000 §2.4.1].
enum class VoxelState : std::uint8_t { unknown = 0, empty = 1, occupied = 2 };

/// Known from weight `known_weight` (W_th) on; then empty in front of the surface, else occupied.
inline VoxelState voxel_state(const TsdfVoxel& v, float known_weight) {
  // Without branches, so that loops over blocks become vector code.
  const int known = static_cast<int>(v.weight >= known_weight);
  return static_cast<VoxelState>(known * (2 - static_cast<int>(v.distance > 0.0F)));
}
}  // namespace surfleet
