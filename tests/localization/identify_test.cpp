// SPDX-License-Identifier: MIT
#include <surfleet/localization/identify.hpp>

#include <surfleet/localization/estimate_pose.hpp>

#include <algorithm>
#include <numeric>

#include "check.hpp"
#include "scenes.hpp"

namespace {
using namespace surfleet;

bool near(const Pose& a, const Pose& b) {
  return scenes::angle_between(a, b) < radians(8.0) &&
         scenes::distance_between(a, b) < 0.05 * a.translation().norm();
}
TEST(the_printed_target_is_told_from_one_image) {
  const auto camera = scenes::printed_camera();
  const MarkerTarget target = printed_target();
  Random random(13);
  IdentifyOptions options;
  options.pixel_noise = 0.1;
  int right = 0, unique = 0, unique_right = 0;
  for (int i = 0; i < 200; ++i) {
    const Pose T = scenes::random_view(camera, target, 0.7, 3.0, random);
    auto pixels = scenes::see(camera, target, T, 0.1, random);
    random.shuffle(pixels);
    const auto found = identify(observe_all(camera, pixels), target, options);
    CHECK(!found.fits.empty());
    if (found.fits.empty()) continue;
    const bool ok = near(T, found.fits[0].T_camera_target);
    right += ok;
    unique += !found.ambiguous();
    unique_right += !found.ambiguous() && ok;
  }
  CHECK(right >= 196);
  CHECK(unique_right == unique);
}
TEST(labels_given_to_blobs_change_nothing) {
  const auto camera = scenes::printed_camera();
  const MarkerTarget target = printed_target();
  Random random(14);
  for (int i = 0; i < 20; ++i) {
    const Pose T = scenes::random_view(camera, target, 0.7, 2.0, random);
    const auto pixels = scenes::see(camera, target, T, 0.1, random);
    const auto seen = observe_all(camera, pixels);
    std::vector<std::size_t> order(pixels.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    random.shuffle(order);
    std::vector<Observation> shuffled;
    for (const std::size_t k : order) shuffled.push_back(seen[k]);
    const auto a = identify(seen, target), b = identify(shuffled, target);
    CHECK(a.fits.size() == b.fits.size() && !a.fits.empty());
    if (a.fits.empty() || b.fits.empty()) continue;
    CHECK_NEAR(scenes::distance_between(a.fits[0].T_camera_target, b.fits[0].T_camera_target), 0.0,
               1e-6);
    for (std::size_t m = 0; m < target.markers.size(); ++m) {
      const int blob = b.fits[0].blob_of_marker[m];
      CHECK(blob >= 0 &&
            static_cast<int>(order[static_cast<std::size_t>(blob)]) == a.fits[0].blob_of_marker[m]);
    }
  }
}
/// The best assignment of four markers among all the blobs, each posed as labelled markers are.
double brute_force(std::span<const Observation> blobs, const MarkerTarget& target, Pose& best) {
  double least = 1e300;
  std::vector<std::size_t> pick(blobs.size());
  std::iota(pick.begin(), pick.end(), std::size_t{0});
  do {
    if (!std::is_sorted(pick.begin() + 4, pick.end())) continue;
    std::vector<Observation> seen;
    for (std::size_t m = 0; m < 4; ++m) seen.push_back(blobs[pick[m]]);
    std::optional<RefinedPose> second;
    const auto found = estimate_pose(seen, target.markers, {}, LambdaTwistP3p{}, &second);
    for (const auto& r : {found, second})
      if (r && r->information.determinant() > 0.0) {
        const double score = r->cost / 0.01 + std::log(r->information.determinant());
        if (score < least) {
          least = score;
          best = r->T_camera_target;
        }
      }
  } while (std::next_permutation(pick.begin(), pick.end()));
  return least;
}
TEST(no_assignment_is_better) {
  const auto camera = scenes::printed_camera();
  const MarkerTarget target = printed_target();
  Random random(15);
  IdentifyOptions options;
  options.pixel_noise = 0.1;
  for (int i = 0; i < 10; ++i) {
    const Pose T = scenes::random_view(camera, target, 0.7, 2.0, random);
    auto pixels = scenes::see(camera, target, T, 0.1, random);
    pixels.emplace_back(random.uniform(0, 751), random.uniform(0, 479));
    pixels.emplace_back(random.uniform(0, 751), random.uniform(0, 479));
    random.shuffle(pixels);
    const auto seen = observe_all(camera, pixels);
    const auto found = identify(seen, target, options);
    Pose best = Pose::Identity();
    const double least = brute_force(seen, target, best);
    CHECK(!found.fits.empty());
    if (!found.fits.empty()) CHECK_NEAR(found.fits[0].score, least, 1e-3);
  }
}
TEST(strangers_and_a_hidden_marker_are_borne) {
  const auto camera = scenes::printed_camera();
  MarkerTarget target;
  target.markers = {{-0.08, -0.10, 0.03},
                    {0.06, -0.09, 0.0},
                    {0.10, 0.05, 0.05},
                    {-0.02, 0.11, 0.09},
                    {-0.10, 0.03, -0.02}};
  Random random(16);
  int right = 0, kept = 0;
  IdentifyOptions options;
  options.pixel_noise = 0.1;
  for (int i = 0; i < 40; ++i) {
    const Pose T = scenes::random_view(camera, target, 0.5, 1.2, random);
    auto pixels = scenes::see(camera, target, T, 0.1, random);
    pixels.erase(pixels.begin() + i % 5);
    for (int k = 0; k < 3; ++k) pixels.emplace_back(random.uniform(0, 751), random.uniform(0, 479));
    const auto found = identify(observe_all(camera, pixels), target, options);
    right += !found.fits.empty() && near(T, found.fits[0].T_camera_target);
    kept += std::any_of(found.fits.begin(), found.fits.end(), [&](const TargetFit& fit) {
      return near(T, fit.T_camera_target) &&
             fit.blob_of_marker[static_cast<std::size_t>(i % 5)] == TargetFit::kUnseen;
    });
  }
  CHECK(right >= 34);
  CHECK(kept >= 39);
}
TEST(a_symmetric_target_is_called_ambiguous) {
  const auto camera = scenes::printed_camera();
  MarkerTarget square;
  square.markers = {{0.1, 0.1, 0.0}, {-0.1, 0.1, 0.0}, {-0.1, -0.1, 0.0}, {0.1, -0.1, 0.0}};
  Random random(17);
  const Pose T = scenes::random_view(camera, square, 0.5, 0.8, random);
  const auto found =
      identify(observe_all(camera, scenes::see(camera, square, T, 0.05, random)), square);
  CHECK(found.fits.size() >= 4);  // the four turns
}
TEST(few_many_and_bad_blobs_end_in_bounded_time) {
  const auto camera = scenes::printed_camera();
  const MarkerTarget target = printed_target();
  Random random(18);
  std::vector<Eigen::Vector2d> many;
  CHECK(identify({}, target).fits.empty());
  for (int i = 0; i < 10000; ++i) many.emplace_back(random.uniform(0, 751), random.uniform(0, 479));
  const auto seen = observe_all(camera, many);
  CHECK(identify(std::span(seen).first(3), target).fits.empty());
  IdentifyOptions few;
  few.max_blobs = 9;
  CHECK(identify(seen, target, few).truncated);
  // One blob many times.
  const std::vector<Observation> same(6, seen[0]);
  CHECK(identify(same, target).fits.empty());
  IdentifyOptions bad;
  bad.pixel_noise = 0.0;
  CHECK_THROWS(Error, identify(seen, target, bad));
  bad = {};
  bad.min_matches = 3;
  CHECK_THROWS(Error, identify(seen, target, bad));
}
TEST(the_size_of_a_blob_tells_strangers) {
  const auto camera = scenes::printed_camera();
  const MarkerTarget target = printed_target();
  Random random(19);
  const Pose T = scenes::random_view(camera, target, 1.0, 1.0, random);
  const auto pixels = scenes::see(camera, target, T, 0.0, random);
  std::vector<Observation> right, wrong;
  for (std::size_t m = 0; m < 4; ++m) {
    const double d = 376.0 * 0.03 / (T * target.markers[m]).norm();
    right.push_back(observe(camera, pixels[m], d));
    wrong.push_back(observe(camera, pixels[m], 5.0 * d));
  }
  CHECK(!identify(right, target).fits.empty());
  for (const TargetFit& fit : identify(wrong, target).fits)
    CHECK(fit.T_camera_target.translation().norm() < 0.8);
}
}  // namespace
