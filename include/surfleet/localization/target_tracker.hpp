// SPDX-License-Identifier: MIT
/// @file
/// @brief A target followed from frame to frame, with a state that says what is known [004 §9.4].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/localization/identify.hpp>
#include <surfleet/localization/image_thresholds.hpp>
#include <surfleet/localization/pose_prediction.hpp>
#include <surfleet/localization/sphere_outline.hpp>

namespace surfleet {
enum class TrackState {
  start_up,   ///< Nothing has been found yet.
  ambiguous,  ///< Several poses explain what was seen; all are returned.
  tracked,    ///< One does.
  coasting,   ///< Too little is seen; the pose is predicted.
  lost        ///< It was tracked and is not found again so far.
};
inline const char* to_string(TrackState s) {
  constexpr const char* kNames[] = {"start_up", "ambiguous", "tracked", "coasting", "lost"};
  return kNames[static_cast<std::size_t>(s)];
}

struct TrackerOptions {
  IdentifyOptions identify;
  double gate = 12.0;              ///< Of markers predicted from the poses before [px].
  double max_coast = 0.5;          ///< Without enough markers, the pose is predicted so long [s].
  std::size_t max_hypotheses = 8;  ///< Poses followed while it is ambiguous which is right.
  double speed_change = 0.1;       ///< From frame to frame, for three markers and coasting [m/s].
  double turn_change = 0.3;        ///< The same of rotation [rad/s].
  double merged_noise = 1.5;       ///< Error of the centre of two markers in one blob [px].
  double roi_margin = 40.0;        ///< About the predicted markers [px].
};

/// What is known after a frame.
struct TrackedFrame {
  TrackState state = TrackState::start_up;
  std::vector<TargetFit> fits;  ///< One if tracked or coasting, all if ambiguous, else none.
  bool three_markers = false;   ///< Fewer than four were seen apart: right if the prediction was.
};

/// Follows one target in the blobs of successive frames.
///
/// While tracked, predicted markers take their nearest blobs; the whole search is made again if
/// that does not fit. Three markers are enough with a prediction; with fewer it coasts. What is
/// ambiguous at first is followed on all ways until one is left.
template <CameraModel Camera, MotionModel Motion = LinearRegression>
class TargetTracker {
 public:
  TargetTracker(Camera camera, MarkerTarget target, TrackerOptions settings = {}, Motion model = {})
      : options(std::move(settings)),
        motion(std::move(model)),
        camera_(std::move(camera)),
        target_(std::move(target)) {
    check_target(target_);
  }

  TrackerOptions options;
  Motion motion;

  TrackState state() const { return state_; }
  /// Where the target should be at `time`; nothing unless tracked or coasting.
  std::optional<Pose> predict(double time) const {
    if (history_.empty()) return std::nullopt;
    return motion(history_, time);
  }
  /// The window about the predicted markers; nothing, which is the whole image, without a
  /// prediction.
  std::optional<PixelWindow> roi(double time) const {
    const auto T = predict(time);
    if (!T) return std::nullopt;
    Eigen::AlignedBox2d box;
    for (const Point3& m : target_.markers)
      if (const auto px = camera_.project(*T * m)) box.extend(*px);
    if (box.isEmpty()) return std::nullopt;
    double margin = options.roi_margin;
    if (target_.marker_radius > 0.0)
      margin += 300.0 * target_.marker_radius / std::max(0.1, T->translation().norm());
    margin += 100.0 * (time - last_seen_);  // what is not seen may have gone anywhere
    return PixelWindow{
        static_cast<int>(box.min().x() - margin), static_cast<int>(box.min().y() - margin),
        static_cast<int>(box.max().x() + margin) + 1, static_cast<int>(box.max().y() + margin) + 1}
        .clipped({0, 0, camera_.width, camera_.height});
  }

  /// Takes the blobs seen at `time`, which must increase (throws `Error`). O(markers · blobs) while
  /// tracked, else as `identify`. With `keep_if_lost`, nothing changes and nothing is returned if
  /// the target is not found where it was predicted: ask again with the blobs of the whole image.
  std::optional<TrackedFrame> update(double time, std::span<const Observation> blobs,
                                     bool keep_if_lost = false) {
    require(!started_ || time > time_, "tracker: expected times that increase");
    if (const auto predicted = predict(time)) {
      if (auto fit = near_prediction(*predicted, blobs)) return accept(time, std::move(*fit));
      if (auto fit = three_markers(time, *predicted, blobs)) return accept(time, std::move(*fit));
      if (keep_if_lost) return std::nullopt;
      // All of it anew; of several the one that is closest to the prediction.
      Identification found = identify(blobs, target_, options.identify);
      if (!found.fits.empty()) {
        const auto far = [&](const TargetFit& f) {
          return pixels_apart(*predicted, f.T_camera_target);
        };
        const auto best = std::min_element(
            found.fits.begin(), found.fits.end(),
            [&](const TargetFit& x, const TargetFit& y) { return far(x) < far(y); });
        const double room = options.gate * (1.0 + 20.0 * (time - last_seen_));
        if (far(*best) <= room) {
          refine(*best, blobs, false);
          return accept(time, *best);
        }
      }
      // Far from what was predicted it is taken only if it goes on in the next frame.
      if (!hypotheses_.empty()) {
        follow(time, blobs);
        if (hypotheses_.size() == 1) {
          const Hypothesis h = hypotheses_.front();
          history_ = h.history;
          history_.pop_back();
          return accept(time, h.fit);
        }
      }
      if (hypotheses_.empty()) propose(time, blobs, found.fits);
      if (time - last_seen_ <= options.max_coast) {
        stamp(time, TrackState::coasting);
        TargetFit fit;
        fit.T_camera_target = *predicted;
        fit.covariance = covariance_;
        const double wait = time - last_seen_;
        fit.covariance += drift(wait) * (wait / std::max(last_step_, 1e-3));
        fit.blob_of_marker.assign(target_.markers.size(), TargetFit::kUnseen);
        return TrackedFrame{state_, {std::move(fit)}, false};
      }
      history_.clear();
      stamp(time, TrackState::lost);
      if (!hypotheses_.empty()) return settle(time);
      return TrackedFrame{state_, {}, false};
    }
    if (!hypotheses_.empty()) {
      follow(time, blobs);
      if (!hypotheses_.empty()) return settle(time);
    }
    stamp(time, was_tracked_ ? TrackState::lost : TrackState::start_up);
    Identification found = identify(blobs, target_, options.identify);
    if (found.fits.empty()) return TrackedFrame{state_, {}, false};
    propose(time, blobs, std::move(found.fits));
    return settle(time);
  }

 private:
  struct Hypothesis {
    TargetFit fit;
    std::vector<TimedPose> history;
    double score = 0.0;  ///< Summed over frames.
  };

  void stamp(double time, TrackState state) {
    time_ = time;
    started_ = true;
    state_ = state;
  }
  /// The fit of at least four markers that have blobs where they are predicted.
  std::optional<TargetFit> near_prediction(const Pose& predicted,
                                           std::span<const Observation> blobs) const {
    TargetFit fit;
    fit.T_camera_target = predicted;
    // The first time with room for the motion; then, from the pose that gives, with little.
    double gate = options.gate;
    for (int round = 0; round < 3; ++round) {
      assign(fit.T_camera_target, blobs, gate, fit);
      if (fit.matches < 4 || shares(fit.blob_of_marker)) return std::nullopt;
      if (!refine(fit, blobs, true)) {
        if (round > 0) return std::nullopt;
        return drop_worst(fit, blobs);
      }
      gate = std::max(6.0 * options.identify.pixel_noise, 2.0);
    }
    return fit;
  }
  /// What can be had of three markers near where they are predicted. If one of their poses shows
  /// another marker on a blob, it is that; else the prediction counts as a measurement, too, for
  /// there are directions that three markers tell little of.
  std::optional<TargetFit> three_markers(double time, const Pose& predicted,
                                         std::span<const Observation> blobs) const {
    TargetFit fit;
    fit.T_camera_target = predicted;
    assign(predicted, blobs, options.gate, fit);
    const bool shared = shares(fit.blob_of_marker);
    if (fit.matches > 3 && shared) {
      if (!with_prior(time, predicted, blobs, fit)) return std::nullopt;
      return fit;
    }
    if (fit.matches > 3) {  // of which one is a stranger: the three that fit best
      std::optional<TargetFit> best;
      for (std::size_t m = 0; m < fit.blob_of_marker.size() && fit.matches == 4; ++m) {
        if (fit.blob_of_marker[m] == TargetFit::kUnseen) continue;
        TargetFit three = fit;
        three.blob_of_marker[m] = TargetFit::kUnseen;
        three.matches = 3;
        if (with_prior(time, predicted, blobs, three) &&
            (!best || three.chi_square < best->chi_square))
          best = std::move(three);
      }
      return best;
    }
    if (fit.matches < 3) return std::nullopt;
    Bearings3 f;
    Points3 p;
    std::size_t k = 0;
    for (std::size_t m = 0; m < fit.blob_of_marker.size(); ++m)
      if (const int b = fit.blob_of_marker[m]; b != TargetFit::kUnseen) {
        f[k] = blobs[static_cast<std::size_t>(b)].bearing;
        p[k++] = target_.markers[m];
      }
    if (blobs.size() > 3 && !shared) {
      detail::FitSearch search(blobs, target_, options.identify);
      for (const Pose& T : LambdaTwistP3p{}(f, p))
        search.consider(T, fit.blob_of_marker, options.identify.gate);
      const auto four = search.take();
      if (!four.empty() && pixels_apart(predicted, four[0].T_camera_target) < 5.0 * options.gate) {
        TargetFit best = four[0];
        refine(best, blobs, false);
        return best;
      }
    }
    if (!with_prior(time, predicted, blobs, fit)) return std::nullopt;
    return fit;
  }
  /// Refines a fit of three markers; false if that is far from what was predicted.
  bool with_prior(double time, const Pose& predicted, std::span<const Observation> blobs,
                  TargetFit& fit) const {
    const double sigma = options.identify.pixel_noise;
    // A prediction from two poses is less sure than each.
    const Matrix6 covariance = 2.0 * covariance_ + drift(time - last_seen_);
    const PosePrior prior{predicted, sigma * sigma * covariance.ldlt().solve(Matrix6::Identity())};
    fit.T_camera_target = predicted;
    if (!refine(fit, blobs, false, &prior)) return false;
    // Six degrees of freedom: the six of the prior and as many of the markers less the pose's.
    return fit.chi_square <= detail::chi_square_quantile(6.0, options.identify.max_deviations);
  }
  /// How much less sure a pose is after `step` seconds.
  Matrix6 drift(double step) const {
    Matrix6 q = Matrix6::Zero();
    q.diagonal().head<3>().setConstant(options.turn_change * options.turn_change * step * step);
    q.diagonal().tail<3>().setConstant(options.speed_change * options.speed_change * step * step);
    return q;
  }
  /// Without each of the markers in turn, one of which may have taken a stranger.
  std::optional<TargetFit> drop_worst(const TargetFit& all,
                                      std::span<const Observation> blobs) const {
    if (all.matches <= 4) return std::nullopt;
    std::optional<TargetFit> best;
    for (std::size_t m = 0; m < all.blob_of_marker.size(); ++m) {
      if (all.blob_of_marker[m] == TargetFit::kUnseen) continue;
      TargetFit fit = all;
      fit.blob_of_marker[m] = TargetFit::kUnseen;
      --fit.matches;
      if (refine(fit, blobs, true) && (!best || fit.chi_square < best->chi_square)) best = fit;
    }
    return best;
  }
  void assign(const Pose& T, std::span<const Observation> blobs, double gate,
              TargetFit& fit) const {
    struct Pair {
      double error;
      std::size_t marker;
      int blob;
    };
    std::vector<Pair> pairs;
    for (std::size_t m = 0; m < target_.markers.size(); ++m) {
      const Eigen::Vector3d p = T * target_.markers[m];
      for (std::size_t b = 0; b < blobs.size(); ++b) {
        const double along = blobs[b].bearing.dot(p);
        if (!(along > 0.0)) continue;
        const double error = (blobs[b].to_pixels * p).squaredNorm() / (along * along);
        if (error <= gate * gate) pairs.push_back({error, m, static_cast<int>(b)});
      }
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return a.error != b.error ? a.error < b.error
                                : std::pair(a.marker, a.blob) < std::pair(b.marker, b.blob);
    });
    fit.blob_of_marker.assign(target_.markers.size(), TargetFit::kUnseen);
    fit.matches = 0;
    std::vector<bool> taken(blobs.size(), false);
    for (const Pair& p : pairs) {
      if (fit.blob_of_marker[p.marker] != TargetFit::kUnseen ||
          taken[static_cast<std::size_t>(p.blob)])
        continue;
      fit.blob_of_marker[p.marker] = p.blob;
      taken[static_cast<std::size_t>(p.blob)] = true;
      ++fit.matches;
    }
    // A marker without a blob whose image overlaps that of one with: both are in that blob.
    const std::vector<int> alone = fit.blob_of_marker;
    for (std::size_t m = 0; m < alone.size(); ++m) {
      if (alone[m] != TargetFit::kUnseen) continue;
      for (std::size_t other = 0; other < alone.size(); ++other) {
        const int b = alone[other];
        if (b == TargetFit::kUnseen || sharing(fit.blob_of_marker, b) > 1) continue;
        const Observation& o = blobs[static_cast<std::size_t>(b)];
        const Eigen::Vector2d apart =
            pixels_off(o, T * target_.markers[m]) - pixels_off(o, T * target_.markers[other]);
        // It holds two if it is larger than one, or if they nearly coincide.
        const double expected =
            target_.marker_radius > 0.0
                ? detail::expected_diameter(o, target_.marker_radius, T * target_.markers[m])
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
  static bool shares(const std::vector<int>& blob_of_marker) {
    return std::any_of(blob_of_marker.begin(), blob_of_marker.end(), [&](int b) {
      return b != TargetFit::kUnseen && sharing(blob_of_marker, b) > 1;
    });
  }
  /// From a blob to where a point of the camera frame is seen [px].
  static Eigen::Vector2d pixels_off(const Observation& o, const Eigen::Vector3d& p) {
    return o.to_pixels * p / o.bearing.dot(p);
  }
  bool refine(TargetFit& fit, std::span<const Observation> blobs, bool judge,
              const PosePrior* prior = nullptr) const {
    std::vector<Observation> seen;
    std::vector<Point3> points;
    for (std::size_t m = 0; m < fit.blob_of_marker.size(); ++m)
      if (const int b = fit.blob_of_marker[m]; b != TargetFit::kUnseen) {
        seen.push_back(blobs[static_cast<std::size_t>(b)]);
        points.push_back(target_.markers[m]);
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
            middle += 0.5 * pixels_off(seen.back(), fit.T_camera_target * target_.markers[k]);
        const Eigen::Vector2d own =
            pixels_off(seen.back(), fit.T_camera_target * target_.markers[m]);
        seen.back() = observe(camera_, seen.back().pixel + own - middle, 0.0);
        seen.back().merged = true;
        seen.back().to_pixels *= options.identify.pixel_noise /
                                 std::max(options.merged_noise, options.identify.pixel_noise);
      }
    RefinedPose refined =
        refine_pose(seen, points, fit.T_camera_target, options.identify.refine, prior);
    if (!refined.valid()) return false;
    if (target_.marker_radius > 0.0) {
      const auto corrected = without_sphere_offsets(camera_, seen, points, refined.T_camera_target,
                                                    target_.marker_radius);
      refined =
          refine_pose(corrected, points, refined.T_camera_target, options.identify.refine, prior);
      if (!refined.valid()) return false;
    }
    const double sigma = options.identify.pixel_noise;
    fit.chi_square = refined.cost / (sigma * sigma);
    const double dof = 2.0 * static_cast<double>(fit.matches) - 6.0;
    if (judge && dof > 0.0 &&
        fit.chi_square > detail::chi_square_quantile(dof, options.identify.max_deviations))
      return false;
    fit.T_camera_target = refined.T_camera_target;
    fit.covariance = refined.covariance(sigma);
    fit.score = fit.chi_square + std::log(std::max(refined.information.determinant(), 1e-300));
    return fit.covariance.allFinite();
  }
  /// The largest distance of a marker's image between two poses [px].
  double pixels_apart(const Pose& a, const Pose& b) const {
    double most = 0.0;
    for (const Point3& m : target_.markers) {
      const auto pa = camera_.project(a * m), pb = camera_.project(b * m);
      if (pa && pb) most = std::max(most, (*pa - *pb).norm());
    }
    // Flipped in place is far, whatever the markers' images are.
    const double turned = Eigen::AngleAxisd(a.linear() * b.linear().transpose()).angle();
    return std::max(most, turned > radians(40.0) ? 1e3 : 0.0);
  }
  TrackedFrame accept(double time, TargetFit fit) {
    const bool three = fit.matches < 4 || shares(fit.blob_of_marker);
    stamp(time, TrackState::tracked);
    if (was_tracked_ && time > last_seen_) last_step_ = time - last_seen_;
    history_.push_back({time, fit.T_camera_target});
    if (history_.size() > motion.samples()) history_.erase(history_.begin());
    last_seen_ = time;
    was_tracked_ = true;
    covariance_ = fit.covariance;
    hypotheses_.clear();
    return {state_, {std::move(fit)}, three};
  }
  /// Starts a hypothesis for each of the fits.
  void propose(double time, std::span<const Observation> blobs, std::vector<TargetFit> fits) {
    if (fits.size() > options.max_hypotheses) fits.resize(options.max_hypotheses);
    hypotheses_.clear();
    for (TargetFit& f : fits) {
      refine(f, blobs, false);  // for the spheres
      const double score = f.score;
      std::vector<TimedPose> history{{time, f.T_camera_target}};
      hypotheses_.push_back({std::move(f), std::move(history), score});
    }
  }
  /// Every hypothesis on its own way; those that no longer fit are dropped.
  void follow(double time, std::span<const Observation> blobs) {
    std::vector<Hypothesis> next;
    for (Hypothesis& h : hypotheses_) {
      const Pose predicted = motion(h.history, time);
      auto fit = near_prediction(predicted, blobs);
      if (!fit) continue;
      h.history.push_back({time, fit->T_camera_target});
      if (h.history.size() > motion.samples()) h.history.erase(h.history.begin());
      h.score += fit->chi_square;
      h.fit = std::move(*fit);
      next.push_back(std::move(h));
    }
    std::stable_sort(next.begin(), next.end(),
                     [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; });
    while (!next.empty() &&
           next.back().score > next.front().score + options.identify.likelihood_bound)
      next.pop_back();
    hypotheses_ = std::move(next);
  }
  TrackedFrame settle(double time) {
    if (hypotheses_.size() == 1) {
      const Hypothesis h = hypotheses_.front();
      TrackedFrame frame = accept(time, h.fit);
      history_ = h.history;
      return frame;
    }
    stamp(time, TrackState::ambiguous);
    TrackedFrame frame{state_, {}, false};
    for (const Hypothesis& h : hypotheses_) frame.fits.push_back(h.fit);
    return frame;
  }

  Camera camera_;
  MarkerTarget target_;
  TrackState state_ = TrackState::start_up;
  std::vector<TimedPose> history_;
  std::vector<Hypothesis> hypotheses_;
  Matrix6 covariance_ = Matrix6::Zero();
  double time_ = 0.0, last_seen_ = 0.0, last_step_ = 0.1;
  bool started_ = false, was_tracked_ = false;
};
}  // namespace surfleet
