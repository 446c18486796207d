// SPDX-License-Identifier: MIT
/// @file
/// @brief What a robot has viewed for long enough, and has not come to know.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/viewpoint/revealing_view.hpp>

namespace surfleet {
/// After `images` from a stop, of at most `most_images`: whatever was viewed at a fair angle for
/// long enough and is still incomplete, and what the stop was for in any case, was viewed in vain.
/// Not for use while goals are stale. O(goals · rays).
inline void note_views_in_vain(SurfaceBelief& belief, const KindSpace& space,
                               const Configuration& at, const Stop& stop, std::size_t images,
                               std::size_t most_images) {
  constexpr double kFair = 0.4;  // least cosine between n̄_v and the line of sight
  const ViewFrustum::Placed view = space.frustum.at(at);
  const Point3 eye = view.eye();
  LineOfSight line(belief.observed());
  std::vector<std::pair<VoxelIndex, Eigen::Vector3d>> vain;
  for (const IncompleteElement& e : belief.goals()) {
    if (images < std::min(belief.images_needed(at.position, e.voxel), most_images)) continue;
    const Eigen::Vector3d to_eye = (eye - e.position).normalized();
    const bool fair = e.faces(to_eye, kFair) && reveals(view, e, line);
    if (fair || std::find(stop.targets.begin(), stop.targets.end(), e.voxel) != stop.targets.end())
      vain.emplace_back(e.voxel, to_eye);
  }
  for (const auto& [voxel, direction] : vain) belief.viewed_in_vain(voxel, direction);
}
}  // namespace surfleet
