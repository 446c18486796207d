// SPDX-License-Identifier: MIT
/// @file
/// @brief Maps whose voxels are given their states by hand.
#pragma once

#include <cstdint>

#include <surfleet/mapping/tsdf_map.hpp>

namespace map_test {
using namespace surfleet;

inline void set_state(TsdfMap& map, const VoxelIndex& v, VoxelState s) {
  const std::uint32_t slot = map.ensure_slot(TsdfMap::block_of(v));
  map.block(slot).voxels[TsdfMap::offset_of(v)] = {s == VoxelState::empty ? 0.5F : -0.5F,
                                                   s == VoxelState::unknown ? 0.1F : 1.0F};
  map.mark_changed(slot);
}

/// Gives every voxel of [low, high] the state that `fn(voxel)` says.
template <typename Fn>
void paint(TsdfMap& map, const VoxelIndex& low, const VoxelIndex& high, Fn&& fn) {
  for_each_index(low, high, [&](const VoxelIndex& v) { set_state(map, v, fn(v)); });
}
}  // namespace map_test
