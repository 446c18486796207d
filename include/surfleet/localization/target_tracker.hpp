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
#include <surfleet/localization/predicted_match.hpp>

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

struct TrackerOptions : PredictedMatchOptions {
  double max_coast = 0.5;          ///< Without enough markers, the pose is predicted so long [s].
  std::size_t max_hypotheses = 8;  ///< Poses followed while it is ambiguous which is right.
  double speed_change = 0.1;       ///< From frame to frame, for three markers and coasting [m/s].
  double turn_change = 0.3;        ///< The same of rotation [rad/s].
  double roi_margin = 40.0;        ///< About the predicted markers [px].
  double recheck = 0.25;           ///< While tracked, all is searched anew so often [s].
  int recheck_frames = 4;          ///< In which what that finds must be better.
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
/// that does not fit, and from time to time, lest what fits by chance is followed for ever. Three
/// markers are enough with a prediction; with fewer it coasts. What is ambiguous at first is
/// followed by all hypotheses until one is left.
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
      auto fit = match().near(*predicted, blobs);
      if (!fit) {
        // A prediction from two poses is less sure than each.
        const Matrix6 covariance = 2.0 * covariance_ + drift(time - last_seen_);
        fit = match().three_markers(*predicted, covariance, blobs);
      }
      if (fit && overtaken(time, *fit, blobs)) {
        history_ = std::move(rival_->history);
        history_.pop_back();
        fit = std::move(rival_->fit);
        rival_.reset();
      }
      if (fit) return accept(time, std::move(*fit));
      rival_.reset();
      if (keep_if_lost) return std::nullopt;
      // All of it anew; of several the one that is closest to the prediction.
      Identification found = identify(blobs, target_, options.identify);
      if (!found.fits.empty()) {
        const auto far = [&](const TargetFit& f) {
          return match().pixels_apart(*predicted, f.T_camera_target);
        };
        const auto best = std::min_element(
            found.fits.begin(), found.fits.end(),
            [&](const TargetFit& x, const TargetFit& y) { return far(x) < far(y); });
        const double room = options.gate * (1.0 + 20.0 * (time - last_seen_));
        if (far(*best) <= room) {
          match().refine(*best, blobs, false);
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
        TargetFit guess;
        guess.T_camera_target = *predicted;
        guess.covariance = covariance_;
        const double wait = time - last_seen_;
        guess.covariance += drift(wait) * (wait / std::max(last_step_, 1e-3));
        guess.blob_of_marker.assign(target_.markers.size(), TargetFit::kUnseen);
        return TrackedFrame{state_, {std::move(guess)}, false};
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
    int ahead = 0;       ///< Frames in which it was better than what is tracked, less the others.
  };
  /// Takes a hypothesis to the next frame; false if the blobs do not bear it out.
  bool goes_on(Hypothesis& h, double time, std::span<const Observation> blobs) const {
    auto fit = match().near(motion(h.history, time), blobs);
    if (!fit) return false;
    h.history.push_back({time, fit->T_camera_target});
    if (h.history.size() > motion.samples()) h.history.erase(h.history.begin());
    h.score += fit->chi_square;
    h.fit = std::move(*fit);
    return true;
  }

  void stamp(double time, TrackState state) {
    time_ = time;
    started_ = true;
    state_ = state;
  }
  /// How much less sure a pose is after `step` seconds.
  Matrix6 drift(double step) const {
    Matrix6 q = Matrix6::Zero();
    q.diagonal().head<3>().setConstant(options.turn_change * options.turn_change * step * step);
    q.diagonal().tail<3>().setConstant(options.speed_change * options.speed_change * step * step);
    return q;
  }
  /// Whether the blobs show one other pose, with more markers or likelier than `fit`, now and in
  /// the frames that follow; then it takes the place of what was tracked.
  bool overtaken(double time, const TargetFit& fit, std::span<const Observation> blobs) {
    if (rival_ && !goes_on(*rival_, time, blobs)) rival_.reset();
    if (!rival_) {
      if (time - checked_ < options.recheck) return false;
      checked_ = time;
      Identification found = identify(blobs, target_, options.identify);
      if (found.fits.size() != 1) return false;
      TargetFit& other = found.fits.front();
      if (match().pixels_apart(fit.T_camera_target, other.T_camera_target) <= options.gate)
        return false;
      match().refine(other, blobs, false);
      rival_ = Hypothesis{std::move(other), {}, 0.0, 0};
      rival_->history.push_back({time, rival_->fit.T_camera_target});
    }
    // Ahead in most of the frames, for a stranger among the blobs may be so in one.
    rival_->ahead += rival_->fit.matches > fit.matches ||
                             (rival_->fit.matches == fit.matches && rival_->fit.score < fit.score)
                         ? 1
                         : -1;
    if (rival_->ahead < 0) rival_.reset();
    return rival_ && rival_->ahead >= options.recheck_frames;
  }
  PredictedMatch<Camera> match() const { return {camera_, target_, options}; }
  TrackedFrame accept(double time, TargetFit fit) {
    const bool three = fit.matches < 4 || PredictedMatch<Camera>::shares(fit.blob_of_marker);
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
      match().refine(f, blobs, false);  // for the spheres
      const double score = f.score;
      std::vector<TimedPose> history{{time, f.T_camera_target}};
      hypotheses_.push_back({std::move(f), std::move(history), score, 0});
    }
  }
  /// Every hypothesis by itself; those that no longer fit are dropped.
  void follow(double time, std::span<const Observation> blobs) {
    std::vector<Hypothesis> next;
    for (Hypothesis& h : hypotheses_) {
      if (goes_on(h, time, blobs)) next.push_back(std::move(h));
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
  std::optional<Hypothesis> rival_;  // of what is tracked
  std::vector<Hypothesis> hypotheses_;
  Matrix6 covariance_ = Matrix6::Zero();
  double time_ = 0.0, last_seen_ = 0.0, checked_ = 0.0, last_step_ = 0.1;
  bool started_ = false, was_tracked_ = false;
};
}  // namespace surfleet
