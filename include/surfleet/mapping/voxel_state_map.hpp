// SPDX-License-Identifier: MIT
/// @file  Unknown, empty or occupied for every voxel: the map as planners read it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet {
struct VoxelStateOptions {
  double known_weight = 0.3;  ///< W_th: the weight from which a voxel counts as known.
  /// Up to this distance in front of the surface a voxel counts as occupied [m]: more than 0 for a
  /// map to fly by, in which convex edges, seen at a slant, must not be cut short.
  double occupied_below = 0.0;
};

/// The states of a TSDF map's voxels, one byte each, kept up to date by the change.
///
/// A block that was never made is unknown. `update` costs O(changed blocks of the source); the
/// blocks whose states really changed are marked here in turn, so that further consumers see less
/// change than the source had.
class VoxelStateMap {
 public:
  using Grid = VoxelGrid<VoxelState, TsdfMap::kBlockSide>;

  explicit VoxelStateMap(const TsdfMap& map, VoxelStateOptions options = {})
      : options_(options), grid_({.voxel_size = map.voxel_size()}) {
    update(map);
  }

  /// Brings the states up to date with `map`, always the same map. Returns the number of blocks
  /// that changed.
  std::size_t update(const TsdfMap& map) {
    const auto threshold = static_cast<float>(options_.known_weight);
    const auto surface = static_cast<float>(options_.occupied_below);
    std::size_t changed = 0;
    for (const std::uint32_t slot : map.changed_since(cursor_)) {
      const TsdfMap::Block& source = map.block(slot);
      std::array<VoxelState, TsdfMap::kBlockVoxels> states;
      for (std::size_t i = 0; i < states.size(); ++i) {
        const TsdfVoxel& v = source.voxels[i];
        states[i] = voxel_state({v.distance - surface, v.weight}, threshold);
      }
      std::uint32_t own = grid_.find_slot(source.index);
      if (own == Grid::kNone) {
        if (std::all_of(states.begin(), states.end(),
                        [](VoxelState s) { return s == VoxelState::unknown; }))
          continue;
        own = grid_.ensure_slot(source.index);
      } else if (grid_.block(own).voxels == states) {
        continue;
      }
      grid_.block(own).voxels = states;
      grid_.mark_changed(own);
      ++changed;
    }
    cursor_ = map.revision();
    return changed;
  }

  const Grid& grid() const { return grid_; }
  double voxel_size() const { return grid_.voxel_size(); }
  const VoxelStateOptions& options() const { return options_; }
  VoxelState operator()(const VoxelIndex& v) const {
    const VoxelState* s = grid_.find(v);
    return s == nullptr ? VoxelState::unknown : *s;
  }
  VoxelState at(const Point3& p) const { return (*this)(grid_.index_of(p)); }

  /// Reads states; remembers the last block.
  class Accessor {
   public:
    explicit Accessor(const VoxelStateMap& map) : inner_(map.grid_) {}
    VoxelState operator()(const VoxelIndex& v) {
      const VoxelState* s = inner_.find(v);
      return s == nullptr ? VoxelState::unknown : *s;
    }

   private:
    Grid::Accessor inner_;
  };
  Accessor accessor() const { return Accessor(*this); }

 private:
  VoxelStateOptions options_;
  Grid grid_;
  std::uint64_t cursor_ = 0;
};
}  // namespace surfleet
