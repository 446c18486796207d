// SPDX-License-Identifier: MIT
/// @file
/// @brief What viewpoints are asked for: that the robot may be there, and that the view may show
/// something new.
#pragma once

#include <cmath>
#include <concepts>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/viewpoint/incomplete_element.hpp>

namespace surfleet {
/// What generation asks about a configuration: `p(q)` is true if the robot may be there. Asked both
/// for "free" and for "reachable". Pure.
template <typename P>
concept ConfigurationPredicate = requires(const P& p, const Configuration& q) {
  { p(q) } -> std::convertible_to<bool>;
};
/// Any configuration will do, and any line of sight.
struct AlwaysTrue {
  bool operator()(const Configuration& /*q*/) const { return true; }
  bool operator()(const IncompleteElement& /*e*/, const Eigen::Vector3d& /*direction*/) const {
    return true;
  }
};
/// What generation asks about a line of sight: `p(e, direction)` is true if a view of the element
/// along the unit vector from it to the camera may show something new. Pure.
template <typename P>
concept ViewPredicate = requires(const P& p, const IncompleteElement& e,
                                 const Eigen::Vector3d& direction) {
  { p(e, direction) } -> std::convertible_to<bool>;
};
/// Free where every voxel whose centre is within `radius` [m] is known to be empty, and the voxel
/// that holds the position itself.
struct EmptyBall {
  const VoxelStateMap* map;
  double radius = 0.0;
  bool operator()(const Configuration& q) const {
    VoxelStateMap::Accessor state(*map);
    const VoxelStateMap::Grid& grid = map->grid();
    if (state(grid.index_of(q.position)) != VoxelState::empty) return false;
    const Eigen::Vector3d r = Eigen::Vector3d::Constant(radius);
    for (int axis = 0; axis < 3; ++axis) {  // what is not free mostly shows at the far ends
      const double reach = std::max(0.0, radius - 0.87 * grid.voxel_size());
      for (const double side : {-reach, reach}) {
        const Point3 p = q.position + side * Eigen::Vector3d::Unit(axis);
        if (state(grid.index_of(p)) != VoxelState::empty) return false;
      }
    }
    const VoxelIndex low = grid.index_of(q.position - r), high = grid.index_of(q.position + r);
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int x = low.x(); x <= high.x(); ++x) {
          const VoxelIndex v(x, y, z);
          if ((grid.center(v) - q.position).squaredNorm() <= radius * radius &&
              state(v) != VoxelState::empty)
            return false;
        }
    return true;
  }
};
static_assert(ConfigurationPredicate<AlwaysTrue> && ConfigurationPredicate<EmptyBall>);
static_assert(ViewPredicate<AlwaysTrue>);
}  // namespace surfleet
