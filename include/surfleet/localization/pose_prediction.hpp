// SPDX-License-Identifier: MIT
/// @file
/// @brief Where a target will be next: policies that carry a history of poses on [004 §9.4.1].
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include <surfleet/core/types.hpp>
#include <surfleet/localization/uncertain_pose.hpp>

namespace surfleet {
/// A pose at a moment.
struct TimedPose {
  double time = 0.0;  ///< [s]
  Pose T_camera_target = Pose::Identity();
};

/// A motion model: `model(history, time)` is the pose at `time`, after the last of `history` (times
/// increase; never empty); `model.samples()` says how many of the latest poses it uses.
template <typename M>
concept MotionModel = std::copyable<M> &&
    requires(const M& m, std::span<const TimedPose> history, double time) {
  { m(history, time) } -> std::convertible_to<Pose>;
  { m.samples() } -> std::convertible_to<std::size_t>;
};

/// It stays where it is.
struct StandStill {
  Pose operator()(std::span<const TimedPose> history, double /*time*/) const {
    return history.back().T_camera_target;
  }
  std::size_t samples() const { return 1; }
};

/// Linear regression over the last k_R poses, in the tangent at the last: with two, the same motion
/// again, T(k−1) (T(k−2)⁻¹ T(k−1)) where frames are evenly spaced; with more, least squares.
struct LinearRegression {
  std::size_t count = 2;  ///< k_R.

  Pose operator()(std::span<const TimedPose> history, double time) const {
    const TimedPose& last = history.back();
    const std::size_t n = std::min(std::max<std::size_t>(count, 1), history.size());
    if (n < 2) return last.T_camera_target;
    history = history.last(n);
    // Of ξ(t) = a + b (t − t_last); translations are straight, rotations about one axis.
    double sum_t = 0.0, sum_tt = 0.0;
    Vector6 sum = Vector6::Zero(), sum_times_t = Vector6::Zero();
    for (const TimedPose& p : history) {
      const double t = p.time - last.time;
      const Vector6 xi = difference(last.T_camera_target, p.T_camera_target);
      sum_t += t;
      sum_tt += t * t;
      sum += xi;
      sum_times_t += t * xi;
    }
    const auto m = static_cast<double>(n);
    const double det = m * sum_tt - sum_t * sum_t;
    if (!(det > 0.0)) return last.T_camera_target;
    const Vector6 slope = (m * sum_times_t - sum_t * sum) / det;
    const Vector6 base = (sum - sum_t * slope) / m;
    return perturbed(last.T_camera_target, base + slope * (time - last.time));
  }
  std::size_t samples() const { return std::max<std::size_t>(count, 1); }
};

/// Translation by regression, rotation by what an inertial sensor says: `turn(from, to)` is the
/// camera's own rotation R_then_now between two times, from its gyroscope. The target is taken to
/// stand still in the world, or to turn as little.
struct InertialRotation {
  std::function<Eigen::Matrix3d(double from, double to)> turn;
  LinearRegression regression;

  Pose operator()(std::span<const TimedPose> history, double time) const {
    const TimedPose& last = history.back();
    const Pose straight = regression(history, time);
    if (!turn) return straight;
    Pose T = straight;
    T.linear() = turn(last.time, time).transpose() * last.T_camera_target.linear();
    return T;
  }
  std::size_t samples() const { return regression.samples(); }
};

static_assert(MotionModel<StandStill> && MotionModel<LinearRegression>);
static_assert(MotionModel<InertialRotation>);
}  // namespace surfleet
