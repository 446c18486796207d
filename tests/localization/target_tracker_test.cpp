// SPDX-License-Identifier: MIT
#include <surfleet/localization/target_tracker.hpp>

#include <functional>

#include "check.hpp"
#include "scenes.hpp"

namespace {
using namespace surfleet;

/// A smooth flight before the camera, 0.8 to 2 m away.
Pose flight(double t) {
  Pose T = Pose::Identity();
  T.linear() = (Eigen::AngleAxisd(0.8 * std::sin(0.9 * t), Eigen::Vector3d::UnitX()) *
                Eigen::AngleAxisd(2.0 + 0.7 * t, Eigen::Vector3d::UnitZ()))
                   .toRotationMatrix();
  T.translation() =
      Point3(0.35 * std::sin(1.1 * t), 0.2 * std::cos(0.8 * t), 1.4 + 0.5 * std::sin(0.5 * t));
  return T;
}
struct Seen {
  std::vector<TrackedFrame> frames;
  int wrong = 0;
};
/// 30 frames a second; `markers(k)` says which of the markers are seen in frame k, as bits.
template <MotionModel Motion>
Seen follow(int frames, const std::function<unsigned(int)>& markers, int strangers, double noise,
            Motion motion, std::uint64_t seed = 22,
            const std::function<Pose(double)>& pose = flight) {
  const auto camera = scenes::printed_camera();
  MarkerTarget target = printed_target();
  target.marker_radius = 0.0;
  TrackerOptions options;
  options.identify.pixel_noise = noise;
  TargetTracker tracker(camera, target, options, std::move(motion));
  Random random(seed);
  Seen seen;
  for (int k = 0; k < frames; ++k) {
    const double t = k / 30.0;
    std::vector<Eigen::Vector2d> pixels;
    for (std::size_t m = 0; m < 4; ++m)
      if ((markers(k) >> m & 1U) != 0)
        if (const auto px = camera.project(pose(t) * target.markers[m]))
          pixels.push_back(*px + noise * Eigen::Vector2d(random.normal(), random.normal()));
    for (int i = 0; i < strangers; ++i)
      pixels.emplace_back(random.uniform(0, 751), random.uniform(0, 479));
    random.shuffle(pixels);
    seen.frames.push_back(*tracker.update(t, observe_all(camera, pixels)));
    const TrackedFrame& f = seen.frames.back();
    if (f.state == TrackState::tracked &&
        (scenes::angle_between(f.fits[0].T_camera_target, pose(t)) > radians(10) ||
         scenes::distance_between(f.fits[0].T_camera_target, pose(t)) > 0.1))
      ++seen.wrong;
  }
  return seen;
}
constexpr unsigned kAll = 15;

template <MotionModel Motion>
void tracker_laws(const Motion& motion) {
  const Seen clear = follow(
      200, [](int) { return kAll; }, 0, 0.1, motion);
  int tracked = 0;
  for (const TrackedFrame& f : clear.frames) tracked += f.state == TrackState::tracked;
  CHECK(tracked >= 198 && clear.wrong == 0);
  const Seen strangers = follow(
      200, [](int) { return kAll; }, 5, 0.1, motion);
  tracked = 0;
  for (const TrackedFrame& f : strangers.frames) tracked += f.state == TrackState::tracked;
  CHECK(tracked >= 195 && strangers.wrong == 0);
}
TEST(a_target_in_sight_is_tracked_by_any_motion_model) {
  tracker_laws(LinearRegression{});
  tracker_laws(LinearRegression{4});
  tracker_laws(StandStill{});
  tracker_laws(InertialRotation{[](double from, double to) -> Eigen::Matrix3d {
                                  return flight(from).linear() * flight(to).linear().transpose();
                                },
                                {}});
}
TEST(three_markers_are_enough_with_a_prediction_and_flagged) {
  const Seen seen = follow(
      120, [](int k) { return k >= 30 && k < 90 ? 11U : kAll; }, 2, 0.1, LinearRegression{});
  for (int k = 30; k < 90; ++k) {
    const TrackedFrame& f = seen.frames[static_cast<std::size_t>(k)];
    CHECK(f.state == TrackState::tracked && (f.three_markers || f.fits[0].matches >= 4));
  }
  CHECK(seen.frames[100].state == TrackState::tracked && !seen.frames[100].three_markers);
  CHECK(seen.wrong == 0);
  // Not without one.
  const Seen never = follow(
      30, [](int) { return 11U; }, 0, 0.1, LinearRegression{});
  for (const TrackedFrame& f : never.frames)
    CHECK(f.state == TrackState::start_up && f.fits.empty());
}
TEST(two_markers_coast_half_a_second_then_it_is_lost_and_found_again) {
  const Seen seen = follow(
      150, [](int k) { return k >= 30 && k < 90 ? 3U : kAll; }, 0, 0.1, LinearRegression{});
  for (int k = 30; k < 90; ++k) {
    const TrackedFrame& f = seen.frames[static_cast<std::size_t>(k)];
    const bool coasts = (k - 29) / 30.0 <= 0.5;
    CHECK(f.state == (coasts ? TrackState::coasting : TrackState::lost));
    CHECK(f.fits.size() == (coasts ? 1U : 0U));
  }
  for (int k = 92; k < 150; ++k)
    CHECK(seen.frames[static_cast<std::size_t>(k)].state == TrackState::tracked);
  CHECK(seen.wrong == 0);
  const Matrix6 early = seen.frames[31].fits[0].covariance,
                late = seen.frames[43].fits[0].covariance;
  CHECK(late.trace() > early.trace());
}
TEST(a_pose_that_fits_by_chance_is_not_followed_for_ever) {
  for (int axis = 0; axis < 3; ++axis)
    for (int jump = 30; jump < 180; jump += 6) {
      const auto turned = [&](double t) {
        Pose T = flight(t);
        if (t > (jump - 0.5) / 30.0)
          T.linear() =
              T.linear() * Eigen::AngleAxisd(kPi, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
        return T;
      };
      const Seen seen = follow(
          jump + 60, [](int) { return kAll; }, 0, 0.1, LinearRegression{},
          static_cast<std::uint64_t>(jump), turned);
      CHECK(seen.wrong <= 25);
    }
}
TEST(what_is_ambiguous_is_returned_whole_and_settled_by_motion) {
  // Far and noisy: single images may not tell.
  int ambiguous = 0, settled = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Seen seen = follow(
        60, [](int) { return kAll; }, 0, 0.6, LinearRegression{}, seed);
    for (const TrackedFrame& f : seen.frames) {
      ambiguous += f.state == TrackState::ambiguous;
      if (f.state == TrackState::ambiguous) CHECK(f.fits.size() > 1);
    }
    settled += seen.frames.back().state == TrackState::tracked && seen.wrong == 0;
  }
  CHECK(ambiguous > 0);
  CHECK(settled == 6);
}
TEST(regression_continues_a_steady_motion) {
  // A screw about a fixed axis of the camera, in even steps.
  std::vector<TimedPose> history;
  const auto at = [](double t) {
    Pose T = Pose::Identity();
    T.linear() =
        Eigen::AngleAxisd(0.3 * t, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    T.translation() = Point3(0.1, 0.2, 1.0) + t * Eigen::Vector3d(0.3, -0.1, 0.2);
    return T;
  };
  for (int k = 0; k < 5; ++k) history.push_back({0.1 * k, at(0.1 * k)});
  for (const std::size_t count : {2U, 3U, 5U})
    CHECK_NEAR((LinearRegression{count}(history, 0.55).matrix() - at(0.55).matrix()).norm(), 0.0,
               1e-9);
  CHECK_NEAR((StandStill{}(history, 0.55).matrix() - at(0.4).matrix()).norm(), 0.0, 1e-12);
  CHECK_NEAR(
      (LinearRegression{3}(std::span(history).first(1), 0.2).matrix() - at(0.0).matrix()).norm(),
      0.0, 1e-12);
}
TEST(bad_times_and_targets_are_refused) {
  const auto camera = scenes::printed_camera();
  TargetTracker tracker(camera, printed_target());
  CHECK(tracker.update(1.0, {})->state == TrackState::start_up);
  CHECK_THROWS(Error, tracker.update(1.0, {}));
  CHECK_THROWS(Error, TargetTracker(camera, MarkerTarget{}));
}
}  // namespace
