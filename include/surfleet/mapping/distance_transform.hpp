// SPDX-License-Identifier: MIT
/// @file
/// @brief The exact Euclidean distance to the nearest of some voxels, truncated, kept up to date as
/// voxels come and go.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/mapping/block_bits.hpp>
#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
/// Squared distances between voxel centres, in voxels, over blocks of bits that say where obstacles
/// are. Separable: along x from the bits, then along y, then z (Saito and Toriwaki 1994). What lies
/// in no block is all obstacle or all empty, as told. An update costs
/// O(blocks with other bits · (1 + reach / 8)³). Reading is thread-safe.
class DistanceTransform {
 public:
  static constexpr int kSide = kBitsSide;
  static constexpr int kMaxReach = 24;  ///< 64-bit rows: 8 + 2 · 24 bits and more.
  /// Squared distance in voxels; `reach`² where nothing is within reach.
  using Grid = VoxelGrid<std::int16_t, kSide>;

  /// `reach` from 1 to `kMaxReach` [voxels].
  DistanceTransform(double voxel_size, int reach, bool obstacle_outside)
      : grid_({.voxel_size = voxel_size}),
        reach_(reach),
        halo_((reach + kSide - 1) / kSide),
        outside_(obstacle_outside) {}

  const Grid& grid() const { return grid_; }
  /// The squared distance where there is no block.
  std::int16_t outside() const { return static_cast<std::int16_t>(outside_ ? 0 : reach_ * reach_); }
  BlockBits outside_bits() const {
    BlockBits bits;
    bits.fill(outside_ ? 0xFF : 0x00);
    return bits;
  }
  bool is_obstacle(const VoxelIndex& v) const {
    const std::uint32_t slot = grid_.find_slot(Grid::block_of(v));
    const auto o = Grid::offset_of(v);
    return ((slot == Grid::kNone ? outside_bits() : bits_[slot])[o / 8] >> (o % 8) & 1) != 0;
  }
  std::size_t memory_bytes() const {
    return grid_.memory_bytes() +
           bits_.size() * (sizeof(BlockBits) + sizeof(Rows) + sizeof(std::uint64_t));
  }

  /// The block's slot, made if need be, as everything outside is.
  std::uint32_t ensure(const BlockIndex& index) {
    const std::uint32_t slot = grid_.ensure_slot(index);
    if (slot < bits_.size()) return slot;
    grid_.block(slot).voxels.fill(outside());
    bits_.push_back(outside_bits());
    rows_.emplace_back().fill(
        static_cast<std::int16_t>(outside_ ? 0 : (reach_ + 1) * (reach_ + 1)));
    far_.push_back(!outside_);
    stamp_.push_back(0);
    return slot;
  }
  /// Says that a block is to be read by what follows `grid().changed_since`.
  void mark_changed(std::uint32_t slot) { grid_.mark_changed(slot); }
  /// Where obstacles are in a block from now on; distances follow with the next `update`.
  void set(const BlockIndex& index, const BlockBits& bits) {
    std::uint32_t slot = grid_.find_slot(index);
    const BlockBits old = slot == Grid::kNone ? outside_bits() : bits_[slot];
    if (bits == old) return;
    if (slot == Grid::kNone) slot = ensure(index);
    changes_.push_back({index, difference(bits, old)});
    bits_[slot] = bits;
  }
  /// Brings the distances up to date. Returns the slots whose distances changed.
  std::vector<std::uint32_t> update() {
    std::vector<std::uint32_t> changed;
    if (changes_.empty()) return changed;
    // Everything within reach of a change. A block that was never made is uniform: full of
    // obstacles, which nothing changes, or empty, and then it is made.
    ++epoch_;
    std::vector<std::uint32_t> dirty;
    for (const Change& c : changes_) {
      const VoxelIndex origin = c.block * kSide, r = VoxelIndex::Constant(reach_);
      for_each_index(Grid::block_of(origin + c.span.lo - r), Grid::block_of(origin + c.span.hi + r),
                     [&](const BlockIndex& b) {
                       std::uint32_t slot = grid_.find_slot(b);
                       if (slot == Grid::kNone && !outside_) slot = ensure(b);
                       if (slot == Grid::kNone || stamp_[slot] == epoch_) return;
                       stamp_[slot] = epoch_;
                       dirty.push_back(slot);
                     });
    }
    changes_.clear();
    for (const std::uint32_t slot : dirty) scan_rows(slot);
    for (const std::uint32_t slot : dirty)
      if (transform(slot)) changed.push_back(slot);
    return changed;
  }

 private:
  using Rows = std::array<std::int16_t, 512>;  // squared distance along x
  /// Of indices, ends included; empty at first.
  struct Range {
    int first = 1 << 20, last = -(1 << 20);

    bool empty() const { return first > last; }
    void extend(int i) {
      first = std::min(first, i);
      last = std::max(last, i);
    }
    /// The voxels of these blocks, no farther than `reach` from those of block 0.
    Range voxels(int reach) const {
      return empty() ? *this : Range{std::max(8 * first, -reach), std::min(8 * last, reach) + 7};
    }
  };
  struct Change {
    BlockIndex block;
    VoxelSpan span;  // of the voxels that differ
  };

  /// First pass of the separable distance transform: along x, from the obstacle bits of the block
  /// and its neighbours in the row.
  void scan_rows(std::uint32_t slot) {
    const BlockIndex index = grid_.block(slot).index;
    std::array<const BlockBits*, 7> row_blocks{};
    for (int d = -halo_; d <= halo_; ++d) {
      const std::uint32_t n = grid_.find_slot(index + BlockIndex(d, 0, 0));
      row_blocks[static_cast<std::size_t>(d + halo_)] = n == Grid::kNone ? nullptr : &bits_[n];
    }
    const std::uint8_t absent = outside_ ? 0xFF : 0x00;
    const auto cap = static_cast<std::int16_t>((reach_ + 1) * (reach_ + 1));
    Rows& rows = rows_[slot];
    far_[slot] = true;
    for (std::size_t r = 0; r < 64; ++r) {
      std::uint64_t bits = 0;
      for (int d = 0; d <= 2 * halo_; ++d) {
        const BlockBits* b = row_blocks[static_cast<std::size_t>(d)];
        bits |= static_cast<std::uint64_t>(b == nullptr ? absent : (*b)[r]) << (8 * d);
      }
      std::int16_t* out = rows.data() + r * 8;
      if (bits == 0) {
        std::fill(out, out + 8, cap);
        continue;
      }
      far_[slot] = false;
      for (int x = 0; x < 8; ++x) {
        const int at = 8 * halo_ + x;
        const int g = std::min(
            {std::countr_zero(bits >> at), std::countl_zero(bits << (63 - at)), reach_ + 1});
        out[x] = static_cast<std::int16_t>(g * g);
      }
    }
  }

  /// Second and third pass: along y, then z. True if the block's distances changed.
  bool transform(std::uint32_t slot) {
    const BlockIndex index = grid_.block(slot).index;
    const int span = 2 * halo_ + 1;
    std::array<const std::int16_t*, 49> near{};  // rows of the neighbours in y, z that are not far
    const std::int16_t* absent = outside_ ? zero_rows() : nullptr;
    Range all;  // blocks along z that have some
    std::array<Range, 7> along_y;
    for (int z = -halo_; z <= halo_; ++z)
      for (int y = -halo_; y <= halo_; ++y) {
        const std::uint32_t n = grid_.find_slot(index + BlockIndex(0, y, z));
        const std::int16_t* rows = n == Grid::kNone ? absent : far_[n] ? nullptr : rows_[n].data();
        near[static_cast<std::size_t>((y + halo_) + span * (z + halo_))] = rows;
        if (rows == nullptr) continue;
        all.extend(z);
        along_y[static_cast<std::size_t>(z + halo_)].extend(y);
      }
    std::array<std::int16_t, 512> result;
    const auto cap = static_cast<std::int16_t>(reach_ * reach_);
    result.fill(cap);
    if (const BlockBits& own = bits_[slot];
        std::all_of(own.begin(), own.end(), [](std::uint8_t b) { return b == 0xFF; })) {
      result.fill(0);
    } else if (!all.empty()) {
      constexpr std::size_t kMaxSpan = 8 + 2 * kMaxReach;
      std::array<std::int16_t, kMaxSpan * 64> columns;  // after the pass along y, a slab per z
      std::array<std::int16_t, kMaxSpan * 8> lines;     // one slab before that pass
      const Range z_with = all.voxels(reach_);
      for (int z = z_with.first; z <= z_with.last; ++z) {
        const int bz = (z + 8 * halo_) / 8, iz = (z + 8 * halo_) % 8;
        std::int16_t* slab = columns.data() + (z + reach_) * 64;
        const Range y_with = along_y[static_cast<std::size_t>(bz)].voxels(reach_);
        if (y_with.empty()) {
          std::fill(slab, slab + 64, cap);
          continue;
        }
        for (int y = -reach_; y < 8 + reach_; ++y) {
          const int by = (y + 8 * halo_) / 8, iy = (y + 8 * halo_) % 8;
          const std::int16_t* rows = near[static_cast<std::size_t>(by + span * bz)];
          std::int16_t* line = lines.data() + (y + reach_) * 8;
          if (rows == nullptr)
            std::fill(line, line + 8, cap);
          else
            std::copy_n(rows + (iy + 8 * iz) * 8, 8, line);
        }
        lower(lines.data() + reach_ * 8, 8, {y_with.first - 7, y_with.last}, cap, slab);
      }
      for (int z = 0; z < 8; ++z) {
        const Range with{z_with.first - z, z_with.last - z};
        lower(columns.data() + (z + reach_) * 64, 64, with, cap, result.data() + z * 64);
      }
    }
    if (result == grid_.block(slot).voxels) return false;
    grid_.block(slot).voxels = result;
    grid_.mark_changed(slot);
    return true;
  }
  /// A pass of the transform: for 64 places at once the least over d of what lies d strides on from
  /// them, plus d², from −reach to reach and within `at`. Nearest first, until that is less than
  /// what lies farther off can be.
  void lower(const std::int16_t* in, int stride, Range at, std::int16_t cap,
             std::int16_t* out) const {
    // Apart from `in` for the compiler, and not indexed as an array, which sanitizers would call.
    std::array<std::int16_t, 64> slab;
    slab.fill(cap);
    std::int16_t* const least = slab.data();
    const auto pass = [=](int d) {
      const std::int16_t* from = in + d * stride;
      const auto far = static_cast<std::int16_t>(d * d);
      for (std::size_t i = 0; i < 64; ++i) {
        const auto through = static_cast<std::int16_t>(from[i] + far);
        least[i] = through < least[i] ? through : least[i];
      }
    };
    if (at.first <= 0 && at.last >= 0) pass(0);
    const int last = std::min(reach_, std::max(-at.first, at.last));
    for (int d = std::max({1, at.first, -at.last}); d <= last; ++d) {
      std::int16_t most = 0;
      for (std::size_t i = 0; i < 64; ++i) most = least[i] > most ? least[i] : most;
      if (most <= d * d) break;
      if (d <= at.last) pass(d);
      if (-d >= at.first) pass(-d);
    }
    std::copy(slab.begin(), slab.end(), out);
  }
  static const std::int16_t* zero_rows() {
    static const Rows zeros{};
    return zeros.data();
  }

  Grid grid_;
  int reach_ = 0, halo_ = 0;
  bool outside_ = true;          // whether what has no block is an obstacle
  std::vector<BlockBits> bits_;  // by slot, like the next three
  std::vector<Rows> rows_;
  std::vector<bool> far_;  // nothing within reach along x
  std::vector<std::uint64_t> stamp_;
  std::vector<Change> changes_;
  std::uint64_t epoch_ = 0;
};
}  // namespace surfleet
