// SPDX-License-Identifier: MIT
/// @file
/// @brief One pinhole view of depths as the projective update works with it: which blocks it
/// concerns, and what it says of each of their voxels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <surfleet/mapping/detail/depth_pyramid.hpp>
#include <surfleet/mapping/detail/pixel_slopes.hpp>
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

enum class Visibility : std::uint8_t { none, mixed, free };

/// A block a view may concern; `free` if all its voxels lie before every surface.
struct ViewedBlock {
  BlockIndex index;
  std::uint32_t slot;
  bool free;
};

/// Finds the blocks of a view by halving cubes of blocks: cubes outside the view or wholly hidden
/// are dropped at once, cubes wholly before every surface taken at once.
class ViewedBlockSearch {
 public:
  ViewedBlockSearch(const ProjectiveView& view, const TsdfMap& map, double truncation, bool carve)
      : view_(view), map_(map), truncation_(truncation), carve_(carve) {
    const Pose T = view.T_world_camera.inverse(Eigen::Isometry);
    const double block = map.voxel_size() * TsdfMap::kBlockSide;
    axes_ = T.linear() * block;
    shift_ = T.translation();
    rotation_ = T.linear();
    // Voxel centres lie half a voxel inside the faces of a cube of blocks.
    inset_ = map.voxel_size() * 0.5;
    const double half = 0.5 - view.margin;
    const double left = (-half - view.cx) / view.fx, top = (-half - view.cy) / view.fy;
    const double right = (view.width - 1 + half - view.cx) / view.fx;
    const double bottom = (view.height - 1 + half - view.cy) / view.fy;
    sides_ = {Eigen::Vector3d(1, 0, -left), Eigen::Vector3d(-1, 0, right),
              Eigen::Vector3d(0, 1, -top), Eigen::Vector3d(0, -1, bottom)};
    const auto deepest = view.pyramid.extremes(0, 0, view.width - 1, view.height - 1).second;
    far_ = std::min<double>({view.z_limit, view.range_limit, std::max(0.0F, deepest)}) + truncation;
    bounds_.extend(view.T_world_camera.translation());
    for (const double x : {left, right})
      for (const double y : {top, bottom})
        bounds_.extend(view.T_world_camera * Point3(x * far_, y * far_, far_));
    nothing_ = deepest <= 0.0F;
  }

  /// In an order that depends on the view alone.
  void run(std::vector<ViewedBlock>& found) {
    found.clear();
    if (nothing_) return;
    low_ = TsdfMap::block_of(map_.index_of(bounds_.min()));
    high_ = TsdfMap::block_of(map_.index_of(bounds_.max()));
    int level = 0;
    while ((1 << level) <= (high_ - low_).maxCoeff()) ++level;
    visit(low_, level, found);
  }

 private:
  void visit(const BlockIndex& at, int level, std::vector<ViewedBlock>& found) {
    if ((at.array() > high_.array()).any()) return;
    const Visibility v = classify(at, 1 << level);
    if (v == Visibility::none) return;
    if (v == Visibility::free || level == 0) {
      const int n = 1 << level;
      for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
          for (int x = 0; x < n; ++x) {
            const BlockIndex b = at + BlockIndex(x, y, z);
            found.push_back({b, map_.find_slot(b), v == Visibility::free});
          }
      return;
    }
    const int half = 1 << (level - 1);
    for (int child = 0; child < 8; ++child)
      visit(at + half * BlockIndex(child & 1, (child >> 1) & 1, child >> 2), level - 1, found);
  }

  Visibility classify(const BlockIndex& at, int side) const {
    const Eigen::Vector3d corner =
        axes_ * at.cast<double>() + shift_ + rotation_ * Eigen::Vector3d::Constant(inset_);
    const Eigen::Matrix3d edges = axes_ * side - rotation_ * (2.0 * inset_);
    const Eigen::Vector3d low = corner + edges.cwiseMin(0.0).rowwise().sum();
    const Eigen::Vector3d high = corner + edges.cwiseMax(0.0).rowwise().sum();
    if (high.z() <= kNearPlane || low.z() > far_) return Visibility::none;
    for (const Eigen::Vector3d& n : sides_)
      if (n.dot(corner) + (n.transpose() * edges).cwiseMax(0.0).sum() < 0.0)
        return Visibility::none;
    const Eigen::Vector3d nearest = low.cwiseMax(0.0) + high.cwiseMin(0.0);
    if (nearest.norm() > view_.range_limit + truncation_) return Visibility::none;
    if (low.z() <= kNearPlane) return Visibility::mixed;

    double u0 = 1e30, u1 = -1e30, v0 = 1e30, v1 = -1e30;
    for (int c = 0; c < 8; ++c) {
      Eigen::Vector3d p = corner;
      for (int i = 0; i < 3; ++i)
        if ((c >> i & 1) != 0) p += edges.col(i);
      const double u = view_.fx * p.x() / p.z() + view_.cx;
      const double v = view_.fy * p.y() / p.z() + view_.cy;
      u0 = std::min(u0, u), u1 = std::max(u1, u);
      v0 = std::min(v0, v), v1 = std::max(v1, v);
    }
    // The pixels whose centre is nearest to any point of the rectangle, with room for rounding.
    const auto pixel = [](double x, double round, int n) {
      return static_cast<int>(std::floor(std::clamp(x + round, -1.0, n + 1.0)));
    };
    const int a = pixel(u0, 0.49, view_.width), b = pixel(v0, 0.49, view_.height);
    const int c = pixel(u1, 0.51, view_.width), d = pixel(v1, 0.51, view_.height);
    const int m = view_.margin;
    const bool inside = a >= m && b >= m && c < view_.width - m && d < view_.height - m;
    const int ua = std::max(a, 0), va = std::max(b, 0);
    const int ub = std::min(c, view_.width - 1), vb = std::min(d, view_.height - 1);
    if (ua > ub || va > vb) return Visibility::none;
    const auto [shallowest, deepest] = view_.pyramid.extremes(ua, va, ub, vb);
    if (deepest < low.z() - truncation_) return Visibility::none;
    const double limit = std::max<double>(view_.z_limit, 0.0);
    if (inside && shallowest >= high.z() + kSlantReach * truncation_ && high.z() <= limit) {
      const Eigen::Vector3d farthest = low.cwiseAbs().cwiseMax(high.cwiseAbs());
      if (farthest.norm() <= view_.range_limit) return carve_ ? Visibility::free : Visibility::none;
    }
    return Visibility::mixed;
  }

  const ProjectiveView& view_;
  const TsdfMap& map_;
  double truncation_, inset_ = 0.0, far_ = 0.0;
  bool carve_, nothing_ = false;
  Eigen::Matrix3d axes_, rotation_;
  Eigen::Vector3d shift_;
  std::array<Eigen::Vector3d, 4> sides_;
  Box3 bounds_;
  BlockIndex low_, high_;
};

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
