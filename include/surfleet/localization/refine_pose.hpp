// SPDX-License-Identifier: MIT
/// @file
/// @brief The most likely pose of points seen along bearings, and its covariance: Gauss–Newton.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include <surfleet/core/types.hpp>
#include <surfleet/localization/observation.hpp>
#include <surfleet/localization/uncertain_pose.hpp>

namespace surfleet {
struct RefineOptions {
  int max_iterations = 15;
  double huber = 3.0;  ///< Errors beyond this count linearly, no longer squared [px].
};

struct RefinedPose {
  Pose T_camera_target = Pose::Identity();
  double cost = std::numeric_limits<double>::infinity();  ///< Σ of squared errors [px²], robust.
  Matrix6 information = Matrix6::Zero();  ///< JᵀJ of `perturbed`'s ξ, for an error of one pixel.
  int iterations = 0;

  bool valid() const { return std::isfinite(cost); }
  /// Σ = σ² (JᵀJ)⁻¹ for centres with errors of `sigma` [px] along each axis.
  Matrix6 covariance(double sigma) const { return sigma * sigma * inverse_of(information); }
};

/// What is known of a pose before it is measured.
struct PosePrior {
  Pose T_camera_target = Pose::Identity();
  Matrix6 information =
      Matrix6::Zero();  ///< Inverse covariance, for an error of one pixel as above.
};

namespace detail {
/// Of one error of length √r2: its robust cost, and the weight of its square in the next step.
inline double huber_cost(double r2, double k) {
  return r2 <= k * k ? r2 : k * (2.0 * std::sqrt(r2) - k);
}
inline double huber_weight(double r2, double k) { return r2 <= k * k ? 1.0 : k / std::sqrt(r2); }

/// Σ of robust squared errors of `points[i]` seen as `seen[i]` [px²]; infinite if one is behind.
inline double reprojection_cost(std::span<const Observation> seen, std::span<const Point3> points,
                                const Pose& T, double huber) {
  double cost = 0.0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Eigen::Vector3d p = T.linear() * points[i] + T.translation();
    const double along = seen[i].bearing.dot(p);
    if (!(along > 0.0)) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d r = seen[i].to_pixels * p;
    cost += huber_cost(r.squaredNorm() / (along * along), huber);
  }
  return cost;
}
}  // namespace detail

/// From `start`, the pose with the least robust sum of squared errors of `points[i]` (target frame)
/// observed as `seen[i]`; damped where a full step would make it worse. Not `valid` where the start
/// has points behind the camera. A `prior` counts like a measurement. O(points) an iteration.
/// Expects at least three points.
inline RefinedPose refine_pose(std::span<const Observation> seen, std::span<const Point3> points,
                               const Pose& start, const RefineOptions& options = {},
                               const PosePrior* prior = nullptr) {
  RefinedPose best;
  best.T_camera_target = start;
  const auto cost_of = [&](const Pose& T) {
    double cost = detail::reprojection_cost(seen, points, T, options.huber);
    if (prior) {
      const Vector6 xi = difference(prior->T_camera_target, T);
      cost += xi.dot(prior->information * xi);
    }
    return cost;
  };
  best.cost = cost_of(start);
  if (!best.valid()) return best;
  double damping = 0.0;
  Matrix6 h;
  Vector6 g;
  const auto linearize = [&] {
    h.setZero();
    g.setZero();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Observation& o = seen[i];
      const Eigen::Vector3d q = best.T_camera_target.linear() * points[i];
      const Eigen::Vector3d p = q + best.T_camera_target.translation();
      const double scale = 1.0 / o.bearing.dot(p);
      const Eigen::Vector2d r = scale * (o.to_pixels * p);
      const Eigen::Matrix<double, 2, 3> by_point =
          scale * (o.to_pixels - r * o.bearing.transpose());
      Eigen::Matrix<double, 6, 2> jt;
      jt.topRows<3>().col(0) = q.cross(by_point.row(0).transpose());
      jt.topRows<3>().col(1) = q.cross(by_point.row(1).transpose());
      jt.bottomRows<3>() = by_point.transpose();
      const double w = detail::huber_weight(r.squaredNorm(), options.huber);
      h.noalias() += w * jt * jt.transpose();
      g.noalias() += w * (jt * r);
    }
    if (prior) {
      h += prior->information;
      g += prior->information * difference(prior->T_camera_target, best.T_camera_target);
    }
  };
  linearize();
  for (; best.iterations < options.max_iterations; ++best.iterations) {
    Matrix6 damped = h;
    damped.diagonal() *= 1.0 + damping;
    const Vector6 step = -Eigen::LLT<Matrix6>(damped).solve(g);
    if (!step.allFinite()) break;
    const Pose next = perturbed(best.T_camera_target, step);
    const double cost = cost_of(next);
    if (!(cost < best.cost)) {
      // At the minimum rounding decides; elsewhere the step was too long.
      if (g.dot(-step) <= 1e-12 * (best.cost + 1e-9) || damping > 1e8) break;
      damping = damping > 0.0 ? 10.0 * damping : 1e-3;
      continue;
    }
    const double gain = best.cost - cost;
    best.T_camera_target = next;
    best.cost = cost;
    damping *= 0.1;
    if (damping < 1e-6) damping = 0.0;
    linearize();
    if (gain <= 1e-7 * cost || cost < 1e-24) break;
  }
  best.information = h;
  return best;
}
}  // namespace surfleet
