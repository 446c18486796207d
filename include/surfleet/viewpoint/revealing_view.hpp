// SPDX-License-Identifier: MIT
/// @file
/// @brief Whether a view can complete an incomplete element.
#pragma once

#include <surfleet/core/types.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/visibility.hpp>

namespace surfleet {
/// Whether an unknown neighbour of an element is in the frustum and in sight. An element that does
/// not say which they are is taken at its word. O(voxels on the lines of sight).
inline bool shows_unknown(const ViewFrustum::Placed& placed, const IncompleteElement& e,
                          LineOfSight& line) {
  const Point3 eye = placed.eye();
  return e.unknown == 0 || e.any_unknown([&](const VoxelIndex& offset) {
    return placed.contains(e.position + line.voxel_size() * offset.cast<double>()) &&
           line.sees(eye, e.voxel + offset);
  });
}
/// Whether a view brings an element nearer to completion: the element is in the frustum and in
/// sight, and so is one of its unknown neighbours. A view that misses them is in vain however long
/// it lasts: the element is complete once they are known. O(voxels on the lines of sight).
inline bool reveals(const ViewFrustum::Placed& placed, const IncompleteElement& e,
                    LineOfSight& line) {
  return placed.contains(e.position) && line.sees(placed.eye(), e.voxel) &&
         shows_unknown(placed, e, line);
}
}  // namespace surfleet
