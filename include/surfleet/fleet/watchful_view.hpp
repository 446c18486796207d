// SPDX-License-Identifier: MIT
/// @file
/// @brief Where a robot under way looks to see most of what is to be seen.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>
#include <surfleet/viewpoint/visibility.hpp>

namespace surfleet {
/// The view of the most incomplete surface from `here`; nothing if there is none. O(goals + those
/// in range · rays). Not for use while goals are stale.
inline std::optional<Configuration> watchful_view(const SurfaceBelief& belief,
                                                  const KindSpace& space, const Point3& here) {
  std::vector<SightTarget> near;
  const double reach = 0.85 * space.kind.camera.max_range;
  for (const IncompleteElement& e : belief.goals())
    if ((e.position - here).squaredNorm() < reach * reach)
      near.push_back({e.frontier(belief.voxel_size()), e.direction, 1.0, 2});
  if (near.empty()) return std::nullopt;
  const SightTargets targets(std::move(near), MapSight(belief.observed()), space.headings,
                             {.max_range = reach});
  const std::vector<char> none(targets.size(), 0);
  const auto worth = worth_by_view(targets, targets.seen_from(here), none);
  const auto best = std::max_element(worth.begin(), worth.end());
  if (*best <= 0.0) return std::nullopt;
  return space.headings.at(here, static_cast<int>(best - worth.begin()));
}
}  // namespace surfleet
