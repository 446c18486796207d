// SPDX-License-Identifier: MIT
/// @file  Where a region goes on into space that nobody has looked into.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>

namespace surfleet {
/// The border of unseen space in a region, in cells: what a surface that stands by itself, behind
/// empty space only, can be found by. Incomplete elements do not lead there, as they need surface.
///
/// A cell is unseen as long as its middle voxel is unknown, and on the border if the middle of a
/// face neighbour is empty. After `max_looks` looks ordered at it a cell is given up: unknown space
/// in nooks stays what it is.
class UnseenSpace {
 public:
  explicit UnseenSpace(int max_looks = 3) : max_looks_(max_looks) {}

  /// Finds the border anew, in cells `edge` wide (rounded to whole voxels) whose centre lies in
  /// `region`; an empty region means nothing to look for. O(cells of the region).
  void update(const VoxelStateMap& states, const Box3& region, double edge) {
    cells_.clear();
    if (region.isEmpty()) return;
    require(edge > 0.0 && std::isfinite(edge), "unseen space: expected cells of a positive width");
    const int voxels = std::max(1, static_cast<int>(std::lround(edge / states.voxel_size())));
    edge_ = voxels * states.voxel_size();
    const auto cell_of = [&](const Point3& p) -> VoxelIndex {
      return (p / edge_).array().floor().cast<int>();
    };
    const VoxelIndex lo = cell_of(region.min()), hi = cell_of(region.max());
    VoxelStateMap::Accessor state(states);
    const auto middle = [&](int x, int y, int z) {
      return state(VoxelIndex(x, y, z) * voxels + VoxelIndex::Constant(voxels / 2));
    };
    for (int z = lo.z(); z <= hi.z(); ++z)
      for (int y = lo.y(); y <= hi.y(); ++y)
        for (int x = lo.x(); x <= hi.x(); ++x) {
          if (middle(x, y, z) != VoxelState::unknown) continue;
          const std::array around{middle(x - 1, y, z), middle(x + 1, y, z), middle(x, y - 1, z),
                                  middle(x, y + 1, z), middle(x, y, z - 1), middle(x, y, z + 1)};
          const VoxelKey cell{x, y, z};
          if (std::find(around.begin(), around.end(), VoxelState::empty) == around.end() ||
              !region.contains(center(cell)))
            continue;
          const auto it = looks_.find(cell);
          if (it == looks_.end() || it->second < max_looks_) cells_.push_back(cell);
        }
  }

  /// The border as of the last update, in the order z, y, x.
  std::size_t size() const { return cells_.size(); }
  /// [m]
  Point3 center(std::size_t i) const { return center(cells_[i]); }
  double edge() const { return edge_; }  ///< Of a cell [m].
  /// A look at cell `i` was ordered.
  void note_look(std::size_t i) { ++looks_[cells_[i]]; }

 private:
  Point3 center(const VoxelKey& c) const {
    return (Point3(c[0], c[1], c[2]) + Point3::Constant(0.5)) * edge_;
  }

  int max_looks_;
  double edge_ = 0.0;
  std::vector<VoxelKey> cells_;
  std::map<VoxelKey, int> looks_;
};
}  // namespace surfleet
