// SPDX-License-Identifier: MIT
#include <surfleet/motion/reachable_set.hpp>

#include <map>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"
#include "motion_scenes.hpp"

namespace {
using namespace surfleet;
using namespace motion_scenes;

/// Components by a plain flood over the lattice.
std::map<std::array<int, 3>, int> flood(const FreeSpace& space, int reach) {
  std::map<std::array<int, 3>, int> label;
  int next = 0;
  for (int z = -reach; z < reach; ++z)
    for (int y = -reach; y < reach; ++y)
      for (int x = -reach; x < reach; ++x) {
        if (label.contains({x, y, z}) || !space.is_free_voxel({x, y, z})) continue;
        std::vector<VoxelIndex> stack;
        stack.emplace_back(x, y, z);
        label[{x, y, z}] = next;
        while (!stack.empty()) {
          const VoxelIndex v = stack.back();
          stack.pop_back();
          for (int axis = 0; axis < 3; ++axis)
            for (const int d : {-1, 1}) {
              VoxelIndex w = v;
              w[axis] += d;
              if (!space.is_free_voxel(w)) continue;
              if (label.emplace(std::array{w.x(), w.y(), w.z()}, next).second) stack.push_back(w);
            }
        }
        ++next;
      }
  return label;
}
}  // namespace

TEST(components_equal_a_flood_fill_as_the_map_grows) {
  Random random(3);
  TsdfMap tsdf({.voxel_size = 0.25});
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 0.1, .margin = 0.1});
  ReachableSet set(space);
  std::size_t most = 0;
  for (int step = 0; step < 8; ++step) {
    const Point3 c(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
    Random noise(static_cast<std::uint64_t>(step));
    observe(tsdf, Box3(c - Point3::Constant(1.7), c + Point3::Constant(1.7)),
            [&](const Point3&) { return noise.uniform() < 0.2 ? -0.1 : 0.1; });
    states.update(tsdf);
    space.update();
    set.update();
    const auto label = flood(space, 20);
    std::map<int, std::int32_t> name;
    std::map<std::int32_t, int> back;
    int wrong = 0;
    for (const auto& [v, l] : label) {
      const auto got = set.component(VoxelIndex(v[0], v[1], v[2]));
      if (!got) {
        ++wrong;
        continue;
      }
      wrong += name.emplace(l, *got).first->second != *got;
      wrong += back.emplace(*got, l).first->second != l;
    }
    CHECK(wrong == 0);
    most = std::max(most, name.size());
  }
  CHECK(most > 20);
}

TEST(positions_join_the_lattice) {
  TsdfMap tsdf({.voxel_size = 0.3});
  observe(tsdf, box(-6, -4, -3, 6, 4, 3), Boxes{{box(-0.3, -5, -4, 0.3, 5, 4)}});
  const VoxelStateMap states(tsdf);
  const FreeSpace space(states, {.radius = 1.0});
  const ReachableSet set(space);
  CHECK(set.connected({-3, 0, 0}, {-3.3, 1.01, 0.4}));
  CHECK(!set.connected({-3, 0, 0}, {3, 0, 0}));
  CHECK(!set.connected({-3, 0, 0}, {0, 0, 0}));
  CHECK(!set.connected({0, 0, 0}, {0, 0, 0}));
  Random random(2);
  int free = 0, anchored = 0;
  for (int i = 0; i < 2000; ++i) {
    const Point3 p(random.uniform(-6, 6), random.uniform(-4, 4), random.uniform(-3, 3));
    if (!space.is_free(p)) continue;
    ++free;
    anchored += set.anchor(p).has_value() ? 1 : 0;
  }
  CHECK(free > 100 && anchored == free);
}

TEST(the_first_change_of_the_space_is_followed) {
  TsdfMap tsdf({.voxel_size = 0.2});
  const auto put = [&](const VoxelIndex& v, float distance) {
    const std::uint32_t slot = tsdf.ensure_slot(TsdfMap::block_of(v));
    tsdf.block(slot).voxels[TsdfMap::offset_of(v)] = {distance, 1.0F};
    tsdf.mark_changed(slot);
  };
  put({0, 0, 0}, -0.1F);  // an obstacle in the unknown: no room anywhere yet
  VoxelStateMap states(tsdf, {.known_weight = 0.3});
  FreeSpace space(states, {.radius = 0.2, .margin = 0.5, .unknown_margin = 0.2});
  ReachableSet kept(space);
  for_each_index(VoxelIndex(8, 0, 0), VoxelIndex(15, 7, 7),
                 [&](const VoxelIndex& v) { put(v, 0.5F); });
  for_each_index(VoxelIndex(1, 1, 1), VoxelIndex(7, 7, 7),
                 [&](const VoxelIndex& v) { put(v, 0.5F); });
  states.update(tsdf);
  space.update();
  kept.update();
  const ReachableSet fresh(space);
  int free = 0;
  for_each_index(VoxelIndex::Zero(), VoxelIndex(15, 7, 7), [&](const VoxelIndex& v) {
    free += space.is_free_voxel(v) ? 1 : 0;
    CHECK(kept.component(v).has_value() == fresh.component(v).has_value());
  });
  CHECK(free > 0);
}
