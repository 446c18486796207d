// SPDX-License-Identifier: MIT
/// @file
/// @brief Which free places are connected with which: "unreachable" as a fast, exact answer.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/motion/free_space.hpp>

namespace surfleet {
/// The connected components of the free voxel lattice (face neighbours).
///
/// Lines between free face neighbours are free, so two places of one component have a valid path
/// between them; places of different components have none on the lattice, though one may squeeze
/// through where no voxel centre fits. Components are labelled block by block and joined over
/// block faces: an update relabels the changed blocks alone and joins all labels anew, which is
/// O(changed blocks · 512 + blocks). Queries are O(1).
///
/// With unknown space free and no bounds, what was never near an obstacle has no component.
class ReachableSet {
 public:
  explicit ReachableSet(const FreeSpace& space) : space_(&space) { update(); }

  /// Follows the free space. True if anything changed.
  bool update() {
    const auto changed = space_->changed_since(cursor_);
    if (changed.empty() && begun_) return false;
    begun_ = true;
    cursor_ = space_->revision();
    const auto& grid = space_->grid();
    parts_.resize(grid.block_count());
    std::vector<std::pair<std::uint32_t, int>> faces;
    for (std::uint32_t slot = known_; slot < parts_.size(); ++slot) label(slot, faces);
    for (const std::uint32_t slot : changed)
      if (slot < known_) label(slot, faces);
    known_ = static_cast<std::uint32_t>(parts_.size());
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    for (const auto& [slot, axis] : faces) join_face(slot, axis);

    std::int32_t next = 0;
    for (Part& p : parts_) {
      p.first = next;
      next += p.count();
    }
    DisjointSets sets(static_cast<std::size_t>(next));
    for (const Part& p : parts_)
      for (const Face& face : p.faces)
        for (const auto& [mine, theirs] : face.links)
          sets.unite(p.first + mine, parts_[face.slot].first + theirs);
    root_ = sets.flattened();
    sizes_.assign(root_.size(), 0);
    for (const Part& p : parts_)
      for (std::int32_t local = 0; local < p.count(); ++local)
        sizes_[static_cast<std::size_t>(root_[static_cast<std::size_t>(p.first + local)])] +=
            p.sizes[static_cast<std::size_t>(local)];
    return true;
  }

  /// The component of a voxel; nothing if its centre is not free.
  std::optional<std::int32_t> component(const VoxelIndex& v) const {
    const std::uint32_t slot = space_->grid().find_slot(FreeSpace::Grid::block_of(v));
    if (slot >= parts_.size()) return std::nullopt;
    const auto offset = FreeSpace::Grid::offset_of(v);
    const Part& p = parts_[slot];
    if (p.sizes.empty() || !space_->is_free_in(slot, offset)) return std::nullopt;
    const std::int32_t local = p.labels.empty() ? 0 : p.labels[offset];
    return root_[static_cast<std::size_t>(p.first + local)];
  }
  /// The lattice voxel that a free position is joined to by a free straight line, roomiest first;
  /// nothing if the position is not free or there is none.
  std::optional<VoxelIndex> anchor(const Point3& p) const {
    if (!space_->is_free(p)) return std::nullopt;
    const double h = space_->voxel_size();
    const VoxelIndex base = space_->grid().index_of(p - Point3::Constant(0.5 * h));
    std::array<std::pair<std::int64_t, int>, 8> order;
    auto read = space_->probe();
    for (int k = 0; k < 8; ++k) {
      const VoxelIndex v = base + corner(k);
      order[static_cast<std::size_t>(k)] = {-static_cast<std::int64_t>(read.squared(v)), k};
    }
    std::sort(order.begin(), order.end());
    for (const auto& [room, k] : order) {
      const VoxelIndex v = base + corner(k);
      if (component(v) && space_->is_free_segment(p, space_->grid().center(v))) return v;
    }
    return std::nullopt;
  }
  /// The component of a position: names are stable until the next update that changes anything.
  std::optional<std::int32_t> component(const Point3& p) const {
    const auto v = anchor(p);
    return v ? component(*v) : std::nullopt;
  }
  bool connected(const Point3& a, const Point3& b) const {
    const auto ca = component(a);
    return ca && ca == component(b);
  }
  /// An entrance of a component: its lattice place nearest to where it was asked from.
  struct Entrance {
    std::int32_t component;
    Point3 position;
  };
  /// The larger components that a free straight line of at most `max_distance` joins to a free
  /// position: the exits of a place too narrow for the lattice. Nearest first. O(voxels in reach).
  std::vector<Entrance> entrances(const Point3& p, double max_distance) const {
    std::vector<Entrance> found;
    const auto own = component(p);
    const std::size_t least = own ? size(*own) + 1 : 0;
    const auto is_new = [&](std::int32_t other) {
      return size(other) >= least && std::none_of(found.begin(), found.end(), [&](const auto& e) {
               return e.component == other;
             });
    };
    for (const Point3& c : space_->free_centers_near(p, max_distance))
      if (const auto other = component(space_->grid().index_of(c)); other && is_new(*other))
        if (space_->is_free_segment(p, c)) found.push_back({*other, c});
    return found;
  }
  /// How many voxels a component has.
  std::size_t size(std::int32_t component) const {
    return sizes_[static_cast<std::size_t>(component)];
  }
  const FreeSpace& space() const { return *space_; }

 private:
  struct Face {
    std::uint32_t slot = 0;                                      // of the neighbour in +axis
    std::vector<std::pair<std::uint16_t, std::uint16_t>> links;  // labels here and there
  };
  struct Part {
    std::int32_t first = 0;             // name of the block's first component
    std::vector<std::uint16_t> labels;  // empty: all free voxels are one component
    std::vector<std::uint16_t> sizes;   // of the components [voxels]
    std::array<Face, 3> faces;
    std::int32_t count() const { return static_cast<std::int32_t>(sizes.size()); }
  };

  static VoxelIndex corner(int k) { return {k & 1, (k >> 1) & 1, k >> 2}; }
  static VoxelIndex unit(int axis) {
    VoxelIndex u = VoxelIndex::Zero();
    u[axis] = 1;
    return u;
  }

  void label(std::uint32_t slot, std::vector<std::pair<std::uint32_t, int>>& faces) {
    Part& p = parts_[slot];
    const auto& grid = space_->grid();
    for (int axis = 0; axis < 3; ++axis) {
      faces.emplace_back(slot, axis);
      const std::uint32_t below = grid.find_slot(grid.block(slot).index - unit(axis));
      if (below != FreeSpace::Grid::kNone) faces.emplace_back(below, axis);
    }
    const auto& bits = space_->free_bits(slot);
    p.labels.clear();
    p.sizes.clear();
    bool any = false, all = true;
    for (const std::uint64_t w : bits) {
      any = any || w != 0;
      all = all && w == ~std::uint64_t{0};
    }
    if (!any) return;
    if (all) {
      p.sizes = {FreeSpace::Grid::kBlockVoxels};
      return;
    }
    // Flood by layers of 8 × 8 bits: grow within the free bits until nothing moves.
    auto left = bits;
    std::vector<FreeSpace::FreeBits> pieces;
    for (std::size_t z = 0; z < 8; ++z)
      while (left[z] != 0) {
        FreeSpace::FreeBits piece{};
        piece[z] = left[z] & (~left[z] + 1);
        for (bool grew = true; grew;) {
          grew = false;
          for (std::size_t k = 0; k < 8; ++k) {
            const std::uint64_t before = piece[k];
            std::uint64_t b = before;
            if (k > 0) b |= piece[k - 1];
            if (k < 7) b |= piece[k + 1];
            b &= left[k];
            for (std::uint64_t was = 0; was != b;) {
              was = b;
              b |= (((b << 1) & 0xFEFEFEFEFEFEFEFEULL) | ((b >> 1) & 0x7F7F7F7F7F7F7F7FULL) |
                    (b << 8) | (b >> 8)) &
                   left[k];
            }
            if (b != before) {
              piece[k] = b;
              grew = true;
            }
          }
        }
        for (std::size_t k = 0; k < 8; ++k) left[k] &= ~piece[k];
        pieces.push_back(piece);
      }
    for (const auto& piece : pieces) {
      int voxels = 0;
      for (const std::uint64_t w : piece) voxels += std::popcount(w);
      p.sizes.push_back(static_cast<std::uint16_t>(voxels));
    }
    if (p.count() == 1) return;
    p.labels.assign(FreeSpace::Grid::kBlockVoxels, 0);
    for (std::size_t c = 0; c < pieces.size(); ++c)
      for (std::size_t k = 0; k < 8; ++k)
        for (std::uint64_t b = pieces[c][k]; b != 0; b &= b - 1)
          p.labels[k * 64 + static_cast<std::size_t>(std::countr_zero(b))] =
              static_cast<std::uint16_t>(c);
  }

  void join_face(std::uint32_t slot, int axis) {
    const auto& grid = space_->grid();
    Part& p = parts_[slot];
    Face& face = p.faces[static_cast<std::size_t>(axis)];
    face.links.clear();
    face.slot = grid.find_slot(grid.block(slot).index + unit(axis));
    if (p.sizes.empty() || face.slot == FreeSpace::Grid::kNone) return;
    const Part& q = parts_[face.slot];
    if (q.sizes.empty()) return;
    const std::size_t step = std::size_t{1} << (3 * axis);
    for (std::size_t o = 0; o < FreeSpace::Grid::kBlockVoxels; ++o) {
      if ((o / step) % 8 != 0) continue;
      const std::size_t here = o + 7 * step;
      if (!space_->is_free_in(slot, here) || !space_->is_free_in(face.slot, o)) continue;
      face.links.emplace_back(p.labels.empty() ? std::uint16_t{0} : p.labels[here],
                              q.labels.empty() ? std::uint16_t{0} : q.labels[o]);
      if (p.labels.empty() && q.labels.empty()) break;
    }
    std::sort(face.links.begin(), face.links.end());
    face.links.erase(std::unique(face.links.begin(), face.links.end()), face.links.end());
  }

  const FreeSpace* space_;
  std::vector<Part> parts_;  // by slot
  std::vector<std::int32_t> root_;
  std::vector<std::size_t> sizes_;  // by root [voxels]
  std::uint32_t known_ = 0;
  std::uint64_t cursor_ = 0;
  bool begun_ = false;
};

/// What a robot at one place can reach; holds until the free space changes. Not for concurrent use.
class ReachFrom {
 public:
  /// From a place `start` that is free if any near it is; a place too narrow for the lattice may be
  /// left for one within `distance` [m].
  ReachFrom(const ReachableSet& set, const Point3& start, double distance)
      : set_(&set), start_(start), home_(set.component(start)), distance_(distance) {}
  const Point3& start() const { return start_; }
  /// Whether a path exists; O(1).
  bool operator()(const Point3& b) const { return gate(b) || is_visible(b); }
  bool is_visible(const Point3& b) const { return set_->space().is_free_segment(start_, b); }
  /// From where the lattice leads to `b`: the start, or what a straight line joins to it.
  std::optional<Point3> gate(const Point3& b) const {
    const auto component = set_->component(b);
    if (!component) return std::nullopt;
    if (component == home_) return start_;
    if (!entrances_) entrances_ = set_->entrances(start_, distance_);
    for (const ReachableSet::Entrance& e : *entrances_)
      if (e.component == *component) return e.position;
    return std::nullopt;
  }

 private:
  const ReachableSet* set_;
  Point3 start_;
  std::optional<std::int32_t> home_;
  double distance_;
  mutable std::optional<std::vector<ReachableSet::Entrance>> entrances_;  // when first needed
};
}  // namespace surfleet
