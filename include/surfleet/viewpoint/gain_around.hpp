// SPDX-License-Identifier: MIT
/// @file
/// @brief How much there is to see around a place.
#pragma once

#include <algorithm>
#include <span>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

namespace surfleet {
/// The gain of all targets in the cell of a place and the 26 around it: no view that reaches no
/// farther than a cell is wide has more. O(targets) to make, O(1) to ask.
class GainAround {
 public:
  /// Cells are `reach` wide [m].
  GainAround(std::span<const SightTarget> targets, double reach) : around_({.voxel_size = reach}) {
    Sums own({.voxel_size = reach});
    for (const SightTarget& t : targets) own.ensure(own.index_of(t.position)) += t.gain;
    own.for_each_block([&](const auto& block) {
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x)
            around_.ensure(block.index + VoxelIndex(x, y, z)) += block.voxels[0];
    });
    around_.for_each_block(
        [&](const auto& block) { largest_ = std::max(largest_, block.voxels[0]); });
  }

  double operator()(const Point3& p) const {
    const double* sum = around_.find(around_.index_of(p));
    return sum == nullptr ? 0.0 : *sum;
  }
  /// The most there is around any place.
  double largest() const { return largest_; }

 private:
  using Sums = VoxelGrid<double, 1>;
  Sums around_;
  double largest_ = 0.0;
};
}  // namespace surfleet
