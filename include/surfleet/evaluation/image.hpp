// SPDX-License-Identifier: MIT
/// @file
/// @brief An RGB picture in memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/error.hpp>

namespace surfleet {
/// An sRGB colour.
using Rgb = std::array<std::uint8_t, 3>;

/// Rows from the top, pixels from the left, three bytes (sRGB) each.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  Image() = default;
  /// Throws `Error` unless both sides are in [1, 32768].
  Image(int w, int h, Rgb fill = {255, 255, 255}) : width(w), height(h) {
    require(w > 0 && h > 0 && w <= 32768 && h <= 32768,
            "picture size: expected 1 to 32768 pixels a side");
    rgb.resize(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = fill[i % 3];
  }

  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x));
  }
  Rgb operator()(int x, int y) const {
    const std::size_t i = offset(x, y);
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
  void set(int x, int y, Rgb color) {
    const std::size_t i = offset(x, y);
    for (std::size_t k = 0; k < 3; ++k) rgb[i + k] = color[k];
  }
};
}  // namespace surfleet
