// SPDX-License-Identifier: MIT
/// @file
/// @brief What a view says of each voxel of a block, and how that is folded into the voxels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <surfleet/mapping/detail/projective_view.hpp>
#include <surfleet/mapping/detail/vector_code.hpp>
#include <surfleet/mapping/update_policy.hpp>

namespace surfleet::detail {
/// What a view says of the voxels of one block, slice by slice of constant z index.
class BlockObserver {
 public:
  static constexpr int kSide = TsdfMap::kBlockSide;
  static constexpr int kSlice = kSide * kSide;

  BlockObserver(const ProjectiveView& view, const TsdfOptions& options, double voxel_size,
                const BlockIndex& block)
      : view_(view),
        truncation_(static_cast<float>(options.truncation)),
        half_voxel_(static_cast<float>(0.5 * voxel_size)),
        carve_(options.carve_free_space) {
    // In double as far as the block, so that precision does not fade away from the origin.
    const Eigen::Matrix3d R = view.T_world_camera.linear().transpose() * voxel_size;
    const Eigen::Vector3d first =
        (block.cast<double>() * kSide + Eigen::Vector3d::Constant(0.5)) * voxel_size;
    start_ =
        (view.T_world_camera.linear().transpose() * (first - view.T_world_camera.translation()))
            .cast<float>();
    step_ = R.cast<float>();
  }

  std::array<float, kSlice> squared_range;  ///< Of the voxels of the slice last looked at [m²].
  std::array<float, kSlice> sdf;            ///< Truncated signed distance [m].
  std::array<float, kSlice> seen;           ///< 1 where the view says something, else 0.

  /// Squared ranges alone.
  void measure_ranges(int z) {
    const Eigen::Vector3f base = start_ + step_.col(2) * static_cast<float>(z);
    for (int i = 0; i < kSlice; ++i) {
      const auto x = static_cast<float>(i % kSide), y = static_cast<float>(i / kSide);
      const float px = base.x() + x * step_(0, 0) + y * step_(0, 1);
      const float py = base.y() + x * step_(1, 0) + y * step_(1, 1);
      const float pz = base.z() + x * step_(2, 0) + y * step_(2, 1);
      squared_range[static_cast<std::size_t>(i)] = px * px + py * py + pz * pz;
    }
  }

  /// Everything; false if the view says nothing of the slice.
  bool observe(int z) {
    // All that the loops ask for is kept in locals, so that they become vector code: of a member
    // the compiler cannot know that no store changes it.
    const float w = static_cast<float>(view_.width), h = static_cast<float>(view_.height);
    const float m = static_cast<float>(view_.margin), right = w - m, bottom = h - m;
    const float fx = view_.fx, fy = view_.fy, cx = view_.cx, cy = view_.cy;
    const float z_limit = view_.z_limit, range_limit = view_.range_limit;
    const float truncation = truncation_;
    const std::int32_t width = view_.width;
    const Eigen::Matrix3f step = step_;
    const Eigen::Vector3f base = start_ + step.col(2) * static_cast<float>(z);
    const auto nowhere = static_cast<std::int32_t>(view_.pixels());
    std::array<float, kSlice> across, down, depth, divisor, u, v, inverse, range2, range, distance,
        said;
    std::array<std::int32_t, kSlice> pixel;
    for (std::int32_t i = 0; i < kSlice; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const auto x = static_cast<float>(i % kSide), y = static_cast<float>(i / kSide);
      const float px = base.x() + x * step(0, 0) + y * step(0, 1);
      const float py = base.y() + x * step(1, 0) + y * step(1, 1);
      const float pz = base.z() + x * step(2, 0) + y * step(2, 1);
      range2[n] = px * px + py * py + pz * pz;
      across[n] = px;
      down[n] = py;
      depth[n] = pz;
      divisor[n] = larger(pz, kNearPlane);
    }
    for (std::size_t i = 0; i < kSlice; ++i) {
      const float scale = 1.0F / divisor[i];
      // Shifted by half a pixel, so that truncation finds the nearest centre.
      const float su = smaller(larger(fx * across[i] * scale + cx + 0.5F, -1.0F), w);
      const float sv = smaller(larger(fy * down[i] * scale + cy + 0.5F, -1.0F), h);
      const int in = int(depth[i] > kNearPlane) & int(su >= m) & int(sv >= m) & int(su < right) &
                     int(sv < bottom);
      const auto iu = static_cast<std::int32_t>(su), iv = static_cast<std::int32_t>(sv);
      pixel[i] = nowhere + in * (iv * width + iu - nowhere);
      u[i] = su - 0.5F;
      v[i] = sv - 0.5F;
    }
    if (view_.cube_axis >= 0) share_borders(across, down, depth, u, v, pixel);
    const float* const inverse_depth = view_.inverse_depth.data();
    for (std::size_t i = 0; i < kSlice; ++i)
      inverse[i] = inverse_depth[static_cast<std::size_t>(pixel[i])];
    for (std::size_t i = 0; i < kSlice; ++i) range[i] = std::sqrt(range2[i]);
    // Along the ray: the difference of depths, scaled by the ray's length at unit depth. A surface
    // beyond the range counts as far as the range goes, so never from behind.
    int any = 0;
    const float slant = static_cast<float>(kSlantReach) * truncation;
    const float carve_from = carve_ ? std::numeric_limits<float>::max() : truncation;
    for (std::size_t i = 0; i < kSlice; ++i) {
      const float surface = 1.0F / inverse[i];
      const float d = (surface - depth[i]) * (range[i] / divisor[i]);
      const int in_range = int(depth[i] <= z_limit) & int(range[i] <= range_limit);
      const int measured = int(surface <= z_limit) & int(range[i] + d <= range_limit);
      const int front = in_range & int(d > 0.0F) & int(d < carve_from);
      const int band = measured & int(std::abs(d) < truncation);
      distance[i] = smaller(d, slant);
      const int says = front | band;
      said[i] = says != 0 ? 1.0F : 0.0F;
      any |= says;
    }
    squared_range = range2;
    sdf = distance;
    seen = said;
    if (any == 0) return false;
    if (!view_.planes.empty()) {
      const SurfacePlane* const planes = view_.planes.data();
      std::array<float, kSlice> plane;
      for (std::size_t i = 0; i < kSlice; ++i) {
        const SurfacePlane& p = planes[static_cast<std::size_t>(pixel[i])];
        const float d = p.offset - p.nx * across[i] - p.ny * down[i] - p.nz * depth[i];
        plane[i] = smaller(larger(d, -truncation), truncation);
      }
      for (std::size_t i = 0; i < kSlice; ++i)
        distance[i] = std::abs(distance[i]) < slant ? plane[i] : distance[i];
      for (std::size_t i = 0; i < kSlice; ++i) sdf[i] = smaller(distance[i], truncation);
      return true;
    }
    for (std::size_t i = 0; i < kSlice; ++i)
      if (std::abs(sdf[i]) < slant && seen[i] > 0.0F) refine(i, u[i], v[i], depth[i]);
    for (std::size_t i = 0; i < kSlice; ++i) sdf[i] = smaller(sdf[i], truncation);
    return true;
  }

 private:
  using Slice = std::array<float, kSlice>;

  /// On the border of two faces of a cube rounded pixels may say that a voxel is of both or of
  /// neither. There the coordinates decide, which are the same numbers in the frames of all faces:
  /// a voxel is of the first axis that has the largest.
  void share_borders(const Slice& across, const Slice& down, const Slice& depth, const Slice& u,
                     const Slice& v, std::array<std::int32_t, kSlice>& pixel) const {
    constexpr float kClose = 1e-4F;  // beside rounding
    int close = 0;
    for (std::size_t i = 0; i < kSlice; ++i) {
      const float near = kClose * std::abs(depth[i]);
      close |= int(std::abs(std::abs(across[i]) - depth[i]) <= near) |
               int(std::abs(std::abs(down[i]) - depth[i]) <= near);
    }
    if (close == 0) return;
    // Whether the other axis comes first.
    const bool across_wins = view_.cube_axis == 2, down_wins = view_.cube_axis > 0;
    for (std::size_t i = 0; i < kSlice; ++i) {
      const float x = std::abs(across[i]), y = std::abs(down[i]), face = depth[i];
      const bool mine = face > kNearPlane && (across_wins ? x < face : x <= face) &&
                        (down_wins ? y < face : y <= face);
      pixel[i] = mine ? static_cast<std::int32_t>(v[i] + 0.5F) * view_.width +
                            static_cast<std::int32_t>(u[i] + 0.5F)
                      : static_cast<std::int32_t>(view_.pixels());
    }
  }
  /// Interpolates between the four pixels around, where they show one surface, and turns the
  /// distance along the ray into the distance to the surface's tangent plane. Beside a jump of
  /// depth the nearest pixel's own surface is continued, so that edges are not smeared.
  void refine(std::size_t i, float u, float v, float depth) {
    const auto nu = static_cast<std::int32_t>(u + 0.5F), nv = static_cast<std::int32_t>(v + 0.5F);
    const float* pixel =
        view_.inverse_depth.data() + static_cast<std::ptrdiff_t>(nv) * view_.width + nu;
    // The plane q · p = 1 through the surface point, from slopes over half a voxel's width.
    const float pixels = half_voxel_ * *pixel;
    const float gu =
        pixel_slope(pixel, nu, view_.width, 1, pixels * view_.fx, view_.max_step_u).value;
    const float gv =
        pixel_slope(pixel, nv, view_.height, view_.width, pixels * view_.fy, view_.max_step_v)
            .value;
    float surface = *pixel + gu * (u - static_cast<float>(nu)) + gv * (v - static_cast<float>(nv));

    const auto u0 = static_cast<std::int32_t>(std::max(u, 0.0F));
    const auto v0 = static_cast<std::int32_t>(std::max(v, 0.0F));
    if (u >= 0.0F && v >= 0.0F && u0 + 1 < view_.width && v0 + 1 < view_.height) {
      const float* row =
          view_.inverse_depth.data() + static_cast<std::ptrdiff_t>(v0) * view_.width + u0;
      const float a = row[0], b = row[1], c = row[view_.width], d = row[view_.width + 1];
      const float low = std::min(std::min(a, b), std::min(c, d));
      const float high = std::max(std::max(a, b), std::max(c, d));
      if ((low > 0.0F) & (high - low <= (view_.max_step_u + view_.max_step_v) * high)) {
        const float s = u - static_cast<float>(u0), t = v - static_cast<float>(v0);
        const float top = a + (b - a) * s, bottom = c + (d - c) * s;
        surface = top + (bottom - top) * t;
      }
    }
    const float qx = gu * view_.fx, qy = gv * view_.fy;
    const float qz = surface - gu * (u - view_.cx) - gv * (v - view_.cy);
    const float distance = (1.0F - depth * surface) / std::sqrt(qx * qx + qy * qy + qz * qz);
    sdf[i] = std::clamp(distance, -truncation_, truncation_);
  }

  const ProjectiveView& view_;
  float truncation_, half_voxel_;
  bool carve_;
  Eigen::Vector3f start_;
  Eigen::Matrix3f step_;
};

/// Folds a slice of observations into voxels; true if any changed.
template <bool kFree, WeightPolicy Weight>
bool fuse_slice(TsdfVoxel* voxels, const BlockObserver& o, const Weight& weight, float truncation,
                float max_weight) {
  std::array<float, BlockObserver::kSlice> gain;
  for (std::size_t i = 0; i < gain.size(); ++i) {
    if constexpr (kFree)
      gain[i] = observation_weight(weight, truncation, o.squared_range[i]);
    else
      gain[i] = observation_weight(weight, o.sdf[i], o.squared_range[i]) * o.seen[i];
  }
  float change = 0.0F;
  for (std::size_t i = 0; i < gain.size(); ++i) {
    const float d = voxels[i].distance, w = voxels[i].weight;
    const float sdf = kFree ? truncation : o.sdf[i];
    const float share = gain[i] / std::max(w + gain[i], 1e-30F);
    const float next_d = d + (sdf - d) * share;
    const float next_w = std::min(w + gain[i], max_weight);
    change = std::max(change, std::max(std::abs(next_d - d), std::abs(next_w - w)));
    voxels[i].distance = next_d;
    voxels[i].weight = next_w;
  }
  return change > 0.0F;
}
}  // namespace surfleet::detail
