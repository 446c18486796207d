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

/// In front of a surface seen at a slant the distance along the ray is much longer than the
/// distance to the surface: up to this many truncations the tangent plane is asked, lest free space
/// at a grazing angle eats into what it grazes.
inline constexpr double kSlantReach = 5.0;
}  // namespace surfleet::detail
