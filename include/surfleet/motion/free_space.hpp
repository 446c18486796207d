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
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/collision_body.hpp>

namespace surfleet {
struct FreeSpaceOptions {
  double radius = 1.0;              ///< Of the body [m].
  bool unknown_is_obstacle = true;  ///< Whether what was never seen blocks the way.
  Box3 bounds{};                    ///< The body's centre stays inside; empty: no bounds.
  /// Kept between the body and the centre of an occupied voxel; one voxel edge if not given [m].
  std::optional<double> margin{};
  /// The same for an unknown voxel, `margin` at the most; that if not given [m].
  std::optional<double> unknown_margin{};
  /// Obstacles, whatever the map says of them.
  KeepOut keep_out{};
};

/// Free-space queries for a ball-shaped body over a map's voxel states.
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
  using Grid = VoxelGrid<std::int16_t, kSide>;
  static_assert(kSide == 8, "rows of obstacle bits are bytes");

  /// Throws `Error` for a negative radius or margin, or a body of more than about 21 voxels.
  explicit FreeSpace(const VoxelStateMap& map, FreeSpaceOptions options = {})
      : map_(&map), options_(options), grid_({.voxel_size = map.voxel_size()}) {
    const double h = map.voxel_size();
    require(options.radius >= 0.0 && std::isfinite(options.radius),
            "body radius " + std::to_string(options.radius) + " m: expected a length of 0 or more");
    const double margin = options.margin.value_or(h);
    require(margin >= 0.0 && std::isfinite(margin),
            "margin " + std::to_string(margin) + " m: expected a length of 0 or more");
    margin_ = options.unknown_is_obstacle ? options.unknown_margin.value_or(margin) : margin;
    require(margin_ >= 0.0 && margin_ <= margin, "margin " + std::to_string(margin_) +
                                                     " m of what is unknown: expected 0 to " +
                                                     std::to_string(margin) + " m");
    growth_ = margin > margin_ ? (margin - margin_) / h + 0.5 : 0.0;
    require(growth_ < kSide, "margin " + std::to_string(margin) + " m: expected less than " +
                                 std::to_string(kSide) + " voxels beyond that of what is unknown");
    step_ = h / 6.0;
    required_ = options.radius + margin_ + 0.5 * step_;
    // A distance to one point, interpolated trilinearly, is too large by at most h²/(4ρ), with ρ
    // the least distance in the cell; the minimum over obstacles only lowers it.
    excess_ = h * h / (4.0 * std::max(required_ - std::sqrt(3.0) * h, 0.5 * h));
    const double reach = (required_ + excess_) / h + 2.0;
    require(reach <= kMaxReach, "body radius " + std::to_string(options.radius) + " m is " +
                                    std::to_string(options.radius / h) +
                                    " voxels: expected at most " + std::to_string(kMaxReach - 4) +
                                    "; use larger voxels");
    reach_ = static_cast<int>(std::ceil(reach));
    halo_ = (reach_ + kSide - 1) / kSide;
    const double free_distance = (required_ + excess_) / h;
    free_squared_ = static_cast<std::int16_t>(std::ceil(free_distance * free_distance));
    for (int i = 0; i <= reach_ * reach_; ++i) root_.push_back(h * std::sqrt(i));
    if (!options_.unknown_is_obstacle && !options_.bounds.isEmpty())
      for_each_index(Grid::block_of(grid_.index_of(options_.bounds.min())),
                     Grid::block_of(grid_.index_of(options_.bounds.max())),
                     [&](const BlockIndex& b) { grid_.mark_changed(make(b)); });
    add_keep_out();
    update();
  }

  const VoxelStateMap& map() const { return *map_; }
  const FreeSpaceOptions& options() const { return options_; }
  double voxel_size() const { return grid_.voxel_size(); }
  /// Kept between the body and every obstacle voxel's centre, occupied ones grown [m].
  double obstacle_margin() const { return margin_; }
  /// Least distance from a free position to an obstacle voxel's centre: radius, obstacle margin and
  /// the slack of stepping along segments [m].
  double required_distance() const { return required_; }

  /// Takes what is unknown in `ball` for empty: the place a robot stands in at the start, which its
  /// camera never sees. Occupied voxels stay obstacles. A body fits in the middle from a radius of
  /// `required_distance()` plus two voxels on. Takes effect with the next `update`.
  void add_known_free(const Sphere& ball) {
    known_free_.push_back(ball);
    const Eigen::Vector3d r = Eigen::Vector3d::Constant(ball.radius);
    const BlockIndex lo = Grid::block_of(grid_.index_of(ball.center - r));
    const BlockIndex hi = Grid::block_of(grid_.index_of(ball.center + r));
    for_each_index(lo, hi, [&](const BlockIndex& b) { pending_.push_back(b); });
  }

  /// Follows the map. Returns the number of blocks whose distances changed.
  std::size_t update() {
    std::vector<Change> changes;
    const auto refresh = [&](const BlockIndex& index) {
      RowBits bits = obstacle_bits(index);
      block_keep_out(index, bits);
      std::uint32_t slot = grid_.find_slot(index);
      const RowBits old = slot == Grid::kNone ? default_bits() : bits_[slot];
      if (bits == old) return;
      if (slot == Grid::kNone) slot = make(index);
      changes.push_back(difference(index, bits, old));
      bits_[slot] = bits;
    };
    std::vector<BlockIndex> stale;
    for (const std::uint32_t slot : map_->grid().changed_since(cursor_)) {
      stale.push_back(map_->grid().block(slot).index);
      if (growth_ > 0.0) follow_occupied(BlockIndex(stale.back()), stale);
    }
    cursor_ = map_->grid().revision();
    stale.insert(stale.end(), pending_.begin(), pending_.end());
    pending_.clear();
    if (growth_ > 0.0) {  // A block is named by many.
      const auto before = [](const BlockIndex& a, const BlockIndex& b) {
        return key_of(a) < key_of(b);
      };
      std::sort(stale.begin(), stale.end(), before);
      stale.erase(std::unique(stale.begin(), stale.end()), stale.end());
    }
    for (const BlockIndex& b : stale) refresh(b);
    if (changes.empty()) return 0;

    // Everything within reach of a change. A block that was never made is uniform: full of
    // obstacles, which nothing changes, or empty, and then it is made.
    ++epoch_;
    std::vector<std::uint32_t> dirty;
    for (const Change& c : changes) {
      const VoxelIndex origin = c.block * kSide, r = VoxelIndex::Constant(reach_);
      for_each_index(Grid::block_of(origin + c.lo - r), Grid::block_of(origin + c.hi + r),
                     [&](const BlockIndex& b) {
                       std::uint32_t slot = grid_.find_slot(b);
                       if (slot == Grid::kNone && !options_.unknown_is_obstacle) slot = make(b);
                       if (slot == Grid::kNone || stamp_[slot] == epoch_) return;
                       stamp_[slot] = epoch_;
                       dirty.push_back(slot);
                     });
    }
    for (const std::uint32_t slot : dirty) scan_rows(slot);
    std::size_t changed = 0;
    for (const std::uint32_t slot : dirty) changed += transform(slot) ? 1 : 0;
    return changed;
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
      if (!(u.cwiseAbs().maxCoeff() < 1 << 29)) return -space_->required_;
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
      return sum - space_->excess_ - space_->required_;
    }
    /// Squared distance from a voxel's centre to the nearest obstacle's, in voxels, truncated.
    std::size_t squared(const VoxelIndex& v) {
      const Grid::Block* block = find(Grid::block_of(v));
      return block == nullptr ? space_->default_squared()
                              : static_cast<std::size_t>(block->voxels[Grid::offset_of(v)]);
    }

   private:
    const Grid::Block* find(const BlockIndex& b) {
      if (!cached_ || b != index_) {
        block_ = space_->grid_.find_block(b);
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

  /// Whether the body fits all the way; every point of the segment then keeps the radius and the
  /// margin from every obstacle voxel's centre.
  bool is_free_segment(const Point3& a, const Point3& b) const {
    return free_length(a, b) == std::numeric_limits<double>::infinity();
  }
  /// How far one gets from `a` towards `b` [m]; infinite if all the way.
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
        t += std::max(s, step_);
      }
      return last;
    }
    for (double t = 0.0, last = 0.0; t < length;) {
      const double s = read.slack(a + t * direction);
      if (s < 0.0) return last;
      last = t;
      t += std::max(s, step_);
    }
    return std::numeric_limits<double>::infinity();
  }

  /// Distance from `p` to what the body must not touch [m]: obstacle voxel centres less the margin.
  /// From below where the body fits; deep inside it may be a tenth of a voxel too large. Negative
  /// beside an obstacle, truncated at about two voxels more than the radius. Takes no account of
  /// the bounds.
  double clearance(const Point3& p) const { return probe().slack(p) + options_.radius; }

  /// Voxel centres where the body fits, at most `max_distance` away and the nearest first.
  /// O(n log n) in the voxels within that distance.
  std::vector<Point3> free_centers_near(const Point3& p, double max_distance) const {
    const VoxelIndex middle = grid_.index_of(p);
    const int n = static_cast<int>(std::ceil(max_distance / voxel_size())) + 1;
    std::vector<std::pair<double, Point3>> near;
    for_each_index(middle - VoxelIndex::Constant(n), middle + VoxelIndex::Constant(n),
                   [&](const VoxelIndex& v) {
                     if (!is_free_voxel(v)) return;
                     const Point3 c = grid_.center(v);
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
  /// straight without coming notably closer to an obstacle than at `p`: the way out for a robot
  /// that finds itself in what has since turned out to be no free place.
  std::optional<Point3> nearest_free(const Point3& p, double max_distance) const {
    if (!p.allFinite()) return std::nullopt;
    Probe read(*this);
    const double floor = std::min(read.slack(p), 0.0) - 0.1 * voxel_size();
    for (const Point3& c : free_centers_near(p, max_distance)) {
      const double distance = (c - p).norm();
      bool ok = true;
      for (double t = step_; ok && t < distance; t += step_)
        ok = read.slack(p + (c - p) * (t / distance)) >= floor;
      if (ok) return c;
    }
    return std::nullopt;
  }

  /// Where a search for ways begins: `p`, or beside what has since turned out to be an obstacle the
  /// way out of it, if there is one within `max_distance`.
  Point3 free_start(const Point3& p, double max_distance = 2.0) const {
    return is_free(p) ? p : nearest_free(p, max_distance).value_or(p);
  }

  // -- the voxel lattice -------------------------------------------------------------------------
  /// Free centres, a bit a voxel; bit `Grid::offset_of(v)`.
  using FreeBits = std::array<std::uint64_t, Grid::kBlockVoxels / 64>;

  /// Whether a voxel's centre is free. The straight line between two face neighbours that are both
  /// free is free, so paths on this lattice are valid paths.
  bool is_free_voxel(const VoxelIndex& v) const {
    const std::uint32_t slot = grid_.find_slot(Grid::block_of(v));
    if (slot == Grid::kNone) return !options_.unknown_is_obstacle && in_bounds(grid_.center(v));
    return is_free_in(slot, Grid::offset_of(v));
  }
  bool is_free_in(std::uint32_t slot, std::size_t offset) const {
    return ((free_[slot][offset / 64] >> (offset % 64)) & 1U) != 0;
  }
  const FreeBits& free_bits(std::uint32_t slot) const { return free_[slot]; }

  /// The distances; its slots, revision and `changed_since` tell consumers what to look at again.
  const Grid& grid() const { return grid_; }
  std::uint64_t revision() const { return grid_.revision(); }
  std::vector<std::uint32_t> changed_since(std::uint64_t cursor) const {
    return grid_.changed_since(cursor);
  }
  /// The region whose queries a block's voxels decide.
  Box3 influence(std::uint32_t slot) const {
    const double h = voxel_size();
    const Point3 lo = (grid_.block(slot).origin().cast<double>()) * h;
    return Box3(lo - Point3::Constant(0.5 * h), lo + Point3::Constant((kSide + 0.5) * h));
  }
  std::size_t memory_bytes() const {
    return grid_.memory_bytes() + occupied_.size() * sizeof(RowBits) +
           bits_.size() *
               (sizeof(RowBits) + sizeof(Rows) + sizeof(FreeBits) + sizeof(std::uint64_t));
  }

  /// Whether a voxel is an obstacle, by the settings and the known-free balls; occupied ones grown.
  bool is_obstacle(const VoxelIndex& v) const {
    const std::uint32_t slot = grid_.find_slot(Grid::block_of(v));
    const auto o = Grid::offset_of(v);
    return ((slot == Grid::kNone ? default_bits() : bits_[slot])[o / 8] >> (o % 8) & 1) != 0;
  }

 private:
  static constexpr int kMaxReach = 24;           // 64-bit rows: 8 + 2 · 24 bits and more
  using RowBits = std::array<std::uint8_t, 64>;  // obstacles; row y + 8 z, bit x
  using Rows = std::array<std::int16_t, 512>;    // squared distance along x
  struct Change {
    BlockIndex block;
    VoxelIndex lo, hi;  // of the voxels that differ
  };
  static Change difference(const BlockIndex& index, const RowBits& a, const RowBits& b) {
    Change c{index, VoxelIndex::Constant(kSide), VoxelIndex::Constant(-1)};
    for (int row = 0; row < kSide * kSide; ++row) {
      const auto r = static_cast<std::size_t>(row);
      const unsigned diff = static_cast<unsigned>(a[r] ^ b[r]);
      if (diff == 0) continue;
      c.lo = c.lo.cwiseMin(VoxelIndex(std::countr_zero(diff), row % kSide, row / kSide));
      c.hi = c.hi.cwiseMax(
          VoxelIndex(static_cast<int>(std::bit_width(diff)) - 1, row % kSide, row / kSide));
    }
    return c;
  }

  std::size_t default_squared() const {
    return options_.unknown_is_obstacle ? 0 : static_cast<std::size_t>(reach_ * reach_);
  }
  RowBits default_bits() const {
    RowBits bits;
    bits.fill(options_.unknown_is_obstacle ? 0xFF : 0x00);
    return bits;
  }
  std::uint32_t make(const BlockIndex& index) {
    const std::uint32_t slot = grid_.ensure_slot(index);
    if (slot < bits_.size()) return slot;
    grid_.block(slot).voxels.fill(static_cast<std::int16_t>(default_squared()));
    bits_.push_back(default_bits());
    rows_.emplace_back().fill(
        static_cast<std::int16_t>(options_.unknown_is_obstacle ? 0 : (reach_ + 1) * (reach_ + 1)));
    stamp_.push_back(0);
    if (growth_ > 0.0) occupied_.emplace_back();
    free_.push_back(free_bits_of(slot));
    return slot;
  }
  RowBits obstacle_bits(const BlockIndex& index) const {
    RowBits bits{};
    const auto* block = map_->grid().find_block(index);
    if (block == nullptr) {
      bits = default_bits();
    } else {
      for (std::size_t row = 0; row < 64; ++row) {
        unsigned b = 0;
        for (std::size_t x = 0; x < 8; ++x) {
          const VoxelState s = block->voxels[row * 8 + x];
          b |= static_cast<unsigned>(s == VoxelState::occupied ||
                                     (s == VoxelState::unknown && options_.unknown_is_obstacle))
               << x;
        }
        bits[row] = static_cast<std::uint8_t>(b);
      }
    }
    if (!options_.unknown_is_obstacle) return bits;
    const double h = voxel_size();
    const Point3 first = grid_.center(index * kSide);
    const Box3 box(first, first + Point3::Constant((kSide - 1) * h));
    for (const Sphere& ball : known_free_) {
      if (box.squaredExteriorDistance(ball.center) > ball.radius * ball.radius) continue;
      for (std::size_t o = 0; o < 512; ++o) {
        if (block != nullptr && block->voxels[o] != VoxelState::unknown) continue;
        const Point3 c =
            first + h * Point3(static_cast<double>(o % 8), static_cast<double>(o / 8 % 8),
                               static_cast<double>(o / 64));
        if ((c - ball.center).squaredNorm() <= ball.radius * ball.radius)
          bits[o / 8] = static_cast<std::uint8_t>(bits[o / 8] & ~(1U << (o % 8)));
      }
    }
    if (growth_ > 0.0) add_grown(index, bits);
    return bits;
  }

  /// How near a box of `keep_out` voxel centres are obstacles: every point within the body's radius
  /// of the box then has one within `required_`, as it has a centre within half a diagonal.
  double keep_out_reach() const {
    const double half_diagonal = 0.5 * std::sqrt(3.0) * voxel_size();
    return half_diagonal + std::max(0.0, half_diagonal - margin_);
  }
  /// Where unknown space is free, the blocks in question must be looked at though the map has none.
  void add_keep_out() {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(keep_out_reach());
    const Eigen::Vector3d far = Eigen::Vector3d::Constant(required_ + excess_ + voxel_size());
    for (const Box3& box : options_.keep_out.boxes) {
      require(box.min().allFinite() && box.max().allFinite() && !box.isEmpty(),
              "keep-out: expected boxes with each minimum at most its maximum");
      Box3 near(box.min() - reach, box.max() + reach);
      if (!options_.bounds.isEmpty())
        near = near.intersection(Box3(options_.bounds.min() - far, options_.bounds.max() + far));
      if (near.isEmpty()) continue;
      for_each_index(Grid::block_of(grid_.index_of(near.min())),
                     Grid::block_of(grid_.index_of(near.max())),
                     [&](const BlockIndex& b) { pending_.push_back(b); });
    }
  }
  void block_keep_out(const BlockIndex& index, RowBits& bits) const {
    if (options_.keep_out.empty()) return;
    const double reach = keep_out_reach();
    const Point3 first = grid_.center(index * kSide);
    const Box3 block(first, first + Point3::Constant((kSide - 1) * voxel_size()));
    for (const Box3& box : options_.keep_out.boxes) {
      if (box.exteriorDistance(block) > reach) continue;
      for (std::size_t o = 0; o < Grid::kBlockVoxels; ++o) {
        const Point3 c = first + voxel_size() * Point3(static_cast<double>(o % 8),
                                                       static_cast<double>(o / 8 % 8),
                                                       static_cast<double>(o / 64));
        if (box.squaredExteriorDistance(c) <= reach * reach)
          bits[o / 8] = static_cast<std::uint8_t>(bits[o / 8] | 1U << (o % 8));
      }
    }
  }

  /// Takes over which voxels of a block of the map are occupied, and names the blocks that what
  /// differs is grown into.
  void follow_occupied(const BlockIndex& index, std::vector<BlockIndex>& stale) {
    RowBits bits{};
    const auto& voxels = map_->grid().find_block(index)->voxels;
    for (std::size_t o = 0; o < Grid::kBlockVoxels; ++o)
      bits[o / 8] = static_cast<std::uint8_t>(
          bits[o / 8] | static_cast<unsigned>(voxels[o] == VoxelState::occupied) << (o % 8));
    std::uint32_t slot = grid_.find_slot(index);
    const RowBits old = slot == Grid::kNone ? RowBits{} : occupied_[slot];
    if (bits == old) return;
    if (slot == Grid::kNone) slot = make(index);
    occupied_[slot] = bits;
    const Change c = difference(index, bits, old);
    const VoxelIndex origin = index * kSide;
    const VoxelIndex r = VoxelIndex::Constant(static_cast<int>(growth_));
    for_each_index(Grid::block_of(origin + c.lo - r), Grid::block_of(origin + c.hi + r),
                   [&](const BlockIndex& b) { stale.push_back(b); });
  }
  /// Adds to a block's obstacles the voxels within the growth of an occupied one.
  void add_grown(const BlockIndex& index, RowBits& bits) const {
    std::array<const RowBits*, 27> near{};
    bool any = false;
    for (int n = 0; n < 27; ++n) {
      const std::uint32_t slot =
          grid_.find_slot(index + BlockIndex(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
      if (slot == Grid::kNone || occupied_[slot] == RowBits{}) continue;
      near[static_cast<std::size_t>(n)] = &occupied_[slot];
      any = true;
    }
    if (!any) return;
    // Rows of the block and its neighbours, three blocks long.
    constexpr int kSpan = 3 * kSide;
    std::array<std::uint32_t, kSpan * kSpan> rows{};
    for (int row = 0; row < kSpan * kSpan; ++row) {
      const int y = row % kSpan, z = row / kSpan;
      for (int x = 0; x < 3; ++x)
        if (const RowBits* b =
                near[static_cast<std::size_t>(x + 3 * (y / kSide) + 9 * (z / kSide))])
          rows[static_cast<std::size_t>(row)] |=
              static_cast<std::uint32_t>(
                  (*b)[static_cast<std::size_t>(y % kSide + kSide * (z % kSide))])
              << (kSide * x);
    }
    const int most = static_cast<int>(growth_);
    for (int dz = -most; dz <= most; ++dz)
      for (int dy = -most; dy <= most; ++dy) {
        const double rest = growth_ * growth_ - dy * dy - dz * dz;
        if (rest < 0.0) continue;
        const int spread = static_cast<int>(std::sqrt(rest));
        for (int row = 0; row < kSide * kSide; ++row) {
          const int y = row % kSide + kSide + dy, z = row / kSide + kSide + dz;
          const std::uint32_t from = rows[static_cast<std::size_t>(y + kSpan * z)];
          std::uint32_t to = from;
          for (int k = 1; k <= spread; ++k) to |= from << k | from >> k;
          std::uint8_t& own = bits[static_cast<std::size_t>(row)];
          own = static_cast<std::uint8_t>(own | (to >> kSide & 0xFF));
        }
      }
  }

  /// First pass of the separable distance transform: along x, from the obstacle bits of the block
  /// and its neighbours in the row.
  void scan_rows(std::uint32_t slot) {
    const BlockIndex index = grid_.block(slot).index;
    std::array<const RowBits*, 7> row_blocks{};
    for (int d = -halo_; d <= halo_; ++d) {
      const std::uint32_t n = grid_.find_slot(index + BlockIndex(d, 0, 0));
      row_blocks[static_cast<std::size_t>(d + halo_)] = n == Grid::kNone ? nullptr : &bits_[n];
    }
    const std::uint8_t absent = options_.unknown_is_obstacle ? 0xFF : 0x00;
    const auto cap = static_cast<std::int16_t>((reach_ + 1) * (reach_ + 1));
    Rows& rows = rows_[slot];
    for (std::size_t r = 0; r < 64; ++r) {
      std::uint64_t bits = 0;
      for (int d = 0; d <= 2 * halo_; ++d) {
        const RowBits* b = row_blocks[static_cast<std::size_t>(d)];
        bits |= static_cast<std::uint64_t>(b == nullptr ? absent : (*b)[r]) << (8 * d);
      }
      std::int16_t* out = rows.data() + r * 8;
      if (bits == 0) {
        std::fill(out, out + 8, cap);
        continue;
      }
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
    std::array<const std::int16_t*, 49> near{};  // rows of the neighbours in y, z
    bool all_far = true;
    const std::int16_t* absent = options_.unknown_is_obstacle ? zero_rows() : nullptr;
    for (int z = -halo_; z <= halo_; ++z)
      for (int y = -halo_; y <= halo_; ++y) {
        const std::uint32_t n = grid_.find_slot(index + BlockIndex(0, y, z));
        const std::int16_t* rows = n == Grid::kNone ? absent : rows_[n].data();
        near[static_cast<std::size_t>((y + halo_) + span * (z + halo_))] = rows;
        all_far = all_far && rows == nullptr;
      }
    std::array<std::int16_t, 512> result;
    const auto cap = static_cast<std::int16_t>(reach_ * reach_);
    result.fill(cap);
    if (const RowBits& own = bits_[slot];
        std::all_of(own.begin(), own.end(), [](std::uint8_t b) { return b == 0xFF; })) {
      result.fill(0);
    } else if (!all_far) {
      constexpr std::size_t kMaxSpan = 8 + 2 * kMaxReach;
      std::array<std::int16_t, kMaxSpan * 64> columns;  // after the pass along y, a slab per z
      std::array<std::int16_t, kMaxSpan * 8> lines;     // one slab before that pass
      for (int z = -reach_; z < 8 + reach_; ++z) {
        const int bz = (z + 8 * halo_) / 8, iz = (z + 8 * halo_) % 8;
        for (int y = -reach_; y < 8 + reach_; ++y) {
          const int by = (y + 8 * halo_) / 8, iy = (y + 8 * halo_) % 8;
          const std::int16_t* rows = near[static_cast<std::size_t>(by + span * bz)];
          std::int16_t* line = lines.data() + (y + reach_) * 8;
          if (rows == nullptr)
            std::fill(line, line + 8, cap);
          else
            std::copy_n(rows + (iy + 8 * iz) * 8, 8, line);
        }
        const Slab slab = lowered(lines.data(), 8, cap);
        std::copy(slab.begin(), slab.end(), columns.data() + (z + reach_) * 64);
      }
      for (int z = 0; z < 8; ++z) {
        const Slab slab = lowered(columns.data() + z * 64, 64, cap);
        std::copy(slab.begin(), slab.end(), result.data() + z * 64);
      }
    }
    if (result == grid_.block(slot).voxels) return false;
    grid_.block(slot).voxels = result;
    free_[slot] = free_bits_of(slot);
    grid_.mark_changed(slot);
    return true;
  }
  /// A pass of the transform: for 64 places at once the least over d of what lies d strides on from
  /// them, plus d²; `in` is where d is −reach.
  using Slab = std::array<std::int16_t, 64>;
  Slab lowered(const std::int16_t* in, int stride, std::int16_t cap) const {
    Slab slab;
    slab.fill(cap);
    std::int16_t* const least = slab.data();  // the sanitizers' build would call operator[]
    for (int d = -reach_; d <= reach_; ++d, in += stride)
      for (std::size_t i = 0; i < slab.size(); ++i) {
        const auto through = static_cast<std::int16_t>(in[i] + d * d);
        least[i] = through < least[i] ? through : least[i];
      }
    return slab;
  }
  static const std::int16_t* zero_rows() {
    static const Rows zeros{};
    return zeros.data();
  }
  FreeBits free_bits_of(std::uint32_t slot) const {
    FreeBits bits{};
    const Grid::Block& block = grid_.block(slot);
    const Box3 centers(grid_.center(block.origin()),
                       grid_.center(block.origin() + VoxelIndex::Constant(kSide - 1)));
    const bool inside = options_.bounds.isEmpty() || options_.bounds.contains(centers);
    if (!inside && !options_.bounds.intersects(centers)) return bits;
    for (std::size_t o = 0; o < Grid::kBlockVoxels; ++o)
      if (block.voxels[o] >= free_squared_ &&
          (inside || options_.bounds.contains(grid_.center(Grid::index_in(block, o)))))
        bits[o / 64] |= std::uint64_t{1} << (o % 64);
    return bits;
  }

  const VoxelStateMap* map_;
  FreeSpaceOptions options_;
  Grid grid_;
  double margin_ = 0.0;  // of all obstacles, occupied voxels grown
  double growth_ = 0.0;  // of occupied voxels [voxels]
  double step_ = 0.0, required_ = 0.0, excess_ = 0.0;
  int reach_ = 0, halo_ = 0;
  std::int16_t free_squared_ = 0;
  std::vector<double> root_;       // h √i
  std::vector<RowBits> bits_;      // by slot, like the next four
  std::vector<RowBits> occupied_;  // of the map, where they are grown
  std::vector<Rows> rows_;
  std::vector<FreeBits> free_;
  std::vector<std::uint64_t> stamp_;
  std::vector<Sphere> known_free_;
  std::vector<BlockIndex> pending_;
  std::uint64_t epoch_ = 0, cursor_ = 0;
};

/// Whether a body of any shape fits at `q`: no obstacle voxel, taken as a ball of the margin's
/// radius about its centre, touches it. `space` may be made for another radius; it decides what is
/// an obstacle. O(1) when the body's inner or outer ball decides, else O(voxels near).
template <CollisionBody Body>
bool is_body_free(const FreeSpace& space, const Body& body, const Configuration& q) {
  if (!space.in_bounds(q.position)) return false;
  const double clearance = space.clearance(q.position);
  if (clearance >= body.bounding_radius()) return true;
  const double margin = space.obstacle_margin();
  const double reach = body.bounding_radius() + margin;
  const VoxelIndex lo = space.grid().index_of(q.position - Point3::Constant(reach));
  const VoxelIndex hi = space.grid().index_of(q.position + Point3::Constant(reach));
  for (int z = lo.z(); z <= hi.z(); ++z)
    for (int y = lo.y(); y <= hi.y(); ++y)
      for (int x = lo.x(); x <= hi.x(); ++x) {
        const VoxelIndex v(x, y, z);
        const Point3 c = space.grid().center(v);
        if ((c - q.position).squaredNorm() < reach * reach && space.is_obstacle(v) &&
            body.touches(q, {c, margin}))
          return false;
      }
  return true;
}
}  // namespace surfleet
