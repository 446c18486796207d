// SPDX-License-Identifier: MIT
/// @file
/// @brief The map that a set of patches makes, whatever the order they come and go in
/// [000 §4.4.1].
///
///     PatchFusion fusion({.voxel_size = 0.3, .truncation = 0.9});
///     fusion.add(patch);                   // ours, and all others'
///     fusion.show_open(recorder.open());   // what is not a patch yet
///     states.update(fusion.map());         // the map as the rest of the library reads it
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <surfleet/mapping/moved_patch.hpp>

namespace surfleet {
struct PatchFusionOptions {
  double voxel_size = 0.3;  ///< [m]
  double truncation = 0.9;  ///< µ [m]
};

/// Sums Σw and Σwd of each voxel, and the sums of hits, in whole numbers: they need no order and
/// subtract exactly, so equal sets of patches at equal poses are equal maps, bit by bit. What a
/// patch does touches its own blocks alone, and only blocks that come out different count as
/// changed. It keeps no patches: what takes one away brings it again, as a rule decoded from the
/// bytes it is kept in.
class PatchFusion {
 public:
  /// Throws `Error` on options out of range.
  explicit PatchFusion(PatchFusionOptions options = {})
      : options_(options),
        sums_({.voxel_size = options.voxel_size}),
        open_({.voxel_size = options.voxel_size}),
        map_({.voxel_size = options.voxel_size}) {
    require(options.truncation > 0.0 && std::isfinite(options.truncation),
            "patch fusion: expected a positive truncation");
  }

  /// Distances, weights and hits: always the same map, whose changes can be followed.
  const TsdfMap& map() const { return map_; }
  const PatchFusionOptions& options() const { return options_; }
  std::size_t size() const { return held_.size(); }
  bool holds(const PatchKey& key) const { return held_.contains(key); }

  /// Adds a patch whose frame lies at `T_map_frame`; false if one of its name is there already.
  /// Throws `Error` if it is of another voxel size or truncation. O(patch).
  bool add(const MapPatch& patch, const Pose& T_map_frame = Pose::Identity()) {
    check(patch);
    if (holds(patch.id.key)) return false;
    MapPatch moved;
    apply(placed(patch, T_map_frame, moved), 1);
    held_[patch.id.key] = {patch.id.hash, T_map_frame};
    refresh();
    return true;
  }
  /// Takes a patch away: what is left is as if it had never come. Throws `Error` unless it is there
  /// with this content. O(patch).
  void remove(const MapPatch& patch) {
    MapPatch moved;
    apply(placed(patch, held_pose(patch), moved), -1);
    held_.erase(patch.id.key);
    refresh();
  }
  /// Puts the frame of a patch elsewhere. Throws as `remove` does. O(patch).
  void move(const MapPatch& patch, const Pose& T_map_frame) {
    MapPatch before, after;
    const auto& to = placed(patch, T_map_frame, after);  // first: it may throw
    apply(placed(patch, held_pose(patch), before), -1);
    apply(to, 1);
    held_[patch.id.key].T_map_frame = T_map_frame;
    refresh();
  }
  /// Puts `whole` in the place of others, at the pose of its frame: what `coalesced_patch` makes
  /// of them. Throws as `remove` does, before anything is done.
  void replace(std::span<const MapPatch> parts, const MapPatch& whole,
               const Pose& T_map_frame = Pose::Identity()) {
    check(whole);
    for (const MapPatch& part : parts) held_pose(part);
    require(!holds(whole.id.key), to_string(whole.id.key) + ": is there already");
    MapPatch moved;
    const auto& to = placed(whole, T_map_frame, moved);
    for (const MapPatch& part : parts) {
      MapPatch before;
      apply(placed(part, held_pose(part), before), -1);
      held_.erase(part.id.key);
    }
    apply(to, 1);
    held_[whole.id.key] = {whole.id.hash, T_map_frame};
    refresh();
  }

  /// Follows the recorder's open map, in its numbers as a patch, until `close_open`.
  /// O(changed blocks).
  void show_open(const TsdfMap& open) {
    for (const std::uint32_t slot : open.changed_since(open_cursor_)) {
      const PatchBlock block = quantised(open.block(slot), options_.truncation);
      Sums::Block& to = open_.ensure_block(block.index);
      to.voxels = {};
      to.layer = {};
      fold(block, 1, to);
      touched_.push_back(block.index);
    }
    open_cursor_ = open.revision();
    refresh();
  }
  /// What was open is a patch now, or some, or nothing: the map does not change by it, unless these
  /// are not what was shown last.
  void close_open(std::span<const MapPatch> patches) {
    for (const MapPatch& patch : patches) check(patch);
    open_.for_each_block([&](const Sums::Block& b) { touched_.push_back(b.index); });
    open_ = Sums({.voxel_size = options_.voxel_size});
    open_cursor_ = 0;
    for (const MapPatch& patch : patches) {
      if (holds(patch.id.key)) continue;
      apply(patch.blocks, 1);
      held_[patch.id.key] = {patch.id.hash, Pose::Identity()};
    }
    refresh();
  }
  std::size_t memory_bytes() const {
    return sums_.memory_bytes() + open_.memory_bytes() + map_.memory_bytes();
  }

 private:
  struct Sum {
    std::int64_t weight = 0, weighted = 0;  // units, units times steps
  };
  using Sums = VoxelGrid<Sum, TsdfMap::kBlockSide, SurfaceHits>;
  struct Held {
    std::uint64_t hash = 0;
    Pose T_map_frame = Pose::Identity();
  };

  void check(const MapPatch& patch) const {
    require(patch.voxel_size == options_.voxel_size && patch.truncation == options_.truncation,
            to_string(patch.id.key) + ": expected voxels of " +
                std::to_string(options_.voxel_size) + " m, truncated at " +
                std::to_string(options_.truncation) + " m");
  }
  const Pose& held_pose(const MapPatch& patch) const {
    const auto it = held_.find(patch.id.key);
    require(it != held_.end() && it->second.hash == patch.id.hash,
            to_string(patch.id.key) + ": is not there; expected one that was added");
    return it->second.T_map_frame;
  }
  static void fold(const PatchBlock& block, int sign, Sums::Block& to) {
    for (std::size_t i = 0; i < block.weight.size(); ++i) {
      const std::int64_t w = std::int64_t{block.weight[i]} * sign;
      to.voxels[i].weight += w;
      to.voxels[i].weighted += w * block.distance[i];
    }
    if (block.hits.empty()) return;
    SurfaceHits hits;
    std::size_t at = 0;
    for (const PatchHit& hit : block.hits) hits.ensure_after(hit.key, at) = hit.sums();
    if (sign > 0)
      to.layer.add(hits);
    else
      to.layer.subtract(hits);
  }
  /// The patch's blocks when its frame lies there; in `moved` if that is elsewhere.
  static const std::vector<PatchBlock>& placed(const MapPatch& patch, const Pose& T_map_frame,
                                               MapPatch& moved) {
    if (T_map_frame.matrix() == Pose::Identity().matrix()) return patch.blocks;
    moved = moved_patch(patch, T_map_frame);
    return moved.blocks;
  }
  void apply(const std::vector<PatchBlock>& blocks, int sign) {
    for (const PatchBlock& block : blocks) {
      fold(block, sign, sums_.ensure_block(block.index));
      touched_.push_back(block.index);
    }
  }
  /// Brings the map's touched blocks up to date.
  void refresh() {
    const double step = options_.truncation / kPatchDistanceSteps;
    for (const BlockIndex& index : touched_) {
      static const Sums::Block kNothing{};
      const Sums::Block* closed = sums_.find_block(index);
      const Sums::Block* open = open_.find_block(index);
      if (closed == nullptr) closed = &kNothing;
      if (open == nullptr) open = &kNothing;
      TsdfMap::Block fused;
      bool empty = true;
      for (std::size_t i = 0; i < fused.voxels.size(); ++i) {
        const std::int64_t w = closed->voxels[i].weight + open->voxels[i].weight;
        if (w == 0) continue;
        const std::int64_t wd = closed->voxels[i].weighted + open->voxels[i].weighted;
        fused.voxels[i] = {
            static_cast<float>(static_cast<double>(wd) / static_cast<double>(w) * step),
            static_cast<float>(static_cast<double>(w) * kPatchWeightUnit)};
        empty = false;
      }
      fused.layer = closed->layer;
      if (!open->layer.empty()) fused.layer.add(open->layer);
      std::uint32_t slot = map_.find_slot(index);
      if (slot == TsdfMap::kNone) {
        if (empty && fused.layer.empty()) continue;
        slot = map_.ensure_slot(index);
      }
      TsdfMap::Block& block = map_.block(slot);
      bool same = block.layer == fused.layer;
      for (std::size_t i = 0; same && i < fused.voxels.size(); ++i)
        same = block.voxels[i].distance == fused.voxels[i].distance &&
               block.voxels[i].weight == fused.voxels[i].weight;
      if (same) continue;
      block.voxels = fused.voxels;
      block.layer = std::move(fused.layer);
      map_.mark_changed(slot);
    }
    touched_.clear();
  }

  PatchFusionOptions options_;
  Sums sums_, open_;  // of closed patches; of the open one
  TsdfMap map_;
  std::map<PatchKey, Held> held_;
  std::uint64_t open_cursor_ = 0;
  std::vector<BlockIndex> touched_;
};
}  // namespace surfleet
