// SPDX-License-Identifier: MIT
/// @file
/// @brief Whether a body of any shape fits somewhere in a free space.
#pragma once

#include <surfleet/motion/collision_body.hpp>
#include <surfleet/motion/free_space.hpp>

namespace surfleet {
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
