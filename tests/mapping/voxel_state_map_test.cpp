// SPDX-License-Identifier: MIT
#include <surfleet/mapping/voxel_state_map.hpp>

#include <array>

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

TEST(clear_cubes_are_clear_and_as_large_as_they_can_be) {
  Random random(7);
  TsdfMap map({.voxel_size = 0.3});
  VoxelStateMap states(map, {.known_weight = 0.3});
  std::array<int, 9> found{};
  for (int round = 0; round < 30; ++round) {
    const std::uint32_t slot = map.ensure_slot(
        {static_cast<int>(random.below(3)) - 1, static_cast<int>(random.below(2)), 0});
    for (TsdfVoxel& v : map.block(slot).voxels) v = {0.5F, 1.0F};
    for (std::size_t k = random.below(4); k > 0; --k)  // few, so that cubes stay clear
      map.block(slot).voxels[random.below(512)] =
          random.below(2) == 0 ? TsdfVoxel{-0.5F, 1.0F} : TsdfVoxel{};
    map.mark_changed(slot);
    states.update(map);
    auto accessor = states.accessor();
    for (int i = 0; i < 300; ++i) {
      const VoxelIndex v(static_cast<int>(random.below(40)) - 16,
                         static_cast<int>(random.below(24)) - 4, static_cast<int>(random.below(8)));
      for (const bool past_unknown : {false, true}) {
        int expected = 0;
        for (const int side : {4, 8}) {
          const VoxelIndex low(v.x() & -side, v.y() & -side, v.z() & -side);
          bool clear = true;
          for_each_index(low, low + VoxelIndex::Constant(side - 1), [&](const VoxelIndex& w) {
            clear = clear && (states(w) == VoxelState::empty ||
                              (past_unknown && states(w) == VoxelState::unknown));
          });
          if (clear) expected = side;
        }
        CHECK(accessor.clear_cube(v, past_unknown) == expected);
        ++found[static_cast<std::size_t>(expected)];
      }
    }
  }
  CHECK(found[0] > 500 && found[4] > 500 && found[8] > 500);
}
