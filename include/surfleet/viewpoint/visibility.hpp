// SPDX-License-Identifier: MIT
/// @file
/// @brief Line of sight through a map of voxel states.
#pragma once

#include <algorithm>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/mapping/voxel_traversal.hpp>

namespace surfleet {
struct SightOptions {
  bool unknown_blocks = false;  ///< Whether sight ends at unknown voxels as it does at occupied.
};

/// Asks whether a voxel can be seen from a point. One object a thread; the map must outlive it and
/// must not gain blocks while it lives.
class LineOfSight {
 public:
  explicit LineOfSight(const VoxelStateMap& map, SightOptions options = {})
      : accessor_(map), voxel_size_(map.voxel_size()), options_(options) {}

  bool blocks(VoxelState s) const {
    return s == VoxelState::occupied || (options_.unknown_blocks && s == VoxelState::unknown);
  }
  VoxelState state(const VoxelIndex& v) { return accessor_(v); }
  double voxel_size() const { return voxel_size_; }

  /// True if nothing blocks the segment from `from` [m] to the centre of `target` before the
  /// target's voxel is entered; what the target itself holds does not matter. O(voxels and clear
  /// cubes passed).
  bool sees(const Point3& from, const VoxelIndex& target) {
    const Point3 to = (target.cast<double>() + Eigen::Vector3d::Constant(0.5)) * voxel_size_;
    bool clear = true;
    traverse_voxels(from, to, voxel_size_, [&](const VoxelIndex& v) {
      if (v == target) return 0;
      if (const int side = clear_cube(v)) return side;
      clear = !blocks(accessor_(v));
      return static_cast<int>(clear);
    });
    return clear;
  }

  /// How far one sees from `from` along `direction` (unit), at most `limit` [m]: the distance at
  /// which the first blocking voxel is entered, give or take a voxel's diagonal.
  double free_length(const Point3& from, const Eigen::Vector3d& direction, double limit) {
    double length = limit;
    traverse_voxels(from, from + limit * direction, voxel_size_, [&](const VoxelIndex& v) {
      if (const int side = clear_cube(v)) return side;
      if (!blocks(accessor_(v))) return 1;
      const Point3 center = (v.cast<double>() + Eigen::Vector3d::Constant(0.5)) * voxel_size_;
      length = std::clamp((center - from).dot(direction), 0.0, limit);
      return 0;
    });
    return length;
  }

 private:
  int clear_cube(const VoxelIndex& v) { return accessor_.clear_cube(v, !options_.unknown_blocks); }

  VoxelStateMap::Accessor accessor_;
  double voxel_size_;
  SightOptions options_;
};
}  // namespace surfleet
