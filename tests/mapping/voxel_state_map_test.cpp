// SPDX-License-Identifier: MIT
#include <surfleet/mapping/voxel_state_map.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

TEST(states_follow_weight_and_sign) {
  CHECK(voxel_state({0.1F, 0.0F}, 0.3F) == VoxelState::unknown);
  CHECK(voxel_state({0.1F, 0.29F}, 0.3F) == VoxelState::unknown);
  CHECK(voxel_state({0.1F, 0.3F}, 0.3F) == VoxelState::empty);
  CHECK(voxel_state({0.0F, 1.0F}, 0.3F) == VoxelState::occupied);
  CHECK(voxel_state({-0.1F, 1.0F}, 0.3F) == VoxelState::occupied);
}

TEST(incremental_equals_the_definition_everywhere) {
  Random random(6);
  TsdfMap map({.voxel_size = 0.3});
  VoxelStateMap states(map, {.known_weight = 0.3});
  CHECK(states.voxel_size() == 0.3 && states.grid().empty());
  for (int round = 0; round < 40; ++round) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t slot = map.ensure_slot(
          {static_cast<int>(random.below(5)) - 2, static_cast<int>(random.below(3)) - 1, -1});
      if (round % 4 != 0)
        for (TsdfVoxel& v : map.block(slot).voxels)
          v = {static_cast<float>(random.uniform(-1, 1)), static_cast<float>(random.uniform())};
      map.mark_changed(slot);
    }
    states.update(map);
    auto accessor = states.accessor();
    for (int z = -9; z < 1; ++z)
      for (int y = -9; y < 17; ++y)
        for (int x = -17; x < 25; ++x) {
          const TsdfVoxel* v = map.find({x, y, z});
          const VoxelState expected = v == nullptr ? VoxelState::unknown : voxel_state(*v, 0.3F);
          CHECK(states({x, y, z}) == expected);
          CHECK(accessor({x, y, z}) == expected);
          CHECK(states.at(map.center({x, y, z})) == expected);
        }
  }
}

TEST(only_real_changes_are_passed_on) {
  TsdfMap map;
  const std::uint32_t slot = map.ensure_slot({0, 0, 0});
  map.mark_changed(slot);
  VoxelStateMap states(map);
  CHECK(states.grid().empty());  // nothing known: nothing made
  map.block(slot).voxels[7] = {0.2F, 5.0F};
  map.mark_changed(slot);
  CHECK(states.update(map) == 1);
  const auto cursor = states.grid().revision();
  map.block(slot).voxels[7] = {0.1F, 9.0F};
  map.mark_changed(slot);
  CHECK(states.update(map) == 0 && states.grid().changed_since(cursor).empty());
  map.block(slot).voxels[7] = {-0.1F, 9.0F};
  map.mark_changed(slot);
  CHECK(states.update(map) == 1 && states.grid().changed_since(cursor).size() == 1);
}
