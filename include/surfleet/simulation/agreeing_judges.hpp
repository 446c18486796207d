// SPDX-License-Identifier: MIT
/// @file
/// @brief Two independent measures of one distance, which are to agree.
///
///     AgreeingJudges both(mesh_judge, bvh);        // FCL and our own tree
///     const JudgeReport report = judge_paths(both, paths, radius);
///     if (both.disagreements() > 0) …              // the verdict is not to be trusted
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>

#include <surfleet/core/error.hpp>
#include <surfleet/simulation/judge.hpp>

namespace surfleet {
/// A judge that asks two others and takes the lesser distance, so that neither can hide a collision
/// that the other sees, and that keeps account of how far they were apart.
///
/// Thread-safe if the two are. Costs both.
template <DistanceJudge First, DistanceJudge Second>
class AgreeingJudges {
 public:
  /// Both are referred to and must outlive this. More than `tolerance` [m] apart is a disagreement.
  AgreeingJudges(const First& first, const Second& second, double tolerance = 1e-3)
      : first_(&first), second_(&second), tolerance_(tolerance) {
    require(tolerance > 0.0, "agreeing judges: expected a positive tolerance");
  }

  /// The lesser of the two [m]; the other if one is not a number.
  double distance(const Point3& p) const {
    const double a = first_->distance(p), b = second_->distance(p);
    // Two infinities, of scenes without a surface, are one.
    double apart = a == b ? 0.0 : std::abs(a - b);
    if (std::isnan(apart)) apart = std::numeric_limits<double>::infinity();
    if (apart > tolerance_) disagreements_.fetch_add(1, std::memory_order_relaxed);
    double most = largest_.load(std::memory_order_relaxed);
    while (apart > most &&
           !largest_.compare_exchange_weak(most, apart, std::memory_order_relaxed)) {
    }
    return std::fmin(a, b);
  }

  double tolerance() const { return tolerance_; }
  /// The farthest that the two were apart [m].
  double largest_disagreement() const { return largest_; }
  /// How often they were farther apart than the tolerance.
  std::size_t disagreements() const { return disagreements_; }

 private:
  const First* first_;
  const Second* second_;
  double tolerance_;
  mutable std::atomic<double> largest_{0.0};
  mutable std::atomic<std::size_t> disagreements_{0};
};
static_assert(DistanceJudge<AgreeingJudges<Bvh, Bvh>>);
}  // namespace surfleet
