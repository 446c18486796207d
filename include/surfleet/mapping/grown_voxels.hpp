// SPDX-License-Identifier: MIT
/// @file
/// @brief Sets of voxels grown by a kernel, block by block, as they change.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/mapping/block_bits.hpp>
#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
/// Offsets of voxels in rows along x, that of no offset among them.
struct VoxelKernel {
  static constexpr int kMaxReach = 24;  ///< Of an offset along an axis.
  struct Row {
    int dy = 0, dz = 0;
    int spread = 0;  ///< Its offsets along x: all from −spread to spread.
  };
  std::vector<Row> rows{Row{}};

  /// Of all offsets no longer than `radius`.
  static VoxelKernel ball(double radius) {
    VoxelKernel k;
    k.rows.clear();
    const int most = static_cast<int>(radius);
    for (int dz = -most; dz <= most; ++dz)
      for (int dy = -most; dy <= most; ++dy)
        if (const double rest = radius * radius - dy * dy - dz * dz; rest >= 0.0)
          k.rows.push_back({dy, dz, static_cast<int>(std::sqrt(rest))});
    return k;
  }
  /// The same offsets negated.
  VoxelKernel mirrored() const {
    VoxelKernel k = *this;
    for (Row& row : k.rows) {
      row.dy = -row.dy;
      row.dz = -row.dz;
    }
    return k;
  }
  /// The greatest coordinate of an offset.
  int reach() const {
    int most = 0;
    for (const Row& row : rows)
      most = std::max({most, std::abs(row.dy), std::abs(row.dz), row.spread});
    return most;
  }
  /// The length of the longest offset.
  double length() const {
    double most = 0.0;
    for (const Row& row : rows)
      most = std::max(
          most, static_cast<double>(row.dy * row.dy + row.dz * row.dz + row.spread * row.spread));
    return std::sqrt(most);
  }
};

/// Voxels, and all that are an offset of a kernel away from one (Minkowski sum, dilation).
///
/// What lies in no block is set or not, as told. A block is grown in
/// O(rows of the kernel · rows of a block).
class GrownVoxels {
 public:
  /// `kernel` reaches `VoxelKernel::kMaxReach` at the most.
  explicit GrownVoxels(VoxelKernel kernel, bool set_outside = false)
      : kernel_(std::move(kernel)), reach_(kernel_.reach()), bits_({.voxel_size = 1.0}) {
    outside_.fill(set_outside ? 0xFF : 0x00);
  }

  /// Which voxels of a block are set from now on; adds to `stale` the blocks that what differs is
  /// grown into. False if nothing differs.
  bool set(const BlockIndex& index, const BlockBits& bits, std::vector<BlockIndex>& stale) {
    const BlockBits old = at(index);
    if (bits == old) return false;
    bits_.ensure_block(index).voxels[0] = bits;
    const VoxelSpan c = difference(bits, old);
    const VoxelIndex origin = index * kBitsSide, r = VoxelIndex::Constant(reach_);
    for_each_index(block_of(origin + c.lo - r), block_of(origin + c.hi + r),
                   [&](const BlockIndex& b) { stale.push_back(b); });
    return true;
  }
  /// A block before it is grown.
  const BlockBits& at(const BlockIndex& index) const {
    const BlockBits* bits = bits_.find(index);
    return bits == nullptr ? outside_ : *bits;
  }
  bool contains(const VoxelIndex& v) const {
    const int row = (v.y() & 7) + kBitsSide * (v.z() & 7);
    return (at(block_of(v))[static_cast<std::size_t>(row)] >> (v.x() & 7) & 1) != 0;
  }
  /// Sets in `bits` the voxels of a block that what is set, there or beside it, is grown to.
  void add_grown(const BlockIndex& index, BlockBits& bits) const {
    constexpr int kHalo = (VoxelKernel::kMaxReach + kBitsSide - 1) / kBitsSide;
    constexpr int kMaxSpan = kBitsSide * (2 * kHalo + 1);
    const int halo = (reach_ + kBitsSide - 1) / kBitsSide, span = kBitsSide * (2 * halo + 1);
    // Rows of the block and those around it, as many blocks long.
    std::array<std::uint64_t, kMaxSpan * kMaxSpan> rows;
    std::fill_n(rows.begin(), span * span, std::uint64_t{0});
    bool any = false;
    for_each_index(VoxelIndex::Zero(), VoxelIndex::Constant(2 * halo), [&](const VoxelIndex& n) {
      const BlockBits& b = at(index + n - VoxelIndex::Constant(halo));
      if (b == BlockBits{}) return;
      any = true;
      for (int row = 0; row < kBitsSide * kBitsSide; ++row) {
        const int y = row % kBitsSide + kBitsSide * n.y(), z = row / kBitsSide + kBitsSide * n.z();
        rows[static_cast<std::size_t>(y + span * z)] |=
            static_cast<std::uint64_t>(b[static_cast<std::size_t>(row)]) << (kBitsSide * n.x());
      }
    });
    if (!any) return;
    const int first = kBitsSide * halo;
    for (const VoxelKernel::Row& k : kernel_.rows)
      for (int row = 0; row < kBitsSide * kBitsSide; ++row) {
        const int y = row % kBitsSide + first - k.dy, z = row / kBitsSide + first - k.dz;
        const std::uint64_t to = spread(rows[static_cast<std::size_t>(y + span * z)], k.spread);
        std::uint8_t& own = bits[static_cast<std::size_t>(row)];
        own = static_cast<std::uint8_t>(own | (to >> first & 0xFF));
      }
  }
  std::size_t memory_bytes() const { return bits_.memory_bytes(); }

 private:
  static BlockIndex block_of(const VoxelIndex& v) { return {v.x() >> 3, v.y() >> 3, v.z() >> 3}; }
  static std::uint64_t spread(std::uint64_t bits, int by) {
    for (int done = 0; done < by;) {
      const int step = std::min(2 * done + 1, by - done);
      bits |= bits << step | bits >> step;
      done += step;
    }
    return bits;
  }
  static_assert(kBitsSide == 8);

  VoxelKernel kernel_;
  int reach_ = 0;
  BlockBits outside_;
  VoxelGrid<BlockBits, 1> bits_;  // a "voxel" a block
};
}  // namespace surfleet
