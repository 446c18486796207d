// SPDX-License-Identifier: MIT
/// @file
/// @brief A bit for each voxel of a block: what differs between two blocks, and growth by a ball.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
inline constexpr int kBitsSide = 8;
/// Rows of a block of 8 × 8 × 8 voxels: row y + 8 z, bit x.
using BlockBits = std::array<std::uint8_t, kBitsSide * kBitsSide>;

/// Voxels of a block, counted from its origin; empty where `lo` is greater than `hi`.
struct VoxelSpan {
  VoxelIndex lo = VoxelIndex::Constant(kBitsSide);
  VoxelIndex hi = VoxelIndex::Constant(-1);
};
/// The span of the voxels in which two blocks differ. O(1).
inline VoxelSpan difference(const BlockBits& a, const BlockBits& b) {
  VoxelSpan span;
  for (int row = 0; row < kBitsSide * kBitsSide; ++row) {
    const auto r = static_cast<std::size_t>(row);
    const unsigned diff = static_cast<unsigned>(a[r] ^ b[r]);
    if (diff == 0) continue;
    span.lo =
        span.lo.cwiseMin(VoxelIndex(std::countr_zero(diff), row % kBitsSide, row / kBitsSide));
    span.hi = span.hi.cwiseMax(
        VoxelIndex(static_cast<int>(std::bit_width(diff)) - 1, row % kBitsSide, row / kBitsSide));
  }
  return span;
}

/// A block and its 26 neighbours, x fastest; null where nothing is set.
using BlockNeighborhood = std::array<const BlockBits*, 27>;

/// Sets in `bits` the voxels of the middle block within `radius` voxels, less than 8, of one that
/// is set in the neighbourhood. O(radius²) for each row.
inline void add_grown(const BlockNeighborhood& near, double radius, BlockBits& bits) {
  // Rows of the block and its neighbours, three blocks long.
  constexpr int kSpan = 3 * kBitsSide;
  std::array<std::uint32_t, kSpan * kSpan> rows{};
  for (int row = 0; row < kSpan * kSpan; ++row) {
    const int y = row % kSpan, z = row / kSpan;
    for (int x = 0; x < 3; ++x)
      if (const BlockBits* b =
              near[static_cast<std::size_t>(x + 3 * (y / kBitsSide) + 9 * (z / kBitsSide))])
        rows[static_cast<std::size_t>(row)] |=
            static_cast<std::uint32_t>(
                (*b)[static_cast<std::size_t>(y % kBitsSide + kBitsSide * (z % kBitsSide))])
            << (kBitsSide * x);
  }
  const int most = static_cast<int>(radius);
  for (int dz = -most; dz <= most; ++dz)
    for (int dy = -most; dy <= most; ++dy) {
      const double rest = radius * radius - dy * dy - dz * dz;
      if (rest < 0.0) continue;
      const int spread = static_cast<int>(std::sqrt(rest));
      for (int row = 0; row < kBitsSide * kBitsSide; ++row) {
        const int y = row % kBitsSide + kBitsSide + dy, z = row / kBitsSide + kBitsSide + dz;
        const std::uint32_t from = rows[static_cast<std::size_t>(y + kSpan * z)];
        std::uint32_t to = from;
        for (int k = 1; k <= spread; ++k) to |= from << k | from >> k;
        std::uint8_t& own = bits[static_cast<std::size_t>(row)];
        own = static_cast<std::uint8_t>(own | (to >> kBitsSide & 0xFF));
      }
    }
}
}  // namespace surfleet
