// SPDX-License-Identifier: MIT
#include <surfleet/localization/identify_targets.hpp>

#include <surfleet/localization/target_design.hpp>

#include "check.hpp"
#include "scenes.hpp"

namespace {
using namespace surfleet;

TEST(two_designed_targets_are_told_apart) {
  TargetDesignOptions design;
  design.targets = 2;
  design.starts = 20;
  auto targets = design_targets(design).targets;
  for (auto& t : targets) t.marker_radius = 0.0;
  const auto camera = scenes::printed_camera();
  Random random(24);
  IdentifyOptions options;
  options.pixel_noise = 0.1;
  int right = 0, chains = 0;
  for (int i = 0; i < 20; ++i) {
    const Pose a = scenes::random_view(camera, targets[0], 0.7, 1.6, random);
    const Pose b = scenes::random_view(camera, targets[1], 0.7, 1.6, random);
    auto pixels = scenes::see(camera, targets[0], a, 0.1, random);
    for (const auto& px : scenes::see(camera, targets[1], b, 0.1, random)) pixels.push_back(px);
    random.shuffle(pixels);
    const auto found = identify_targets(observe_all(camera, pixels), targets, options);
    CHECK(found.size() == 2);
    if (found[0].fits.empty() || found[1].fits.empty()) continue;
    const TargetFit &fa = found[0].fits[0], &fb = found[1].fits[0];
    if (scenes::distance_between(fa.T_camera_target, a) < 0.05 &&
        scenes::distance_between(fb.T_camera_target, b) < 0.05) {
      ++right;
      // From one target to the other, with a covariance that holds.
      const UncertainPose chain = fa.camera_in_target() * fb.target_in_camera();
      chains += chain.normalized_error(a.inverse() * b) < 40.0;
    }
    for (const int x : fa.blob_of_marker)
      for (const int y : fb.blob_of_marker) CHECK(x != y || x == TargetFit::kUnseen);
  }
  CHECK(right >= 18);
  CHECK(chains == right);
}
TEST(a_target_that_is_not_there_is_not_found) {
  const auto camera = scenes::printed_camera();
  TargetDesignOptions design;
  design.targets = 2;
  design.starts = 20;
  auto targets = design_targets(design).targets;
  for (auto& t : targets) t.marker_radius = 0.0;
  Random random(25);
  IdentifyOptions options;
  options.pixel_noise = 0.1;
  int found = 0;
  for (int i = 0; i < 20; ++i) {
    const Pose a = scenes::random_view(camera, targets[0], 0.7, 1.2, random);
    const auto seen = observe_all(camera, scenes::see(camera, targets[0], a, 0.1, random));
    const auto all = identify_targets(seen, targets, options);
    found +=
        !all[0].fits.empty() && scenes::distance_between(all[0].fits[0].T_camera_target, a) < 0.05;
  }
  CHECK(found >= 19);
  CHECK(identify_targets({}, targets).size() == 2);
  CHECK_THROWS(Error, identify_targets({}, std::vector<MarkerTarget>(9, printed_target())));
}
}  // namespace
