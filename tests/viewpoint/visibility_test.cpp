// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/visibility.hpp>

#include "check.hpp"
#include "state_scenes.hpp"

namespace {
using namespace surfleet;
using namespace view_test;

/// Samples the segment densely; voxels that it cuts by less than the sampling may be missed.
bool sampled_sees(const VoxelStateMap& map, const Point3& from, const VoxelIndex& target,
                  bool unknown_blocks) {
  const Point3 to = map.grid().center(target);
  for (int i = 0; i <= 4000; ++i) {
    const Point3 p = from + (to - from) * (i / 4000.0);
    if (map.grid().index_of(p) == target) return true;
    const VoxelState s = map.at(p);
    if (s == VoxelState::occupied || (unknown_blocks && s == VoxelState::unknown)) return false;
  }
  return true;
}

TEST(agrees_with_dense_sampling) {
  Random random(11);
  TsdfMap map({.voxel_size = 0.3});
  paint(map, {-9, -9, -9}, {9, 9, 9}, [&](const VoxelIndex&) {
    const std::uint64_t r = random.below(60);
    return r == 0 ? VoxelState::occupied : r == 1 ? VoxelState::unknown : VoxelState::empty;
  });
  const VoxelStateMap states(map);
  int different = 0, clear = 0;
  for (int n = 0; n < 2000; ++n) {
    const Point3 from(random.uniform(-2.5, 2.5), random.uniform(-2.5, 2.5),
                      random.uniform(-2.5, 2.5));
    const VoxelIndex target(static_cast<int>(random.below(19)) - 9,
                            static_cast<int>(random.below(19)) - 9,
                            static_cast<int>(random.below(19)) - 9);
    const bool unknown_blocks = n % 2 == 0;
    LineOfSight line(states, {.unknown_blocks = unknown_blocks});
    const bool sees = line.sees(from, target);
    const bool sampled = sampled_sees(states, from, target, unknown_blocks);
    CHECK(!sees || sampled);  // the sampling can only miss what blocks
    different += sees != sampled ? 1 : 0;
    clear += sees ? 1 : 0;
  }
  CHECK(different < 20 && clear > 200);
}

TEST(lines_of_sight_are_those_of_a_walk_by_single_voxels) {
  Random random(13);
  TsdfMap map({.voxel_size = 0.3});
  paint(map, {-20, -20, -20}, {20, 20, 20}, [&](const VoxelIndex&) {
    const std::uint64_t r = random.below(900);  // so few that cubes stay clear
    return r == 0 ? VoxelState::occupied : r == 1 ? VoxelState::unknown : VoxelState::empty;
  });
  const VoxelStateMap states(map);
  int blocked = 0, clear = 0;
  for (int n = 0; n < 6000; ++n) {
    const auto any = [&] { return static_cast<int>(random.below(47)) - 23; };
    const VoxelIndex target(any(), any(), any());
    Point3 from(0.3 * any(), 0.3 * any(), 0.3 * any());  // corners
    if (n % 3 == 0) from += Point3::Constant(random.uniform(0.0, 0.3));
    LineOfSight line(states, {.unknown_blocks = n % 2 == 0});
    bool expected = true;
    traverse_voxels(from, states.grid().center(target), 0.3, [&](const VoxelIndex& v) {
      expected = v == target || !line.blocks(states(v));
      return expected && v != target;
    });
    CHECK(line.sees(from, target) == expected);
    ++(expected ? clear : blocked);
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    double length = 6.0;
    traverse_voxels(from, from + 6.0 * direction, 0.3, [&](const VoxelIndex& v) {
      if (!line.blocks(states(v))) return true;
      length = std::clamp((states.grid().center(v) - from).dot(direction), 0.0, 6.0);
      return false;
    });
    CHECK(line.free_length(from, direction, 6.0) == length);
  }
  CHECK(blocked > 1000 && clear > 1000);
}

TEST(the_target_itself_does_not_block) {
  const TsdfMap map = wall_scene(6, 12);
  const VoxelStateMap states(map);
  LineOfSight line(states), strict(states, {.unknown_blocks = true});
  const Point3 eye(2.0, 0.1, 0.1);
  CHECK(line.sees(eye, {0, 0, 0}));
  CHECK(line.sees(eye, {-1, 0, 0}));   // occupied, in the first layer
  CHECK(!line.sees(eye, {-2, 0, 0}));  // behind it
  CHECK(line.sees(eye, {0, 30, 0}));   // through the unknown
  CHECK(!strict.sees(eye, {0, 30, 0}));
  CHECK(line.sees(map.center({0, 0, 0}), {0, 0, 0}));  // from within
}

TEST(free_length_ends_at_the_wall) {
  const TsdfMap map = wall_scene(6, 12, 0.25);
  const VoxelStateMap states(map);
  LineOfSight line(states);
  const Point3 from(2.0, 0.1, 0.1);
  CHECK_NEAR(line.free_length(from, -Eigen::Vector3d::UnitX(), 5.0), 2.0, 0.26);
  CHECK_NEAR(line.free_length(from, -Eigen::Vector3d::UnitX(), 1.0), 1.0, 1e-9);
  CHECK_NEAR(line.free_length(from, Eigen::Vector3d::UnitX(), 7.0), 7.0, 1e-9);
  CHECK_NEAR(LineOfSight(states, {.unknown_blocks = true})
                 .free_length(from, Eigen::Vector3d::UnitX(), 7.0),
             1.25, 0.26);
}

TEST(a_map_without_blocks_hides_nothing_unless_asked) {
  const TsdfMap map;
  const VoxelStateMap states(map);
  CHECK(LineOfSight(states).sees({0, 0, 0}, {20, 20, 20}));
  CHECK(!LineOfSight(states, {.unknown_blocks = true}).sees({0, 0, 0}, {20, 20, 20}));
}
}  // namespace
