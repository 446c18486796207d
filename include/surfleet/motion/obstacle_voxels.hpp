// SPDX-License-Identifier: MIT
/// @file
/// @brief Which voxels are obstacles to a body, kept up to date as the map grows.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/mapping/block_bits.hpp>
#include <surfleet/mapping/distance_transform.hpp>
#include <surfleet/mapping/grown_voxels.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/collision_body.hpp>
#include <surfleet/motion/free_space_options.hpp>

namespace surfleet {
/// The obstacles of a `FreeSpace`: occupied voxels, grown by what their margin is more than that of
/// unknown ones; unknown voxels, by setting, outside the known-free balls; those beside a keep-out
/// box. For a body that is no ball, distances are told of all these grown by the body's balls.
///
/// The map must outlive this object. An update costs by what has changed.
class ObstacleVoxels {
 public:
  using Grid = DistanceTransform::Grid;

  ObstacleVoxels(const VoxelStateMap& map, FreeSpaceOptions options,
                 const FreeSpaceLengths& lengths)
      : map_(&map),
        options_(std::move(options)),
        lengths_(lengths),
        occupied_(VoxelKernel::ball(lengths.growth)) {
    if (options_.shape)
      by_body_.emplace(lengths.body.centers.mirrored(), options_.unknown_is_obstacle);
    add_keep_out();
  }

  /// See `FreeSpace`.
  void add_known_free(const Sphere& ball) {
    known_free_.push_back(ball);
    const Eigen::Vector3d r = Eigen::Vector3d::Constant(ball.radius);
    add_pending(Box3(ball.center - r, ball.center + r));
  }

  /// Tells `distances`, which are not updated yet, what has changed in the map and the settings.
  void update(DistanceTransform& distances) {
    std::vector<BlockIndex> stale;
    for (const std::uint32_t slot : map_->grid().changed_since(cursor_)) {
      const auto& block = map_->grid().block(slot);
      stale.push_back(block.index);
      if (lengths_.growth <= 0.0) continue;
      const BlockBits occupied =
          bits_where(block, [](VoxelState s) { return s == VoxelState::occupied; });
      if (occupied_.set(block.index, occupied, stale)) distances.ensure(block.index);
    }
    cursor_ = map_->grid().revision();
    stale.insert(stale.end(), pending_.begin(), pending_.end());
    pending_.clear();
    if (lengths_.growth > 0.0) make_unique(stale);
    if (!by_body_) {
      for (const BlockIndex& b : stale) distances.set(b, bits_of(b));
      return;
    }
    std::vector<BlockIndex> grown_into;
    for (const BlockIndex& b : stale) by_body_->set(b, bits_of(b), grown_into);
    make_unique(grown_into);
    for (const BlockIndex& b : grown_into) {
      BlockBits bits = by_body_->at(b);
      by_body_->add_grown(b, bits);
      distances.set(b, bits);
    }
  }

  /// Whether a voxel is one, as of the last update of `distances`; none for the body's shape.
  bool contains(const DistanceTransform& distances, const VoxelIndex& v) const {
    return by_body_ ? by_body_->contains(v) : distances.is_obstacle(v);
  }
  std::size_t memory_bytes() const {
    return occupied_.memory_bytes() + (by_body_ ? by_body_->memory_bytes() : 0);
  }

 private:
  /// A block is named by many.
  static void make_unique(std::vector<BlockIndex>& blocks) {
    std::sort(blocks.begin(), blocks.end(),
              [](const BlockIndex& a, const BlockIndex& b) { return key_of(a) < key_of(b); });
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  }
  void add_pending(const Box3& box) {
    const auto& grid = map_->grid();
    for_each_index(Grid::block_of(grid.index_of(box.min())),
                   Grid::block_of(grid.index_of(box.max())),
                   [&](const BlockIndex& b) { pending_.push_back(b); });
  }
  /// `fn(offset, centre)` of the voxels of a block.
  template <typename Fn>
  void for_each_center(const Point3& first, Fn&& fn) const {
    for (std::size_t o = 0; o < Grid::kBlockVoxels; ++o)
      fn(o, Point3(first + map_->voxel_size() * Point3(static_cast<double>(o % 8),
                                                       static_cast<double>(o / 8 % 8),
                                                       static_cast<double>(o / 64))));
  }

  /// Which voxels of a block of the map are in a state that `is` says.
  template <typename Is>
  static BlockBits bits_where(const VoxelStateMap::Grid::Block& block, Is&& is) {
    BlockBits bits{};
    for (std::size_t row = 0; row < bits.size(); ++row) {
      unsigned b = 0;
      for (std::size_t x = 0; x < 8; ++x)
        b |= static_cast<unsigned>(is(block.voxels[row * 8 + x])) << x;
      bits[row] = static_cast<std::uint8_t>(b);
    }
    return bits;
  }
  BlockBits bits_of(const BlockIndex& index) const {
    const double h = map_->voxel_size();
    const Point3 first = map_->grid().center(index * kBitsSide);
    const Box3 centers(first, first + Point3::Constant((kBitsSide - 1) * h));
    BlockBits bits = map_bits(index);
    if (options_.unknown_is_obstacle) clear_known_free(index, first, centers, bits);
    if (lengths_.growth > 0.0) occupied_.add_grown(index, bits);
    add_kept_out(first, centers, bits);
    return bits;
  }
  BlockBits map_bits(const BlockIndex& index) const {
    const bool unknown = options_.unknown_is_obstacle;
    if (const auto* block = map_->grid().find_block(index))
      return bits_where(*block, [unknown](VoxelState s) {
        return s == VoxelState::occupied || (s == VoxelState::unknown && unknown);
      });
    BlockBits bits;
    bits.fill(unknown ? 0xFF : 0x00);
    return bits;
  }
  void clear_known_free(const BlockIndex& index, const Point3& first, const Box3& centers,
                        BlockBits& bits) const {
    const auto* block = map_->grid().find_block(index);
    for (const Sphere& ball : known_free_) {
      if (centers.squaredExteriorDistance(ball.center) > ball.radius * ball.radius) continue;
      for_each_center(first, [&](std::size_t o, const Point3& c) {
        if (block != nullptr && block->voxels[o] != VoxelState::unknown) return;
        if ((c - ball.center).squaredNorm() <= ball.radius * ball.radius)
          bits[o / 8] = static_cast<std::uint8_t>(bits[o / 8] & ~(1U << (o % 8)));
      });
    }
  }

  /// How near a box of `keep_out` voxel centres are obstacles: every point within the radius of the
  /// body's balls then has one within `lengths_.required`, as it has a centre within half a
  /// diagonal.
  double keep_out_reach() const {
    const double half_diagonal = 0.5 * std::sqrt(3.0) * map_->voxel_size();
    return half_diagonal + std::max(0.0, half_diagonal - lengths_.margin);
  }
  /// Where unknown space is free, the blocks in question must be examined though the map has none.
  void add_keep_out() {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(keep_out_reach());
    const Eigen::Vector3d far =
        Eigen::Vector3d::Constant(lengths_.outer + lengths_.excess + map_->voxel_size());
    for (const Box3& box : options_.keep_out.boxes) {
      require(box.min().allFinite() && box.max().allFinite() && !box.isEmpty(),
              "keep-out: expected boxes with each minimum at most its maximum");
      Box3 near(box.min() - reach, box.max() + reach);
      if (!options_.bounds.isEmpty())
        near = near.intersection(Box3(options_.bounds.min() - far, options_.bounds.max() + far));
      if (!near.isEmpty()) add_pending(near);
    }
  }
  void add_kept_out(const Point3& first, const Box3& centers, BlockBits& bits) const {
    const double reach = keep_out_reach();
    for (const Box3& box : options_.keep_out.boxes) {
      if (box.exteriorDistance(centers) > reach) continue;
      for_each_center(first, [&](std::size_t o, const Point3& c) {
        if (box.squaredExteriorDistance(c) <= reach * reach)
          bits[o / 8] = static_cast<std::uint8_t>(bits[o / 8] | 1U << (o % 8));
      });
    }
  }

  const VoxelStateMap* map_;
  FreeSpaceOptions options_;
  FreeSpaceLengths lengths_;
  GrownVoxels occupied_;                // of the map, by the growth
  std::optional<GrownVoxels> by_body_;  // all, by the centres of the body's balls
  std::vector<Sphere> known_free_;
  std::vector<BlockIndex> pending_;
  std::uint64_t cursor_ = 0;
};
}  // namespace surfleet
