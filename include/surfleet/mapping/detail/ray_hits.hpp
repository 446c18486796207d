// SPDX-License-Identifier: MIT
/// @file
/// @brief Surface hits of single rays: where they end, and which hits of the map they pass.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <surfleet/mapping/surface_hits.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/mapping/voxel_traversal.hpp>

namespace surfleet::detail {
/// Gathers the rays of one observation. A voxel and side takes one hit of weight 1 / z², the mean
/// of its rays' ends, and a hit of the map at most one pass, so that voxels near the sensor do not
/// count hundreds of times. Nothing is known of normals: they point back along the rays.
class RayHits {
 public:
  RayHits(const Point3& origin, const TsdfMap& map) : origin_(origin), map_(&map) {}

  /// A ray along the unit `direction` ended after `length` [m].
  void ends(const Eigen::Vector3d& direction, double length) {
    const Point3 p = origin_ + length * direction;
    const VoxelIndex v = map_->index_of(p);
    const Eigen::Vector3d off = (p - map_->center(v)) * (2.0 / map_->voxel_size());
    Sum& sum = sums_[{key_of(TsdfMap::block_of(v)),
                      SurfaceHits::key_of(TsdfMap::offset_of(v), side_of_normal(-direction))}];
    ++sum.count;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      sum.position[k] += std::lround(std::clamp(off[i], -1.0, 1.0) * SurfaceHit::kSteps);
      sum.normal[k] -= std::lround(direction[i] * SurfaceHit::kNormal);
    }
  }

  /// A ray was free for `length` [m]: it passes hits that it comes near to, not edge-on, more than
  /// half a voxel before its end.
  void passes(const Eigen::Vector3d& direction, double length) {
    constexpr double kNear = 0.125, kEdgeOn = 0.3;  // voxels; cosine
    const double h = map_->voxel_size(), free = length - 0.5 * h;
    if (!(free > 0.0)) return;
    const TsdfMap::Block* block = nullptr;
    BlockIndex index = BlockIndex::Constant(std::numeric_limits<int>::min());
    traverse_voxels(origin_, origin_ + free * direction, h, [&](const VoxelIndex& v) {
      if (const BlockIndex b = TsdfMap::block_of(v); b != index) {
        index = b;
        block = map_->find_block(b);
      }
      if (block == nullptr || block->layer.empty()) return true;
      for (const SurfaceHit& hit : block->layer.of_voxel(TsdfMap::offset_of(v))) {
        const Eigen::Vector3d to = map_->center(v) + hit.mean_offset(h) - origin_;
        const double along = to.dot(direction);
        const double incidence = std::abs(hit.mean_normal().dot(direction));
        if (along <= 0.0 || along * incidence > length * incidence - 0.5 * h ||
            incidence < kEdgeOn || (to - along * direction).norm() > kNear * h)
          continue;
        passed_.insert({key_of(index), hit.key});
      }
      return true;
    });
  }

  /// Adds what was gathered, hits up to a weight of `most`, and marks the blocks that changed.
  void add_to(TsdfMap& map, double most) const {
    for (const auto& [where, sum] : sums_) {
      const std::uint32_t slot = map.ensure_slot(index_of(where));
      TsdfMap::Block& block = map.block(slot);
      const std::int64_t each =
          std::max<std::int64_t>(1, weight_at(map, block, where.second) / sum.count);
      SurfaceHit hit;
      hit.weight = each * sum.count;
      for (std::size_t k = 0; k < 3; ++k) {
        hit.position[k] = each * sum.position[k];
        hit.normal[k] = each * sum.normal[k];
      }
      if (block.layer.ensure(where.second).take(hit, most)) map.mark_changed(slot);
    }
    for (const auto& where : passed_) {
      const std::uint32_t slot = map.ensure_slot(index_of(where));
      TsdfMap::Block& block = map.block(slot);
      if (block.layer.ensure(where.second).pass(weight_at(map, block, where.second)))
        map.mark_changed(slot);
    }
  }

 private:
  using Where = std::pair<VoxelKey, std::uint16_t>;  ///< Block and key of a hit.
  struct Sum {
    std::int64_t count = 0;
    std::array<std::int64_t, 3> position{}, normal{};
  };
  static BlockIndex index_of(const Where& w) { return {w.first[0], w.first[1], w.first[2]}; }
  std::int64_t weight_at(const TsdfMap& map, const TsdfMap::Block& block, std::uint16_t key) const {
    constexpr double kNearest = 0.1;  // range below which weights grow no further [m]
    const double range2 =
        (map.center(TsdfMap::index_in(block, std::size_t{key} >> 3)) - origin_).squaredNorm();
    return std::max<std::int64_t>(
        1, std::llround(1.0 / std::max(range2, kNearest * kNearest) / SurfaceHit::kWeightUnit));
  }

  Point3 origin_;
  const TsdfMap* map_;
  std::map<Where, Sum> sums_;
  std::set<Where> passed_;
};
}  // namespace surfleet::detail
