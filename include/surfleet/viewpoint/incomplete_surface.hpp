// SPDX-License-Identifier: MIT
/// @file
/// @brief Incomplete surface elements: where the known surface ends, kept up to date by the change.
///
///     IncompleteSurface incomplete{{.known_weight = 0.3}};
///     incomplete.update(map);                       // only the blocks that changed
///     for (const IncompleteElement& e : incomplete.elements()) …
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/viewpoint/incomplete_element.hpp>

namespace surfleet {
struct IncompleteSurfaceOptions {
  double known_weight = 0.3;  ///< W_th, where the source is a TSDF map.
  Box3 region = {};           ///< Elements are taken inside it [m]; an empty box means everywhere.
};

/// What one update did.
struct IncompleteSurfaceChange {
  std::size_t blocks_read = 0;      ///< Blocks whose voxels were read.
  std::size_t blocks_examined = 0;  ///< Blocks whose elements were found anew.
  std::size_t added = 0;
  std::size_t removed = 0;
};

/// The incomplete surface elements (ISE) of a map [000 §2.4.2]: voxels that are empty, have an
/// unknown neighbour (of `Unknown`) and an occupied one (of `Occupied`). Their direction is
/// n_v = Σ_c w'(c) (c − v) / ‖c − v‖ over `Direction`, w' negative where c is occupied, normalised;
/// zero where the sum vanishes.
///
/// Where a map keeps hits (`HitStates`) there are two more kinds of elements, which are their own
/// unknown neighbour. Glimpses with no occupied voxel among their 26 neighbours: a wire or a far
/// sheet, met by few rays, that no border leads to. And empty voxels behind surface that is known
/// from before alone, not even by a neighbour's ray from here: the far side of a sheet.
///
/// Follows one map for life: `update` costs O(blocks changed since the last call), whatever the
/// map's size, and gives what a fresh extraction would. A bit a state and voxel is kept, 0.25 KB a
/// block. A map that was cleared needs a new object.
template <NeighborhoodPolicy Unknown = Neighborhood6, NeighborhoodPolicy Occupied = Neighborhood18,
          NeighborhoodPolicy Direction = Neighborhood26>
class BasicIncompleteSurface {
 public:
  static constexpr int kSide = TsdfMap::kBlockSide;
  static_assert(kSide == 8, "a row of a block is a byte");

  explicit BasicIncompleteSurface(IncompleteSurfaceOptions options = {})
      : options_(std::move(options)) {}

  const IncompleteSurfaceOptions& options() const { return options_; }
  double voxel_size() const { return voxel_size_; }

  IncompleteSurfaceChange update(const TsdfMap& map) {
    const VoxelStateOptions states{.known_weight = options_.known_weight};
    return follow(map,
                  [&](const TsdfMap::Block& b) { read(block_states(b, states), StoredState{}); });
  }
  IncompleteSurfaceChange update(const VoxelStateMap& map) {
    return follow(map.grid(), [&](const auto& b) { read(b, StoredState{}); });
  }
  /// Brings the elements up to date with `grid`, always the same grid.
  template <typename Voxel, typename Layer, VoxelStateTest<Voxel> Test>
  IncompleteSurfaceChange update(const VoxelGrid<Voxel, kSide, Layer>& grid, const Test& state) {
    return follow(grid, [&](const auto& b) { read(b, state); });
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// O(1).
  bool contains(const VoxelIndex& v) const {
    const auto* record = records_.find(TsdfMap::block_of(v));
    return record != nullptr &&
           (record->incomplete[row_of(v.y() & 7, v.z() & 7)] >> (v.x() & 7) & 1) != 0;
  }
  /// Calls `fn(const IncompleteElement&)` for each, in an order that depends only on the map's
  /// history.
  template <typename Fn>
  void for_each(Fn&& fn) const {
    records_.for_each_block([&](const auto& block) {
      for (const IncompleteElement& e : block.voxels[0].elements) fn(e);
    });
  }
  /// All of them, by block (z, y, x) and by voxel (z, y, x) within a block: the same for the same
  /// states, however they came about. O(size + blocks log blocks).
  std::vector<IncompleteElement> elements() const {
    std::vector<const typename Records::Block*> order;
    records_.for_each_block([&](const auto& block) {
      if (!block.voxels[0].elements.empty()) order.push_back(&block);
    });
    std::sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
      for (const int axis : {2, 1})
        if (a->index[axis] != b->index[axis]) return a->index[axis] < b->index[axis];
      return a->index.x() < b->index.x();
    });
    std::vector<IncompleteElement> all;
    all.reserve(size_);
    for (const auto* block : order) {
      const auto& own = block->voxels[0].elements;
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }

 private:
  /// One bit a voxel: byte y + 8 z, bit x.
  using Bits = std::array<std::uint8_t, 64>;
  struct Record {
    Bits empty{}, occupied{}, glimpsed{}, incomplete{};
    std::array<Bits, 6> sides{};  ///< Voxels whose surface is known from each axis direction.
    std::uint8_t any_empty = 0, any_occupied = 0, any_glimpsed = 0, any_hit = 0;
    std::uint64_t pass = 0;  ///< Of the last update that listed it as dirty.
    std::vector<IncompleteElement> elements;
  };
  using Records = VoxelGrid<Record, 1>;  // a hash from block index to record
  /// A block's bits and one voxel around it: row (y + 1) + 10 (z + 1), bit x + 1.
  using PaddedBits = std::array<std::uint16_t, 100>;

  static constexpr std::size_t row_of(int y, int z) { return static_cast<std::size_t>(y + 8 * z); }
  static constexpr std::size_t padded_row(int y, int z) {
    return static_cast<std::size_t>(y + 1 + 10 * (z + 1));
  }
  static constexpr int neighbor_slot(int dx, int dy, int dz) {
    return (dx + 1) + 3 * (dy + 1) + 9 * (dz + 1);
  }

  /// Reads what changed of `grid`, and finds anew what that can concern.
  template <typename Grid, typename Read>
  IncompleteSurfaceChange follow(const Grid& grid, Read&& read_block) {
    IncompleteSurfaceChange change;
    voxel_size_ = grid.voxel_size();
    ++pass_;
    dirty_.clear();
    reached_.clear();
    for (const std::uint32_t slot : grid.changed_since(cursor_)) {
      ++change.blocks_read;
      read_block(grid.block(slot));
    }
    cursor_ = grid.revision();
    for (const auto& [index, sides] : reached_) {
      for (int i = 0; i < 27; ++i) {
        if ((sides >> i & 1U) == 0) continue;
        const std::uint32_t slot = records_.find_slot(index + detail::neighbor_offset(i));
        if (slot != Records::kNone) touch(slot);
      }
    }
    change.blocks_examined = dirty_.size();
    for (const std::uint32_t slot : dirty_) examine(records_.block(slot), change);
    size_ += change.added;
    size_ -= change.removed;
    return change;
  }

  void touch(std::uint32_t slot) {
    Record& record = records_.block(slot).voxels[0];
    if (record.pass == pass_) return;
    record.pass = pass_;
    dirty_.push_back(slot);
  }

  /// Takes over a block's states and notes which blocks around it the difference can reach.
  template <typename SourceBlock, typename Test>
  void read(const SourceBlock& block, const Test& state) {
    Bits empty, occupied, glimpsed{};
    std::array<Bits, 6> sides{};
    std::uint8_t any_empty = 0, any_occupied = 0, any_glimpsed = 0, any_hit = 0;
    if constexpr (requires { block.layer.glimpses; }) {
      const auto set = [](Bits& bits, std::uint16_t v) {
        bits[v / 8] = static_cast<std::uint8_t>(bits[v / 8] | 1U << (v % 8));
      };
      for (const std::uint16_t v : block.layer.glimpses) set(glimpsed, v);
      for (const auto& [v, mask] : block.layer.known) {
        for (std::size_t k = 0; k < 6; ++k)
          if ((mask >> k & 1U) != 0) set(sides[k], v);
      }
      any_glimpsed = block.layer.glimpses.empty() ? 0 : 1;
      any_hit = block.layer.known.empty() ? 0 : 1;
    }
    for (std::size_t row = 0; row < 64; ++row) {
      unsigned e = 0, o = 0;
      for (std::size_t x = 0; x < 8; ++x) {
        const VoxelState s = state(block.voxels[row * 8 + x]);
        e |= static_cast<unsigned>(s == VoxelState::empty) << x;
        o |= static_cast<unsigned>(s == VoxelState::occupied) << x;
      }
      empty[row] = static_cast<std::uint8_t>(e);
      occupied[row] = static_cast<std::uint8_t>(o);
      any_empty |= empty[row];
      any_occupied |= occupied[row];
    }
    std::uint32_t slot = records_.find_slot(block.index);
    if (slot == Records::kNone) {
      if ((any_empty | any_occupied | any_glimpsed) == 0) return;
      slot = records_.ensure_slot(block.index);
    }
    Record& record = records_.block(slot).voxels[0];
    std::array<std::uint8_t, 9> changed{};  // by the (dy, dz) of the blocks that are next to a row
    for (int z = 0; z < 8; ++z) {
      for (int y = 0; y < 8; ++y) {
        const std::size_t row = row_of(y, z);
        unsigned changes = (empty[row] ^ record.empty[row]) |
                           (occupied[row] ^ record.occupied[row]) |
                           (glimpsed[row] ^ record.glimpsed[row]);
        for (std::size_t k = 0; k < 6; ++k) changes |= sides[k][row] ^ record.sides[k][row];
        const auto difference = static_cast<std::uint8_t>(changes);
        if (difference == 0) continue;
        for (int dz = z == 0 ? -1 : 0; dz <= (z == 7 ? 1 : 0); ++dz)
          for (int dy = y == 0 ? -1 : 0; dy <= (y == 7 ? 1 : 0); ++dy)
            changed[static_cast<std::size_t>(dy + 1 + 3 * (dz + 1))] |= difference;
      }
    }
    if (changed[4] == 0) return;
    record.empty = empty;
    record.occupied = occupied;
    record.glimpsed = glimpsed;
    record.any_glimpsed = any_glimpsed;
    record.any_hit = any_hit;
    record.sides = sides;
    record.any_empty = any_empty;
    record.any_occupied = any_occupied;
    std::uint32_t reach = 0;
    for (int i = 0; i < 9; ++i) {
      const unsigned bits = changed[static_cast<std::size_t>(i)];
      reach |= ((bits & 1U) | (bits != 0 ? 2U : 0U) | (bits >> 7 << 2)) << (3 * i);
    }
    reached_.emplace_back(block.index, reach);
  }

  /// For every voxel of a row, whether one of its neighbours has its bit set.
  template <NeighborhoodPolicy N>
  static std::uint8_t near_row(const PaddedBits& bits, int y, int z) {
    unsigned found = 0;
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        const unsigned row = bits[padded_row(y + dy, z + dz)];
        if (N::contains(-1, dy, dz)) found |= row << 1;
        if ((dy != 0 || dz != 0) && N::contains(0, dy, dz)) found |= row;
        if (N::contains(1, dy, dz)) found |= row >> 1;
      }
    }
    return static_cast<std::uint8_t>(found >> 1);
  }

  void examine(typename Records::Block& block, IncompleteSurfaceChange& change) {
    static const Record kUnknown{};
    Record& record = block.voxels[0];
    Bits incomplete{};
    PaddedBits occupied, unknown;
    std::array<PaddedBits, 6> sides;
    bool candidates = record.any_empty != 0, with_hits = false;
    if (candidates || record.any_glimpsed != 0) {
      std::array<const Record*, 27> around;
      unsigned any_occupied = 0, any_hit = 0;
      for (int i = 0; i < 27; ++i) {
        const Record* r =
            i == 13 ? &record : records_.find(block.index + detail::neighbor_offset(i));
        around[static_cast<std::size_t>(i)] = r == nullptr ? &kUnknown : r;
        any_occupied |= r == nullptr ? 0U : r->any_occupied;
        any_hit |= r == nullptr ? 0U : r->any_hit;
      }
      candidates = candidates && any_occupied != 0;
      if (candidates || record.any_glimpsed != 0) pad(around, occupied, unknown);
      with_hits = candidates && any_hit != 0;
      if (with_hits) {
        for (std::size_t k = 0; k < 6; ++k)
          pad(
              around, [k](const Record& r) -> const Bits& { return r.sides[k]; }, sides[k]);
      }
    }
    record.elements.clear();
    const auto add = [&](int x, int y, int z, std::uint32_t unknown_neighbors) {
      IncompleteElement e;
      e.voxel = block.index * kSide + VoxelIndex(x, y, z);
      e.position = (e.voxel.template cast<double>() + Eigen::Vector3d::Constant(0.5)) * voxel_size_;
      if (!options_.region.isEmpty() && !options_.region.contains(e.position)) return;
      e.direction = direction(occupied, x, y, z);
      e.unknown = unknown_neighbors;
      incomplete[row_of(y, z)] |= static_cast<std::uint8_t>(1U << x);
      record.elements.push_back(e);
    };
    constexpr std::uint32_t kSelf = 1U << 13;
    for (int z = 0; (candidates || record.any_glimpsed != 0) && z < 8; ++z) {
      for (int y = 0; y < 8; ++y) {
        const std::size_t row = row_of(y, z);
        const unsigned near = record.empty[row] & near_row<Occupied>(occupied, y, z);
        const unsigned found = near != 0 ? near & near_row<Unknown>(unknown, y, z) : 0U;
        unsigned alone = 0;  // by itself, without an unknown neighbour
        if (record.glimpsed[row] != 0)
          alone = record.glimpsed[row] & ~unsigned{near_row<Neighborhood26>(occupied, y, z)};
        if (with_hits && near != 0) alone |= unmet(sides, record.empty[row], y, z) & ~found;
        for (unsigned bits = found | alone; bits != 0; bits &= bits - 1) {
          const int x = std::countr_zero(bits);
          add(x, y, z, (alone >> x & 1U) != 0 ? kSelf : neighbors_in(unknown, x, y, z));
        }
      }
    }
    for (std::size_t row = 0; row < 64; ++row) {
      const unsigned before = record.incomplete[row], after = incomplete[row];
      change.added += static_cast<std::size_t>(std::popcount(after & ~before));
      change.removed += static_cast<std::size_t>(std::popcount(before & ~after));
    }
    record.incomplete = incomplete;
  }

  /// The empty voxels of a row that have beside them, along an axis, a voxel with surface that is
  /// known from the opposite side, while in and around them no hit is known on their own. Rims do
  /// not count: what a rim faces, no side of the sheet is opposite to.
  static unsigned unmet(const std::array<PaddedBits, 6>& sides, unsigned empty, int y, int z) {
    unsigned found = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const int sign : {1, -1}) {
        const int dx = axis == 0 ? -sign : 0, dy = axis == 1 ? -sign : 0,
                  dz = axis == 2 ? -sign : 0;
        const auto own = static_cast<std::size_t>(2 * axis + (sign < 0 ? 1 : 0));
        const unsigned row = sides[own ^ 1][padded_row(y + dy, z + dz)];
        const unsigned beside = empty & (dx < 0 ? row : dx > 0 ? row >> 2 : row >> 1);
        if ((beside & 0xffU) == 0) continue;
        const PaddedBits& side = sides[own];
        const unsigned met =
            near_row<Neighborhood26>(side, y, z) | (side[padded_row(y, z)] >> 1 & 0xffU);
        found |= beside & ~met;
      }
    return found & 0xffU;
  }

  /// One kind of bits of a block with those one voxel around it.
  template <typename BitsOf>
  static void pad(const std::array<const Record*, 27>& around, BitsOf&& bits_of, PaddedBits& bits) {
    for (int z = -1; z <= 8; ++z) {
      const int dz = z < 0 ? -1 : z > 7 ? 1 : 0;
      for (int y = -1; y <= 8; ++y) {
        const int dy = y < 0 ? -1 : y > 7 ? 1 : 0;
        const Record* const* three = &around[static_cast<std::size_t>(neighbor_slot(-1, dy, dz))];
        const std::size_t row = row_of(y & 7, z & 7);
        const unsigned left = bits_of(*three[0])[row], middle = bits_of(*three[1])[row],
                       right = bits_of(*three[2])[row];
        bits[padded_row(y, z)] =
            static_cast<std::uint16_t>((left >> 7) | (middle << 1) | ((right & 1U) << 9));
      }
    }
  }
  static void pad(const std::array<const Record*, 27>& around, PaddedBits& occupied,
                  PaddedBits& unknown) {
    pad(
        around, [](const Record& r) -> const Bits& { return r.occupied; }, occupied);
    pad(
        around, [](const Record& r) -> const Bits& { return r.empty; }, unknown);
    for (std::size_t row = 0; row < unknown.size(); ++row)
      unknown[row] = static_cast<std::uint16_t>(~(occupied[row] | unknown[row]) & 0x3ffU);
  }

  static std::uint32_t neighbors_in(const PaddedBits& unknown, int x, int y, int z) {
    std::uint32_t bits = 0;
    for (int i = 0; i < 27; ++i) {
      const BlockIndex d = detail::neighbor_offset(i);
      if (i == 13 || !Unknown::contains(d.x(), d.y(), d.z())) continue;
      const unsigned row = unknown[padded_row(y + d.y(), z + d.z())];
      bits |= (row >> (x + 1 + d.x()) & 1U) << i;
    }
    return bits;
  }
  static Eigen::Vector3d direction(const PaddedBits& occupied, int x, int y, int z) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        const unsigned row = occupied[padded_row(y + dy, z + dz)];
        for (int dx = -1; dx <= 1; ++dx) {
          if ((dx == 0 && dy == 0 && dz == 0) || !Direction::contains(dx, dy, dz)) continue;
          const Eigen::Vector3d unit = Eigen::Vector3d(dx, dy, dz).normalized();
          if ((row >> (x + 1 + dx) & 1U) != 0)
            sum -= unit;
          else
            sum += unit;
        }
      }
    }
    const double length = sum.norm();
    return length > 1e-9 ? Eigen::Vector3d(sum / length) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }

  IncompleteSurfaceOptions options_;
  double voxel_size_ = 0.0;
  Records records_{{.voxel_size = 1.0}};
  std::uint64_t cursor_ = 0, pass_ = 0;
  std::size_t size_ = 0;
  std::vector<std::uint32_t> dirty_;                           // scratch of one update
  std::vector<std::pair<BlockIndex, std::uint32_t>> reached_;  // scratch of one update
};

using IncompleteSurface = BasicIncompleteSurface<>;
}  // namespace surfleet
