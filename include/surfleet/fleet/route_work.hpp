// SPDX-License-Identifier: MIT
/// @file
/// @brief What a route is for, and whether enough of it is complete for a new one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/motion/low_level_planner.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>

namespace surfleet {
/// The incomplete elements that a route was made for.
class RouteWork {
 public:
  RouteWork() = default;
  RouteWork(const Stops& route, const IncompleteSurface& incomplete) {
    for (const Stop& s : route)
      for (const VoxelIndex& v : s.targets)
        if (incomplete.contains(v)) initial_.push_back(v);
  }

  /// UtilityCheck as printed [000 §2.5.3 item 3]: whether this share of all of them is complete,
  /// whatever was visited.
  bool is_complete(double share, const IncompleteSurface& incomplete) const {
    return !initial_.empty() && UtilityCheck{share}(initial_.size(), open(initial_, incomplete));
  }
  /// The same, where what is behind the robot counts no more: it was viewed, if in vain, or given
  /// up. `ahead` is what is left of the route.
  bool is_complete_or_behind(double share, const IncompleteSurface& incomplete,
                             const Stops& ahead) const {
    std::size_t left = 0;
    for (const Stop& s : ahead) left += open(s.targets, incomplete);
    return !initial_.empty() && UtilityCheck{share}(initial_.size(), left);
  }

 private:
  static std::size_t open(const std::vector<VoxelIndex>& voxels,
                          const IncompleteSurface& incomplete) {
    return static_cast<std::size_t>(std::count_if(
        voxels.begin(), voxels.end(), [&](const VoxelIndex& v) { return incomplete.contains(v); }));
  }
  std::vector<VoxelIndex> initial_;
};
}  // namespace surfleet
