// SPDX-License-Identifier: MIT
#include <surfleet/localization/blobs.hpp>

#include <surfleet/localization/sphere_outline.hpp>
#include <surfleet/simulation/marker_images.hpp>

#include "check.hpp"
#include "scenes.hpp"

namespace {
using namespace surfleet;

/// Discs drawn at random places at least `gap` from one another and from the border.
std::vector<ImageDisc> random_discs(int count, double radius, double gap, Random& random) {
  std::vector<ImageDisc> discs;
  while (static_cast<int>(discs.size()) < count) {
    const Eigen::Vector2d c(random.uniform(gap, 751 - gap), random.uniform(gap, 479 - gap));
    bool free = true;
    for (const ImageDisc& d : discs) free = free && (d.center - c).norm() > gap;
    if (free) discs.push_back({c, radius, false});
  }
  return discs;
}
double root_mean_square_error(double diameter, bool dark, Random& random) {
  MarkerTarget none;
  MarkerImageOptions options;
  if (dark) {
    options.background = 210.0;
    options.brightness = -170.0;
  }
  MarkerImages draw(options, 5);
  BlobOptions find;
  find.dark = dark;
  double squares = 0.0;
  int found = 0;
  const auto camera = scenes::printed_camera();
  for (int i = 0; i < 4; ++i) {
    const auto discs = random_discs(20, 0.5 * diameter, 50.0, random);
    const auto blobs = extract_blobs(draw(camera, none, Pose::Identity(), discs), find);
    CHECK(blobs.size() == discs.size());
    for (const Blob& b : blobs) {
      double least = 1e9;
      for (const ImageDisc& d : discs) least = std::min(least, (d.center - b.center).norm());
      squares += least * least;
      ++found;
      if (diameter >= 6.0) CHECK_NEAR(b.diameter, diameter, 0.12 * diameter);
    }
  }
  return std::sqrt(squares / std::max(found, 1));
}
TEST(centers_are_finer_than_pixels) {
  Random random(20);
  for (const double diameter : {4.0, 6.0, 10.0, 20.0}) {
    CHECK(root_mean_square_error(diameter, false, random) < 0.05);
    CHECK(root_mean_square_error(diameter, true, random) < 0.05);
  }
}
TEST(images_without_contrast_have_no_blobs) {
  CHECK(extract_blobs(GreyImage(752, 480, 0)).empty());
  CHECK(extract_blobs(GreyImage(752, 480, 255)).empty());
  CHECK(extract_blobs(GreyImage(1, 1, 9)).empty());
  MarkerImages draw;
  CHECK(extract_blobs(draw(scenes::printed_camera(), MarkerTarget{}, Pose::Identity())).empty());
  CHECK_THROWS(Error, extract_blobs(GreyImage()));
  CHECK(extract_blobs(GreyImage(20, 20, 9), {}, PixelWindow{30, 30, 40, 40}).empty());
}
TEST(bars_and_frames_are_no_markers) {
  GreyImage image(200, 100, 20);
  for (int u = 20; u < 120; ++u)
    for (int v = 30; v < 34; ++v) image(u, v) = 220;  // a bar
  for (int i = 0; i < 30; ++i)
    for (int k = 0; k < 3; ++k) image(140 + i, 20 + k) = image(140 + k, 20 + i) = 220;  // an angle
  CHECK(extract_blobs(image).empty());
  for (int u = 60; u < 68; ++u)
    for (int v = 60; v < 68; ++v) image(u, v) = 220;
  const auto blobs = extract_blobs(image);
  CHECK(blobs.size() == 1);
  if (blobs.size() == 1) CHECK_NEAR((blobs[0].center - Point2(63.5, 63.5)).norm(), 0.0, 1e-6);
  CHECK(extract_blobs(image, {}, PixelWindow{0, 0, 50, 100}).empty());
}
TEST(ten_thousand_specks_end_in_bounded_time) {
  GreyImage image(752, 480, 20);
  for (int v = 1; v + 1 < 480; v += 6)
    for (int u = 1; u + 1 < 752; u += 6) image(u, v) = image(u + 1, v) = image(u, v + 1) = 220;
  CHECK(extract_blobs(image).size() <= BlobOptions{}.max_count);
}
TEST(two_discs_that_touch_are_two) {
  MarkerImages draw;
  const std::vector<ImageDisc> discs{{{100, 100}, 10.0, false}, {{117, 103}, 10.0, false}};
  const auto blobs =
      extract_blobs(draw(scenes::printed_camera(), MarkerTarget{}, Pose::Identity(), discs));
  CHECK(blobs.size() == 2);
}
TEST(discs_that_overlap_are_told_apart_by_their_circles) {
  MarkerImages draw;
  const auto camera = scenes::printed_camera();
  const std::vector<std::vector<ImageDisc>> groups{
      {{{100.3, 100.0}, 9.0, false}, {{116.0, 103.5}, 9.0, false}},
      {{{300.0, 200.2}, 8.0, false}, {{310.6, 200.0}, 8.0, false}, {{320.9, 201.0}, 8.0, false}}};
  for (const auto& discs : groups) {
    const auto blobs = extract_blobs(draw(camera, MarkerTarget{}, Pose::Identity(), discs));
    CHECK(blobs.size() == discs.size());
    for (const ImageDisc& d : discs) {
      double least = 1e9;
      for (const Blob& b : blobs) {
        least = std::min(least, (b.center - d.center).norm());
        CHECK_NEAR(b.diameter, 2.0 * d.radius, 3.5);  // at λ₂ blur counts
      }
      CHECK(least < 0.8);
    }
  }
  // A streak is none of them.
  const GreyImage streak = [] {
    GreyImage image(200, 100);
    for (int v = 40; v < 52; ++v)
      for (int u = 50; u < 70; ++u) image(u, v) = 220;
    return image;
  }();
  CHECK(extract_blobs(streak).size() <= 1);
}
TEST(circles_are_fitted_exactly_and_found_in_outlines) {
  std::vector<Point2> points;
  for (int k = 0; k < 40; ++k)
    points.push_back(Point2(3.2, -1.7) + 6.5 * Point2(std::cos(0.1 * k), std::sin(0.1 * k)));
  const auto circle = fit_circle(points);
  CHECK(circle && (circle->center - Point2(3.2, -1.7)).norm() < 1e-9);
  CHECK_NEAR(circle->radius, 6.5, 1e-9);
  points.clear();
  for (int k = 0; k < 9; ++k) points.emplace_back(k, 2.0 * k);
  CHECK(!fit_circle(points));
  CHECK(hough_circles({}, 2.0, 9.0).empty());
}
TEST(components_are_those_of_a_flood) {
  Random random(21);
  GreyImage image(60, 40);
  for (auto& p : image.pixels) p = random.uniform() < 0.45 ? 200 : 0;
  const auto components = connected_components(image, PixelWindow::whole(image), 100);
  // The same by filling from each pixel.
  std::vector<int> label(image.pixels.size(), -1);
  int count = 0;
  for (int start = 0; start < 60 * 40; ++start) {
    if (image.pixels[static_cast<std::size_t>(start)] == 0 ||
        label[static_cast<std::size_t>(start)] >= 0)
      continue;
    std::vector<int> stack{start};
    label[static_cast<std::size_t>(start)] = count;
    int area = 0;
    while (!stack.empty()) {
      const int at = stack.back();
      stack.pop_back();
      ++area;
      for (int dv = -1; dv <= 1; ++dv)
        for (int du = -1; du <= 1; ++du) {
          const int u = at % 60 + du, v = at / 60 + dv;
          if (u < 0 || v < 0 || u >= 60 || v >= 40) continue;
          const auto k = static_cast<std::size_t>(v * 60 + u);
          if (image.pixels[k] == 0 || label[k] >= 0) continue;
          label[k] = count;
          stack.push_back(static_cast<int>(k));
        }
    }
    CHECK(static_cast<std::size_t>(count) < components.size());
    if (static_cast<std::size_t>(count) < components.size()) {
      const auto& c = components[static_cast<std::size_t>(count)];
      CHECK(c.area == area);
      for (const PixelRun& r : c.runs)
        for (int u = r.begin; u < r.end; ++u)
          CHECK(label[static_cast<std::size_t>(r.v * 60 + u)] == count);
    }
    ++count;
  }
  CHECK(static_cast<std::size_t>(count) == components.size());
}
TEST(otsu_and_the_background_of_two_classes) {
  GreyHistogram h{};
  for (std::size_t g = 20; g <= 40; ++g) h[g] = 1000;
  for (std::size_t g = 200; g <= 210; ++g) h[g] = 10;
  const int t = otsu_threshold(h);
  CHECK(t >= 40 && t < 200);
  const GreyBackground b = fit_background(h);
  CHECK_NEAR(b.mean, 30.0, 1e-9);
  CHECK_NEAR(b.deviation, std::sqrt((21.0 * 21.0 - 1.0) / 12.0), 1e-9);
}
TEST(the_farthest_blobs_go_first) {
  std::vector<Blob> blobs(4);
  blobs[0].center = {10, 10};
  blobs[1].center = {500, 10};
  blobs[2].center = {12, 10};
  blobs[3].center = {14, 14};
  const auto kept = nearest_blobs(blobs, 3);
  CHECK(kept.size() == 3 && kept[1].center.x() == 12);
}
TEST(colour_is_told_by_hue_not_by_brightness) {
  std::vector<std::uint8_t> rgb(3 * 40 * 40, 90);
  for (int v = 10; v < 16; ++v)
    for (int u = 10; u < 16; ++u) rgb[static_cast<std::size_t>(3 * (v * 40 + u) + 1)] = 250;
  for (int v = 25; v < 31; ++v)
    for (int u = 25; u < 31; ++u)
      for (int k = 0; k < 3; ++k) rgb[static_cast<std::size_t>(3 * (v * 40 + u) + k)] = 250;
  const auto blobs = extract_blobs(select_color(rgb, 40, 40, {{0, 0, 0}, {255, 110, 110}}));
  CHECK(blobs.size() == 1);
  if (blobs.size() == 1) CHECK_NEAR((blobs[0].center - Point2(12.5, 12.5)).norm(), 0.0, 1e-9);
  CHECK_THROWS(Error, select_color(rgb, 41, 40, {}));
}
TEST(the_outline_of_a_sphere_is_an_ellipse_of_known_centre) {
  // In a pinhole, its centre is that of the sphere's times cos²/(cos² − sin² of the cone).
  const auto camera = scenes::printed_camera();
  const Point3 center(0.45, 0.2, 0.6);
  const double r = 0.015, c2 = center.z() * center.z() / center.squaredNorm(),
               s2 = r * r / center.squaredNorm();
  const Eigen::Vector2d x = center.head<2>() / center.z();
  const Eigen::Vector2d expected = camera.fx * x * (c2 / (c2 - s2) - 1.0);
  const auto offset = sphere_outline_offset(camera, center, r);
  CHECK(offset.has_value());
  if (offset) CHECK_NEAR((*offset - expected).norm(), 0.0, 0.03 * expected.norm());
  CHECK(expected.norm() > 0.1);
  CHECK(!sphere_outline_offset(camera, {0.0, 0.0, 0.01}, 0.02));
  // And that is where the light is.
  MarkerTarget target;
  target.markers = {center};
  target.marker_radius = r;
  MarkerImageOptions clean;
  clean.noise = 0.0;
  const auto blobs = extract_blobs(MarkerImages(clean)(camera, target, Pose::Identity()));
  CHECK(blobs.size() == 1);
  if (blobs.size() == 1 && offset)
    CHECK_NEAR((blobs[0].center - *camera.project(center) - *offset).norm(), 0.0, 0.02);
}
}  // namespace
