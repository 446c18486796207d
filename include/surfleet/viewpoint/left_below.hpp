// SPDX-License-Identifier: MIT
/// @file
/// @brief What a robot that climbs leaves below.
#pragma once

#include <algorithm>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// All but `most` and `foot` are over the camera's range.
struct LeftBelowOptions {
  double most = 1.0;   ///< What lies below counts so much more at the most; 0: nothing more.
  double foot = 1.0;   ///< And again so much more at the foot of the region, a range up nothing.
  double peak = 0.5;   ///< So far below the robot it does.
  double end = 1.5;    ///< So far below it counts no more than elsewhere.
  double aside = 2.0;  ///< So far off on the level, too; up to one range less it counts in full.
};

/// How many times its worth something at `target` counts for a robot at `robot`, in a region whose
/// foot is at the height `foot` [m]: 1 or more.
///
/// What a robot climbs away from it has to come back for, from higher up the longer it waits. So
/// what it could leave below counts more while that is near, most of all at the foot: nothing else
/// takes it all the way down again. What is far below does not: the way back to it costs about the
/// same whenever it is flown. Continuous in both places. O(1).
inline double worth_left_below(const Point3& robot, const Point3& target, double foot, double range,
                               const LeftBelowOptions& options = {}) {
  require(range > 0.0 && options.most >= 0.0 && options.foot >= 0.0 && options.peak > 0.0 &&
              options.end > options.peak,
          "left below: expected a positive range, shares of 0 or more and 0 < peak < end");
  const double below = (robot.z() - target.z()) / range;
  const double off = (robot - target).head<2>().norm() / range;
  const double down = below < options.peak ? below / options.peak
                                           : (options.end - below) / (options.end - options.peak);
  const double most =
      options.most + options.foot * std::clamp(1.0 - (target.z() - foot) / range, 0.0, 1.0);
  return 1.0 + most * std::max(down, 0.0) * std::clamp(options.aside - off, 0.0, 1.0);
}
}  // namespace surfleet
