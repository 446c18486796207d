// SPDX-License-Identifier: MIT
#include <surfleet/mapping/detail/pixel_slopes.hpp>

#include <cmath>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;
using namespace surfleet::detail;

namespace {
struct Answer {
  float value = 0.0F;
  bool known = false;
};
/// One pixel at a time, with branches.
Answer slope_of(const std::vector<float>& image, int pixel, int x, const PixelAxis& axis,
                float reach) {
  const int n = std::clamp(static_cast<int>(reach + 0.5F), 1, 64), half = (n + 1) / 2;
  const auto at = [&](int steps) {
    return image[static_cast<std::size_t>(pixel + steps * axis.stride)];
  };
  float sum = 0.0F, weights = 0.0F;
  for (const int side : {-1, 1}) {
    if (x + side * n < 0 || x + side * n >= axis.size) continue;
    const float far = at(side * n), near = at(side * half), limit = axis.max_step * at(0);
    if (!(far > 0.0F && near > 0.0F)) continue;
    const float rise = (far - at(0)) / static_cast<float>(n);
    const float start = (near - at(0)) / static_cast<float>(half);
    if (std::abs(rise) > limit || std::abs(start) > limit) continue;
    const float bend = std::abs(rise - start) / limit + 1e-3F;
    sum += rise * static_cast<float>(side) / (bend * bend);
    weights += 1.0F / (bend * bend);
  }
  return weights > 0.0F ? Answer{sum / weights, true} : Answer{};
}
}  // namespace

TEST(pixel_slopes_are_those_of_one_pixel_at_a_time) {
  constexpr int kWidth = 23, kHeight = 17;
  Random random(11);
  for (int round = 0; round < 200; ++round) {
    std::vector<float> image(static_cast<std::size_t>(kWidth * kHeight));
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        float& d = image[static_cast<std::size_t>(v * kWidth + u)];
        d = 0.4F + 0.01F * static_cast<float>(u) - 0.005F * static_cast<float>(v) +
            0.01F * static_cast<float>(random.uniform());
        if (u > 12) d += 0.3F;                  // a jump
        if (random.below(20) == 0) d = -1e-8F;  // no measurement
      }
    const bool along_u = round % 2 == 0;
    const PixelAxis axis{image.data(), along_u ? kWidth : kHeight, along_u ? 1 : kWidth, 0.08F};
    PixelLanes<std::int32_t> pixel, x;
    PixelLanes<float> reach;
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      pixel[i] = static_cast<std::int32_t>(random.below(image.size()));
      x[i] = along_u ? pixel[i] % kWidth : pixel[i] / kWidth;
      reach[i] = static_cast<float>(8.0 * random.uniform());
    }
    const PixelSlopes slopes = pixel_slopes(axis, pixel, x, reach);
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      const Answer expected = slope_of(image, pixel[i], x[i], axis, reach[i]);
      CHECK((slopes.weight[i] > 0.0F) == expected.known);
      CHECK_NEAR(slopes.value[i], expected.value, 1e-5);
    }
  }
}

TEST(pixel_slopes_of_a_plane_are_exact_and_of_nothing_nought) {
  std::vector<float> image(64 * 8);
  for (int i = 0; i < 64 * 8; ++i)
    image[static_cast<std::size_t>(i)] = 0.5F + 0.002F * static_cast<float>(i % 64);
  PixelLanes<std::int32_t> pixel, x;
  PixelLanes<float> reach;
  for (std::size_t i = 0; i < kPixelLanes; ++i) {
    x[i] = static_cast<std::int32_t>(4 * i);
    pixel[i] = 3 * 64 + x[i];
    reach[i] = 3.0F;
  }
  const PixelSlopes slopes = pixel_slopes({image.data(), 64, 1, 0.1F}, pixel, x, reach);
  for (const float s : slopes.value) CHECK_NEAR(s, 0.002, 1e-6);
  const std::vector<float> nothing(64 * 8, -1e-8F);
  const PixelSlopes none = pixel_slopes({nothing.data(), 64, 1, 0.1F}, pixel, x, reach);
  for (std::size_t i = 0; i < kPixelLanes; ++i)
    CHECK(none.weight[i] == 0.0F && none.value[i] == 0.0F);
}
