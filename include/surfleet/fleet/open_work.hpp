// SPDX-License-Identifier: MIT
/// @file
/// @brief What stops still are for, by what is believed now.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <surfleet/core/types.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
/// Whether a robot on its way to one need not be told of the other.
inline bool nearly_equal(const Configuration& a, const Configuration& b) {
  constexpr double kSame = 1e-6;  // [m] and [rad]
  return (a.position - b.position).norm() < kSame && std::abs(wrap_angle(a.yaw - b.yaw)) < kSame &&
         std::abs(a.pitch - b.pitch) < kSame;
}
/// Nothing is left that the stop was for; one that is for nothing stays to be flown to.
inline bool is_pointless(const SurfaceBelief& belief, const Stop& stop) {
  return !stop.targets.empty() &&
         std::none_of(stop.targets.begin(), stop.targets.end(),
                      [&](const VoxelIndex& v) { return belief.is_open(v); });
}
/// Images that a stop's incomplete targets want, seen from `eye`; 0 if it has none.
inline std::size_t images_needed(const SurfaceBelief& belief, const Point3& eye, const Stop& stop) {
  std::size_t needed = 0;
  for (const VoxelIndex& v : stop.targets)
    if (belief.incomplete().contains(v))
      needed = std::max<std::size_t>(needed, belief.images_needed(eye, v));
  return needed;
}
}  // namespace surfleet
