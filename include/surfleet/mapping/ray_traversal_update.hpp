// SPDX-License-Identifier: MIT
/// @file
/// @brief The ray-traversal TSDF update: every ray visits the voxels it passes through.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/mapping/detail/ray_hits.hpp>
#include <surfleet/mapping/update_policy.hpp>
#include <surfleet/mapping/voxel_traversal.hpp>

namespace surfleet {
/// Walks every measured ray from the sensor to µ behind the surface.
///
/// The rays that pass through a voxel are bundled: it takes one observation, the mean of their
/// distances along the rays, with one weight, so that voxels near the sensor are not counted
/// hundreds of times. Nothing is said of a voxel no ray passes through, which makes this the choice
/// for sparse or irregular points. Means are summed in fixed point, whose order does not matter.
/// O(voxels on all rays).
class RayTraversalUpdate {
 public:
  template <WeightPolicy Weight>
  std::size_t operator()(const DepthObservation& o, const Weight& weight,
                         const TsdfOptions& options, TsdfMap& map) {
    const PinholeCamera& c = o.camera;
    const auto row = static_cast<std::size_t>(c.width);
    return fold(
        o.T_world_camera, o.image.depth.size(),
        [&](std::size_t i) -> Ray {
          const float d = o.image.depth[i];
          if (!DepthImage::is_measurement(d) || static_cast<double>(d) < c.min_range) return {};
          const Eigen::Vector3d ray =
              c.ray(static_cast<double>(i % row), static_cast<double>(i / row));
          const double stretch = ray.norm();
          return {ray / stretch, static_cast<double>(d) * stretch, c.max_range * stretch};
        },
        weight, options, map);
  }

  template <WeightPolicy Weight>
  std::size_t operator()(const ScanObservation& o, const Weight& weight, const TsdfOptions& options,
                         TsdfMap& map) {
    return fold(
        o.T_world_sensor, o.points.size(),
        [&](std::size_t i) -> Ray {
          const double range = o.points[i].norm();
          if (!(range > 0.0 && range >= o.min_range && std::isfinite(range))) return {};
          return {o.points[i] / range, range, o.max_range};
        },
        weight, options, map);
  }

 private:
  struct Ray {
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< Sensor frame, unit length.
    double length = 0.0;                                  ///< [m]; 0 for no measurement.
    double limit = 0.0;                                   ///< The sensor's range on this ray [m].
  };
  struct Sum {
    std::int64_t distance = 0;  ///< In units of µ / kUnit.
    std::int64_t rays = 0;
  };
  using SumGrid = VoxelGrid<Sum, TsdfMap::kBlockSide>;
  static constexpr double kUnit = 1 << 24;
  static constexpr std::size_t kParts = 8;

  template <typename RayAt, WeightPolicy Weight>
  static std::size_t fold(const Pose& T_world_sensor, std::size_t rays, RayAt&& ray_at,
                          const Weight& weight, const TsdfOptions& options, TsdfMap& map) {
    const double mu = options.truncation, h = map.voxel_size();
    const Point3 origin = T_world_sensor.translation();
    const std::uint64_t before = map.revision();
    if (options.keep_hits) {
      detail::RayHits hits(origin, map);
      for (std::size_t i = 0; i < rays; ++i) {
        const Ray ray = ray_at(i);
        if (ray.length <= 0.0) continue;
        const bool beyond = ray.length > ray.limit;
        if (options.carve_free_space && (!beyond || options.carve_beyond_range))
          hits.passes(T_world_sensor.linear() * ray.direction, std::min(ray.length, ray.limit));
        if (!beyond) hits.ends(T_world_sensor.linear() * ray.direction, ray.length);
      }
      hits.add_to(map, options.max_weight);
    }
    std::vector<SumGrid> parts;
    for (std::size_t i = 0; i < kParts; ++i) parts.emplace_back(VoxelGridOptions{h});
    parallel_for(kParts, options.threads, [&](std::size_t part) {
      SumGrid& sums = parts[part];
      SumGrid::Writer write(sums);
      for (std::size_t i = part * rays / kParts; i < (part + 1) * rays / kParts; ++i) {
        const Ray ray = ray_at(i);
        if (ray.length <= 0.0) continue;
        const bool beyond = ray.length > ray.limit;
        if (beyond && !(options.carve_beyond_range && options.carve_free_space)) continue;
        const Eigen::Vector3d direction = T_world_sensor.linear() * ray.direction;
        const double first = options.carve_free_space ? 0.0 : std::max(0.0, ray.length - mu);
        const double last = beyond ? ray.limit : ray.length + mu;
        const Point3 from = origin + first * direction, to = origin + last * direction;
        static_cast<void>(sums.index_of(from));
        static_cast<void>(sums.index_of(to));
        traverse_voxels(from, to, h, [&](const VoxelIndex& v) {
          const double along = (sums.center(v) - origin).dot(direction);
          if (along <= 0.0 || (beyond && along > ray.limit)) return true;
          const double sdf = ray.length - along;
          if (sdf <= -mu || (sdf >= mu && !options.carve_free_space)) return true;
          Sum& sum = write.ensure(v);
          sum.distance += std::llround(std::min(sdf, mu) / mu * kUnit);
          ++sum.rays;
          return true;
        });
      }
    });

    std::vector<BlockIndex> touched;
    for (const SumGrid& part : parts)
      part.for_each_block([&](const SumGrid::Block& b) { touched.push_back(b.index); });
    std::sort(touched.begin(), touched.end(), [](const BlockIndex& a, const BlockIndex& b) {
      return std::tuple(a.z(), a.y(), a.x()) < std::tuple(b.z(), b.y(), b.x());
    });
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());

    // A rule may refuse all of a block's observations; such a block is not made.
    const auto each_observation = [&](const BlockIndex& index, auto&& visit) {
      std::vector<const SumGrid::Block*> sums;
      for (const SumGrid& part : parts)
        if (const SumGrid::Block* b = part.find_block(index)) sums.push_back(b);
      for (std::size_t n = 0; n < SumGrid::kBlockVoxels; ++n) {
        Sum total;
        for (const SumGrid::Block* b : sums) {
          total.distance += b->voxels[n].distance;
          total.rays += b->voxels[n].rays;
        }
        if (total.rays == 0) continue;
        const double mean =
            static_cast<double>(total.distance) / static_cast<double>(total.rays) / kUnit;
        const auto sdf = static_cast<float>(mean * mu);
        const auto range2 = static_cast<float>(
            (map.center(SumGrid::index_in(*sums.front(), n)) - origin).squaredNorm());
        const float gain = detail::observation_weight(weight, sdf, range2);
        if (gain > 0.0F && !visit(n, sdf, gain)) return;
      }
    };
    std::vector<std::uint8_t> flags(touched.size(), 0);
    parallel_for(
        touched.size(), options.threads,
        [&](std::size_t i) {
          each_observation(touched[i], [&](std::size_t, float, float) {
            flags[i] = 1;
            return false;
          });
        },
        16);
    std::vector<std::uint32_t> slots(touched.size(), TsdfMap::kNone);
    for (std::size_t i = 0; i < touched.size(); ++i)
      if (flags[i] != 0) slots[i] = map.ensure_slot(touched[i]);
    const auto max_weight = static_cast<float>(options.max_weight);
    parallel_for(
        touched.size(), options.threads,
        [&](std::size_t i) {
          flags[i] = 0;
          if (slots[i] == TsdfMap::kNone) return;
          TsdfMap::Block& block = map.block(slots[i]);
          each_observation(touched[i], [&](std::size_t n, float sdf, float gain) {
            if (detail::fuse(block.voxels[n], sdf, gain, max_weight)) flags[i] = 1;
            return true;
          });
        },
        16);
    for (std::size_t i = 0; i < touched.size(); ++i)
      if (flags[i] != 0) map.mark_changed(slots[i]);
    return map.changed_since(before).size();
  }
};

static_assert(UpdatePolicy<RayTraversalUpdate>);
}  // namespace surfleet
