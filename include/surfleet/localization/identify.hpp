// SPDX-License-Identifier: MIT
/// @file
/// @brief Which blob is which of a target's like markers: every pose that explains an image
/// [004 §9.4.3].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/localization/marker_target.hpp>
#include <surfleet/localization/p3p_lambda_twist.hpp>
#include <surfleet/localization/refine_pose.hpp>

namespace surfleet {
struct IdentifyOptions {
  double pixel_noise = 0.3;        ///< Standard deviation of a blob's centre along each axis [px].
  double gate = 3.0;               ///< Of a marker predicted from three others [px].
  std::size_t min_matches = 4;     ///< Three would fit always.
  double likelihood_bound = 15.0;  ///< Fits whose `score` is within this of the best are all kept.
  double max_deviations = 4.5;     ///< Fits less likely than so many standard deviations are none.
  double min_distance = 0.0;       ///< From camera to target's origin [m].
  double max_distance = std::numeric_limits<double>::infinity();  ///< [m]
  double size_ratio = 2.0;     ///< Images of markers larger or smaller by more are no matches.
  std::size_t max_blobs = 16;  ///< Of more, the first are used.
  RefineOptions refine;
};

/// A pose that explains blobs as markers.
struct TargetFit {
  static constexpr int kUnseen = -1;

  Pose T_camera_target = Pose::Identity();
  Matrix6 covariance = Matrix6::Zero();  ///< Of `T_camera_target`, as in `UncertainPose`.
  std::vector<int> blob_of_marker;       ///< `kUnseen` where a marker has none.
  std::size_t matches = 0;
  double chi_square = 0.0;  ///< With 2·matches − 6 degrees of freedom.
  /// −2 log of the probability of these matches, but for a constant, if all poses are as likely:
  /// χ² + log det JᵀJ. Chance fits tend to be near ones, which are exact and so say little.
  double score = 0.0;

  Pose T_target_camera() const { return T_camera_target.inverse(); }
  UncertainPose target_in_camera() const { return {T_camera_target, covariance}; }
  UncertainPose camera_in_target() const { return target_in_camera().inverse(); }
};

/// All fits that are likely, best first: by matches, then by `score`.
struct Identification {
  std::vector<TargetFit> fits;
  bool truncated = false;  ///< There were more blobs than are examined.

  bool ambiguous() const { return fits.size() > 1; }
};

namespace detail {
/// The value that χ² with `dof` degrees of freedom exceeds as seldom as a normal variable exceeds
/// `deviations` (Wilson & Hilferty).
inline double chi_square_quantile(double dof, double deviations) {
  const double v = 2.0 / (9.0 * dof);
  const double root = 1.0 - v + deviations * std::sqrt(v);
  return dof * root * root * root;
}

/// Diameter of the image of a sphere at `p` (camera frame) near an observation [px].
inline double expected_diameter(const Observation& near, double radius, const Eigen::Vector3d& p) {
  const double pixels_per_radian =
      std::sqrt(std::abs(near.to_pixels.row(0).cross(near.to_pixels.row(1)).dot(near.bearing)));
  return 2.0 * radius / p.norm() * pixels_per_radian;
}

struct MarkerPair {
  double error;  ///< Squared, of the blob from where the marker is seen [px²].
  std::size_t marker, blob;
};
/// The nearest pairs first, gives each marker without a blob one that is not taken.
/// O(pairs log pairs), which are sorted by it.
inline void take_nearest(std::vector<MarkerPair>& pairs, std::vector<bool>& taken, TargetFit& fit) {
  std::sort(pairs.begin(), pairs.end(), [](const MarkerPair& a, const MarkerPair& b) {
    return std::tie(a.error, a.marker, a.blob) < std::tie(b.error, b.marker, b.blob);
  });
  for (const MarkerPair& pair : pairs) {
    int& blob = fit.blob_of_marker[pair.marker];
    if (blob != TargetFit::kUnseen || taken[pair.blob]) continue;
    blob = static_cast<int>(pair.blob);
    taken[pair.blob] = true;
    ++fit.matches;
  }
}
/// Puts what a refinement gave into the fit; false, with no more than χ² changed, if that is
/// unlikely and `judge` says to mind.
inline bool take_refined(const RefinedPose& refined, const IdentifyOptions& options, bool judge,
                         TargetFit& fit) {
  fit.chi_square = refined.cost / (options.pixel_noise * options.pixel_noise);
  const double dof = 2.0 * static_cast<double>(fit.matches) - 6.0;
  if (judge && dof > 0.0 && fit.chi_square > chi_square_quantile(dof, options.max_deviations))
    return false;
  fit.T_camera_target = refined.T_camera_target;
  fit.covariance = refined.covariance(options.pixel_noise);
  fit.score = fit.chi_square + log_determinant(refined.information);
  return true;
}

/// Gathers fits of one target among one image's blobs.
class FitSearch {
 public:
  FitSearch(std::span<const Observation> blobs, const MarkerTarget& target,
            const IdentifyOptions& options)
      : blobs_(blobs), target_(target), options_(options) {}

  /// Matches the blobs with the markers as seen from `T`, refines, and keeps the fit if it is
  /// likely and new. `sure` markers keep their blobs.
  void consider(const Pose& T, std::span<const int> sure, double gate) {
    const double distance = T.translation().norm();
    if (distance < options_.min_distance || distance > options_.max_distance) return;
    if (!promising(T, sure, gate)) return;
    TargetFit fit;
    if (!match(T, sure, gate, fit) || known(fit, T)) return;
    if (!settle(fit, T)) return;
    // What the refined pose shows where nothing was found before.
    if (fit.matches < std::min(target_.markers.size(), blobs_.size())) {
      TargetFit more;
      if (match(fit.T_camera_target, fit.blob_of_marker, gate, more) && more.matches > fit.matches)
        if (settle(more, fit.T_camera_target)) fit = more;
    }
    if (!known(fit, fit.T_camera_target)) fits_.push_back(std::move(fit));
  }
  std::vector<TargetFit> take() {
    std::stable_sort(fits_.begin(), fits_.end(), [](const TargetFit& a, const TargetFit& b) {
      return a.matches != b.matches ? a.matches > b.matches : a.score < b.score;
    });
    std::size_t kept = 0;
    while (kept < fits_.size() && fits_[kept].matches == fits_[0].matches &&
           fits_[kept].score <= fits_[0].score + options_.likelihood_bound)
      ++kept;
    fits_.resize(kept);
    return std::move(fits_);
  }

 private:
  /// Whether any marker but those that are sure falls on a blob but theirs: most poses end here.
  bool promising(const Pose& T, std::span<const int> sure, double gate) const {
    for (std::size_t m = 0; m < sure.size(); ++m) {
      if (sure[m] != TargetFit::kUnseen) continue;
      const Eigen::Vector3d p = T.linear() * target_.markers[m] + T.translation();
      for (std::size_t b = 0; b < blobs_.size(); ++b) {
        const double along = blobs_[b].bearing.dot(p), limit = gate * along;
        if (along > 0.0 && !blobs_[b].merged &&
            (blobs_[b].to_pixels * p).squaredNorm() <= limit * limit &&
            std::find(sure.begin(), sure.end(), static_cast<int>(b)) == sure.end())
          return true;
      }
    }
    return false;
  }
  bool match(const Pose& T, std::span<const int> sure, double gate, TargetFit& fit) {
    fit.blob_of_marker.assign(sure.begin(), sure.end());
    fit.matches = 0;
    taken_.assign(blobs_.size(), false);
    for (const int b : sure)
      if (b != TargetFit::kUnseen) {
        taken_[static_cast<std::size_t>(b)] = true;
        ++fit.matches;
      }
    pairs_.clear();
    for (std::size_t m = 0; m < sure.size(); ++m) {
      if (sure[m] != TargetFit::kUnseen) continue;
      const Eigen::Vector3d p = T.linear() * target_.markers[m] + T.translation();
      for (std::size_t b = 0; b < blobs_.size(); ++b) {
        if (taken_[b] || blobs_[b].merged) continue;
        const double along = blobs_[b].bearing.dot(p);
        if (!(along > 0.0)) continue;
        const double error = (blobs_[b].to_pixels * p).squaredNorm() / (along * along);
        if (error <= gate * gate && size_fits(blobs_[b], p)) pairs_.push_back({error, m, b});
      }
    }
    take_nearest(pairs_, taken_, fit);
    return fit.matches >= options_.min_matches;
  }
  bool size_fits(const Observation& blob, const Eigen::Vector3d& p) const {
    if (blob.diameter <= 0.0 || target_.marker_radius <= 0.0) return true;
    const double expected = expected_diameter(blob, target_.marker_radius, p);
    // A pixel of edge either way: the images of far markers are small.
    return blob.diameter + 1.0 >= expected / options_.size_ratio &&
           blob.diameter <= expected * options_.size_ratio + 2.0;
  }
  bool settle(TargetFit& fit, const Pose& start) {
    seen_.clear();
    points_.clear();
    for (std::size_t m = 0; m < fit.blob_of_marker.size(); ++m)
      if (const int b = fit.blob_of_marker[m]; b != TargetFit::kUnseen) {
        seen_.push_back(blobs_[static_cast<std::size_t>(b)]);
        points_.push_back(target_.markers[m]);
      }
    const RefinedPose refined = refine_pose(seen_, points_, start, options_.refine);
    if (!refined.valid()) return false;
    return take_refined(refined, options_, true, fit);
  }
  /// Whether a fit with these matches and about this pose is there already.
  bool known(const TargetFit& fit, const Pose& T) const {
    for (const TargetFit& other : fits_)
      if (other.blob_of_marker == fit.blob_of_marker &&
          (other.T_camera_target.linear() - T.linear()).squaredNorm() < 0.01)
        return true;
    return false;
  }

  std::span<const Observation> blobs_;
  const MarkerTarget& target_;
  const IdentifyOptions& options_;
  std::vector<TargetFit> fits_;
  std::vector<bool> taken_;
  std::vector<MarkerPair> pairs_;
  std::vector<Observation> seen_;
  std::vector<Point3> points_;
};
}  // namespace detail

/// Every likely pose of the target in an image with these blobs, among which there may be strangers
/// and from which markers may be missing.
///
/// P3P of every triple of blobs with every ordered triple of markers; the other markers verify; one
/// blob is one marker. O(b³ m³) for b blobs, at most `max_blobs` of them, and m markers. Blobs are
/// expected best first. Throws `Error` on settings out of range and on fewer than four markers.
template <P3pSolver Solver = LambdaTwistP3p>
Identification identify(std::span<const Observation> blobs, const MarkerTarget& target,
                        const IdentifyOptions& options = {}, const Solver& solver = {}) {
  require(options.pixel_noise > 0.0 && options.gate > 0.0,
          "identification: expected a positive pixel noise and gate");
  require(options.min_matches >= 4 && target.markers.size() >= 4,
          "identification: expected at least four markers and matches");
  Identification result;
  if (blobs.size() > options.max_blobs) {
    result.truncated = true;
    blobs = blobs.first(options.max_blobs);
  }
  const std::size_t n = blobs.size(), m = target.markers.size();
  detail::FitSearch search(blobs, target, options);
  std::vector<int> sure(m, TargetFit::kUnseen);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k) {
        if (blobs[i].merged || blobs[j].merged || blobs[k].merged) continue;
        const Bearings3 f{blobs[i].bearing, blobs[j].bearing, blobs[k].bearing};
        for (std::size_t a = 0; a < m; ++a)
          for (std::size_t b = 0; b < m; ++b)
            for (std::size_t c = 0; c < m; ++c) {
              if (a == b || a == c || b == c) continue;
              const Points3 p{target.markers[a], target.markers[b], target.markers[c]};
              const P3pSolutions solutions = solver(f, p);
              if (solutions.empty()) continue;
              sure[a] = static_cast<int>(i);
              sure[b] = static_cast<int>(j);
              sure[c] = static_cast<int>(k);
              for (const Pose& T : solutions) search.consider(T, sure, options.gate);
              sure[a] = sure[b] = sure[c] = TargetFit::kUnseen;
            }
      }
  result.fits = search.take();
  return result;
}
}  // namespace surfleet
