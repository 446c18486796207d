// SPDX-License-Identifier: MIT
/// @file
/// @brief The pose of a target whose markers are told apart.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include <surfleet/core/error.hpp>
#include <surfleet/localization/p3p_lambda_twist.hpp>
#include <surfleet/localization/refine_pose.hpp>

namespace surfleet {
/// The pose of at least four labelled markers: P3P of the triple that spans most of the view, the
/// solutions that fit the other markers best, refined. The other of two that fit about as well is
/// in `second`, as with flat targets. Nothing if no solution has all markers in front of the
/// camera.
///
/// O(n) after the choice of the triple, which is greedy. Throws `Error` on fewer than four or on
/// unequal numbers.
template <P3pSolver Solver = LambdaTwistP3p>
std::optional<RefinedPose> estimate_pose(std::span<const Observation> seen,
                                         std::span<const Point3> points,
                                         const RefineOptions& options = {},
                                         const Solver& solver = {},
                                         std::optional<RefinedPose>* second = nullptr) {
  const std::size_t n = seen.size();
  require(n >= 4 && points.size() == n,
          "pose: expected at least four markers and as many observations");
  // The farthest pair as seen, then what is farthest from the plane through both rays; and another
  // triple without the first of them.
  std::array<std::array<std::size_t, 3>, 2> triples{};
  for (std::size_t k = 0; k < 2; ++k) {
    auto& t = triples[k];
    const std::size_t banned = k == 0 ? n : triples[0][0];
    double widest = -1.0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j)
        if (i != banned && j != banned)
          if (const double s = (seen[i].bearing - seen[j].bearing).squaredNorm(); s > widest) {
            widest = s;
            t[0] = i;
            t[1] = j;
          }
    const Eigen::Vector3d normal = seen[t[0]].bearing.cross(seen[t[1]].bearing);
    double off = -1.0;
    for (std::size_t i = 0; i < n; ++i)
      if (i != t[0] && i != t[1] && i != banned)
        if (const double s = std::abs(normal.dot(seen[i].bearing)); s > off) {
          off = s;
          t[2] = i;
        }
  }
  constexpr double kAll = std::numeric_limits<double>::infinity();
  std::array<Pose, 2> start;
  std::array<double, 2> cost{kAll, kAll};
  const auto different = [](const Pose& a, const Pose& b) {
    return (a.linear() - b.linear()).squaredNorm() > 0.01 ||
           (a.translation() - b.translation()).squaredNorm() > 1e-3 * a.translation().squaredNorm();
  };
  for (const auto& t : triples) {
    const Bearings3 f{seen[t[0]].bearing, seen[t[1]].bearing, seen[t[2]].bearing};
    const Points3 p{points[t[0]], points[t[1]], points[t[2]]};
    for (const Pose& T : solver(f, p)) {
      const double c = detail::reprojection_cost(seen, points, T, options.huber);
      if (c < cost[0]) {
        if (cost[0] < kAll && different(T, start[0])) {
          start[1] = start[0];
          cost[1] = cost[0];
        }
        start[0] = T;
        cost[0] = c;
      } else if (c < cost[1] && different(T, start[0])) {
        start[1] = T;
        cost[1] = c;
      }
    }
  }
  if (!(cost[0] < kAll)) return std::nullopt;
  RefinedPose best = refine_pose(seen, points, start[0], options);
  if (cost[1] < kAll) {
    // A few steps show whether the other start leads to anything.
    RefineOptions few = options;
    few.max_iterations = std::min(3, options.max_iterations);
    RefinedPose other = refine_pose(seen, points, start[1], few);
    if (other.cost < 4.0 * best.cost + 1e-12)
      other = refine_pose(seen, points, other.T_camera_target, options);
    if (other.cost < best.cost) std::swap(best, other);
    if (second && other.valid() && different(best.T_camera_target, other.T_camera_target))
      *second = other;
  }
  return best;
}
}  // namespace surfleet
