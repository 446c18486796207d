// SPDX-License-Identifier: MIT
/// @file
/// @brief Perceptual colour maps: diverging for signed error, sequential, and one colour a robot.
///
/// Maps interpolate in Oklab (Ottosson 2020), where equal steps look equally large.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

#include <Eigen/Core>
#include <surfleet/evaluation/image.hpp>

namespace surfleet {
/// Light energy, in [0, 1], of an sRGB channel in [0, 1], and back.
inline double srgb_to_linear(double s) {
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}
inline double linear_to_srgb(double l) {
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
}

namespace detail {
inline std::uint8_t to_byte(double unit) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(unit, 0.0, 1.0)));
}
/// Lightness, green–red and blue–yellow of an sRGB colour.
inline Eigen::Vector3d oklab_from_rgb(Rgb c) {
  const double r = srgb_to_linear(c[0] / 255.0), g = srgb_to_linear(c[1] / 255.0),
               b = srgb_to_linear(c[2] / 255.0);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}
inline Rgb rgb_from_oklab(const Eigen::Vector3d& lab) {
  const auto cube = [](double v) { return v * v * v; };
  const double l = cube(lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2]);
  const double m = cube(lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2]);
  const double s = cube(lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2]);
  return {to_byte(linear_to_srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s)),
          to_byte(linear_to_srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s)),
          to_byte(linear_to_srgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s))};
}
/// The colour at `t` ∈ [0, 1] of equally spaced `stops`, straight between them in Oklab.
inline Rgb interpolate_colors(std::span<const Rgb> stops, double t) {
  const double at = std::clamp(t, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double f = at - static_cast<double>(i);
  return rgb_from_oklab((1.0 - f) * oklab_from_rgb(stops[i]) + f * oklab_from_rgb(stops[i + 1]));
}
}  // namespace detail

/// What colours a value.
///
/// `map(t)` is the colour at `t` ∈ [0, 1]; values outside take the colour of the nearer end.
template <typename M>
concept ColorMap = requires(const M& map, double t) {
  { map(t) } -> std::convertible_to<Rgb>;
};

/// Blue below, pale grey in the middle, red above; equally dark at both ends and distinct for the
/// colour-blind. For errors whose sign matters: `t` = ½ + error / (2 limit).
struct DivergingMap {
  Rgb operator()(double t) const {
    static constexpr std::array<Rgb, 7> kStops{{{24, 58, 128},
                                                {53, 117, 182},
                                                {142, 188, 222},
                                                {232, 230, 226},
                                                {243, 170, 132},
                                                {206, 86, 64},
                                                {125, 20, 44}}};
    return detail::interpolate_colors(kStops, std::isnan(t) ? 0.5 : t);
  }
};
/// Dark violet to bright yellow, its lightness rising evenly. For quantities with a natural zero.
struct SequentialMap {
  Rgb operator()(double t) const {
    static constexpr std::array<Rgb, 5> kStops{
        {{58, 12, 92}, {60, 79, 140}, {33, 145, 140}, {116, 202, 95}, {250, 228, 60}}};
    return detail::interpolate_colors(kStops, std::isnan(t) ? 0.0 : t);
  }
};
static_assert(ColorMap<DivergingMap> && ColorMap<SequentialMap>);

/// The colour of a signed error, saturated at ±`limit`; grey if it is not a number.
inline Rgb signed_error_color(double error, double limit) {
  if (std::isnan(error)) return {150, 150, 150};
  return DivergingMap{}(0.5 + 0.5 * error / limit);
}

/// The `i`-th of eight colours that are told apart by the colour-blind too; repeats after eight.
inline Rgb categorical_color(std::size_t i) {
  static constexpr std::array<Rgb, 8> kColors{{{0, 114, 178},
                                               {213, 94, 0},
                                               {0, 145, 106},
                                               {178, 88, 150},
                                               {196, 138, 0},
                                               {70, 160, 215},
                                               {120, 94, 60},
                                               {105, 105, 115}}};
  return kColors[i % kColors.size()];
}

/// `#rrggbb`.
inline std::string css_color(Rgb c) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", unsigned{c[0]}, unsigned{c[1]}, unsigned{c[2]});
  return text;
}
}  // namespace surfleet
