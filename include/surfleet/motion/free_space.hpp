// SPDX-License-Identifier: MIT
/// @file
/// @brief Where a robot's body fits, kept up to date as the map grows.
///
///     FreeSpace free(states, {.radius = 1.0, .bounds = box});
///     free.add_known_free({start, free.required_distance() + 0.5});
///     free.update();                                  // after every update of the map's states
///     if (free.is_free_segment(a, b)) …
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/mapping/distance_transform.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/collision_body.hpp>
#include <surfleet/motion/free_space_options.hpp>
#include <surfleet/motion/obstacle_voxels.hpp>

namespace surfleet {
/// Free-space queries for a robot's body over a map's voxel states. The body is a ball, or of any
/// shape: then a position is free where the body fits whatever its heading.
///
/// An obstacle is an occupied voxel and, by setting, an unknown one. A position is free when the
/// centre of every obstacle voxel is at least `required_distance()` away. Why that is safe: a
/// surface that the map has seen runs between a voxel centre in front of it (empty) and one behind
/// it (occupied or not yet known), at most one voxel edge apart along an axis, so every point of
/// it has an obstacle centre within about one edge; a surface hidden in an unknown voxel lies
/// within half a diagonal, 0.87 edges, of its centre. With the default margin of one edge the body
/// therefore keeps its radius from either. It does not hold for what the map has missed: a
/// structure so thin that every voxel it touches was carved empty. Such things are parts of larger
/// ones: a wide `margin` around what is occupied keeps away from them, while an `unknown_margin` of
/// one edge lets the body go where no more was seen empty than it needs. To have both, occupied
/// voxels are grown by the difference, to half an edge, and the smaller margin holds for all.
///
/// Held inside is the exact Euclidean distance, truncated, from every voxel centre to the nearest
/// obstacle centre; between centres it is interpolated and lowered by the interpolation's largest
/// excess, so it errs to the safe side. An update costs O(changed blocks · (1 + reach / block)³),
/// a query O(1), a segment O(length) with long steps where there is room.
///
/// The map must outlive this object. Reading is thread-safe.
class FreeSpace {
 public:
  static constexpr int kSide = VoxelStateMap::Grid::kBlockSide;
  /// Squared distance in voxels, truncated.
  using Grid = DistanceTransform::Grid;
  static_assert(kSide == kBitsSide, "rows of obstacle bits are bytes");

  /// Throws `Error` for a negative radius or margin, or a body of more than about 21 voxels.
  explicit FreeSpace(const VoxelStateMap& map, FreeSpaceOptions options = {})
      : map_(&map),
        options_(options),
        lengths_(map.voxel_size(), options),
        distances_(map.voxel_size(), lengths_.reach, options.unknown_is_obstacle),
        obstacles_(map, options, lengths_) {
    const double h = map.voxel_size();
    const double free_distance = (lengths_.required + lengths_.excess) / h;
    free_squared_ = static_cast<std::int16_t>(std::ceil(free_distance * free_distance));
    for (int i = 0; i <= lengths_.reach * lengths_.reach; ++i) root_.push_back(h * std::sqrt(i));
    if (!options_.unknown_is_obstacle && options_.all_blocks && !options_.bounds.isEmpty())
      for_each_index(Grid::block_of(grid().index_of(options_.bounds.min())),
                     Grid::block_of(grid().index_of(options_.bounds.max())),
                     [&](const BlockIndex& b) { distances_.mark_changed(distances_.ensure(b)); });
    update();
  }

  const VoxelStateMap& map() const { return *map_; }
  const FreeSpaceOptions& options() const { return options_; }
  double voxel_size() const { return grid().voxel_size(); }
  /// Kept between the body and every obstacle voxel's centre, occupied ones grown [m].
  double obstacle_margin() const { return lengths_.margin; }
  /// Least distance from a free position to an obstacle voxel's centre: radius, obstacle margin and
  /// the slack of stepping along segments; for a body that is no ball, from which on none touches
  /// it, whatever its direction [m].
  double required_distance() const { return lengths_.outer; }

  /// Takes what is unknown in `ball` for empty: the place a robot stands in at the start, which its
  /// camera never sees. Occupied voxels stay obstacles. A body fits in the middle from a radius of
  /// `required_distance()` plus two voxels on. Takes effect with the next `update`.
  void add_known_free(const Sphere& ball) { obstacles_.add_known_free(ball); }

  /// Follows the map. Returns the number of blocks whose distances changed.
  std::size_t update() {
    obstacles_.update(distances_);
    const std::vector<std::uint32_t> changed = distances_.update();
    for (std::size_t slot = free_.size(); slot < grid().block_count(); ++slot)
      free_.push_back(free_bits_of(static_cast<std::uint32_t>(slot)));
    for (const std::uint32_t slot : changed) free_[slot] = free_bits_of(slot);
    return changed.size();
  }

  // -- queries -----------------------------------------------------------------------------------
  /// Reads distances; remembers the last block. One a thread; invalid after an update.
  class Probe {
   public:
    explicit Probe(const FreeSpace& space) : space_(&space) {}

    /// How much farther than required the nearest obstacle is, from below where it matters (at 0
    /// and above); negative where the body does not fit. Truncated at about two voxels [m].
    double slack(const Point3& p) {
      const double h = space_->voxel_size();
      const Eigen::Vector3d u = p / h - Eigen::Vector3d::Constant(0.5);
      if (!(u.cwiseAbs().maxCoeff() < 1 << 29)) return -space_->lengths_.required;
      const VoxelIndex base(floor_int(u.x()), floor_int(u.y()), floor_int(u.z()));
      const Eigen::Vector3d f = u - base.cast<double>();
      const auto weight = [&](int k) {
        return ((k & 1) != 0 ? f.x() : 1.0 - f.x()) * ((k & 2) != 0 ? f.y() : 1.0 - f.y()) *
               ((k & 4) != 0 ? f.z() : 1.0 - f.z());
      };
      double sum = 0.0;
      const std::size_t first = Grid::offset_of(base);
      if (const VoxelIndex in(base.x() & (kSide - 1), base.y() & (kSide - 1),
                              base.z() & (kSide - 1));
          in.maxCoeff() < kSide - 1 && find(Grid::block_of(base)) != nullptr) {
        // All eight in one block.
        for (int k = 0; k < 8; ++k) {
          const std::size_t at =
              first + static_cast<std::size_t>((k & 1) + kSide * ((k >> 1 & 1) + kSide * (k >> 2)));
          sum += weight(k) * space_->root_[static_cast<std::size_t>(block_->voxels[at])];
        }
      } else {
        for (int k = 0; k < 8; ++k)
          if (const double w = weight(k); w > 0.0)
            sum += w * space_->root_[squared(base + VoxelIndex(k & 1, (k >> 1) & 1, k >> 2))];
      }
      return sum - space_->lengths_.excess - space_->lengths_.required;
    }
    /// Squared distance from a voxel's centre to the nearest obstacle's, in voxels, truncated.
    std::size_t squared(const VoxelIndex& v) {
      const Grid::Block* block = find(Grid::block_of(v));
      return block == nullptr ? static_cast<std::size_t>(space_->distances_.outside())
                              : static_cast<std::size_t>(block->voxels[Grid::offset_of(v)]);
    }

   private:
    const Grid::Block* find(const BlockIndex& b) {
      if (!cached_ || b != index_) {
        block_ = space_->grid().find_block(b);
        index_ = b;
        cached_ = true;
      }
      return block_;
    }
    static int floor_int(double x) { return static_cast<int>(std::floor(x)); }
    const FreeSpace* space_;
    const Grid::Block* block_ = nullptr;
    BlockIndex index_ = BlockIndex::Zero();
    bool cached_ = false;
  };
  Probe probe() const { return Probe(*this); }

  bool in_bounds(const Point3& p) const {
    return p.allFinite() && (options_.bounds.isEmpty() || options_.bounds.contains(p));
  }
  bool is_free(const Point3& p) const { return in_bounds(p) && probe().slack(p) >= 0.0; }

  /// Whether the body fits along all of it; every point of the segment then keeps the radius and
  /// the margin from every obstacle voxel's centre.
  bool is_free_segment(const Point3& a, const Point3& b) const {
    return free_length(a, b) == std::numeric_limits<double>::infinity();
  }
  /// How far the body gets from `a` towards `b` [m]; infinite if it gets there.
  double free_length(const Point3& a, const Point3& b) const {
    if (!in_bounds(a)) return 0.0;
    const double length = (b - a).norm();
    const Eigen::Vector3d direction =
        length > 0.0 ? Eigen::Vector3d((b - a) / length) : Eigen::Vector3d::Zero();
    Probe read(*this);
    if (!in_bounds(b) || read.slack(b) < 0.0) {
      double last = 0.0;
      for (double t = 0.0; t < length;) {
        const Point3 p = a + t * direction;
        const double s = in_bounds(p) ? read.slack(p) : -1.0;
        if (s < 0.0) return last;
        last = t;
        t += std::max(s, lengths_.step);
      }
      return last;
    }
    for (double t = 0.0, last = 0.0; t < length;) {
      const double s = read.slack(a + t * direction);
      if (s < 0.0) return last;
      last = t;
      t += std::max(s, lengths_.step);
    }
    return std::numeric_limits<double>::infinity();
  }

  /// Distance from `p` to what the body must not touch [m]: obstacle voxel centres less the margin.
  /// From below where the body fits, far below for one that is no ball; deep inside it may be a
  /// tenth of a voxel too large. Negative beside an obstacle, truncated at about two voxels more
  /// than the radius. Takes no account of the bounds.
  double clearance(const Point3& p) const { return probe().slack(p) + lengths_.body.radius; }

  /// Voxel centres where the body fits, at most `max_distance` away and the nearest first.
  /// O(n log n) in the voxels within that distance.
  std::vector<Point3> free_centers_near(const Point3& p, double max_distance) const {
    const VoxelIndex middle = grid().index_of(p);
    const int n = static_cast<int>(std::ceil(max_distance / voxel_size())) + 1;
    std::vector<std::pair<double, Point3>> near;
    for_each_index(middle - VoxelIndex::Constant(n), middle + VoxelIndex::Constant(n),
                   [&](const VoxelIndex& v) {
                     if (!is_free_voxel(v)) return;
                     const Point3 c = grid().center(v);
                     const double d = (c - p).norm();
                     if (d <= max_distance) near.emplace_back(d, c);
                   });
    std::stable_sort(near.begin(), near.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Point3> centers;
    for (const auto& [distance, center] : near) centers.push_back(center);
    return centers;
  }
  /// The nearest voxel centre where the body fits, at most `max_distance` away, that can be reached
  /// straight without coming notably closer to an obstacle than at `p`: the escape of a robot that
  /// finds itself in what has since turned out to be no free place.
  std::optional<Point3> nearest_free(const Point3& p, double max_distance) const {
    if (!p.allFinite()) return std::nullopt;
    Probe read(*this);
    const double floor = std::min(read.slack(p), 0.0) - 0.1 * voxel_size();
    for (const Point3& c : free_centers_near(p, max_distance)) {
      const double distance = (c - p).norm();
      bool ok = true;
      for (double t = lengths_.step; ok && t < distance; t += lengths_.step)
        ok = read.slack(p + (c - p) * (t / distance)) >= floor;
      if (ok) return c;
    }
    return std::nullopt;
  }

  /// Where a search for paths begins: `p`, or if that has since turned out not to be free
  /// `nearest_free`, if there is one within `max_distance`.
  Point3 free_start(const Point3& p, double max_distance = 2.0) const {
    return is_free(p) ? p : nearest_free(p, max_distance).value_or(p);
  }

  // -- the voxel lattice -------------------------------------------------------------------------
  /// Free centres, a bit a voxel; bit `Grid::offset_of(v)`.
  using FreeBits = std::array<std::uint64_t, Grid::kBlockVoxels / 64>;

  /// Whether a voxel's centre is free. The straight line between two face neighbours that are both
  /// free is free, so paths on this lattice are valid paths.
  bool is_free_voxel(const VoxelIndex& v) const {
    const std::uint32_t slot = grid().find_slot(Grid::block_of(v));
    if (slot == Grid::kNone) return !options_.unknown_is_obstacle && in_bounds(grid().center(v));
    return is_free_in(slot, Grid::offset_of(v));
  }
  bool is_free_in(std::uint32_t slot, std::size_t offset) const {
    return ((free_[slot][offset / 64] >> (offset % 64)) & 1U) != 0;
  }
  const FreeBits& free_bits(std::uint32_t slot) const { return free_[slot]; }

  /// The distances; its slots, revision and `changed_since` tell consumers what to read again.
  const Grid& grid() const { return distances_.grid(); }
  std::uint64_t revision() const { return grid().revision(); }
  std::vector<std::uint32_t> changed_since(std::uint64_t cursor) const {
    return grid().changed_since(cursor);
  }
  /// The region whose queries a block's voxels decide.
  Box3 influence(std::uint32_t slot) const {
    const double h = voxel_size();
    const Point3 lo = (grid().block(slot).origin().cast<double>()) * h;
    return Box3(lo - Point3::Constant(0.5 * h), lo + Point3::Constant((kSide + 0.5) * h));
  }
  std::size_t memory_bytes() const {
    return distances_.memory_bytes() + obstacles_.memory_bytes() + free_.size() * sizeof(FreeBits);
  }

  /// Whether a voxel is an obstacle, by the settings and the known-free balls; occupied ones grown.
  bool is_obstacle(const VoxelIndex& v) const { return obstacles_.contains(distances_, v); }

 private:
  FreeBits free_bits_of(std::uint32_t slot) const {
    FreeBits bits{};
    const Grid::Block& block = grid().block(slot);
    const Box3 centers(grid().center(block.origin()),
                       grid().center(block.origin() + VoxelIndex::Constant(kSide - 1)));
    const bool inside = options_.bounds.isEmpty() || options_.bounds.contains(centers);
    if (!inside && !options_.bounds.intersects(centers)) return bits;
    for (std::size_t o = 0; o < Grid::kBlockVoxels; ++o)
      if (block.voxels[o] >= free_squared_ &&
          (inside || options_.bounds.contains(grid().center(Grid::index_in(block, o)))))
        bits[o / 64] |= std::uint64_t{1} << (o % 64);
    return bits;
  }

  const VoxelStateMap* map_;
  FreeSpaceOptions options_;
  FreeSpaceLengths lengths_;
  DistanceTransform distances_;
  ObstacleVoxels obstacles_;
  std::int16_t free_squared_ = 0;
  std::vector<double> root_;    // h √i
  std::vector<FreeBits> free_;  // by slot
};
}  // namespace surfleet
