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

#include <surfleet/mapping/detail/pixel_slopes.hpp>
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

  std::array<float, kSlice> squared_range;  ///< Of the voxels of the last slice [m²].
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
    std::array<std::int32_t, kSlice + kPixelLanes> near;
    std::size_t count = 0;
    for (std::size_t i = 0; i < kSlice; ++i) {
      near[count] = static_cast<std::int32_t>(i);
      count += static_cast<std::size_t>(int(std::abs(sdf[i]) < slant) & int(seen[i] > 0.0F));
    }
    // The last ones are repeated to fill the lanes.
    for (std::size_t k = 0; count > 0 && k < kPixelLanes; ++k) near[count + k] = near[count - 1];
    for (std::size_t k = 0; k < count; k += kPixelLanes) refine(near.data() + k, u, v, depth);
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
  /// depth the nearest pixel's own surface is continued, so that edges are not smeared. For so many
  /// voxels at a time as there are lanes, some of which may be the same.
  void refine(const std::int32_t* voxels, const Slice& slice_u, const Slice& slice_v,
              const Slice& slice_depth) {
    using Lanes = PixelLanes<float>;
    using Whole = PixelLanes<std::int32_t>;
    const std::int32_t width = view_.width, height = view_.height;
    const float fx = view_.fx, fy = view_.fy, cx = view_.cx, cy = view_.cy;
    const float half_voxel = half_voxel_, truncation = truncation_;
    const float* const inverse = view_.inverse_depth.data();
    Lanes u, v, depth, center, reach_u, reach_v;
    Whole nu, nv, pixel, corner, in;
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      const auto n = static_cast<std::size_t>(voxels[i]);
      u[i] = slice_u[n];
      v[i] = slice_v[n];
      depth[i] = slice_depth[n];
    }
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      nu[i] = static_cast<std::int32_t>(u[i] + 0.5F);
      nv[i] = static_cast<std::int32_t>(v[i] + 0.5F);
      pixel[i] = nv[i] * width + nu[i];
      const auto u0 = static_cast<std::int32_t>(larger(u[i], 0.0F));
      const auto v0 = static_cast<std::int32_t>(larger(v[i], 0.0F));
      in[i] = int(u[i] >= 0.0F) & int(v[i] >= 0.0F) & int(u0 + 1 < width) & int(v0 + 1 < height);
      corner[i] = in[i] * (v0 * width + u0);
    }
    Lanes a, b, c, d;
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      center[i] = inverse[pixel[i]];
      const float* const row = inverse + corner[i];
      a[i] = row[0];
      b[i] = row[in[i]];
      c[i] = row[in[i] * width];
      d[i] = row[in[i] * width + in[i]];
    }
    // The plane q · p = 1 through the surface point, from slopes over half a voxel's width.
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      const float pixels = half_voxel * center[i];
      reach_u[i] = pixels * fx;
      reach_v[i] = pixels * fy;
    }
    const PixelSlopes gu = pixel_slopes({inverse, width, 1, view_.max_step_u}, pixel, nu, reach_u);
    const PixelSlopes gv =
        pixel_slopes({inverse, height, width, view_.max_step_v}, pixel, nv, reach_v);
    const float steepest = view_.max_step_u + view_.max_step_v;
    Lanes result;
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      const float own = center[i] + gu.value[i] * (u[i] - static_cast<float>(nu[i])) +
                        gv.value[i] * (v[i] - static_cast<float>(nv[i]));
      const float low = smaller(smaller(a[i], b[i]), smaller(c[i], d[i]));
      const float high = larger(larger(a[i], b[i]), larger(c[i], d[i]));
      const int one = in[i] & int(low > 0.0F) & int(high - low <= steepest * high);
      // Of what is in the image: where it is not, the fractions are not used.
      const float s = u[i] - static_cast<float>(static_cast<std::int32_t>(larger(u[i], 0.0F)));
      const float t = v[i] - static_cast<float>(static_cast<std::int32_t>(larger(v[i], 0.0F)));
      const float top = a[i] + (b[i] - a[i]) * s, bottom = c[i] + (d[i] - c[i]) * s;
      const float between = top + (bottom - top) * t;
      const float surface = one != 0 ? between : own;
      const float qx = gu.value[i] * fx, qy = gv.value[i] * fy;
      const float qz = surface - gu.value[i] * (u[i] - cx) - gv.value[i] * (v[i] - cy);
      const float distance = (1.0F - depth[i] * surface) / std::sqrt(qx * qx + qy * qy + qz * qz);
      result[i] = smaller(larger(distance, -truncation), truncation);
    }
    for (std::size_t i = 0; i < kPixelLanes; ++i)
      sdf[static_cast<std::size_t>(voxels[i])] = result[i];
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
