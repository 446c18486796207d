// SPDX-License-Identifier: MIT
#include <surfleet/mapping/detail/depth_pyramid.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
/// Every answer lies between the extremes of the rectangle and those of the tiles it touches.
void pyramid_laws(int width, int height) {
  using detail::DepthPyramid;
  constexpr int kTile = DepthPyramid::kTile;
  Random random(static_cast<std::uint64_t>(width * 1000 + height));
  std::vector<float> depth(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto at = [&](int u, int v) {
    return depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(u)];
  };
  for (float& d : depth) d = static_cast<float>(random.uniform(-1.0, 9.0));

  DepthPyramid pyramid;
  pyramid.resize(width, height);
  for (int ty = 0; ty < pyramid.tile_rows(); ++ty)
    pyramid.fill_row(ty,
                     &depth[static_cast<std::size_t>(ty * kTile) * static_cast<std::size_t>(width)],
                     width, std::min(kTile, height - ty * kTile));
  pyramid.finish();

  const auto extremes = [&](int u0, int v0, int u1, int v1) {
    std::pair<float, float> e{at(u0, v0), at(u0, v0)};
    for (int v = v0; v <= v1; ++v)
      for (int u = u0; u <= u1; ++u)
        e = {std::min(e.first, at(u, v)), std::max(e.second, at(u, v))};
    return e;
  };
  const auto draw = [&](int n) {
    return static_cast<int>(random.below(static_cast<std::uint64_t>(n)));
  };
  for (int i = 0; i < 200; ++i) {
    const auto [u0, u1] = std::minmax({draw(width), draw(width)});
    const auto [v0, v1] = std::minmax({draw(height), draw(height)});
    const auto found = pyramid.extremes(u0, v0, u1, v1);
    const auto inner = extremes(u0, v0, u1, v1);
    const auto outer = extremes(u0 / kTile * kTile, v0 / kTile * kTile,
                                std::min(width - 1, u1 / kTile * kTile + kTile - 1),
                                std::min(height - 1, v1 / kTile * kTile + kTile - 1));
    CHECK(found.first <= inner.first && found.second >= inner.second);
    CHECK(found == outer);
  }
}

TEST(extremes_of_rectangles_against_every_pixel) {
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{
           {1, 1}, {3, 2}, {4, 4}, {5, 9}, {64, 48}, {65, 3}, {160, 92}, {203, 131}})
    pyramid_laws(width, height);
}
}  // namespace
