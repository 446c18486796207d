// SPDX-License-Identifier: MIT
/// @file
/// @brief What one pinhole view says of surface hits: where its rays end, and which hits of the map
///        they pass through.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/mapping/detail/projective_view.hpp>
#include <surfleet/mapping/surface_hits.hpp>
#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet::detail {
/// The share of a voxel that a pixel may be wide to resolve what the voxel holds.
inline constexpr double kResolved = 0.25;

/// Sums the pixels of a view by voxel and side. O(pixels). Holds scratch memory.
class HitObserver {
 public:
  /// Hits of one voxel and side in one view.
  struct Sum {
    std::uint64_t key = 0;  ///< Of the voxel, from the camera's, and the side.
    std::int32_t count = 0;
    std::array<std::int32_t, 3> position{}, normal{};
  };

  /// Reads the view; `add_to` then puts what was read into a map.
  void read(const ProjectiveView& view, double voxel_size, int threads) {
    const Eigen::Vector3d eye = view.T_world_camera.translation() / voxel_size;
    base_ = eye.array().floor().cast<int>();
    const Eigen::Vector3f start = (eye - base_.cast<double>()).cast<float>();
    // Bounded, so that no image of however large pixels over small voxels overflows the sums.
    constexpr double kMost = 1e9;
    const double share = 1.0 / (static_cast<double>(view.fx) * static_cast<double>(view.fy) *
                                voxel_size * voxel_size * SurfaceHit::kWeightUnit);
    pixel_weight_ = std::max<std::int64_t>(1, std::llround(std::min(share, kMost)));
    pixels_.resize(view.pixels());
    const Eigen::Matrix3f R = view.T_world_camera.linear().cast<float>();
    const auto inverse_size = static_cast<float>(1.0 / voxel_size);
    parallel_for(
        static_cast<std::size_t>(view.height), threads,
        [&](std::size_t row) {
          const auto v = static_cast<int>(row);
          for (int u = 0; u < view.width; ++u)
            pixels_[row * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(u)] =
                pixel(view, R, start, inverse_size, u, v);
        },
        16);
    gather();
  }

  /// Calls `fn(block, offset, sum)` for each sum, those of one block in one run.
  template <typename Fn>
  void for_each(Fn&& fn) const {
    for (const std::uint32_t i : order_) {
      const Sum& s = sums_[i];
      const VoxelIndex v = voxel_of(s.key);
      fn(TsdfMap::block_of(v), SurfaceHits::key_of(TsdfMap::offset_of(v), side_of(s.key)), s);
    }
  }
  /// What a sum adds to a hit.
  SurfaceHit hit(const Sum& s) const {
    SurfaceHit h;
    h.weight = pixel_weight_ * s.count;
    for (std::size_t i = 0; i < 3; ++i) {
      h.position[i] = pixel_weight_ * s.position[i];
      h.normal[i] = pixel_weight_ * s.normal[i];
    }
    return h;
  }

 private:
  static constexpr int kBits = 20;  ///< Of a coordinate in a key.
  static constexpr int kHalf = 1 << (kBits - 1);
  static constexpr std::uint64_t kNoKey = ~std::uint64_t{0};
  struct Pixel {
    std::uint64_t key = kNoKey;
    std::array<std::int8_t, 3> position{}, normal{};
    std::int8_t count = 1;  ///< Pixels it stands for.
  };

  static std::uint64_t key_of(const Eigen::Vector3i& v, int side) {
    const auto part = [](int c) { return static_cast<std::uint64_t>(c + kHalf); };
    return ((part(v.z()) << kBits | part(v.y())) << kBits | part(v.x())) << 3 |
           static_cast<std::uint64_t>(side);
  }
  VoxelIndex voxel_of(std::uint64_t key) const {
    const auto part = [&](int shift) {
      return static_cast<int>(key >> shift & ((1U << kBits) - 1)) - kHalf;
    };
    return base_ + VoxelIndex(part(3), part(3 + kBits), part(3 + 2 * kBits));
  }
  static int side_of(std::uint64_t key) { return static_cast<int>(key & 7); }

  static Pixel pixel(const ProjectiveView& view, const Eigen::Matrix3f& R,
                     const Eigen::Vector3f& start, float inverse_size, int u, int v) {
    const int m = view.margin;
    const float* at = view.inverse_depth.data() + static_cast<std::ptrdiff_t>(v) * view.width + u;
    const float inverse = *at;
    if (!(inverse > 0.0F) || u < m || v < m || u >= view.width - m || v >= view.height - m)
      return {};
    const float z = 1.0F / inverse;
    // Where pixels are finer than a quarter of a voxel, every other one tells as much.
    const bool fine = z * inverse_size < static_cast<float>(kResolved) * std::min(view.fx, view.fy);
    if (fine && ((u + v) & 1) != 0) return {};
    const float du = static_cast<float>(u) - view.cx, dv = static_cast<float>(v) - view.cy;
    const Eigen::Vector3f p(du / view.fx * z, dv / view.fy * z, z);
    const float range2 = p.squaredNorm();
    if (z > view.z_limit || range2 > view.range_limit * view.range_limit) return {};

    Eigen::Vector3f n;  // towards the camera, its frame
    if (!view.planes.empty()) {
      const SurfacePlane& plane =
          view.planes[static_cast<std::size_t>(at - view.inverse_depth.data())];
      n = -Eigen::Vector3f(plane.nx, plane.ny, plane.nz);
    } else {
      const float reach = 0.5F / inverse_size * inverse;
      const PixelSlope su = pixel_slope(at, u, view.width, 1, reach * view.fx, view.max_step_u);
      const PixelSlope sv =
          pixel_slope(at, v, view.height, view.width, reach * view.fy, view.max_step_v);
      // The plane q · x = 1; along an axis that tells nothing it faces the camera.
      const float qx = su.known ? su.value * view.fx : p.x() / range2;
      const float qy = sv.known ? sv.value * view.fy : p.y() / range2;
      n = -Eigen::Vector3f(qx, qy, inverse - qx * du / view.fx - qy * dv / view.fy);
    }
    const float length = n.norm();
    if (!(length > 0.0F) || n.dot(p) >= 0.0F) {
      n = -p / std::sqrt(range2);
    } else {
      n /= length;
    }
    const Eigen::Vector3f m_world = R * n;
    const Eigen::Vector3f place = start + R * (p * inverse_size);
    if (!(place.cwiseAbs().maxCoeff() < static_cast<float>(kHalf - 1))) return {};
    Pixel hit;
    hit.count = fine ? 2 : 1;
    Eigen::Vector3i low;
    for (int i = 0; i < 3; ++i) {
      low[i] = static_cast<int>(place[i]);
      low[i] -= static_cast<float>(low[i]) > place[i] ? 1 : 0;
      // Rounded by truncation of what is never negative.
      const float q = (place[i] - static_cast<float>(low[i])) * (2.0F * SurfaceHit::kSteps) + 0.5F;
      hit.position[static_cast<std::size_t>(i)] = static_cast<std::int8_t>(
          std::min(static_cast<int>(q) - SurfaceHit::kSteps, SurfaceHit::kSteps));
      const float shifted = (m_world[i] + 1.0F) * SurfaceHit::kNormal + 0.5F;
      hit.normal[static_cast<std::size_t>(i)] =
          static_cast<std::int8_t>(static_cast<int>(shifted) - SurfaceHit::kNormal);
    }
    const float ax = std::abs(m_world.x()), ay = std::abs(m_world.y()), az = std::abs(m_world.z());
    const int axis = ax >= ay ? (ax >= az ? 0 : 2) : (ay >= az ? 1 : 2);
    hit.key = key_of(low, 2 * axis + (m_world[axis] < 0.0F ? 1 : 0));
    return hit;
  }

  /// Sums pixels of one key, by a hash table; neighbours are often of the same.
  void gather() {
    sums_.clear();
    table_.assign(std::bit_ceil(std::max<std::size_t>(pixels_.size(), 64)), kEmpty);
    const std::size_t mask = table_.size() - 1;
    std::uint64_t last = kNoKey;
    std::uint32_t at = 0;
    for (const Pixel& p : pixels_) {
      if (p.key == kNoKey) continue;
      if (p.key != last) {
        last = p.key;
        std::size_t h = static_cast<std::size_t>((p.key * 0x9e3779b97f4a7c15ULL) >> 20) & mask;
        while (table_[h] != kEmpty && sums_[table_[h]].key != p.key) h = (h + 1) & mask;
        if (table_[h] == kEmpty) {
          table_[h] = static_cast<std::uint32_t>(sums_.size());
          sums_.push_back({.key = p.key});
        }
        at = table_[h];
      }
      Sum& s = sums_[at];
      s.count += p.count;
      for (std::size_t i = 0; i < 3; ++i) {
        s.position[i] += p.count * p.position[i];
        s.normal[i] += p.count * p.normal[i];
      }
    }
    // One block after the other; the order within an image does not matter to the sums.
    order_.resize(sums_.size());
    keys_.resize(sums_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
      order_[i] = i;
      const BlockIndex b = TsdfMap::block_of(voxel_of(sums_[i].key));
      const auto part = [&](int c, int base) {
        return static_cast<std::uint64_t>(c - (base >> TsdfMap::kBlockShift) + kHalf);
      };
      keys_[i] = (part(b.z(), base_.z()) << (kBits + 1) | part(b.y(), base_.y())) << (kBits + 1) |
                 part(b.x(), base_.x());
    }
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return keys_[a] != keys_[b] ? keys_[a] < keys_[b] : sums_[a].key < sums_[b].key;
    });
  }

  static constexpr std::uint32_t kEmpty = ~std::uint32_t{0};
  Eigen::Vector3i base_ = Eigen::Vector3i::Zero();  ///< The camera's voxel.
  std::int64_t pixel_weight_ = 1;
  std::vector<Pixel> pixels_;
  std::vector<Sum> sums_;
  std::vector<std::uint32_t> table_, order_;
  std::vector<std::uint64_t> keys_;
};

/// Notes the hits of a block that a view looks through: clearly so, where the image resolves a
/// quarter of a voxel, does not meet the hit's plane edge-on, and everything around the hit's pixel
/// is more than half a voxel farther. True if any was noted.
inline bool observe_passing(const ProjectiveView& view, double voxel_size, TsdfMap::Block& block) {
  constexpr double kEdgeOn = 0.3;   // least cosine of incidence
  constexpr double kNearest = 0.1;  // range below which weights grow no further [m]
  if (block.layer.empty()) return false;
  const double focal = std::min(static_cast<double>(view.fx), static_cast<double>(view.fy));
  const double farthest =
      std::min(static_cast<double>(view.z_limit), kResolved * voxel_size * focal);
  const Eigen::Matrix3d R = view.T_world_camera.linear().transpose();
  const Point3 eye = view.T_world_camera.translation();
  const Point3 origin =
      (block.origin().cast<double>() + Eigen::Vector3d::Constant(0.5)) * voxel_size;
  const int m = std::max(view.margin, 1);
  bool changed = false;
  for (SurfaceHit& hit : block.layer.hits()) {
    const auto o = static_cast<int>(hit.voxel());
    constexpr int kLow = TsdfMap::kBlockSide - 1, kShift = TsdfMap::kBlockShift;
    const Eigen::Vector3d voxel(o & kLow, o >> kShift & kLow, o >> (2 * kShift));
    const Point3 p = origin + voxel_size * voxel + hit.mean_offset(voxel_size);
    const Eigen::Vector3d ray = p - eye;
    const Point3 c = R * ray;
    if (!(c.z() > kNearPlane && c.z() <= farthest)) continue;
    const double u = static_cast<double>(view.fx) * c.x() / c.z() + static_cast<double>(view.cx);
    const double v = static_cast<double>(view.fy) * c.y() / c.z() + static_cast<double>(view.cy);
    if (!(u >= m - 0.5 && v >= m - 0.5 && u < view.width - m - 0.5 && v < view.height - m - 0.5))
      continue;
    const auto iu = static_cast<int>(u + 0.5), iv = static_cast<int>(v + 0.5);
    float nearest = 0.0F;  // as an inverse depth
    float least = std::numeric_limits<float>::max();
    for (int dv = -1; dv <= 1; ++dv)
      for (int du = -1; du <= 1; ++du) {
        const float d = view.inverse_depth[static_cast<std::size_t>(iv + dv) *
                                               static_cast<std::size_t>(view.width) +
                                           static_cast<std::size_t>(iu + du)];
        nearest = std::max(nearest, d);
        least = std::min(least, d);
      }
    if (!(least > 0.0F)) continue;
    const double range = ray.norm();
    const double beyond = (1.0 / static_cast<double>(nearest) - c.z()) * range / c.z();
    if (beyond <= 0.5 * voxel_size) continue;
    const double incidence = std::abs(hit.mean_normal().dot(ray)) / range;
    if (incidence < kEdgeOn || beyond * incidence <= 0.5 * voxel_size) continue;
    const double weight = incidence / std::max(range * range, kNearest * kNearest);
    changed |= hit.pass(std::max<std::int64_t>(1, std::llround(weight / SurfaceHit::kWeightUnit)));
  }
  return changed;
}
}  // namespace surfleet::detail
