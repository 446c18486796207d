// SPDX-License-Identifier: MIT
/// @file
/// @brief Teammates that are seen and have told nothing of themselves, as traffic.
#pragma once

#include <algorithm>
#include <map>
#include <span>
#include <vector>

#include <surfleet/fleet/robot_body.hpp>
#include <surfleet/motion/traffic_policy.hpp>

namespace surfleet {
/// Adds those of `seen` that none of `told` is at. Where they go is unknown: they are as large as
/// all that a robot like `self` reaches before it sees a reason to brake and stands. They come last
/// by right of way. O(seen · told).
inline void add_silent_mates(std::span<const SeenRobot> seen,
                             const std::map<int, TrafficAgent>& told, const TrafficAgent& self,
                             const TrafficOptions& options, std::vector<TrafficAgent>& traffic) {
  constexpr int kFirstId = 1 << 20;
  const double reach =
      self.speed * options.period + 0.5 * self.speed * self.speed / options.braking;
  for (const SeenRobot& mate : seen) {
    if (std::any_of(told.begin(), told.end(), [&](const auto& t) {
          return t.second.distance(mate.position) <= t.second.extent() + mate.error;
        }))
      continue;
    TrafficAgent silent;
    silent.id = kFirstId + static_cast<int>(traffic.size());
    silent.position = mate.position;
    silent.radius = self.radius + mate.error + reach;
    silent.speed = self.speed;
    traffic.push_back(silent);
  }
}
}  // namespace surfleet
