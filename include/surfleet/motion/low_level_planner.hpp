// SPDX-License-Identifier: MIT
/// @file
/// @brief The checks a robot makes along its path [000 §2.5.3, 3.5.2, Alg. 1 and 3].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include <surfleet/core/error.hpp>
#include <surfleet/motion/body_check.hpp>
#include <surfleet/motion/free_space.hpp>

namespace surfleet {
/// Whether enough of what a plan set out to complete is done for a new plan to pay.
///
/// A robot waits for a new plan once c_thres (80 or 50 %) of the elements its plan was made for are
/// complete [000 §2.5.3 item 3]. A smaller share keeps a fleet near to what it discovers.
struct UtilityCheck {
  double threshold = 0.8;  ///< c_thres: share of the initial elements complete, in (0, 1].

  /// `initial` elements when the plan was made, `left` of them still incomplete. A plan without
  /// any is always done.
  bool operator()(std::size_t initial, std::size_t left) const {
    const std::size_t done = initial - std::min(left, initial);
    return static_cast<double>(done) >= threshold * static_cast<double>(initial);
  }
};

/// Whether a configuration has been reached.
struct GoalCheck {
  double position_tolerance = 0.05;     ///< [m]
  double yaw_tolerance = radians(2.0);  ///< [rad]

  bool operator()(const Configuration& at, const Configuration& goal) const {
    return (at.position - goal.position).norm() <= position_tolerance &&
           std::abs(wrap_angle(at.yaw - goal.yaw)) <= yaw_tolerance;
  }
};

/// Whether the path ahead has become blocked so near that the robot must stop now.
struct ObstacleCheck {
  double lookahead = 0.5;  ///< Checked beyond the braking distance [m].
  /// How far an obstacle may reach into the required distance before it counts [m]: less than the
  /// free space's margin, so that noise in a voxel beside the path does not stop the robot while
  /// the body's radius is still kept.
  double tolerance = 0.1;

  /// How far along `ahead`, which begins at the robot, it is blocked, if that is within reach. A
  /// path that leads out of a blocked place is not held against it: what counts is coming closer.
  std::optional<double> operator()(const FreeSpace& space, std::span<const Point3> ahead,
                                   double stopping_distance) const {
    if (ahead.size() < 2) return std::nullopt;
    const double step = space.voxel_size() / 3.0;
    auto read = space.probe();
    const double here = std::min(read.slack(ahead[0]), 0.0);
    double along = 0.0;
    const double reach = stopping_distance + lookahead;
    for (std::size_t i = 1; i < ahead.size() && along < reach; ++i) {
      const Eigen::Vector3d leg = ahead[i] - ahead[i - 1];
      const double length = leg.norm();
      const int parts = std::max(1, static_cast<int>(std::ceil(length / step)));
      for (int k = 1; k <= parts; ++k) {
        const double at = along + length * k / parts;
        if (at > reach + step) return std::nullopt;
        const Point3 p = ahead[i - 1] + leg * (static_cast<double>(k) / parts);
        if (read.slack(p) < here - tolerance) return at;
      }
      along += length;
    }
    return std::nullopt;
  }

  /// The same for a body of any shape that keeps its heading along the path: whether an obstacle
  /// voxel reaches it at `q`.
  template <CollisionBody Body>
  bool reaches(const FreeSpace& space, const Body& body, const Configuration& q) const {
    return !is_body_free(space, body, q);
  }
};
}  // namespace surfleet
