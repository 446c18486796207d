// SPDX-License-Identifier: MIT
/// @file
/// @brief Maps made by hand for the tests of this room.
#pragma once

#include <cmath>
#include <vector>

#include "paint_states.hpp"

#include <surfleet/core/random.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>

namespace view_test {
using namespace surfleet;
using namespace map_test;

inline std::vector<IncompleteElement> elements_of(const TsdfMap& map) {
  IncompleteSurface incomplete;
  incomplete.update(map);
  return incomplete.elements();
}

/// Occupied below `floor`, empty from there up to `top`, within ±`half` voxels; unknown elsewhere.
inline TsdfMap floor_scene(int half, int top, double voxel_size = 0.25) {
  TsdfMap map({.voxel_size = voxel_size});
  paint(map, {-half, -half, -3}, {half, half, top},
        [](const VoxelIndex& v) { return v.z() < 0 ? VoxelState::occupied : VoxelState::empty; });
  return map;
}

/// A wall seen from +x: occupied for x in [−3, −1], empty from 0 to `depth`, |y| and |z| ≤ `half`.
inline TsdfMap wall_scene(int half, int depth, double voxel_size = 0.25) {
  TsdfMap map({.voxel_size = voxel_size});
  paint(map, {-3, -half, -half}, {depth, half, half},
        [](const VoxelIndex& v) { return v.x() < 0 ? VoxelState::occupied : VoxelState::empty; });
  return map;
}
}  // namespace view_test
