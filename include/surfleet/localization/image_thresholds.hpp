// SPDX-License-Identifier: MIT
/// @file
/// @brief The grey levels that part markers from the rest of an image: Otsu's, and one from the
/// spread of the background [004 §9.4.2].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <surfleet/geometry/grey_image.hpp>

namespace surfleet {
/// A window of pixels: from (left, top) to before (right, bottom).
struct PixelWindow {
  int left = 0, top = 0, right = 0, bottom = 0;

  static PixelWindow whole(const GreyImage& image) { return {0, 0, image.width, image.height}; }
  bool empty() const { return left >= right || top >= bottom; }
  PixelWindow inflated(int by) const { return {left - by, top - by, right + by, bottom + by}; }
  PixelWindow clipped(const PixelWindow& to) const {
    return {std::max(left, to.left), std::max(top, to.top), std::min(right, to.right),
            std::min(bottom, to.bottom)};
  }
};

/// How many pixels have each grey level.
using GreyHistogram = std::array<std::uint32_t, 256>;

/// O(pixels).
inline GreyHistogram grey_histogram(const GreyImage& image, const PixelWindow& window) {
  // Neighbours are often alike; four tables keep their counts from waiting for one another.
  std::array<GreyHistogram, 4> part{};
  for (int v = window.top; v < window.bottom; ++v) {
    const std::uint8_t* row = image.row(v);
    int u = window.left;
    for (; u + 4 <= window.right; u += 4)
      for (int k = 0; k < 4; ++k) ++part[static_cast<std::size_t>(k)][row[u + k]];
    for (; u < window.right; ++u) ++part[0][row[u]];
  }
  GreyHistogram sum{};
  for (const GreyHistogram& p : part)
    for (std::size_t g = 0; g < 256; ++g) sum[g] += p[g];
  return sum;
}

/// Otsu's threshold: levels above it are the brighter class of the two with the largest variance
/// between them. The middle of the levels that are as good. O(256).
inline int otsu_threshold(const GreyHistogram& histogram) {
  double count = 0.0, total = 0.0;
  for (std::size_t g = 0; g < 256; ++g) {
    count += histogram[g];
    total += static_cast<double>(g) * histogram[g];
  }
  double below = 0.0, sum = 0.0, best = 0.0;
  int first = 0, last = 0;
  for (std::size_t g = 0; g < 255; ++g) {
    below += histogram[g];
    sum += static_cast<double>(g) * histogram[g];
    const double above = count - below;
    if (below == 0.0 || above == 0.0) continue;
    const double gap = sum / below - (total - sum) / above;
    const double between = below * above * gap * gap;
    if (between > best * (1.0 + 1e-12)) {
      best = between;
      first = last = static_cast<int>(g);
    } else if (best > 0.0 && between >= best * (1.0 - 1e-12)) {
      last = static_cast<int>(g);
    }
  }
  return (first + last) / 2;
}

/// Mean and standard deviation of the background's grey levels.
struct GreyBackground {
  double mean = 0.0, deviation = 0.0;
};
/// A Gaussian fitted to the histogram, of which levels beyond three deviations are left out again
/// and again: there are many more pixels of the background than of markers. O(256).
inline GreyBackground fit_background(const GreyHistogram& histogram) {
  double low = 0.0, high = 255.0;
  GreyBackground fit;
  for (int round = 0; round < 12; ++round) {
    double count = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t g = 0; g < 256; ++g) {
      const auto level = static_cast<double>(g);
      if (level < low || level > high) continue;
      count += histogram[g];
      sum += level * histogram[g];
      squares += level * level * histogram[g];
    }
    if (count == 0.0) break;
    fit.mean = sum / count;
    fit.deviation = std::sqrt(std::max(0.0, squares / count - fit.mean * fit.mean));
    const double reach = std::max(3.0 * fit.deviation, 1.0);
    if (fit.mean - reach == low && fit.mean + reach == high) break;
    low = fit.mean - reach;
    high = fit.mean + reach;
  }
  return fit;
}
}  // namespace surfleet
