// SPDX-License-Identifier: MIT
/// @file
/// @brief How a view's inverse depth changes from pixel to pixel, for many pixels at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <surfleet/mapping/detail/vector_code.hpp>

namespace surfleet::detail {
/// Pixels that are worked on together: two or four vector registers.
inline constexpr std::size_t kPixelLanes = 16;
template <typename T>
using PixelLanes = std::array<T, kPixelLanes>;

/// Change of inverse depth a pixel along an image axis.
struct PixelSlopes {
  PixelLanes<float> value{};
  PixelLanes<float> weight{};  ///< 0 where neither side tells; the value is then 0.
};

/// One axis of an image, for slopes along it.
struct PixelAxis {
  const float* image;   ///< Inverse depths.
  std::int32_t size;    ///< Pixels along the axis.
  std::int32_t stride;  ///< From one to the next.
  float max_step;       ///< Relative change a pixel up to which two count as one surface.
};

/// The slopes along one image axis at `pixel`, whose coordinate on it is `x`, to `reach` pixels
/// either side; the straighter side counts more, so that beside a crease the surface the pixel lies
/// on prevails.
///
/// Noise decides what counts: factors in place of branches that no predictor foresees, and loops
/// over the pixels that become vector code.
inline PixelSlopes pixel_slopes(const PixelAxis& axis, const PixelLanes<std::int32_t>& pixel,
                                const PixelLanes<std::int32_t>& x, const PixelLanes<float>& reach) {
  constexpr std::int32_t kFarthest = 64;  // pixels
  PixelLanes<std::int32_t> n, half, before, after;
  for (std::size_t i = 0; i < kPixelLanes; ++i) {
    const auto r = static_cast<std::int32_t>(reach[i] + 0.5F);
    const std::int32_t least = r < 1 ? 1 : r;
    n[i] = least > kFarthest ? kFarthest : least;
    half[i] = (n[i] + 1) / 2;
    before[i] = int(x[i] - n[i] >= 0);
    after[i] = int(x[i] + n[i] < axis.size);
  }
  PixelLanes<float> center, far_before, near_before, far_after, near_after;
  for (std::size_t i = 0; i < kPixelLanes; ++i) {
    const float* const at = axis.image + pixel[i];
    center[i] = *at;
    const std::int32_t back = before[i] * axis.stride, on = after[i] * axis.stride;
    far_before[i] = at[-back * n[i]];
    near_before[i] = at[-back * half[i]];
    far_after[i] = at[on * n[i]];
    near_after[i] = at[on * half[i]];
  }
  PixelSlopes slopes;
  PixelLanes<float> sum{};
  const auto take = [&](std::size_t i, float far, float near, int inside, float sign) {
    const float per_n = 1.0F / static_cast<float>(n[i]);
    const float per_half = 1.0F / static_cast<float>(half[i]);
    const float limit = axis.max_step * center[i], per_limit = 1.0F / limit;
    const float rise = (far - center[i]) * per_n, start = (near - center[i]) * per_half;
    const int counts = inside & int(far > 0.0F) & int(near > 0.0F) & int(std::abs(rise) <= limit) &
                       int(std::abs(start) <= limit);
    const float bend = std::abs(rise - start) * per_limit + 1e-3F;
    const float weight = one_if(counts) / (bend * bend);
    sum[i] += weight * rise * sign;
    slopes.weight[i] += weight;
  };
  for (std::size_t i = 0; i < kPixelLanes; ++i)
    take(i, far_before[i], near_before[i], before[i], -1.0F);
  for (std::size_t i = 0; i < kPixelLanes; ++i)
    take(i, far_after[i], near_after[i], after[i], 1.0F);
  for (std::size_t i = 0; i < kPixelLanes; ++i) {
    const float mean = sum[i] / larger(slopes.weight[i], 1e-30F);
    slopes.value[i] = slopes.weight[i] > 0.0F ? mean : 0.0F;
  }
  return slopes;
}
}  // namespace surfleet::detail
