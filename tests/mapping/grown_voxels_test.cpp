// SPDX-License-Identifier: MIT
#include <surfleet/mapping/grown_voxels.hpp>

#include <set>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Lopsided, and as far as a kernel may reach.
VoxelKernel lopsided(int reach) {
  VoxelKernel k;
  k.rows = {{0, 0, 1}, {reach, -1, 0}, {-2, reach / 2, reach}};
  return k;
}
bool has_offset(const VoxelKernel& kernel, const VoxelIndex& d) {
  for (const VoxelKernel::Row& row : kernel.rows)
    if (d.y() == row.dy && d.z() == row.dz && std::abs(d.x()) <= row.spread) return true;
  return false;
}
}  // namespace

TEST(kernels_are_the_offsets_that_they_name) {
  for (const double radius : {0.0, 1.0, 2.5, 6.0}) {
    const VoxelKernel ball = VoxelKernel::ball(radius);
    for_each_index(VoxelIndex::Constant(-8), VoxelIndex::Constant(8), [&](const VoxelIndex& d) {
      CHECK(has_offset(ball, d) == (d.cast<double>().norm() <= radius));
      const VoxelKernel k = lopsided(7);
      CHECK(has_offset(k.mirrored(), d) == has_offset(k, -d));
    });
    CHECK(ball.reach() == static_cast<int>(radius));
  }
  CHECK(lopsided(20).reach() == 20);
  CHECK_NEAR(lopsided(20).length(), std::sqrt(400.0 + 100.0 + 4.0), 1e-12);
}

TEST(what_is_grown_is_what_an_offset_leads_to) {
  Random random(3);
  for (const bool outside : {false, true})
    for (const VoxelKernel& kernel : {VoxelKernel{}, VoxelKernel::ball(1.5), VoxelKernel::ball(5.2),
                                      lopsided(9), lopsided(VoxelKernel::kMaxReach)}) {
      GrownVoxels grown(kernel, outside);
      // A cave of five blocks an axis in what is set, or a few voxels in what is not.
      std::set<VoxelKey> odd;  // voxels that are not as everything outside
      const auto is_set = [&](const VoxelIndex& v) {
        return (odd.count(key_of(v)) != 0) != outside;
      };
      for (int change = 0; change < 3; ++change) {
        std::vector<BlockIndex> stale;
        for (int i = 0; i < (outside ? 0 : 12); ++i)
          odd.insert({static_cast<int>(random.below(24)) - 12,
                      static_cast<int>(random.below(24)) - 12,
                      static_cast<int>(random.below(24)) - 12});
        if (outside)
          for_each_index(VoxelIndex::Constant(-20), VoxelIndex::Constant(19),
                         [&](const VoxelIndex& v) {
                           if (random.below(400) != 0) odd.insert(key_of(v));
                         });
        std::vector<std::pair<BlockIndex, BlockBits>> before;
        for_each_index(VoxelIndex::Constant(-6), VoxelIndex::Constant(5), [&](const BlockIndex& b) {
          BlockBits bits = grown.at(b);
          grown.add_grown(b, bits);
          before.emplace_back(b, bits);
        });
        for_each_index(VoxelIndex::Constant(-3), VoxelIndex::Constant(2), [&](const BlockIndex& b) {
          BlockBits bits{};
          for (int o = 0; o < 512; ++o)
            if (is_set(b * 8 + VoxelIndex(o % 8, o / 8 % 8, o / 64)))
              bits[static_cast<std::size_t>(o / 8)] |= static_cast<std::uint8_t>(1U << (o % 8));
          const bool differs = grown.at(b) != bits;
          CHECK(grown.set(b, bits, stale) == differs);
        });
        std::set<VoxelKey> named;
        for (const BlockIndex& b : stale) named.insert(key_of(b));
        int wrong = 0, unnamed = 0;
        for (const auto& [b, old] : before) {
          BlockBits bits = grown.at(b);
          grown.add_grown(b, bits);
          unnamed += bits != old && named.count(key_of(b)) == 0 ? 1 : 0;
        }
        CHECK(unnamed == 0);
        for (int i = 0; i < 400; ++i) {
          const VoxelIndex v(static_cast<int>(random.below(60)) - 30,
                             static_cast<int>(random.below(60)) - 30,
                             static_cast<int>(random.below(60)) - 30);
          bool expected = false;
          for (const VoxelKernel::Row& row : kernel.rows)
            for (int dx = -row.spread; dx <= row.spread; ++dx)
              expected = expected || is_set(v - VoxelIndex(dx, row.dy, row.dz));
          const BlockIndex b(v.x() >> 3, v.y() >> 3, v.z() >> 3);
          BlockBits bits = grown.at(b);
          grown.add_grown(b, bits);
          const int row = (v.y() & 7) + 8 * (v.z() & 7);
          wrong += (bits[static_cast<std::size_t>(row)] >> (v.x() & 7) & 1) != (expected ? 1 : 0);
          wrong += grown.contains(v) != is_set(v) ? 1 : 0;
        }
        CHECK(wrong == 0);
      }
    }
}
