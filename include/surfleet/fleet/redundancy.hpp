// SPDX-License-Identifier: MIT
/// @file
/// @brief Two robots that are about to do the same, as each plans on a map of its own
/// [000 §4.5.2, Fig. 4.4].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <span>

#include <surfleet/core/types.hpp>
#include <surfleet/planning/plan.hpp>

namespace surfleet {
struct RedundancyOptions {
  double radius = 1.0;           ///< Stops this near are the same, d_ν / 2 [m] …
  double angle = radians(45.0);  ///< … if their headings differ by less.
  double shared = 0.5;           ///< So are those that share this part of either's targets.
};

/// RedundancyCheck [000 Alg. 6], for the next stop of a robot.
///
/// A stop that a mate has in its route, too, is the mate's if it gets there in fewer steps, or in
/// as many and is nearer, or as near and has the lower id. So of any number of robots one goes on.
class RedundancyCheck {
 public:
  RedundancyOptions options;

  bool same(const Stop& a, const Stop& b) const {
    if ((a.configuration.position - b.configuration.position).norm() <= options.radius &&
        std::abs(wrap_angle(a.configuration.yaw - b.configuration.yaw)) <= options.angle &&
        std::abs(a.configuration.pitch - b.configuration.pitch) <= options.angle)
      return true;
    if (a.targets.empty() || b.targets.empty()) return false;
    std::set<std::array<int, 3>> of_a;
    for (const VoxelIndex& v : a.targets) of_a.insert({v.x(), v.y(), v.z()});
    const auto common = static_cast<double>(
        std::count_if(b.targets.begin(), b.targets.end(), [&](const VoxelIndex& v) {
          return of_a.contains({v.x(), v.y(), v.z()});
        }));
    return common >=
           options.shared * static_cast<double>(std::min(a.targets.size(), b.targets.size()));
  }
  /// Whether the first stop of `self` is to be left to one of `mates`. O(stops · targets).
  bool operator()(const RobotState& self, std::span<const RobotState> mates) const {
    if (self.route.empty()) return false;
    const Stop& next = self.route.front();
    for (const RobotState& mate : mates) {
      if (mate.id == self.id || mate.route.empty()) continue;
      if (mate.first || !same(next, mate.route.front()))
        continue;  // one on its way home views none
      const double mine = (next.configuration.position - self.at.position).norm();
      const double its = (mate.route.front().configuration.position - mate.at.position).norm();
      if (its < mine || (its == mine && mate.id < self.id)) return true;
    }
    return false;
  }
};
}  // namespace surfleet
