// SPDX-License-Identifier: MIT
/// @file
/// @brief What planners are made with, in terms of the mission.
#pragma once

#include <optional>

#include <surfleet/viewpoint/viewpoint_merging.hpp>

namespace surfleet {
/// What planners are made with. Settings of one planner alone are those of its own type.
struct PlannerSettings {
  double standoff = 4.7;            ///< δ_pose [m].
  double cluster_radius = 2.0;      ///< d_ν [m].
  double cluster_max_radius = 5.0;  ///< d_ν^max [m].
  bool cluster_by_path = false;     ///< Whether roadmap paths join viewpoints, not straight lines.
  double lambda_tc = 0.3, lambda_ic = 0.03;  ///< Penalties of travel [1/m].
  MergeOptions merge{};
  double speed = 0.6, yaw_rate = 0.8;  ///< Of the robots [m/s, rad/s]; what stops cost.
  /// c_thres of TSGA as it is printed: what is complete of a route when a new plan is wanted.
  double printed_share = 0.8;
  /// The same of whatever planner, in place of its own.
  std::optional<double> utility_share{};
  int threads = 1;  ///< Of the default planner; plans are the same for any number.
};
}  // namespace surfleet
