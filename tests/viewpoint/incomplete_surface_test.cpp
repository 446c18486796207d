// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/incomplete_surface.hpp>

#include <algorithm>
#include <vector>

#include "check.hpp"
#include "state_scenes.hpp"

namespace {
using namespace surfleet;
using namespace view_test;

/// Edges only, and nothing below: an archetype of a user's own neighbourhood.
struct UpperEdges {
  static constexpr bool contains(int dx, int dy, int dz) {
    return dz >= 0 && (dx != 0) + (dy != 0) + (dz != 0) == 2;
  }
};
static_assert(NeighborhoodPolicy<UpperEdges> && !NeighborhoodPolicy<int>);
struct ArchetypeTest {
  VoxelState operator()(const TsdfVoxel& v) const { return voxel_state(v, 0.3F); }
};

VoxelState state_of(const TsdfMap& map, const VoxelIndex& v) {
  const TsdfVoxel* voxel = map.find(v);
  return voxel == nullptr ? VoxelState::unknown : voxel_state(*voxel, 0.3F);
}

template <typename N>
bool has(const TsdfMap& map, const VoxelIndex& v, VoxelState wanted) {
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if ((dx != 0 || dy != 0 || dz != 0) && N::contains(dx, dy, dz) &&
            state_of(map, v + VoxelIndex(dx, dy, dz)) == wanted)
          return true;
  return false;
}

/// The definition, voxel by voxel.
template <typename U, typename O>
std::vector<VoxelIndex> by_definition(const TsdfMap& map) {
  std::vector<VoxelIndex> found;
  map.for_each_block([&](const TsdfMap::Block& b) {
    for (std::size_t i = 0; i < TsdfMap::kBlockVoxels; ++i) {
      const VoxelIndex v = TsdfMap::index_in(b, i);
      if (state_of(map, v) == VoxelState::empty && has<U>(map, v, VoxelState::unknown) &&
          has<O>(map, v, VoxelState::occupied))
        found.push_back(v);
    }
  });
  return found;
}

/// Every unknown neighbour is named, and nothing else.
template <typename U>
void check_unknown(const TsdfMap& map, const IncompleteElement& e) {
  std::uint32_t expected = 0;
  for (int i = 0; i < 27; ++i) {
    const VoxelIndex d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (!d.isZero() && U::contains(d.x(), d.y(), d.z()) &&
        state_of(map, e.voxel + d) == VoxelState::unknown)
      expected |= 1U << i;
  }
  CHECK(e.unknown == expected && expected != 0);
  std::uint32_t named = 0;
  CHECK(!e.any_unknown([&](const VoxelIndex& d) {
    named |= 1U << (d.x() + 1 + 3 * (d.y() + 1) + 9 * (d.z() + 1));
    return false;
  }));
  CHECK(named == expected);
  CHECK(e.any_unknown([](const VoxelIndex&) { return true; }));
}

bool same(const std::vector<IncompleteElement>& a, const std::vector<IncompleteElement>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].voxel != b[i].voxel || a[i].position != b[i].position ||
        a[i].direction != b[i].direction || a[i].unknown != b[i].unknown)
      return false;
  return true;
}

void random_edit(TsdfMap& map, Random& random, int range) {
  const VoxelIndex low(
      static_cast<int>(random.below(static_cast<std::uint64_t>(2 * range))) - range,
      static_cast<int>(random.below(static_cast<std::uint64_t>(2 * range))) - range,
      static_cast<int>(random.below(static_cast<std::uint64_t>(2 * range))) - range);
  const VoxelIndex size(static_cast<int>(random.below(7)), static_cast<int>(random.below(7)),
                        static_cast<int>(random.below(7)));
  const auto s = static_cast<VoxelState>(random.below(3));
  paint(map, low, low + size, [&](const VoxelIndex&) { return s; });
}

template <typename U, typename O>
void follows_random_edits(std::uint64_t seed) {
  Random random(seed);
  TsdfMap map({.voxel_size = 0.3});
  BasicIncompleteSurface<U, O> kept, kept_by_states;
  VoxelStateMap states(map);
  for (int round = 0; round < 30; ++round) {
    for (std::uint64_t n = random.below(8); n > 0; --n) random_edit(map, random, 14);
    const std::size_t before = kept.size();
    const IncompleteSurfaceChange change = kept.update(map);
    CHECK(before + change.added - change.removed == kept.size());
    states.update(map);
    kept_by_states.update(states);
    BasicIncompleteSurface<U, O> fresh;
    fresh.update(map, ArchetypeTest{});
    CHECK(same(kept.elements(), fresh.elements()));
    CHECK(same(kept.elements(), kept_by_states.elements()));
    const auto expected = by_definition<U, O>(map);
    CHECK(expected.size() == kept.size());
    for (const VoxelIndex& v : expected) CHECK(kept.contains(v));
    for (const IncompleteElement& e : kept.elements()) check_unknown<U>(map, e);
  }
  CHECK(kept.size() > 0);
}

TEST(follows_random_edits_6_18) { follows_random_edits<Neighborhood6, Neighborhood18>(1); }
TEST(follows_random_edits_26_6) { follows_random_edits<Neighborhood26, Neighborhood6>(2); }
TEST(follows_random_edits_own) { follows_random_edits<UpperEdges, Neighborhood26>(3); }

TEST(elements_carry_voxel_position_and_direction) {
  Random random(5);
  TsdfMap map({.voxel_size = 0.2});
  for (int n = 0; n < 60; ++n) random_edit(map, random, 10);
  IncompleteSurface incomplete;
  incomplete.update(map);
  std::size_t visited = 0;
  incomplete.for_each([&](const IncompleteElement& e) {
    ++visited;
    CHECK(incomplete.contains(e.voxel));
    CHECK_NEAR((e.position - map.center(e.voxel)).norm(), 0.0, 1e-12);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (dx == 0 && dy == 0 && dz == 0) continue;
          const VoxelIndex d(dx, dy, dz);
          const double w = state_of(map, e.voxel + d) == VoxelState::occupied ? -0.3 : 0.3;
          sum += w * d.cast<double>() / d.cast<double>().norm();
        }
    if (sum.norm() < 1e-9)
      CHECK(e.direction.isZero());
    else
      CHECK_NEAR((e.direction - sum.normalized()).norm(), 0.0, 1e-9);
  });
  CHECK(visited == incomplete.size());
}

TEST(the_rim_of_a_floor_is_incomplete_and_faces_up) {
  const TsdfMap map = floor_scene(10, 8);
  IncompleteSurface incomplete;
  incomplete.update(map);
  CHECK(incomplete.size() == 80);  // the rim of a square of 21 voxels a side
  for (const IncompleteElement& e : incomplete.elements()) {
    CHECK(e.voxel.z() == 0);
    CHECK(std::max(std::abs(e.voxel.x()), std::abs(e.voxel.y())) == 10);
    CHECK(e.direction.z() > 0.8);
    // Beyond the rim, a voxel further out.
    const VoxelIndex beyond = map.index_of(e.frontier(map.voxel_size()));
    CHECK(beyond.z() == 0 && (beyond - e.voxel).cwiseAbs().sum() == 1);
    CHECK(std::max(std::abs(beyond.x()), std::abs(beyond.y())) == 11);
  }
  IncompleteElement unsaid;
  unsaid.position = {1, 2, 3};
  CHECK(unsaid.frontier(0.3) == unsaid.position);
}

TEST(the_direction_vanishes_between_two_walls) {
  TsdfMap map;
  paint(map, {-1, -4, -4}, {1, 4, 4},
        [](const VoxelIndex& v) { return v.x() == 0 ? VoxelState::empty : VoxelState::occupied; });
  set_state(map, {0, 0, 0}, VoxelState::unknown);
  set_state(map, {0, 1, 0}, VoxelState::empty);
  IncompleteSurface incomplete;
  incomplete.update(map);
  CHECK(incomplete.contains({0, 1, 0}));
  incomplete.for_each([&](const IncompleteElement& e) {
    if (e.voxel == VoxelIndex(0, 1, 0)) CHECK(e.direction.isZero());
  });
}

TEST(the_region_bounds_the_elements) {
  const TsdfMap map = floor_scene(10, 8, 0.25);
  IncompleteSurface incomplete{{.region = Box3(Point3(0, -9, -9), Point3(9, 9, 9))}};
  incomplete.update(map);
  CHECK(incomplete.size() == 41);  // x = 0 … 10 on two sides of the rim, and the third one between
  IncompleteSurface nowhere{{.region = Box3(Point3(50, 50, 50), Point3(51, 51, 51))}};
  nowhere.update(map);
  CHECK(nowhere.empty() && nowhere.elements().empty());
}

TEST(cost_follows_the_change) {
  TsdfMap map = floor_scene(60, 8);
  IncompleteSurface incomplete;
  incomplete.update(map);
  CHECK(incomplete.update(map).blocks_read == 0);
  set_state(map, {3, 3, 3}, VoxelState::unknown);  // inside a block: touches no neighbour
  IncompleteSurfaceChange change = incomplete.update(map);
  CHECK(change.blocks_read == 1 && change.blocks_examined == 1);
  set_state(map, {3, 3, 3}, VoxelState::unknown);  // marked, but nothing is different
  change = incomplete.update(map);
  CHECK(change.blocks_read == 1 && change.blocks_examined == 0);
  set_state(map, {0, 0, 0}, VoxelState::unknown);  // a corner: eight blocks meet there
  CHECK(incomplete.update(map).blocks_examined == 8);
}

TEST(an_empty_map_has_no_elements) {
  IncompleteSurface incomplete;
  const TsdfMap map;
  CHECK(incomplete.update(map).blocks_read == 0);
  CHECK(incomplete.empty() && incomplete.elements().empty() && !incomplete.contains({0, 0, 0}));
}
}  // namespace
