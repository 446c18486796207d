// SPDX-License-Identifier: MIT
#include <surfleet/mapping/voxel_grid.hpp>

#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <type_traits>
#include <utility>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
VoxelIndex random_index(Random& random, int reach) {
  const auto draw = [&] {
    return static_cast<int>(random.below(static_cast<std::uint64_t>(2 * reach))) - reach;
  };
  return {draw(), draw(), draw()};
}

/// The grid against a std::map, over writes at random places.
template <int kSide>
void grid_laws(int reach) {
  Random random(static_cast<std::uint64_t>(kSide * 1000 + reach));
  VoxelGrid<int, kSide> grid({.voxel_size = 0.25});
  std::map<std::tuple<int, int, int>, int> truth;
  std::set<std::tuple<int, int, int>> blocks;
  for (int i = 0; i < 3000; ++i) {
    const VoxelIndex v = random_index(random, reach);
    grid.ensure(v) = i + 1;
    truth[{v.x(), v.y(), v.z()}] = i + 1;
    const BlockIndex b = grid.block_of(v);
    for (int a = 0; a < 3; ++a) CHECK(b[a] * kSide <= v[a] && v[a] < (b[a] + 1) * kSide);
    blocks.insert({b.x(), b.y(), b.z()});
  }
  CHECK(grid.block_count() == blocks.size());
  auto accessor = grid.accessor();
  for (const auto& [key, value] : truth) {
    const VoxelIndex v(std::get<0>(key), std::get<1>(key), std::get<2>(key));
    CHECK(grid.find(v) != nullptr && *grid.find(v) == value);
    CHECK(accessor.find(v) == grid.find(v));
  }
  for (int i = 0; i < 1000; ++i) {
    const VoxelIndex v = random_index(random, 2 * reach);
    const BlockIndex b = grid.block_of(v);
    CHECK((grid.find(v) != nullptr) == blocks.contains({b.x(), b.y(), b.z()}));
    CHECK(accessor.find(v) == grid.find(v));
  }
  std::size_t filled = 0;
  std::uint32_t slot = 0;
  grid.for_each_block([&](const auto& block) {
    CHECK(&block == &grid.block(slot) && grid.find_slot(block.index) == slot);
    ++slot;
    for (std::size_t i = 0; i < block.voxels.size(); ++i) {
      const VoxelIndex v = grid.index_in(block, i);
      CHECK(grid.offset_of(v) == i && grid.block_of(v) == block.index);
      filled += block.voxels[i] != 0 ? 1U : 0U;
    }
  });
  CHECK(filled == truth.size());
  CHECK(grid.memory_bytes() >= grid.block_count() * sizeof(int) * kSide * kSide * kSide);
}
}  // namespace

TEST(writer_makes_and_finds_what_the_grid_does) {
  // Walks that stay in a block, leave it, come back, and make blocks enough to grow the table.
  VoxelGrid<int, 4> written({.voxel_size = 0.1}), expected({.voxel_size = 0.1});
  VoxelGrid<int, 4>::Writer write(written);
  Random random(4);
  VoxelIndex v(0, 0, 0);
  for (int step = 0; step < 20000; ++step) {
    if (step % 100 == 0) v = random_index(random, 60);
    v[step % 3] += random.uniform() < 0.5 ? -1 : 1;
    write.ensure(v) += step;
    expected.ensure(v) += step;
  }
  CHECK(written.block_count() == expected.block_count());
  expected.for_each_block([&](const auto& block) {
    const auto* own = written.find_block(block.index);
    CHECK(own != nullptr && own->voxels == block.voxels);
  });
}

TEST(blocks_filled_outside_are_taken_over) {
  VoxelGrid<int> grid;
  for (int i = 0; i < 200; ++i) {  // enough for the table to grow
    auto block = std::make_unique<VoxelGrid<int>::Block>();
    block->index = BlockIndex(i, -i, 7);
    block->voxels[3] = i;
    CHECK(grid.adopt(std::move(block)) == static_cast<std::uint32_t>(i));
  }
  for (int i = 0; i < 200; ++i) {
    const auto* block = grid.find_block(BlockIndex(i, -i, 7));
    CHECK(block != nullptr && block->voxels[3] == i && block->voxels[4] == 0);
    CHECK(grid.ensure_slot(BlockIndex(i, -i, 7)) == static_cast<std::uint32_t>(i));
  }
}

TEST(grid_equals_a_map) {
  grid_laws<8>(20);
  grid_laws<8>(1 << 28);
  grid_laws<4>(30);
  grid_laws<1>(5);
}

TEST(points_and_voxels_agree) {
  Random random(1);
  const VoxelGrid<int> grid({.voxel_size = 0.3});
  for (const double far : {1.0, 1e4, 1e8}) {
    for (int i = 0; i < 1000; ++i) {
      const Point3 p(random.uniform(-far, far), random.uniform(-far, far),
                     random.uniform(-far, far));
      const VoxelIndex v = grid.index_of(p);
      CHECK((grid.center(v) - p).cwiseAbs().maxCoeff() <= 0.15 + far * 1e-12);
      CHECK(grid.index_of(grid.center(v)) == v);
    }
  }
  CHECK(grid.index_of({-1e-9, 0.0, 0.3 - 1e-9}) == VoxelIndex(-1, 0, 0));
  CHECK_THROWS(Error, grid.index_of({1e12, 0, 0}));
  CHECK_THROWS(Error, grid.index_of({0, std::numeric_limits<double>::quiet_NaN(), 0}));
  CHECK_THROWS(Error, VoxelGrid<int>({.voxel_size = 0.0}));
  CHECK_THROWS(Error, VoxelGrid<int>({.voxel_size = -1.0}));
  CHECK_THROWS(Error, VoxelGrid<int>({.voxel_size = std::numeric_limits<double>::infinity()}));
}

TEST(changes_are_told_once_and_in_order) {
  Random random(4);
  VoxelGrid<int> grid;
  for (int i = 0; i < 50; ++i) grid.ensure_slot({i - 25, 0, 0});
  std::vector<std::uint64_t> last(50, 0);
  std::vector<std::uint64_t> cursors{0};
  std::uint64_t clock = 0;
  std::vector<std::uint64_t> time_at_cursor{0};
  for (int i = 0; i < 20000; ++i) {
    const auto slot = static_cast<std::uint32_t>(random.below(50));
    grid.mark_changed(slot);
    last[slot] = ++clock;
    if (random.below(1000) == 0) {
      cursors.push_back(grid.revision());
      time_at_cursor.push_back(clock);
    }
  }
  for (std::size_t c = 0; c < cursors.size(); ++c) {
    std::map<std::uint64_t, std::uint32_t> expected;
    for (std::uint32_t s = 0; s < 50; ++s)
      if (last[s] > time_at_cursor[c]) expected[last[s]] = s;
    std::vector<std::uint32_t> order;
    for (const auto& [time, slot] : expected) order.push_back(slot);
    CHECK(grid.changed_since(cursors[c]) == order);
  }
  CHECK(grid.changed_since(grid.revision()).empty());
}

static_assert(std::is_copy_constructible_v<VoxelGrid<int>> &&
              std::is_copy_assignable_v<VoxelGrid<int>>);
static_assert(std::is_nothrow_move_constructible_v<VoxelGrid<int>>);

TEST(a_copied_grid_is_its_own) {
  VoxelGrid<int> grid({.voxel_size = 0.25});
  Random random(2);
  const auto draw = [&] { return static_cast<int>(random.uniform(-40.0, 40.0)); };
  for (int i = 0; i < 500; ++i) {
    const VoxelIndex v(draw(), draw(), draw());
    grid.ensure(v) = i + 1;
    grid.mark_changed(grid.find_slot(VoxelGrid<int>::block_of(v)));
  }
  const std::uint64_t cursor = grid.revision() / 2;
  VoxelGrid<int> copy(grid), assigned({.voxel_size = 9.0});
  assigned.ensure({1, 2, 3}) = 5;
  assigned = grid;
  for (VoxelGrid<int>* other : {&copy, &assigned}) {
    CHECK(other->voxel_size() == 0.25 && other->block_count() == grid.block_count());
    CHECK(other->revision() == grid.revision());
    CHECK(other->changed_since(cursor) == grid.changed_since(cursor));
    for (std::uint32_t s = 0; s < grid.block_count(); ++s) {
      CHECK(other->block(s).index == grid.block(s).index);
      CHECK(other->block(s).voxels == grid.block(s).voxels);
      CHECK(&other->block(s) != &grid.block(s));
      CHECK(other->find_slot(grid.block(s).index) == s);
    }
  }
  // What happens to one does not happen to the other.
  const VoxelIndex at = grid.block(0).origin();
  const int before = grid.block(0).voxels[0];
  copy.ensure(at) = -7;
  copy.ensure({1000, 1000, 1000}) = 1;
  copy.mark_changed(0);
  CHECK(grid.block(0).voxels[0] == before && grid.find({1000, 1000, 1000}) == nullptr);
  CHECK(grid.changed_since(grid.revision()).empty() && copy.revision() == grid.revision() + 1);
  const VoxelGrid<int>& self = copy;
  copy = self;
  CHECK(*copy.find(at) == -7);
  const VoxelGrid<int> moved(std::move(copy));
  CHECK(*moved.find(at) == -7);
}
