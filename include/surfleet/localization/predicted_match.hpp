// SPDX-License-Identifier: MIT
/// @file
/// @brief Which blobs a target's markers are where its pose is about known [004 §9.4].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/localization/identify.hpp>
#include <surfleet/localization/sphere_outline.hpp>

namespace surfleet {
struct PredictedMatchOptions {
  IdentifyOptions identify;
  double gate = 12.0;         ///< Of markers predicted from the poses before [px].
  double merged_noise = 1.5;  ///< Error of the centre of two markers in one blob [px].
};

/// Fits of one target to blobs near a prediction: markers take their nearest blobs, several one if
/// their images overlap. A view: what it is made of must outlive it.
template <CameraModel Camera>
struct PredictedMatch {
  const Camera& camera;
  const MarkerTarget& target;
  const PredictedMatchOptions& options;

  /// The fit of at least four markers that have blobs where they are predicted.
  std::optional<TargetFit> near(const Pose& predicted, std::span<const Observation> blobs) const {
    TargetFit fit;
    fit.T_camera_target = predicted;
    // The first time with room for the motion; then, from the pose that gives, with little.
    double gate = options.gate;
    for (int round = 0; round < 3; ++round) {
      assign(fit.T_camera_target, blobs, gate, fit);
      if (fit.matches < 4 || shares(fit.blob_of_marker)) return std::nullopt;
      if (!refine(fit, blobs, true)) {
        if (round > 0 || fit.matches <= 4) return std::nullopt;
        return best_without_one(fit, [&](TargetFit& f) { return refine(f, blobs, true); });
      }
      gate = std::max(6.0 * options.identify.pixel_noise, 2.0);
    }
    return fit;
  }
  /// What can be had of three markers near where they are predicted. If one of their poses shows
  /// another marker on a blob, it is that; else the prediction counts as a measurement, too, for
  /// there are directions that three markers tell little of. `covariance` is the prediction's.
  std::optional<TargetFit> three_markers(const Pose& predicted, const Matrix6& covariance,
                                         std::span<const Observation> blobs) const {
    TargetFit fit;
    fit.T_camera_target = predicted;
    assign(predicted, blobs, options.gate, fit);
    const bool shared = shares(fit.blob_of_marker);
    if (fit.matches > 3 && shared) {
      if (!with_prior(predicted, covariance, blobs, fit)) return std::nullopt;
      return fit;
    }
    if (fit.matches > 4) return std::nullopt;
    if (fit.matches == 4)  // of which one is a stranger: the three that fit best
      return best_without_one(
          fit, [&](TargetFit& three) { return with_prior(predicted, covariance, blobs, three); });
    if (fit.matches < 3) return std::nullopt;
    Bearings3 f;
    Points3 p;
    std::size_t k = 0;
    for (std::size_t m = 0; m < fit.blob_of_marker.size(); ++m)
      if (const int b = fit.blob_of_marker[m]; b != TargetFit::kUnseen) {
        f[k] = blobs[static_cast<std::size_t>(b)].bearing;
        p[k++] = target.markers[m];
      }
    if (blobs.size() > 3 && !shared) {
      detail::FitSearch search(blobs, target, options.identify);
      for (const Pose& T : LambdaTwistP3p{}(f, p))
        search.consider(T, fit.blob_of_marker, options.identify.gate);
      const auto four = search.take();
      if (!four.empty() && pixels_apart(predicted, four[0].T_camera_target) < 5.0 * options.gate) {
        TargetFit best = four[0];
        refine(best, blobs, false);
        return best;
      }
    }
    if (!with_prior(predicted, covariance, blobs, fit)) return std::nullopt;
    return fit;
  }
  /// Refines a fit on its blobs; false if that fails, or, with `judge`, if the result is unlikely.
  bool refine(TargetFit& fit, std::span<const Observation> blobs, bool judge,
              const PosePrior* prior = nullptr) const {
    std::vector<Observation> seen;
    std::vector<Point3> points;
    for (std::size_t m = 0; m < fit.blob_of_marker.size(); ++m)
      if (const int b = fit.blob_of_marker[m]; b != TargetFit::kUnseen) {
        seen.push_back(blobs[static_cast<std::size_t>(b)]);
        points.push_back(target.markers[m]);
        const double rough = std::max(
            {options.merged_noise, options.identify.pixel_noise, 0.3 * seen.back().diameter});
        if (sharing(fit.blob_of_marker, b) < 2) {
          // With a stranger, or cut: its centre is roughly there.
          if (seen.back().merged || seen.back().elongated) {
            seen.back().merged = true;
            seen.back().to_pixels *= options.identify.pixel_noise / rough;
          }
          continue;
        }
        // Two in one: its centre is the middle of theirs, which are as far apart as predicted.
        Eigen::Vector2d middle = Eigen::Vector2d::Zero();
        for (std::size_t k = 0; k < fit.blob_of_marker.size(); ++k)
          if (fit.blob_of_marker[k] == b)
            middle += 0.5 * pixels_off(seen.back(), fit.T_camera_target * target.markers[k]);
        const Eigen::Vector2d own =
            pixels_off(seen.back(), fit.T_camera_target * target.markers[m]);
        seen.back() = observe(camera, seen.back().pixel + own - middle, 0.0);
        seen.back().merged = true;
        seen.back().to_pixels *= options.identify.pixel_noise /
                                 std::max(options.merged_noise, options.identify.pixel_noise);
      }
    RefinedPose refined =
        refine_pose(seen, points, fit.T_camera_target, options.identify.refine, prior);
    if (!refined.valid()) return false;
    if (target.marker_radius > 0.0) {
      const auto corrected = without_sphere_offsets(camera, seen, points, refined.T_camera_target,
                                                    target.marker_radius);
      refined =
          refine_pose(corrected, points, refined.T_camera_target, options.identify.refine, prior);
      if (!refined.valid()) return false;
    }
    return detail::take_refined(refined, options.identify, judge, fit) &&
           fit.covariance.allFinite();
  }
  /// The largest distance of a marker's image between two poses [px].
  double pixels_apart(const Pose& a, const Pose& b) const {
    double most = 0.0;
    for (const Point3& m : target.markers) {
      const auto pa = camera.project(a * m), pb = camera.project(b * m);
      if (pa && pb) most = std::max(most, (*pa - *pb).norm());
    }
    // Flipped in place is far, whatever the markers' images are.
    const double turned = Eigen::AngleAxisd(a.linear() * b.linear().transpose()).angle();
    return std::max(most, turned > radians(40.0) ? 1e3 : 0.0);
  }
  /// Whether a blob is that of several markers.
  static bool shares(const std::vector<int>& blob_of_marker) {
    return std::any_of(blob_of_marker.begin(), blob_of_marker.end(), [&](int b) {
      return b != TargetFit::kUnseen && sharing(blob_of_marker, b) > 1;
    });
  }

 private:
  /// Refines a fit of three markers; false if that is far from what was predicted.
  bool with_prior(const Pose& predicted, const Matrix6& covariance,
                  std::span<const Observation> blobs, TargetFit& fit) const {
    const double sigma = options.identify.pixel_noise;
    const PosePrior prior{predicted, sigma * sigma * inverse_of(covariance)};
    fit.T_camera_target = predicted;
    if (!refine(fit, blobs, false, &prior)) return false;
    // Six degrees of freedom: the six of the prior and as many of the markers less the pose's.
    return fit.chi_square <= detail::chi_square_quantile(6.0, options.identify.max_deviations);
  }
  /// Without each of the markers in turn, one of which may have taken a stranger: the likeliest of
  /// what `refit` makes of them.
  template <typename Refit>
  static std::optional<TargetFit> best_without_one(const TargetFit& all, const Refit& refit) {
    std::optional<TargetFit> best;
    for (std::size_t m = 0; m < all.blob_of_marker.size(); ++m) {
      if (all.blob_of_marker[m] == TargetFit::kUnseen) continue;
      TargetFit fit = all;
      fit.blob_of_marker[m] = TargetFit::kUnseen;
      --fit.matches;
      if (refit(fit) && (!best || fit.chi_square < best->chi_square)) best = std::move(fit);
    }
    return best;
  }
  void assign(const Pose& T, std::span<const Observation> blobs, double gate,
              TargetFit& fit) const {
    std::vector<detail::MarkerPair> pairs;
    for (std::size_t m = 0; m < target.markers.size(); ++m) {
      const Eigen::Vector3d p = T * target.markers[m];
      for (std::size_t b = 0; b < blobs.size(); ++b) {
        const double along = blobs[b].bearing.dot(p);
        if (!(along > 0.0)) continue;
        const double error = (blobs[b].to_pixels * p).squaredNorm() / (along * along);
        if (error <= gate * gate) pairs.push_back({error, m, b});
      }
    }
    fit.blob_of_marker.assign(target.markers.size(), TargetFit::kUnseen);
    fit.matches = 0;
    std::vector<bool> taken(blobs.size(), false);
    detail::take_nearest(pairs, taken, fit);
    // A marker without a blob whose image overlaps that of one with: both are in that blob.
    const std::vector<int> alone = fit.blob_of_marker;
    for (std::size_t m = 0; m < alone.size(); ++m) {
      if (alone[m] != TargetFit::kUnseen) continue;
      for (std::size_t other = 0; other < alone.size(); ++other) {
        const int b = alone[other];
        if (b == TargetFit::kUnseen || sharing(fit.blob_of_marker, b) > 1) continue;
        const Observation& o = blobs[static_cast<std::size_t>(b)];
        const Eigen::Vector2d apart =
            pixels_off(o, T * target.markers[m]) - pixels_off(o, T * target.markers[other]);
        // It holds two if it is larger than one, or if they nearly coincide.
        const double expected =
            target.marker_radius > 0.0
                ? detail::expected_diameter(o, target.marker_radius, T * target.markers[m])
                : o.diameter;
        const bool large = o.merged || o.elongated || o.diameter > 1.1 * expected + 0.5;
        const double reach = large ? o.diameter + 2.0 : 0.35 * o.diameter;
        if (!(o.diameter > 0.0 && apart.norm() < reach)) continue;
        fit.blob_of_marker[m] = b;
        ++fit.matches;
        break;
      }
    }
  }
  static std::ptrdiff_t sharing(const std::vector<int>& blob_of_marker, int blob) {
    return std::count(blob_of_marker.begin(), blob_of_marker.end(), blob);
  }
  /// From a blob to where a point of the camera frame is seen [px].
  static Eigen::Vector2d pixels_off(const Observation& o, const Eigen::Vector3d& p) {
    return o.to_pixels * p / o.bearing.dot(p);
  }
};
}  // namespace surfleet
