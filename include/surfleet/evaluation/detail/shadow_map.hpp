// SPDX-License-Identifier: MIT
/// @file
/// @brief What a sun lights: a picture of depths from where it stands.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/evaluation/detail/render_frame.hpp>
#include <surfleet/evaluation/render_view.hpp>

namespace surfleet::detail {
/// Depths along the light, and the share of it that arrives; all of it where there are none.
struct ShadowMap {
  RenderFrame frame;
  std::vector<float> depth;
  double texel = 0.0;
  /// Share of the light that arrives, softened over neighbouring texels.
  double light_at(const Point3& world, const Eigen::Vector3d& normal) const {
    if (depth.empty()) return 1.0;
    const Point3 p = frame.project(frame.to_camera(world + 2.0 * texel * normal));
    const int cx = static_cast<int>(std::lround(p.x())), cy = static_cast<int>(std::lround(p.y()));
    double lit = 0.0, weight = 0.0;
    for (int y = cy - 1; y <= cy + 1; ++y)
      for (int x = cx - 1; x <= cx + 1; ++x) {
        if (x < 0 || y < 0 || x >= frame.width || y >= frame.height) continue;
        weight += 1.0;
        if (depth[frame.index(x, y)] >= p.z() - 1.5 * texel) lit += 1.0;
      }
    return weight > 0.0 ? lit / weight : 1.0;
  }
};

/// The map of `casters`, all of them in the box `world`, lit from the direction `sun`.
inline ShadowMap make_shadow_map(std::span<const std::array<Point3, 3>> casters, const Box3& world,
                                 const Eigen::Vector3d& sun) {
  ShadowMap map;
  if (world.isEmpty()) return map;
  constexpr int kSide = 2048;
  const Eigen::Vector3d to_light = sun.normalized();
  RenderView view;
  view.target = world.center();
  view.orthographic_height = world.sizes().norm() * 1.01 + 1e-6;
  view.eye = view.target + 2.0 * view.orthographic_height * to_light;
  map.frame = RenderFrame(view, kSide, kSide);
  map.texel = view.orthographic_height / kSide;
  map.depth.assign(map.frame.pixels(), std::numeric_limits<float>::infinity());
  for (const auto& [a, b, c] : casters) {
    std::array<RenderCorner, 3> corners;
    corners[0].world = a;
    corners[1].world = b;
    corners[2].world = c;
    fill_triangle(map.frame, corners, [&](std::size_t i, double z, const auto&) {
      map.depth[i] = std::min(map.depth[i], static_cast<float>(z));
    });
  }
  return map;
}
}  // namespace surfleet::detail
