// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/color_map.hpp>

#include <cmath>
#include <set>

#include "check.hpp"

using namespace surfleet;

namespace {
double lightness(Rgb c) { return detail::oklab_from_rgb(c)[0]; }
}  // namespace

TEST(oklab_round_trips) {
  for (int r = 0; r < 256; r += 51)
    for (int g = 0; g < 256; g += 51)
      for (int b = 0; b < 256; b += 51) {
        const Rgb c{static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                    static_cast<std::uint8_t>(b)};
        CHECK(detail::rgb_from_oklab(detail::oklab_from_rgb(c)) == c);
      }
  CHECK_NEAR(lightness({255, 255, 255}), 1.0, 1e-6);
}

TEST(diverging_map_is_lightest_at_zero_and_falls_to_both_sides) {
  const DivergingMap map;
  for (double t = 0.0; t < 0.5; t += 0.02) {
    CHECK(lightness(map(t)) <= lightness(map(t + 0.02)) + 1e-3);
    CHECK(lightness(map(1.0 - t)) <= lightness(map(0.98 - t)) + 1e-3);
  }
  CHECK(map(-3.0) == map(0.0) && map(7.0) == map(1.0));
  CHECK(signed_error_color(0.0, 0.1) == map(0.5));
  CHECK(signed_error_color(std::nan(""), 0.1) == (Rgb{150, 150, 150}));
  CHECK(signed_error_color(1.0, 0.1) == map(1.0) && signed_error_color(-1.0, 0.1) == map(0.0));
}

TEST(sequential_map_gets_evenly_lighter) {
  const SequentialMap map;
  for (double t = 0.0; t < 0.99; t += 0.01)
    CHECK(lightness(map(t)) < lightness(map(t + 0.01)) + 2e-3);
  CHECK(lightness(map(1.0)) - lightness(map(0.0)) > 0.5);
}

TEST(categories_are_distinct) {
  std::set<Rgb> seen;
  for (std::size_t i = 0; i < 8; ++i) seen.insert(categorical_color(i));
  CHECK(seen.size() == 8 && categorical_color(8) == categorical_color(0));
  CHECK(css_color({0, 114, 255}) == "#0072ff");
}
