// SPDX-License-Identifier: MIT
/// @file
/// @brief Unknown, empty or occupied for every voxel: the map as planners read it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet {
struct VoxelStateOptions {
  double known_weight = 0.3;  ///< W_th: the weight from which a voxel counts as known.
  /// Up to this distance in front of the surface a voxel counts as occupied [m]: more than 0 for a
  /// map to fly by, in which convex edges, seen at a slant, must not be cut short.
  double occupied_below = 0.0;
};

/// What the hits of a block say beside the states of its voxels. Offsets, ascending.
struct HitStates {
  /// From which sides the surface in a voxel is known: bit 2 · axis, plus 1 where it is negative,
  /// for each axis direction that a known hit's normal has a fair part of.
  struct Sides {
    std::uint16_t voxel = 0;
    std::uint8_t mask = 0;
    bool operator==(const Sides&) const = default;
  };
  std::vector<Sides> known;
  /// Voxels in which rays ended, but too few to know of surface there.
  std::vector<std::uint16_t> glimpses;

  bool empty() const { return known.empty() && glimpses.empty(); }
  std::size_t memory_bytes() const {
    return known.capacity() * sizeof(known[0]) + glimpses.capacity() * sizeof(glimpses[0]);
  }
  bool operator==(const HitStates&) const = default;
};

/// What a block of a map says of its voxels.
struct BlockStates {
  BlockIndex index = BlockIndex::Zero();
  std::array<VoxelState, TsdfMap::kBlockVoxels> voxels{};
  HitStates layer;
};

/// The states of a block's voxels. Where rays ended often enough and did not pass since, a voxel is
/// occupied whatever its distance says: sheets and bars that a distance cannot hold are there.
/// Where they ended less often, down to a sixteenth of that, it is a glimpse.
inline BlockStates block_states(const TsdfMap::Block& block, const VoxelStateOptions& options) {
  constexpr double kGlimpse = 1.0 / 16.0;
  constexpr double kFairPart = 0.3;  // of a unit normal
  const auto threshold = static_cast<float>(options.known_weight);
  const auto surface = static_cast<float>(options.occupied_below);
  BlockStates states;
  states.index = block.index;
  for (std::size_t i = 0; i < states.voxels.size(); ++i) {
    const TsdfVoxel& v = block.voxels[i];
    states.voxels[i] = voxel_state({v.distance - surface, v.weight}, threshold);
  }
  for (const SurfaceHit& hit : block.layer.hits()) {
    if (!hit.is_solid(options.known_weight)) continue;
    states.voxels[hit.voxel()] = VoxelState::occupied;
    const Eigen::Vector3d n = hit.mean_normal();
    std::uint8_t mask = 0;
    for (int k = 0; k < 3; ++k)
      if (std::abs(n[k]) > kFairPart)
        mask = static_cast<std::uint8_t>(mask | 1U << (2 * k + (n[k] < 0.0 ? 1 : 0)));
    const auto v = static_cast<std::uint16_t>(hit.voxel());
    auto& known = states.layer.known;
    if (known.empty() || known.back().voxel != v) known.push_back({v, 0});
    known.back().mask = static_cast<std::uint8_t>(known.back().mask | mask);
  }
  for (const SurfaceHit& hit : block.layer.hits()) {
    const auto v = static_cast<std::uint16_t>(hit.voxel());
    auto& seen = states.layer.glimpses;
    if (hit.is_solid(kGlimpse * options.known_weight) && states.voxels[v] != VoxelState::occupied &&
        (seen.empty() || seen.back() != v))
      seen.push_back(v);
  }
  return states;
}

/// A map that states can be told of: `block_states(block, options)`, found beside the block's type,
/// says which. Models: `TsdfMap`, `OccupancyMap`.
template <typename Map>
concept VoxelStateSource = Map::kBlockSide ==
                           TsdfMap::kBlockSide&& requires(const Map& map, std::uint32_t slot,
                                                          std::uint64_t cursor,
                                                          const VoxelStateOptions& options) {
  { map.voxel_size() } -> std::convertible_to<double>;
  { map.revision() } -> std::convertible_to<std::uint64_t>;
  { map.changed_since(cursor) } -> std::convertible_to<std::vector<std::uint32_t>>;
  { block_states(map.block(slot), options) } -> std::same_as<BlockStates>;
};
static_assert(VoxelStateSource<TsdfMap>);

/// In which octants of a block there are voxels of a state, a bit each by `octant_of`.
struct StateOctants {
  std::uint8_t unknown = 0xFF, occupied = 0;

  static constexpr int kSide = TsdfMap::kBlockSide / 2;
  static int octant_of(const VoxelIndex& v) {
    return static_cast<int>((v.x() & kSide) != 0) | static_cast<int>((v.y() & kSide) != 0) << 1 |
           static_cast<int>((v.z() & kSide) != 0) << 2;
  }
};
inline StateOctants octants_of(const std::array<VoxelState, TsdfMap::kBlockVoxels>& voxels) {
  StateOctants o{0, 0};
  constexpr std::size_t kHalf = StateOctants::kSide, kSide = TsdfMap::kBlockSide;
  for (std::size_t row = 0; row < 2 * kSide * kSide; ++row) {  // of half a block
    int unknown = 0, occupied = 0;
    for (std::size_t i = row * kHalf; i < (row + 1) * kHalf; ++i) {
      unknown |= static_cast<int>(voxels[i] == VoxelState::unknown);
      occupied |= static_cast<int>(voxels[i] == VoxelState::occupied);
    }
    const std::size_t octant = row % 2 | (row / kSide % 2) << 1 | (row / (kSide * kSide)) << 2;
    o.unknown = static_cast<std::uint8_t>(o.unknown | unknown << octant);
    o.occupied = static_cast<std::uint8_t>(o.occupied | occupied << octant);
  }
  return o;
}

/// The states of a map's voxels, one byte each, kept up to date by the change.
///
/// A block that was never made is unknown. `update` costs O(changed blocks of the source); the
/// blocks whose states really changed are marked here in turn, so that further consumers see less
/// change than the source had.
class VoxelStateMap {
 public:
  /// What a block keeps beside the states of its voxels.
  struct Layer : HitStates {
    StateOctants octants;
  };
  using Grid = VoxelGrid<VoxelState, TsdfMap::kBlockSide, Layer>;

  template <VoxelStateSource Map>
  explicit VoxelStateMap(const Map& map, VoxelStateOptions options = {})
      : options_(options), grid_({.voxel_size = map.voxel_size()}) {
    update(map);
  }

  /// Brings the states up to date with `map`, always the same map. Returns the number of blocks
  /// that changed.
  template <VoxelStateSource Map>
  std::size_t update(const Map& map) {
    std::size_t changed = 0;
    for (const std::uint32_t slot : map.changed_since(cursor_)) {
      BlockStates states = block_states(map.block(slot), options_);
      std::uint32_t own = grid_.find_slot(states.index);
      if (own == Grid::kNone) {
        if (states.layer.empty() &&
            std::all_of(states.voxels.begin(), states.voxels.end(),
                        [](VoxelState s) { return s == VoxelState::unknown; }))
          continue;
        own = grid_.ensure_slot(states.index);
      } else if (grid_.block(own).voxels == states.voxels &&
                 grid_.block(own).layer == states.layer) {
        continue;
      }
      grid_.block(own).voxels = states.voxels;
      grid_.block(own).layer = {std::move(states.layer), octants_of(states.voxels)};
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
    /// The side of an aligned cube around a voxel in which all voxels are empty, or,
    /// `past_unknown`, empty or unknown; 0 if none was found. A cube of one voxel is not looked
    /// for.
    int clear_cube(const VoxelIndex& v, bool past_unknown) {
      const Grid::Block* block = inner_.find_block(v);
      if (block == nullptr) return past_unknown ? Grid::kBlockSide : 0;
      const StateOctants& o = block->layer.octants;
      const int full = past_unknown ? o.occupied : o.occupied | o.unknown;
      if (full == 0) return Grid::kBlockSide;
      return (full >> StateOctants::octant_of(v) & 1) != 0 ? 0 : StateOctants::kSide;
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
