// SPDX-License-Identifier: MIT
#include <surfleet/localization/image_tracker.hpp>

#include <surfleet/simulation/marker_images.hpp>
#include <surfleet/simulation/target_motions.hpp>

#include "check.hpp"
#include "scenes.hpp"

namespace {
using namespace surfleet;

struct Errors {
  double position = 0.0, angle = 0.0;  ///< Means [m], [rad].
  int tracked = 0, wrong = 0;
};
template <CameraModel Camera>
Errors follow(const Camera& camera, const CameraMotionOptions& motion, int frames,
              MarkerImageOptions drawing = {}, BlobOptions blobs = {}) {
  const MarkerTarget target = printed_target();
  MarkerImages draw(drawing, 26);
  ImageTracker track(camera, target, {}, blobs);
  const CameraMotion move(motion, 27);
  Errors e;
  for (int k = 0; k < frames; ++k) {
    const double t = k / 30.0;
    const ImageFrame frame = track(draw(camera, target, move(t)), t);
    if (frame.tracked.state != TrackState::tracked) continue;
    ++e.tracked;
    const double off = scenes::distance_between(frame.tracked.fits[0].T_camera_target, move(t));
    const double turn = scenes::angle_between(frame.tracked.fits[0].T_camera_target, move(t));
    e.position += off;
    e.angle += turn;
    e.wrong += off > 0.1 || turn > radians(10.0);
  }
  e.position /= std::max(e.tracked, 1);
  e.angle /= std::max(e.tracked, 1);
  return e;
}
TEST(rendered_frames_are_tracked_to_millimetres) {
  const Errors bright = follow(scenes::printed_camera(), handheld_motion(), 90);
  CHECK(bright.tracked >= 88 && bright.wrong == 0);
  CHECK(bright.position < 0.004 && bright.angle < radians(0.4));
  MarkerImageOptions dark;
  dark.background = 220.0;
  dark.brightness = -180.0;
  BlobOptions find_dark;
  find_dark.dark = true;
  const Errors e = follow(scenes::printed_camera(), handheld_motion(), 40, dark, find_dark);
  CHECK(e.tracked >= 38 && e.wrong == 0 && e.position < 0.005);
}
TEST(through_a_fish_eye_too) {
  const Errors e =
      follow(EquidistantCamera::from_fov(radians(150), 752, 480), handheld_motion(), 40);
  CHECK(e.tracked >= 30 && e.wrong == 0 && e.position < 0.008);
}
TEST(images_of_another_size_are_refused) {
  ImageTracker track(scenes::printed_camera(), printed_target());
  CHECK_THROWS(Error, track(GreyImage(640, 480), 0.0));
  CHECK(track(GreyImage(752, 480, 255), 0.0).tracked.state == TrackState::start_up);
}
TEST(a_sweep_covers_its_rectangle) {
  double left = 1, right = -1, top = -1, bottom = 1;
  Point2 last = sweep_place(0.3, 0.42, 5, 0.0);
  for (double distance = 0.0; distance < 8.0; distance += 0.01) {
    const Point2 p = sweep_place(0.3, 0.42, 5, distance);
    CHECK((p - last).norm() < 0.0101);
    last = p;
    left = std::min(left, p.x());
    right = std::max(right, p.x());
    bottom = std::min(bottom, p.y());
    top = std::max(top, p.y());
  }
  CHECK_NEAR(right - left, 0.3, 0.01);
  CHECK_NEAR(top - bottom, 0.42, 0.01);
}
TEST(the_camera_keeps_its_distance) {
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const CameraMotionOptions options = flight_motion();
    const CameraMotion move(options, seed);
    for (double t = 0.0; t < 30.0; t += 0.1) {
      const double d = (move(t) * options.middle).norm();
      CHECK(d >= options.nearest - 1e-9 && d <= options.farthest + 1e-9);
      CHECK((move(t).translation() - move(t + 1e-3).translation()).norm() < 0.02);
    }
  }
}
}  // namespace
