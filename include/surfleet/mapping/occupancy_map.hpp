// SPDX-License-Identifier: MIT
/// @file
/// @brief How likely voxels are occupied, and the states that makes of them.
#pragma once

#include <algorithm>
#include <cstddef>

#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>

namespace surfleet {
struct OccupancyVoxel {
  float log_odds = 0.0F;  ///< Of being occupied.
  bool observed = false;  ///< Whether a ray ever passed or ended here.
};
using OccupancyMap = VoxelGrid<OccupancyVoxel, TsdfMap::kBlockSide>;

/// Occupied from even odds on, else empty; unknown where no ray ever was. The settings are those of
/// distances and change nothing here.
inline BlockStates block_states(const OccupancyMap::Block& block, const VoxelStateOptions&) {
  BlockStates states;
  states.index = block.index;
  std::transform(block.voxels.begin(), block.voxels.end(), states.voxels.begin(),
                 [](const OccupancyVoxel& v) {
                   if (!v.observed) return VoxelState::unknown;
                   return v.log_odds >= 0.0F ? VoxelState::occupied : VoxelState::empty;
                 });
  return states;
}
static_assert(VoxelStateSource<OccupancyMap>);
}  // namespace surfleet
