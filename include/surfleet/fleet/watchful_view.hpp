// SPDX-License-Identifier: MIT
/// @file
/// @brief The view of the most incomplete surface for a robot under way.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>
#include <surfleet/viewpoint/view_limits.hpp>
#include <surfleet/viewpoint/visibility.hpp>

namespace surfleet {
/// The view of the most incomplete surface from `here`; nothing if there is none. O(goals + those
/// in range · rays). Not for use while goals are stale.
inline std::optional<Configuration> watchful_view(const SurfaceBelief& belief,
                                                  const KindSpace& space, const Point3& here) {
  std::vector<SightTarget> near;
  const double reach = kUsefulRange * space.kind.camera.max_range;
  for (const IncompleteElement& e : belief.goals())
    if ((e.position - here).squaredNorm() < reach * reach)
      near.push_back({e.frontier(belief.voxel_size()), e.direction, 1.0, 2});
  if (near.empty()) return std::nullopt;
  const SightTargets targets(std::move(near), MapSight(belief.observed()), space.headings,
                             {.max_range = reach});
  const std::vector<char> none(targets.size(), 0);
  const auto gain = gain_by_view(targets, targets.seen_from(here), none);
  const auto best = std::max_element(gain.begin(), gain.end());
  if (*best <= 0.0) return std::nullopt;
  return space.headings.at(here, static_cast<int>(best - gain.begin()));
}

/// The same for a robot with `left` metres before its goal; the goal's view where there is none, or
/// it could not turn to that in time any more. Unless it is to `watch_on`, the goal's as soon as it
/// might have to turn right round.
inline Configuration view_under_way(const SurfaceBelief& belief, const KindSpace& space,
                                    const Point3& here, double left, const Configuration& goal,
                                    bool watch_on) {
  const AerialLimits& limits = space.kind.limits;
  const auto has_to_turn = [&](double yaw, double pitch) {
    const double time = std::max(yaw / limits.yaw_rate, pitch / limits.pitch_rate);
    return left < (time + 0.5) * limits.speed;
  };
  if (!watch_on && has_to_turn(kPi, 0.0)) return goal;
  const auto view = watchful_view(belief, space, here);
  return !view || has_to_turn(std::abs(wrap_angle(goal.yaw - view->yaw)),
                              std::abs(goal.pitch - view->pitch))
             ? goal
             : *view;
}
}  // namespace surfleet
