// SPDX-License-Identifier: MIT
/// @file
/// @brief A bit for each voxel of a block: what differs between two blocks.
#pragma once

#include <array>
#include <bit>
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
}  // namespace surfleet
