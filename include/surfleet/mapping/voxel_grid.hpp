// SPDX-License-Identifier: MIT
/// @file
/// @brief A sparse, unbounded grid of voxels in hashed blocks that remembers what changed.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// Integer coordinates of a voxel, or of a block of voxels.
using VoxelIndex = Eigen::Vector3i;
/// The same as a key of ordered containers.
using VoxelKey = std::array<int, 3>;
inline VoxelKey key_of(const VoxelIndex& v) { return {v.x(), v.y(), v.z()}; }
/// The cell of `width` voxels that voxel `i` of an axis is in.
inline int cell_of_width(int i, int width) {
  return i >= 0 ? i / width : -((width - 1 - i) / width);
}
/// `fn` of every index from `lo` to `hi`, both included; x runs fastest.
template <typename Fn>
void for_each_index(const VoxelIndex& lo, const VoxelIndex& hi, Fn&& fn) {
  for (int z = lo.z(); z <= hi.z(); ++z)
    for (int y = lo.y(); y <= hi.y(); ++y)
      for (int x = lo.x(); x <= hi.x(); ++x) fn(VoxelIndex(x, y, z));
}
using BlockIndex = Eigen::Vector3i;

/// What a block keeps beside its voxels when it keeps nothing.
struct NoLayer {
  std::size_t memory_bytes() const { return 0; }
};

struct VoxelGridOptions {
  double voxel_size = 0.1;  ///< Edge of a voxel [m].
};

/// Voxels in cubic blocks of `kSide`³, found through a hash table.
///
/// Voxel (i, j, k) covers [i, i + 1) × … times the voxel size; its centre is half a voxel further.
/// Access is O(1); an `Accessor` that stays in one block skips the hash. Blocks keep the slot they
/// were made in, so iteration by slot is deterministic. Whoever writes into a block says so with
/// `mark_changed`; whoever follows the grid asks `changed_since(cursor)`, whose cost is the number
/// of changes, not the size of the grid. Reading is thread-safe; writing is, block by block, once
/// the blocks exist.
///
/// `Layer` is what a block keeps beside its voxels, as a rule something sparse; it is part of the
/// block for change tracking, copies and memory.
template <typename Voxel, int kSide = 8, typename Layer = NoLayer>
class VoxelGrid {
  static_assert(kSide > 0 && (kSide & (kSide - 1)) == 0, "the side is a power of two");

 public:
  using voxel_type = Voxel;
  using layer_type = Layer;
  static constexpr int kBlockSide = kSide;
  static constexpr int kBlockShift = std::countr_zero(static_cast<unsigned>(kSide));
  static constexpr std::size_t kBlockVoxels = static_cast<std::size_t>(kSide) * kSide * kSide;

  struct Block {
    BlockIndex index = BlockIndex::Zero();
    std::uint64_t changed = 0;  ///< Number of its last change; 0 if never marked.
    std::array<Voxel, kBlockVoxels> voxels{};
    [[no_unique_address]] Layer layer{};

    /// The index of the block's first voxel.
    VoxelIndex origin() const { return index * kSide; }
  };

  /// Throws `Error` unless the voxel size is positive and finite.
  explicit VoxelGrid(VoxelGridOptions options = {}) : options_(options) {
    require(options.voxel_size > 0.0 && std::isfinite(options.voxel_size),
            "voxel size " + std::to_string(options.voxel_size) + " m: expected a positive length");
    inverse_size_ = 1.0 / options.voxel_size;
    table_.resize(64);
  }

  /// A copy has its own blocks, in the same slots, and the same account of changes. O(blocks).
  VoxelGrid(const VoxelGrid& other)
      : options_(other.options_),
        inverse_size_(other.inverse_size_),
        table_(other.table_),
        log_(other.log_),
        revision_(other.revision_) {
    blocks_.reserve(other.blocks_.size());
    for (const auto& b : other.blocks_) blocks_.push_back(std::make_unique<Block>(*b));
  }
  VoxelGrid& operator=(const VoxelGrid& other) {
    if (this != &other) *this = VoxelGrid(other);
    return *this;
  }
  VoxelGrid(VoxelGrid&&) noexcept = default;
  VoxelGrid& operator=(VoxelGrid&&) noexcept = default;
  ~VoxelGrid() = default;

  double voxel_size() const { return options_.voxel_size; }
  std::size_t block_count() const { return blocks_.size(); }
  bool empty() const { return blocks_.empty(); }
  /// Memory of blocks, layers, table and change log [bytes]. O(blocks).
  std::size_t memory_bytes() const {
    std::size_t layers = 0;
    for (const auto& b : blocks_) layers += b->layer.memory_bytes();
    return layers + blocks_.size() * (sizeof(Block) + sizeof(void*)) +
           table_.size() * sizeof(Entry) + log_.size() * sizeof(log_[0]);
  }

  /// The voxel that holds `p`. Throws `Error` if it does not fit 30 bits an axis.
  VoxelIndex index_of(const Point3& p) const {
    const Eigen::Vector3d s = p * inverse_size_;
    require((s.array().abs() < 1 << 30).all(),
            "point outside the grid: expected finite coordinates below 2^30 voxels");
    return {static_cast<int>(std::floor(s.x())), static_cast<int>(std::floor(s.y())),
            static_cast<int>(std::floor(s.z()))};
  }
  Point3 center(const VoxelIndex& v) const {
    return (v.cast<double>() + Eigen::Vector3d::Constant(0.5)) * options_.voxel_size;
  }
  static BlockIndex block_of(const VoxelIndex& v) {
    return {v.x() >> kBlockShift, v.y() >> kBlockShift, v.z() >> kBlockShift};
  }
  /// Place of a voxel in its block, x fastest.
  static std::size_t offset_of(const VoxelIndex& v) {
    constexpr int m = kSide - 1;
    return static_cast<std::size_t>((v.x() & m) | ((v.y() & m) << kBlockShift) |
                                    ((v.z() & m) << (2 * kBlockShift)));
  }
  /// The voxel at `offset` of a block; inverse of `offset_of`.
  static VoxelIndex index_in(const Block& block, std::size_t offset) {
    const int o = static_cast<int>(offset);
    constexpr int m = kSide - 1;
    return block.origin() + VoxelIndex(o & m, (o >> kBlockShift) & m, (o >> (2 * kBlockShift)) & m);
  }

  // -- blocks ------------------------------------------------------------------------------------
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// Slot of a block, or `kNone`.
  std::uint32_t find_slot(const BlockIndex& b) const {
    for (std::size_t h = hash(b);; ++h) {
      const Entry& e = table_[h & (table_.size() - 1)];
      if (e.slot == kNone) return kNone;
      if (e.x == b.x() && e.y == b.y() && e.z == b.z()) return e.slot;
    }
  }
  const Block* find_block(const BlockIndex& b) const {
    const std::uint32_t slot = find_slot(b);
    return slot == kNone ? nullptr : blocks_[slot].get();
  }
  Block* find_block(const BlockIndex& b) {
    return const_cast<Block*>(std::as_const(*this).find_block(b));
  }
  /// Slot of the block, which is made of default voxels if it is not there.
  std::uint32_t ensure_slot(const BlockIndex& b) {
    const std::uint32_t found = find_slot(b);
    if (found != kNone) return found;
    auto block = std::make_unique<Block>();
    block->index = b;
    return adopt(std::move(block));
  }
  /// Takes over a block that was filled outside, at its index, where the grid must have none.
  std::uint32_t adopt(std::unique_ptr<Block> block) {
    if ((blocks_.size() + 1) * 2 > table_.size()) grow();
    const auto slot = static_cast<std::uint32_t>(blocks_.size());
    blocks_.push_back(std::move(block));  // first: it may fail, and then nothing has happened
    insert(blocks_.back()->index, slot);
    return slot;
  }
  Block& ensure_block(const BlockIndex& b) { return *blocks_[ensure_slot(b)]; }
  /// Blocks in the order they were made; slots are indices here.
  const Block& block(std::uint32_t slot) const { return *blocks_[slot]; }
  Block& block(std::uint32_t slot) { return *blocks_[slot]; }

  /// Makes a block what it was when nothing had been written to it, and marks the change: whoever
  /// follows the grid sees known space become unknown. The block itself stays.
  void forget(std::uint32_t slot) {
    blocks_[slot]->voxels.fill(Voxel{});
    blocks_[slot]->layer = Layer{};
    mark_changed(slot);
  }

  /// Calls `fn(const Block&)` for every block in the order they were made.
  template <typename Fn>
  void for_each_block(Fn&& fn) const {
    for (const auto& b : blocks_) fn(std::as_const(*b));
  }

  // -- voxels ------------------------------------------------------------------------------------
  const Voxel* find(const VoxelIndex& v) const {
    const Block* b = find_block(block_of(v));
    return b == nullptr ? nullptr : &b->voxels[offset_of(v)];
  }
  /// The voxel, made if absent. The caller marks the change.
  Voxel& ensure(const VoxelIndex& v) { return ensure_block(block_of(v)).voxels[offset_of(v)]; }

  /// Reads voxels and remembers the last block, so that walks along a ray or a neighbourhood
  /// seldom hash. Invalid once a block is added. One accessor a thread.
  class Accessor {
   public:
    explicit Accessor(const VoxelGrid& grid) : grid_(&grid) {}
    const Voxel* find(const VoxelIndex& v) {
      const Block* block = find_block(v);
      return block == nullptr ? nullptr : &block->voxels[offset_of(v)];
    }
    /// The block of a voxel.
    const Block* find_block(const VoxelIndex& v) {
      // No voxel of another block has the high bits of the first of this one.
      if ((((v.x() ^ x_) | (v.y() ^ y_) | (v.z() ^ z_)) & ~(kSide - 1)) != 0) move_to(v);
      return block_;
    }

   private:
    /// Apart from `find_block`, which is to be small enough to become part of its callers.
    [[gnu::noinline]] void move_to(const VoxelIndex& v) {
      block_ = grid_->find_block(block_of(v));
      x_ = v.x() & ~(kSide - 1);
      y_ = v.y() & ~(kSide - 1);
      z_ = v.z() & ~(kSide - 1);
    }
    const VoxelGrid* grid_;
    const Block* block_ = nullptr;
    int x_ = std::numeric_limits<int>::min(), y_ = 0, z_ = 0;  // beyond any voxel
  };
  Accessor accessor() const { return Accessor(*this); }

  /// The same for writing: `ensure` that remembers the last block. Marks nothing.
  class Writer {
   public:
    explicit Writer(VoxelGrid& grid) : grid_(&grid) {}
    Voxel& ensure(const VoxelIndex& v) {
      const BlockIndex b = block_of(v);
      if (block_ == nullptr || block_->index != b) block_ = &grid_->ensure_block(b);
      return block_->voxels[offset_of(v)];
    }

   private:
    VoxelGrid* grid_;
    Block* block_ = nullptr;  // blocks stay where they are
  };

  // -- changes -----------------------------------------------------------------------------------
  /// Number of the latest change; a cursor for `changed_since`.
  std::uint64_t revision() const { return revision_; }
  void mark_changed(std::uint32_t slot) {
    if (log_.size() > 2 * blocks_.size() + 1024) compact_log();
    blocks_[slot]->changed = ++revision_;
    log_.emplace_back(revision_, slot);
  }
  /// Slots of the blocks marked after `cursor`, each once, oldest change first.
  std::vector<std::uint32_t> changed_since(std::uint64_t cursor) const {
    std::vector<std::uint32_t> slots;
    auto it = std::upper_bound(log_.begin(), log_.end(), cursor,
                               [](std::uint64_t c, const auto& e) { return c < e.first; });
    for (; it != log_.end(); ++it)
      if (blocks_[it->second]->changed == it->first) slots.push_back(it->second);
    return slots;
  }

 private:
  struct Entry {
    std::int32_t x = 0, y = 0, z = 0;
    std::uint32_t slot = kNone;
  };
  static std::size_t hash(const BlockIndex& b) {
    const auto u = [](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)); };
    std::uint64_t h = u(b.x()) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ (h >> 32) ^ u(b.y())) * 0xbf58476d1ce4e5b9ULL;
    h = (h ^ (h >> 32) ^ u(b.z())) * 0x94d049bb133111ebULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
  void insert(const BlockIndex& b, std::uint32_t slot) {
    std::size_t h = hash(b) & (table_.size() - 1);
    while (table_[h].slot != kNone) h = (h + 1) & (table_.size() - 1);
    table_[h] = {b.x(), b.y(), b.z(), slot};
  }
  void grow() {
    table_.assign(table_.size() * 2, Entry{});
    for (std::uint32_t s = 0; s < blocks_.size(); ++s) insert(blocks_[s]->index, s);
  }
  void compact_log() {
    std::erase_if(log_, [&](const auto& e) { return blocks_[e.second]->changed != e.first; });
  }

  VoxelGridOptions options_;
  double inverse_size_ = 1.0;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<Entry> table_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> log_;
  std::uint64_t revision_ = 0;
};
}  // namespace surfleet
