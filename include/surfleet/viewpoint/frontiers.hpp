// SPDX-License-Identifier: MIT
/// @file
/// @brief Frontiers: where the known part of a region borders on unknown space.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/viewpoint/view_limits.hpp>

namespace surfleet {
struct FrontierOptions {
  int max_views = kViewsInVain;  ///< In vain, after which a cell is given up.
  double prior_chance = 0.25;    ///< That a cell holds surface, before any was opened.
  double prior_cells = 20.0;     ///< Weight of the prior, in cells.
};

/// The frontier of a region, in cells: what a surface that stands by itself, behind empty space
/// only, can be found by. Incomplete elements do not lead there, as they need surface.
///
/// A cell is unknown as long as its middle voxel is, and on the frontier if the middle of a face
/// neighbour is empty. After `max_views` views of it in vain a cell is given up: unknown space in
/// nooks stays what it is. What the cells on the frontier turn out to hold is remembered by height:
/// there is less to expect of the sky around a tower than of the ground it stands on. Cells near
/// known surface tell nothing of what stands by itself, and may be left out.
class Frontiers {
 public:
  explicit Frontiers(FrontierOptions options = {}) : options_(options) {
    require(options.prior_chance > 0.0 && options.prior_chance <= 1.0 && options.prior_cells > 0.0,
            "frontiers: expected a prior chance in (0, 1] of a positive number of cells");
  }

  /// Follows one map for life: the frontier, in cells `edge` wide (rounded to whole voxels) whose
  /// centre lies in `region`; an empty region has none. O(blocks changed since the last call), and
  /// all of them where the region or the width is a new one.
  void update(const VoxelStateMap& states, const Box3& region, double edge) {
    if (region.isEmpty()) {
      cells_.clear();
      near_.clear();
      return;
    }
    require(edge > 0.0 && std::isfinite(edge), "frontiers: expected cells of a positive width");
    const int side = std::max(1, static_cast<int>(std::lround(edge / states.voxel_size())));
    if (side != side_ || region.min() != region_.min() || region.max() != region_.max()) {
      border_.clear();
      views_.clear();
      opened_.clear();
      cells_.clear();
      cursor_ = 0;
      side_ = side;
      region_ = region;
      edge_ = side * states.voxel_size();
    }
    VoxelStateMap::Accessor state(states);
    constexpr int kBlock = VoxelStateMap::Grid::kBlockSide;
    const Eigen::Array3d middle = Eigen::Array3d::Constant(side_ / 2);
    for (const std::uint32_t slot : states.grid().changed_since(cursor_)) {
      // The cells whose middle voxel lies in the block, and their neighbours.
      const Eigen::Array3d first = (states.grid().block(slot).index * kBlock).cast<double>();
      const VoxelIndex lo = ((first - middle) / side_).ceil().cast<int>();
      const VoxelIndex hi = ((first + (kBlock - 1) - middle) / side_).floor().cast<int>();
      for_each_index(lo, hi, [&](const VoxelIndex& cell) {
        examine(state, cell);
        for (const VoxelIndex& d : kFaces) examine(state, cell + d);
      });
    }
    cursor_ = states.grid().revision();
    cells_.clear();
    for (const VoxelKey& cell : border_) {
      const auto it = views_.find(cell);
      if (it == views_.end() || it->second < options_.max_views) cells_.push_back(cell);
    }
    near_.assign(cells_.size(), 0);
  }

  /// The border as of the last update, in the order z, y, x.
  std::size_t size() const { return cells_.size(); }
  /// [m]
  Point3 center(std::size_t i) const { return center(cells_[i]); }
  double edge() const { return edge_; }  ///< Of a cell [m].
  /// How likely cell `i` holds surface: the share of the cells opened so far at its height, and one
  /// cell above and below, that did, the prior among them.
  double chance(std::size_t i) const {
    double cells = options_.prior_cells, hits = cells * options_.prior_chance;
    for (int dz = -1; dz <= 1; ++dz)
      if (const auto it = opened_.find(cells_[i][2] + dz); it != opened_.end()) {
        cells += it->second.cells;
        hits += it->second.hits;
      }
    return hits / cells;
  }
  const FrontierOptions& options() const { return options_; }
  /// Cell `i` is near known surface: `chance` is not told what it holds if it is opened by the next
  /// update.
  void note_near(std::size_t i) { near_[i] = 1; }
  /// Cell `i` was viewed and is on the frontier still.
  void note_view(std::size_t i) { ++views_[cells_[i]]; }

 private:
  struct ByLayer {
    bool operator()(const VoxelKey& a, const VoxelKey& b) const {
      return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
    }
  };
  static inline const std::array<VoxelIndex, 6> kFaces{VoxelIndex(-1, 0, 0), VoxelIndex(1, 0, 0),
                                                       VoxelIndex(0, -1, 0), VoxelIndex(0, 1, 0),
                                                       VoxelIndex(0, 0, -1), VoxelIndex(0, 0, 1)};

  Point3 center(const VoxelKey& c) const {
    return (Point3(c[0], c[1], c[2]) + Point3::Constant(0.5)) * edge_;
  }
  void examine(VoxelStateMap::Accessor& state, const VoxelIndex& cell) {
    const auto at = [&](const VoxelIndex& c) {
      return state(c * side_ + VoxelIndex::Constant(side_ / 2));
    };
    const VoxelKey key = key_of(cell);
    if (at(cell) == VoxelState::unknown && region_.contains(center(key)) &&
        std::any_of(kFaces.begin(), kFaces.end(),
                    [&](const VoxelIndex& d) { return at(cell + d) == VoxelState::empty; }))
      border_.insert(key);
    else if (border_.erase(key) > 0 && at(cell) != VoxelState::unknown && !was_near(key))
      note_opened(state, cell);
  }
  bool was_near(const VoxelKey& cell) const {
    const auto it = std::lower_bound(cells_.begin(), cells_.end(), cell, ByLayer{});
    return it != cells_.end() && *it == cell &&
           near_[static_cast<std::size_t>(it - cells_.begin())] != 0;
  }
  void note_opened(VoxelStateMap::Accessor& state, const VoxelIndex& cell) {
    bool hit = false;
    for_each_index(cell * side_, cell * side_ + VoxelIndex::Constant(side_ - 1),
                   [&](const VoxelIndex& v) { hit = hit || state(v) == VoxelState::occupied; });
    Layer& layer = opened_[cell.z()];
    layer.cells += 1.0;
    layer.hits += hit ? 1.0 : 0.0;
  }

  /// Cells that were on the border and are known now, and those of them that hold surface.
  struct Layer {
    double cells = 0.0, hits = 0.0;
  };
  FrontierOptions options_;
  int side_ = 0;       // of a cell, in voxels
  double edge_ = 0.0;  // the same [m]
  Box3 region_;
  std::uint64_t cursor_ = 0;
  std::set<VoxelKey, ByLayer> border_;
  std::vector<VoxelKey> cells_;  // of the border, less what was given up
  std::map<VoxelKey, int> views_;
  std::vector<char> near_;       // by cell, as told since the last update
  std::map<int, Layer> opened_;  // by height in cells
};
}  // namespace surfleet
