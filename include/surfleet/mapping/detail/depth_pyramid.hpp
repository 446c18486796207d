// SPDX-License-Identifier: MIT
/// @file
/// @brief Smallest and largest depth in any rectangle of an image, in a few look-ups.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <surfleet/core/parallel.hpp>

namespace surfleet::detail {
/// Extremes over square windows of 1, 2, 4, … tiles of 4 × 4 pixels, one window at every tile.
///
/// Building costs O(pixels + tiles · log tiles); a query reads about four windows. Answers cover
/// whole tiles, so they may be looser than the rectangle, never tighter.
class DepthPyramid {
 public:
  static constexpr int kTile = 4;

  /// Prepares for an image of the given size; then fill every tile row, then `finish`.
  void resize(int width, int height) {
    tiles_x_ = (width + kTile - 1) / kTile;
    tiles_y_ = (height + kTile - 1) / kTile;
    levels_ = bits(std::min(tiles_x_, tiles_y_));
    const std::size_t n = tiles() * static_cast<std::size_t>(levels_);
    min_.resize(n);
    max_.resize(n);
  }
  int tile_rows() const { return tiles_y_; }

  /// Takes tile row `ty` from the first of its `rows` rows of depths, which are `width` long.
  void fill_row(int ty, const float* depth, int width, int rows) {
    // Columns first, over stretches of a fixed length, which becomes vector code.
    constexpr int kStretch = 16 * kTile;
    std::array<float, kStretch> low, high;
    for (int u0 = 0; u0 < width; u0 += kStretch) {
      const int n = std::min(width - u0, kStretch);
      low.fill(std::numeric_limits<float>::infinity());
      high.fill(-std::numeric_limits<float>::infinity());
      for (int r = 0; r < rows; ++r) {
        const float* d = depth + row(r, width) + static_cast<std::size_t>(u0);
        if (n == kStretch)
          fold(d, kStretch, low.data(), high.data());
        else
          fold(d, n, low.data(), high.data());
      }
      const std::size_t first = row(ty, tiles_x_) + static_cast<std::size_t>(u0 / kTile);
      const std::size_t tiles = static_cast<std::size_t>((n + kTile - 1) / kTile);
      for (std::size_t t = 0; t < tiles; ++t) {
        const float *a = low.data() + t * kTile, *b = high.data() + t * kTile;
        min_[first + t] = std::min(std::min(a[0], a[1]), std::min(a[2], a[3]));
        max_[first + t] = std::max(std::max(b[0], b[1]), std::max(b[2], b[3]));
      }
    }
  }
  void finish() {
    for (int k = 1; k < levels_; ++k) {
      const int half = 1 << (k - 1);
      float* low = min_.data() + tiles() * static_cast<std::size_t>(k);
      float* high = max_.data() + tiles() * static_cast<std::size_t>(k);
      const float* low0 = low - tiles();
      const float* high0 = high - tiles();
      for (int y = 0; y + 2 * half <= tiles_y_; ++y) {
        const std::size_t a = row(y, tiles_x_), b = row(y + half, tiles_x_);
        const auto h = static_cast<std::size_t>(half);
        const auto n = static_cast<std::size_t>(std::max(0, tiles_x_ - 2 * half + 1));
        const auto least = [](float p, float q) { return std::min(p, q); };
        const auto most = [](float p, float q) { return std::max(p, q); };
        combine(low0 + a, low0 + b, h, n, low + a, least);
        combine(high0 + a, high0 + b, h, n, high + a, most);
      }
    }
  }

  /// Smallest and largest depth over pixels [u0, u1] × [v0, v1], which lie in the image.
  std::pair<float, float> extremes(int u0, int v0, int u1, int v1) const {
    const int a0 = u0 / kTile, a1 = u1 / kTile, b0 = v0 / kTile, b1 = v1 / kTile;
    const int k = bits(std::min(a1 - a0, b1 - b0) + 1) - 1;
    const int side = 1 << k;
    const float* low = min_.data() + tiles() * static_cast<std::size_t>(k);
    const float* high = max_.data() + tiles() * static_cast<std::size_t>(k);
    float lowest = low[row(b0, tiles_x_) + static_cast<std::size_t>(a0)];
    float highest = high[row(b0, tiles_x_) + static_cast<std::size_t>(a0)];
    for (int y = b0; y <= b1; y += side) {
      const std::size_t r = row(std::min(y, b1 + 1 - side), tiles_x_);
      for (int x = a0; x <= a1; x += side) {
        const std::size_t i = r + static_cast<std::size_t>(std::min(x, a1 + 1 - side));
        lowest = std::min(lowest, low[i]);
        highest = std::max(highest, high[i]);
      }
    }
    return {lowest, highest};
  }

 private:
  static int bits(int n) { return static_cast<int>(std::bit_width(static_cast<unsigned>(n))); }
  static void fold(const float* d, int n, float* low, float* high) {
    for (int i = 0; i < n; ++i) {
      low[i] = std::min(low[i], d[i]);
      high[i] = std::max(high[i], d[i]);
    }
  }
  /// Windows of twice the size from two rows of windows; one output a loop becomes vector code.
  template <typename Choice>
  static void combine(const float* top, const float* bottom, std::size_t half, std::size_t n,
                      float* out, Choice&& choose) {
    for (std::size_t x = 0; x < n; ++x)
      out[x] = choose(choose(top[x], top[x + half]), choose(bottom[x], bottom[x + half]));
  }
  static std::size_t row(int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
  std::size_t tiles() const { return row(tiles_y_, tiles_x_); }

  int tiles_x_ = 0, tiles_y_ = 0, levels_ = 0;
  std::vector<float> min_, max_;
};
}  // namespace surfleet::detail
