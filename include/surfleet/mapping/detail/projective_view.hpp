// SPDX-License-Identifier: MIT
/// @file
/// @brief One pinhole view of depths as the projective update works with it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <surfleet/mapping/detail/depth_pyramid.hpp>
#include <surfleet/mapping/detail/vector_code.hpp>
#include <surfleet/mapping/update_policy.hpp>

namespace surfleet::detail {
/// Depth that stands for "no measurement"; no measured depth is as large.
inline constexpr float kNoDepth = -1e8F;
/// Points nearer to the camera's plane than this belong to no view [m].
inline constexpr float kNearPlane = 1e-3F;

/// The tangent plane of a pixel's surface, as `offset − n · p` for points p of the camera frame.
struct SurfacePlane {
  float nx = 0.0F, ny = 0.0F, nz = 0.0F, offset = 0.0F;
};

/// A pinhole image of depths along z with pixel centres at integers. Stored as inverse depths,
/// which are affine in pixel coordinates over a plane, so interpolating them is exact on planes.
struct ProjectiveView {
  int width = 0, height = 0;
  int margin = 0;  ///< Outer pixels that serve interpolation only: no voxel is theirs.
  /// Of a face of the cube around a scanner, the axis it stands on; −1 for an image. x and y of its
  /// frame lie along the next axes, or against them.
  int cube_axis = -1;
  float fx = 1, fy = 1, cx = 0, cy = 0;
  float z_limit = 0;                     ///< Nothing at greater depth is a surface or carved [m].
  float range_limit = 0;                 ///< The same for the distance from the sensor [m].
  float max_step_u = 0, max_step_v = 0;  ///< Relative change of inverse depth from pixel to pixel
                                         ///< up to which they count as one surface.
  Pose T_world_camera = Pose::Identity();
  std::vector<float> inverse_depth;  ///< Row by row, then one "no measurement".
  std::vector<SurfacePlane> planes;  ///< One a pixel and one more, where the maker knows them.
  DepthPyramid pyramid;

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  void set_slope_limit(double max_slope) {
    max_step_u = static_cast<float>(max_slope) / fx;
    max_step_v = static_cast<float>(max_slope) / fy;
  }
  /// Sets the size and asks `depth_row(v, out)` for the depths of every row.
  template <typename DepthRow>
  void fill(int threads, DepthRow&& depth_row) {
    inverse_depth.resize(pixels() + 1);
    inverse_depth.back() = 1.0F / kNoDepth;
    pyramid.resize(width, height);
    parallel_for(
        static_cast<std::size_t>(pyramid.tile_rows()), threads,
        [&](std::size_t ty) {
          const int v0 = static_cast<int>(ty) * DepthPyramid::kTile;
          const int rows = std::min(height - v0, DepthPyramid::kTile);
          const auto row = static_cast<std::size_t>(width);
          // Depths lie where their inverses will, a few rows at a time.
          float* const first = inverse_depth.data() + static_cast<std::size_t>(v0) * row;
          float* const end = first + static_cast<std::size_t>(rows) * row;
          for (int r = 0; r < rows; ++r)
            depth_row(v0 + r, first + static_cast<std::size_t>(r) * row);
          pyramid.fill_row(static_cast<int>(ty), first, width, rows);
          for (float* d = first; d != end; ++d) *d = 1.0F / *d;
        },
        2);
    pyramid.finish();
  }
};

/// In front of a surface seen at a slant the way along the ray is much longer than the distance to
/// the surface: up to this many truncations the tangent plane is asked, lest free space at a
/// grazing angle eats into what it grazes.
inline constexpr double kSlantReach = 5.0;

/// Change of inverse depth a pixel along an image axis; not `known` if neither side tells.
struct PixelSlope {
  float value = 0.0F;
  bool known = false;
};
/// The slope along one image axis from `at`, whose coordinate on it is `x`, to `reach` pixels
/// either side; the straighter side counts more, so that beside a crease the surface the pixel lies
/// on prevails.
inline PixelSlope pixel_slope(const float* at, std::int32_t x, std::int32_t size,
                              std::int32_t stride, float reach, float max_step) {
  const std::int32_t n = std::clamp(static_cast<std::int32_t>(reach + 0.5F), 1, 64);
  const std::int32_t half = (n + 1) / 2;
  const float center = *at;
  const float per_n = 1.0F / static_cast<float>(n), per_half = 1.0F / static_cast<float>(half);
  const float limit = max_step * center, per_limit = 1.0F / limit;
  float sum = 0.0F, weights = 0.0F;
  // Noise decides what counts: factors in place of branches that nobody could foresee.
  for (const std::int32_t side : {-1, 1}) {
    const std::int32_t end = x + side * n;
    const int inside = int(end >= 0) & int(end < size);
    const float far = at[inside * side * n * stride], near = at[inside * side * half * stride];
    const float rise = (far - center) * per_n, start = (near - center) * per_half;
    const int counts = inside & int(far > 0.0F) & int(near > 0.0F) & int(std::abs(rise) <= limit) &
                       int(std::abs(start) <= limit);
    const float bend = std::abs(rise - start) * per_limit + 1e-3F;
    const float weight = one_if(counts) / (bend * bend);
    sum += weight * rise * static_cast<float>(side);
    weights += weight;
  }
  return weights > 0.0F ? PixelSlope{sum / weights, true} : PixelSlope{};
}
}  // namespace surfleet::detail
