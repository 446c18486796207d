// SPDX-License-Identifier: MIT
/// @file
/// @brief Waypoints over a cloud joined by motions of a bicycle on quadric patches [004 §8.3].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/triangle_queries.hpp>
#include <surfleet/surface/quadric_patch.hpp>

namespace surfleet {
struct PatchDriveOptions {
  QuadricOptions quadric = {};
  double wheelbase = 0.125;              ///< [m]
  double most_steering = radians(45.0);  ///< [rad]
  int fan = 11;                          ///< Steering angles tried, the straight one among them.
  double primitive = 0.02;               ///< Length of a motion [m].
  double lookahead = 0.08;               ///< Waypoints nearer than this are behind it [m].
  double tolerance = 0.03;               ///< How near to the last waypoint is there [m].
};

struct PatchDrive {
  std::vector<PatchPose> poses;  ///< At the ends of motions.
  std::size_t patches = 0;       ///< Fitted in all.
  double length = 0.0;           ///< [m]
  double off_path = 0.0;         ///< Farthest from the waypoints' polyline [m].
  bool reached = false;
};

/// Drives from the first waypoint towards the others: of a fan of motions on the patch the one that
/// ends nearest to the waypoint ahead; a new patch where all would leave the valid part of the old
/// one. Patches are weighted by `saliency` where one value a point is given. Ends where no patch
/// can be fitted. Throws `Error` for fewer than two waypoints.
inline PatchDrive drive_over_patches(const PointCloud& cloud, const KdTree& tree,
                                     std::span<const Point3> waypoints,
                                     const PatchDriveOptions& options = {},
                                     std::span<const double> saliency = {}) {
  require(waypoints.size() >= 2, "patch drive: expected two waypoints or more");
  require(options.fan >= 3 && options.fan % 2 == 1 && options.wheelbase > 0.0 &&
              options.most_steering > 0.0 && options.most_steering < 0.5 * kPi &&
              options.primitive > 0.0 && options.lookahead >= options.primitive,
          "patch drive: expected an odd fan, a wheelbase, steering below 90 degrees and a "
          "lookahead of a motion at least");
  PatchDrive drive;
  double planned = 0.0;
  for (std::size_t i = 1; i < waypoints.size(); ++i)
    planned += (waypoints[i] - waypoints[i - 1]).norm();
  auto patch = fit_quadric(cloud, tree, waypoints[0], options.quadric, saliency);
  if (!patch) return drive;
  drive.patches = 1;
  auto at = patch->pose(waypoints[0], waypoints[1] - waypoints[0]);
  if (!at) return drive;
  drive.poses.push_back(*at);
  const auto most = static_cast<std::size_t>(3.0 * planned / options.primitive) + 50;
  std::size_t ahead = 1;
  bool fresh = true;
  while (drive.poses.size() < most) {
    while (ahead + 1 < waypoints.size() &&
           (waypoints[ahead] - at->position).norm() < options.lookahead)
      ++ahead;
    const Point3& target = waypoints[ahead];
    const double left = (target - at->position).norm();
    const bool last = ahead + 1 == waypoints.size();
    if (last && left < 0.5 * options.primitive) break;
    std::optional<PatchPose> best;
    double nearest = 0.0;
    for (int i = 0; i < options.fan; ++i) {
      const double share = 2.0 * i / (options.fan - 1) - 1.0;
      const double curvature = std::tan(share * options.most_steering) / options.wheelbase;
      const auto end = patch->drive(*at, curvature, options.primitive);
      if (!end) continue;
      // The point ahead of it from there, so that it turns in time.
      const Point3 aim = end->position + std::min(left, options.lookahead) * end->forward;
      const double off = (end->position - target).norm() + 0.5 * (aim - target).norm();
      if (!best || off < nearest) {
        best = end;
        nearest = off;
      }
    }
    if (!best) {
      if (fresh) break;  // not even on its own patch
      patch = fit_quadric(cloud, tree, at->position, options.quadric, saliency);
      if (!patch) break;
      ++drive.patches;
      fresh = true;
      at = patch->pose(at->position, at->forward);
      if (!at) break;
      continue;
    }
    if (last && left < options.lookahead && (best->position - target).norm() > left) break;
    fresh = false;
    drive.length += (best->position - at->position).norm();
    at = best;
    drive.poses.push_back(*at);
    double off = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < waypoints.size(); ++i)
      off = std::min(
          off,
          (at->position - closest_on_segment(at->position, waypoints[i - 1], waypoints[i])).norm());
    drive.off_path = std::max(drive.off_path, off);
  }
  drive.reached = (drive.poses.back().position - waypoints.back()).norm() <= options.tolerance;
  return drive;
}
}  // namespace surfleet
