// SPDX-License-Identifier: MIT
/// @file
/// @brief The projective TSDF update: every voxel in the view looks up its pixel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <surfleet/mapping/detail/block_observer.hpp>
#include <surfleet/mapping/detail/hit_observer.hpp>
#include <surfleet/mapping/detail/projective_view.hpp>
#include <surfleet/mapping/detail/scan_projection.hpp>
#include <surfleet/mapping/detail/viewed_block_search.hpp>
#include <surfleet/mapping/update_policy.hpp>

namespace surfleet {
/// Projects the centre of every voxel in the view and compares its depth with the image's, free
/// space included.
///
/// The distance is taken along the voxel's ray. Near the surface inverse depth is interpolated
/// between the four pixels around, which is exact on planes; across a jump steeper than
/// `max_slope`, or beside a pixel without measurement, the nearest pixel decides alone, so that
/// nothing is smeared from one surface to the next. Blocks that lie wholly before or behind what a
/// pyramid of depths shows are carved or skipped without projecting their voxels. A scan of points
/// is first resampled to the six faces of a cube around the sensor, each then a view of its own.
///
/// O(pixels + voxels in the view), the free ones at a small fraction of the cost. Holds scratch
/// memory: one object a thread of the caller's.
class ProjectiveUpdate {
 public:
  template <WeightPolicy Weight>
  std::size_t operator()(const DepthObservation& o, const Weight& weight,
                         const TsdfOptions& options, TsdfMap& map) {
    const PinholeCamera& camera = o.camera;
    view_.width = camera.width;
    view_.height = camera.height;
    view_.margin = 0;
    view_.cube_axis = -1;
    view_.planes.clear();
    view_.fx = static_cast<float>(camera.fx);
    view_.fy = static_cast<float>(camera.fy);
    view_.cx = static_cast<float>(camera.cx);
    view_.cy = static_cast<float>(camera.cy);
    view_.z_limit = static_cast<float>(camera.max_range);
    view_.range_limit = 1e6F;
    view_.set_slope_limit(options.max_slope);
    view_.T_world_camera = o.T_world_camera;
    const auto nearest = static_cast<float>(camera.min_range);
    const float farthest =
        options.carve_beyond_range && options.carve_free_space ? kFarthest : view_.z_limit;
    view_.fill(options.threads, [&](int v, float* out) {
      const float* in = o.image.depth.data() + o.image.index(0, v);
      const float least = nearest, most = farthest;  // locals, so that the loop is vector code
      for (int u = 0, n = camera.width; u < n; ++u) {
        const float d = in[u];
        const bool measured = (d > 0.0F) & (d >= least) & (d <= std::numeric_limits<float>::max());
        const float near_enough = std::min(d, kFarthest);
        out[u] = (measured & (near_enough <= most)) ? near_enough : detail::kNoDepth;
      }
    });
    return fold(view_, weight, options, map);
  }

  template <WeightPolicy Weight>
  std::size_t operator()(const ScanObservation& o, const Weight& weight, const TsdfOptions& options,
                         TsdfMap& map) {
    // A block may be seen through several faces: count it once.
    const std::uint64_t before = map.revision();
    scan_.project(o, options);
    for (int face = 0; face < detail::ScanProjection::kFaces; ++face)
      if (scan_.resample(face, options, view_)) fold(view_, weight, options, map);
    return map.changed_since(before).size();
  }

 private:
  static constexpr float kFarthest = 1e7F;  ///< Greater depths count as this [m].
  /// Few, so that no thread has much to do when the others are done.
  static constexpr std::size_t kBlocksATime = 4;

  template <WeightPolicy Weight>
  std::size_t fold(const detail::ProjectiveView& view, const Weight& weight,
                   const TsdfOptions& options, TsdfMap& map) {
    using detail::BlockObserver;
    detail::ViewedBlockSearch search(view, map, options.truncation, options.carve_free_space);
    search.run(blocks_);
    changed_.assign(blocks_.size(), 0);
    std::vector<std::unique_ptr<TsdfMap::Block>> fresh(blocks_.size());

    const auto truncation = static_cast<float>(options.truncation);
    const auto max_weight = static_cast<float>(options.max_weight);
    parallel_for(
        blocks_.size(), options.threads,
        [&](std::size_t i) {
          const detail::ViewedBlock& b = blocks_[i];
          TsdfMap::Block* block = b.slot == TsdfMap::kNone ? nullptr : &map.block(b.slot);
          // A block is made when the view has something to say of it, by the thread that finds so.
          const auto slice = [&](int z) {
            if (block == nullptr) {
              fresh[i] = std::make_unique<TsdfMap::Block>();
              fresh[i]->index = b.index;
              block = fresh[i].get();
            }
            return block->voxels.data() + static_cast<std::size_t>(z) * BlockObserver::kSlice;
          };
          BlockObserver observer(view, options, map.voxel_size(), b.index);
          bool changed = options.keep_hits && options.carve_free_space && block != nullptr &&
                         detail::observe_passing(view, map.voxel_size(), *block);
          for (int z = 0; z < BlockObserver::kSide; ++z) {
            if (b.free) {
              observer.measure_ranges(z);
              changed |=
                  detail::fuse_slice<true>(slice(z), observer, weight, truncation, max_weight);
            } else if (observer.observe(z)) {
              changed |=
                  detail::fuse_slice<false>(slice(z), observer, weight, truncation, max_weight);
            }
          }
          changed_[i] = changed ? 1 : 0;
        },
        kBlocksATime);
    const std::uint64_t before = map.revision();
    std::size_t count = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      std::unique_ptr<TsdfMap::Block> made = std::move(fresh[i]);
      if (changed_[i] == 0) continue;
      map.mark_changed(made ? map.adopt(std::move(made)) : blocks_[i].slot);
      ++count;
    }
    return options.keep_hits ? count + add_hits(view, options, before, map) : count;
  }

  /// Puts the view's hits into the map; returns the number of blocks not marked since `before`.
  std::size_t add_hits(const detail::ProjectiveView& view, const TsdfOptions& options,
                       std::uint64_t before, TsdfMap& map) {
    hits_.read(view, map.voxel_size(), options.threads);
    std::size_t count = 0;
    std::uint32_t slot = TsdfMap::kNone;
    std::size_t at = 0;  // in the block's hits, whose keys come in ascending order
    hits_.for_each([&](const BlockIndex& index, std::uint16_t key, const auto& sum) {
      if (slot == TsdfMap::kNone || map.block(slot).index != index) {
        slot = map.ensure_slot(index);
        at = 0;
      }
      TsdfMap::Block& block = map.block(slot);
      if (!block.layer.ensure_after(key, at).take(hits_.hit(sum), options.max_weight)) return;
      if (block.changed > before) return;
      map.mark_changed(slot);
      ++count;
    });
    return count;
  }

  detail::ProjectiveView view_;
  detail::ScanProjection scan_;
  detail::HitObserver hits_;
  std::vector<detail::ViewedBlock> blocks_;
  std::vector<std::uint8_t> changed_;
};

static_assert(UpdatePolicy<ProjectiveUpdate>);
}  // namespace surfleet
