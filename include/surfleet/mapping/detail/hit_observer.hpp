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
#include <surfleet/mapping/detail/pixel_slopes.hpp>
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
    row_counts_.resize(static_cast<std::size_t>(view.height));
    const Eigen::Matrix3f R = view.T_world_camera.linear().cast<float>();
    const auto inverse_size = static_cast<float>(1.0 / voxel_size);
    parallel_for(
        static_cast<std::size_t>(view.height), threads,
        [&](std::size_t row) {
          row_counts_[row] = read_row(view, R, start, inverse_size, static_cast<int>(row),
                                      pixels_.data() + row * static_cast<std::size_t>(view.width));
        },
        16);
    row_length_ = static_cast<std::size_t>(view.width);
    gather();
  }

  /// Calls `fn(block, key, sum)` for each sum, those of one block in one run, by ascending keys.
  template <typename Fn>
  void for_each(Fn&& fn) const {
    for (const Place& place : order_) {
      const Sum& s = sums_[place.sum];
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

  /// Puts the hits of row `v` side by side from `out` on; returns how many.
  static std::size_t read_row(const ProjectiveView& view, const Eigen::Matrix3f& R,
                              const Eigen::Vector3f& start, float inverse_size, int v, Pixel* out) {
    const int m = view.margin;
    if (v < m || v >= view.height - m) return 0;
    // Where pixels are finer than a quarter of a voxel, every other one tells as much.
    const float finest = static_cast<float>(kResolved) * std::min(view.fx, view.fy);
    const float* const row =
        view.inverse_depth.data() + static_cast<std::ptrdiff_t>(v) * view.width;
    PixelLanes<std::int32_t> across;
    std::size_t lanes = 0, found = 0;
    for (int u = m; u < view.width - m; ++u) {
      const float inverse = row[u];
      const bool skipped = ((u + v) & 1) != 0 && 1.0F / inverse * inverse_size < finest;
      if (!(inverse > 0.0F) || skipped) continue;
      across[lanes++] = u;
      if (lanes < kPixelLanes) continue;
      found += read_lanes(view, R, start, inverse_size, across, lanes, v, out + found);
      lanes = 0;
    }
    if (lanes == 0) return found;
    for (std::size_t i = lanes; i < kPixelLanes; ++i) across[i] = across[0];
    return found + read_lanes(view, R, start, inverse_size, across, lanes, v, out + found);
  }

  /// Towards the camera, in its frame, but of any length.
  struct Normals {
    PixelLanes<float> x, y, z;
  };
  static Normals normals_at(const ProjectiveView& view, float inverse_size,
                            const PixelLanes<std::int32_t>& u, int v,
                            const PixelLanes<std::int32_t>& pixel, const PixelLanes<float>& inverse,
                            const PixelLanes<float>& flat_u, const PixelLanes<float>& flat_v) {
    Normals n;
    if (!view.planes.empty()) {
      for (std::size_t i = 0; i < kPixelLanes; ++i) {
        const SurfacePlane& plane = view.planes[static_cast<std::size_t>(pixel[i])];
        n.x[i] = -plane.nx;
        n.y[i] = -plane.ny;
        n.z[i] = -plane.nz;
      }
      return n;
    }
    PixelLanes<float> reach_u, reach_v;
    PixelLanes<std::int32_t> down;
    down.fill(v);
    const float fx = view.fx, fy = view.fy, cx = view.cx, cy = view.cy, half = 0.5F / inverse_size;
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      const float reach = half * inverse[i];
      reach_u[i] = reach * fx;
      reach_v[i] = reach * fy;
    }
    const float* const image = view.inverse_depth.data();
    const PixelSlopes su = pixel_slopes({image, view.width, 1, view.max_step_u}, pixel, u, reach_u);
    const PixelSlopes sv =
        pixel_slopes({image, view.height, view.width, view.max_step_v}, pixel, down, reach_v);
    const float dv = static_cast<float>(v) - cy;
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      // The plane q · x = 1; along an axis that tells nothing it faces the camera.
      const float du = static_cast<float>(u[i]) - cx;
      const float qx = su.weight[i] > 0.0F ? su.value[i] * fx : flat_u[i];
      const float qy = sv.weight[i] > 0.0F ? sv.value[i] * fy : flat_v[i];
      n.x[i] = -qx;
      n.y[i] = -qy;
      n.z[i] = -(inverse[i] - qx * du / fx - qy * dv / fy);
    }
    return n;
  }

  /// The hits of the first `lanes` of the pixels `u` of row `v`, as far as they are in range; how
  /// many they are.
  static std::size_t read_lanes(const ProjectiveView& view, const Eigen::Matrix3f& R,
                                const Eigen::Vector3f& start, float inverse_size,
                                const PixelLanes<std::int32_t>& u, std::size_t lanes, int v,
                                Pixel* out) {
    using Lanes = PixelLanes<float>;
    const float fx = view.fx, fy = view.fy, cx = view.cx;
    const float dv = static_cast<float>(v) - view.cy;
    const float* const image = view.inverse_depth.data();
    PixelLanes<std::int32_t> pixel;
    Lanes inverse, px, py, pz, range2, flat_u, flat_v;
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      pixel[i] = v * view.width + u[i];
      inverse[i] = image[pixel[i]];
    }
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      const float du = static_cast<float>(u[i]) - cx, z = 1.0F / inverse[i];
      px[i] = du / fx * z;
      py[i] = dv / fy * z;
      pz[i] = z;
      range2[i] = px[i] * px[i] + (py[i] * py[i] + z * z);
      flat_u[i] = px[i] / range2[i];
      flat_v[i] = py[i] / range2[i];
    }
    const Normals n = normals_at(view, inverse_size, u, v, pixel, inverse, flat_u, flat_v);

    const float z_limit = view.z_limit, range2_limit = view.range_limit * view.range_limit;
    const float finest = static_cast<float>(kResolved) * std::min(fx, fy);
    Lanes nx, ny, nz;
    PixelLanes<std::int32_t> counts, side;
    std::array<PixelLanes<std::int32_t>, 3> low, position, normal;
    for (std::size_t i = 0; i < kPixelLanes; ++i) {
      const float length = std::sqrt(n.x[i] * n.x[i] + (n.y[i] * n.y[i] + n.z[i] * n.z[i]));
      const float along = n.x[i] * px[i] + (n.y[i] * py[i] + n.z[i] * pz[i]);
      const int good = int(length > 0.0F) & int(along < 0.0F);
      const float divisor = good != 0 ? length : std::sqrt(range2[i]);
      nx[i] = (good != 0 ? n.x[i] : -px[i]) / divisor;
      ny[i] = (good != 0 ? n.y[i] : -py[i]) / divisor;
      nz[i] = (good != 0 ? n.z[i] : -pz[i]) / divisor;
      const int fine = int(pz[i] * inverse_size < finest);
      counts[i] = (int(pz[i] <= z_limit) & int(range2[i] <= range2_limit)) * (1 + fine);
    }
    Lanes largest{}, magnitude{};
    side.fill(0);
    for (int k = 0; k < 3; ++k) {
      const float r0 = R(k, 0), r1 = R(k, 1), r2 = R(k, 2), from = start[k];
      const std::int32_t number = 2 * k;
      auto& cell = low[static_cast<std::size_t>(k)];
      auto& steps = position[static_cast<std::size_t>(k)];
      auto& part = normal[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < kPixelLanes; ++i) {
        const float x = px[i] * inverse_size, y = py[i] * inverse_size, z = pz[i] * inverse_size;
        const float place = from + (r0 * x + (r1 * y + r2 * z));
        magnitude[i] = larger(magnitude[i], std::abs(place));
        // Out of bounds it becomes no hit: see below.
        const float within = smaller(larger(place, -2.0F * kHalf), 2.0F * kHalf);
        const auto whole = static_cast<std::int32_t>(within);
        cell[i] = whole - int(static_cast<float>(whole) > within);
        // Rounded by truncation of what is never negative.
        const float q = (within - static_cast<float>(cell[i])) * (2.0F * SurfaceHit::kSteps) + 0.5F;
        const std::int32_t step = static_cast<std::int32_t>(q) - SurfaceHit::kSteps;
        steps[i] = step < SurfaceHit::kSteps ? step : SurfaceHit::kSteps;
        const float m = r0 * nx[i] + (r1 * ny[i] + r2 * nz[i]);
        part[i] = static_cast<std::int32_t>((m + 1.0F) * SurfaceHit::kNormal + 0.5F) -
                  SurfaceHit::kNormal;
        // The first axis that has the largest part.
        const int larger_part = k == 0 ? 1 : int(std::abs(m) > largest[i]);
        side[i] = larger_part != 0 ? number + int(m < 0.0F) : side[i];
        largest[i] = larger_part != 0 ? std::abs(m) : largest[i];
      }
    }
    std::size_t found = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
      if (counts[i] == 0 || !(magnitude[i] < static_cast<float>(kHalf - 1))) continue;
      Pixel& hit = out[found++];
      for (std::size_t k = 0; k < 3; ++k) {
        hit.position[k] = static_cast<std::int8_t>(position[k][i]);
        hit.normal[k] = static_cast<std::int8_t>(normal[k][i]);
      }
      hit.count = static_cast<std::int8_t>(counts[i]);
      hit.key = key_of({low[0][i], low[1][i], low[2][i]}, side[i]);
    }
    return found;
  }

  /// Sums pixels of one key, by a hash table; neighbours are often of the same.
  void gather() {
    sums_.clear();
    table_.assign(kLeastTable, kEmpty);
    for (std::size_t row = 0; row < row_counts_.size(); ++row) {
      const Pixel* const first = pixels_.data() + row * row_length_;
      std::uint64_t last = kNoKey;
      std::uint32_t at = 0;
      for (const Pixel* p = first; p != first + row_counts_[row]; ++p) {
        if (p->key != last) {
          last = p->key;
          at = sum_of(p->key);
        }
        Sum& s = sums_[at];
        s.count += p->count;
        for (std::size_t i = 0; i < 3; ++i) {
          s.position[i] += p->count * p->position[i];
          s.normal[i] += p->count * p->normal[i];
        }
      }
    }
    // One block after the other; the order within an image does not matter to the sums.
    order_.resize(sums_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
      const BlockIndex b = TsdfMap::block_of(voxel_of(sums_[i].key));
      const auto part = [&](int c, int base) {
        return static_cast<std::uint64_t>(c - (base >> TsdfMap::kBlockShift) + kHalf);
      };
      order_[i] = {(part(b.z(), base_.z()) << (kBits + 1) | part(b.y(), base_.y())) << (kBits + 1) |
                       part(b.x(), base_.x()),
                   sums_[i].key, i};
    }
    std::sort(order_.begin(), order_.end(), [](const Place& a, const Place& b) {
      return a.block != b.block ? a.block < b.block : a.key < b.key;
    });
  }
  /// The number of the sum of a key, made if it is new.
  std::uint32_t sum_of(std::uint64_t key) {
    std::size_t h = slot_of(key);
    if (table_[h] != kEmpty) return table_[h];
    const auto made = static_cast<std::uint32_t>(sums_.size());
    table_[h] = made;
    sums_.push_back({.key = key});
    if (2 * sums_.size() > table_.size()) {
      // Small to begin with, so that it stays in the cache.
      table_.assign(2 * table_.size(), kEmpty);
      for (std::uint32_t i = 0; i < sums_.size(); ++i) table_[slot_of(sums_[i].key)] = i;
    }
    return made;
  }
  /// Where a key is in the table, or is to be.
  std::size_t slot_of(std::uint64_t key) const {
    const std::size_t mask = table_.size() - 1;
    const auto bits = static_cast<int>(std::bit_width(mask));
    // The product's highest bits, which all of the key's decide.
    std::size_t h = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> (64 - bits));
    while (table_[h] != kEmpty && sums_[table_[h]].key != key) h = (h + 1) & mask;
    return h;
  }

  static constexpr std::uint32_t kEmpty = ~std::uint32_t{0};
  static constexpr std::size_t kLeastTable = 4096;
  struct Place {
    std::uint64_t block, key;
    std::uint32_t sum;
  };
  Eigen::Vector3i base_ = Eigen::Vector3i::Zero();  ///< The camera's voxel.
  std::int64_t pixel_weight_ = 1;
  std::vector<Pixel> pixels_;
  std::vector<std::size_t> row_counts_;  ///< Hits of each row, which lie at its start.
  std::size_t row_length_ = 0;
  std::vector<Sum> sums_;
  std::vector<std::uint32_t> table_;
  std::vector<Place> order_;
};

/// Notes the hits of a block that a view sees through: clearly so, where the image resolves a
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
    if (!hit.may_pass()) continue;
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
    const float* const pixel = view.inverse_depth.data() +
                               static_cast<std::ptrdiff_t>(iv) * view.width +
                               static_cast<std::ptrdiff_t>(iu);
    // Mostly the hit's own surface is what is seen: then those around need not be asked.
    if (!(*pixel > 0.0F) || 1.0 / static_cast<double>(*pixel) - c.z() <= 0.0) continue;
    float nearest = 0.0F;  // as an inverse depth
    float least = std::numeric_limits<float>::max();
    for (int dv = -1; dv <= 1; ++dv)
      for (int du = -1; du <= 1; ++du) {
        const float d = pixel[dv * view.width + du];
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
