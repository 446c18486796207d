// SPDX-License-Identifier: MIT
/// @file
/// @brief An element of the incomplete surface, and what makes a voxel one: neighbours and states.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>

namespace surfleet {
/// Which of the 26 voxels around a voxel are its neighbours.
///
/// `N::contains(dx, dy, dz)`, constexpr, for offsets in {−1, 0, 1} other than (0, 0, 0).
template <typename N>
concept NeighborhoodPolicy = requires(int d) {
  { N::contains(d, d, d) } -> std::same_as<bool>;
  typename std::bool_constant<N::contains(1, 0, 0)>;
};

/// Offsets along at most `kAxes` axes at once: faces, edges, corners.
template <int kAxes>
struct AdjacentVoxels {
  static constexpr bool contains(int dx, int dy, int dz) {
    const int axes = (dx != 0) + (dy != 0) + (dz != 0);
    return axes > 0 && axes <= kAxes;
  }
};
using Neighborhood6 = AdjacentVoxels<1>;
using Neighborhood18 = AdjacentVoxels<2>;
using Neighborhood26 = AdjacentVoxels<3>;
static_assert(NeighborhoodPolicy<Neighborhood6> && NeighborhoodPolicy<Neighborhood18> &&
              NeighborhoodPolicy<Neighborhood26>);

/// Tells the state of a voxel from its payload: `test(voxel)` is a `VoxelState`.
template <typename T, typename Voxel>
concept VoxelStateTest = requires(const T& test, const Voxel& voxel) {
  { test(voxel) } -> std::same_as<VoxelState>;
};
/// Known from a weight on, and empty in front of the surface [000 §2.4.1].
struct TsdfStateTest {
  float known_weight = 0.3F;  ///< W_th.
  VoxelState operator()(const TsdfVoxel& v) const { return voxel_state(v, known_weight); }
};
/// The payload is the state.
struct StoredState {
  VoxelState operator()(VoxelState s) const { return s; }
};
static_assert(VoxelStateTest<TsdfStateTest, TsdfVoxel> && VoxelStateTest<StoredState, VoxelState>);

namespace detail {
/// The i-th of the 27 offsets in a cube of three, x fastest.
inline VoxelIndex neighbor_offset(int i) { return {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1}; }
}  // namespace detail

/// An empty voxel on the border between the surface and the unknown, or a voxel in which rays ended
/// too seldom to know of surface there, with none known around it.
struct IncompleteElement {
  VoxelIndex voxel = VoxelIndex::Zero();
  Point3 position = Point3::Zero();                     ///< Its centre [m].
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< n̄_v: unit, away from the surface, or 0.
  /// Its unknown neighbours, whose states complete it: bit (dx + 1) + 3 (dy + 1) + 9 (dz + 1). None
  /// means that it is not said which they are.
  std::uint32_t unknown = 0;

  /// Whether n̄_v is within the angle of this cosine of the unit vector to a camera; without a
  /// direction, always.
  bool faces(const Eigen::Vector3d& to_camera, double least_cosine) const {
    return direction.isZero() || direction.dot(to_camera) >= least_cosine;
  }
  /// Calls `fn(offset)`, in voxels, for each unknown neighbour until it returns true; whether it
  /// did.
  template <typename Fn>
  bool any_unknown(Fn&& fn) const {
    for (std::uint32_t bits = unknown; bits != 0; bits &= bits - 1) {
      if (fn(detail::neighbor_offset(std::countr_zero(bits)))) return true;
    }
    return false;
  }
  /// Centre of the unknown neighbour that lies most to the front, or of itself [m].
  Point3 frontier(double voxel_size) const {
    Eigen::Vector3d foremost = Eigen::Vector3d::Zero();
    double best = -2.0;
    any_unknown([&](const VoxelIndex& offset) {
      const Eigen::Vector3d o = offset.cast<double>();
      if (o.dot(direction) > best + 1e-9) {
        best = o.dot(direction);
        foremost = o;
      }
      return false;
    });
    return position + voxel_size * foremost;
  }
};
}  // namespace surfleet
