// SPDX-License-Identifier: MIT
/// @file
/// @brief Map patches on another lattice: a patch whose frame turned out to lie elsewhere, and many
/// patches as one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/mapping/map_patch.hpp>

namespace surfleet {
namespace detail {
/// Within so many voxels of a voxel's centre, a point is the centre: whole steps move exactly.
inline constexpr double kOnLattice = 1e-6;

struct PatchSample {
  double distance = 0.0;     // steps
  std::uint32_t weight = 0;  // units
};
/// The patch's voxels, found by their index.
using PatchGrid = VoxelGrid<PatchSample, TsdfMap::kBlockSide>;

/// Trilinear at `s`, in voxels from the first one's centre; nothing where a corner has no weight.
inline PatchSample sample_patch(PatchGrid::Accessor& voxels, const Eigen::Vector3d& s) {
  VoxelIndex base;
  Eigen::Vector3d part;
  for (int k = 0; k < 3; ++k) {
    double whole = std::floor(s[k]);
    part[k] = s[k] - whole;
    if (part[k] > 1.0 - kOnLattice) whole += 1.0;
    if (part[k] < kOnLattice || part[k] > 1.0 - kOnLattice) part[k] = 0.0;
    base[k] = static_cast<int>(whole);
  }
  double distance = 0.0, weight = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double share = 1.0;
    VoxelIndex v = base;
    for (int k = 0; k < 3; ++k) {
      const bool far = (corner >> k & 1) != 0;
      share *= far ? part[k] : 1.0 - part[k];
      v[k] += far ? 1 : 0;
    }
    if (share == 0.0) continue;
    const PatchSample* voxel = voxels.find(v);
    if (voxel == nullptr || voxel->weight == 0) return {};
    distance += share * voxel->distance;
    weight += share * voxel->weight;
  }
  return {std::round(distance), static_cast<std::uint32_t>(std::round(weight))};
}

/// A hit at its new place; those without weight stand for their voxel and side.
inline std::pair<VoxelIndex, SurfaceHit> moved_hit(const PatchHit& hit, const Point3& center,
                                                   const Pose& T, const TsdfMap& lattice) {
  const double h = lattice.voxel_size();
  SurfaceHit sums = hit.sums();
  const Point3 at = T * Point3(center + sums.mean_offset(h));
  const VoxelIndex v = lattice.index_of(at);
  const Eigen::Vector3d normal = T.linear() * sums.mean_normal();
  sums.key = SurfaceHits::key_of(TsdfMap::offset_of(v), side_of_normal(normal));
  const Eigen::Vector3d steps = (at - lattice.center(v)) * (2.0 * SurfaceHit::kSteps / h);
  Eigen::Vector3d mean;
  for (int k = 0; k < 3; ++k) mean[k] = hit.normal[static_cast<std::size_t>(k)];
  mean = T.linear() * mean;
  for (int k = 0; k < 3; ++k) {
    const auto n = static_cast<std::size_t>(k);
    sums.position[n] =
        sums.weight *
        std::clamp<std::int64_t>(std::llround(steps[k]), -SurfaceHit::kSteps, SurfaceHit::kSteps);
    sums.normal[n] =
        sums.weight *
        std::clamp<std::int64_t>(std::llround(mean[k]), -SurfaceHit::kNormal, SurfaceHit::kNormal);
  }
  return {v, sums};
}

inline std::vector<PatchBlock> sorted_patch_blocks(std::map<VoxelKey, PatchBlock> blocks) {
  std::vector<PatchBlock> sorted;
  for (auto& [key, block] : blocks)
    if (!block.empty()) sorted.push_back(std::move(block));
  std::sort(sorted.begin(), sorted.end(),
            [](const PatchBlock& a, const PatchBlock& b) { return patch_order(a.index, b.index); });
  return sorted;
}
inline void set_patch_hits(PatchBlock& block, const SurfaceHits& sums) {
  for (const SurfaceHit& h : sums.hits()) {
    const PatchHit hit = quantised(h);
    if (hit.weight != 0 || hit.passed != 0) block.hits.push_back(hit);
  }
}
}  // namespace detail

/// The patch as it stands when its frame lies at `T_map_frame`: distances and weights resampled
/// trilinearly, without weight where one of the eight voxels around has none; hits moved one by
/// one. Exact where voxels fall on voxels. The name stays; the hash is not of what comes out.
/// Throws `Error` for a pose that is no rigid motion. O(patch).
inline MapPatch moved_patch(const MapPatch& patch, const Pose& T_map_frame) {
  require(T_map_frame.matrix().allFinite() &&
              (T_map_frame.linear().transpose() * T_map_frame.linear()).isIdentity(1e-6) &&
              T_map_frame.linear().determinant() > 0.0,
          "moving a patch: expected a rigid motion");
  const double h = patch.voxel_size;
  const TsdfMap lattice({.voxel_size = h});
  detail::PatchGrid from({.voxel_size = h});
  std::map<VoxelKey, PatchBlock> blocks;
  std::map<VoxelKey, SurfaceHits> hits;
  const double side = TsdfMap::kBlockSide * h;
  for (const PatchBlock& b : patch.blocks) {
    auto& own = from.ensure_block(b.index);
    for (std::size_t i = 0; i < b.weight.size(); ++i)
      own.voxels[i] = {static_cast<double>(b.distance[i]), b.weight[i]};
    // Every block of the map that may have a voxel's centre in this one or a voxel around it.
    Box3 reach;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d c(corner & 1, corner >> 1 & 1, corner >> 2);
      reach.extend(T_map_frame * Point3((b.index.cast<double>() + c) * side));
    }
    for_each_index(TsdfMap::block_of(lattice.index_of(reach.min() - Point3::Constant(h))),
                   TsdfMap::block_of(lattice.index_of(reach.max() + Point3::Constant(h))),
                   [&](const BlockIndex& to) { blocks[key_of(to)].index = to; });
    for (const PatchHit& hit : b.hits) {
      const VoxelIndex v = detail::PatchGrid::index_in(own, static_cast<std::size_t>(hit.key >> 3));
      const auto [to, sums] = detail::moved_hit(hit, from.center(v), T_map_frame, lattice);
      hits[key_of(TsdfMap::block_of(to))].ensure(sums.key).add(sums, 1);
    }
  }
  const Pose T_frame_map = T_map_frame.inverse();
  auto voxels = from.accessor();
  for (auto& [key, block] : blocks)
    for (std::size_t i = 0; i < block.weight.size(); ++i) {
      const auto o = static_cast<int>(i);
      const VoxelIndex v =
          block.index * TsdfMap::kBlockSide + VoxelIndex(o & 7, o >> 3 & 7, o >> 6);
      const Eigen::Vector3d s =
          T_frame_map * lattice.center(v) / h - Eigen::Vector3d::Constant(0.5);
      const detail::PatchSample sample = detail::sample_patch(voxels, s);
      block.weight[i] = sample.weight;
      block.distance[i] = static_cast<std::int8_t>(sample.distance);
    }
  for (const auto& [key, sums] : hits) {
    PatchBlock& block = blocks[key];
    block.index = {key[0], key[1], key[2]};
    detail::set_patch_hits(block, sums);
  }
  MapPatch moved = patch;
  moved.anchor = T_map_frame * patch.anchor;
  moved.notes = moved_notes(patch.notes, T_map_frame, h);
  moved.blocks = detail::sorted_patch_blocks(std::move(blocks));
  return moved;
}

/// Many patches of one frame as one, which weighs what they weigh together; distances and hits are
/// rounded once more. Throws `Error` on none, on different lattices or on notes of different kinds.
/// O(their voxels).
inline MapPatch coalesced_patch(std::span<const MapPatch> patches, const PatchKey& name) {
  require(!patches.empty(), "coalescing patches: expected at least one");
  struct Sum {
    std::array<std::int64_t, TsdfMap::kBlockVoxels> weight{}, weighted{};
    SurfaceHits hits;
  };
  MapPatch whole;
  whole.id.key = name;
  whole.voxel_size = patches[0].voxel_size;
  whole.truncation = patches[0].truncation;
  whole.anchor = patches[0].anchor;
  std::map<VoxelKey, Sum> sums;
  std::vector<ViewNotes> notes;
  for (const MapPatch& patch : patches) {
    require(patch.voxel_size == whole.voxel_size && patch.truncation == whole.truncation,
            "coalescing patches: expected one voxel size and truncation");
    whole.images += patch.images;
    notes.push_back(patch.notes);
    for (const PatchBlock& b : patch.blocks) {
      Sum& sum = sums[key_of(b.index)];
      for (std::size_t i = 0; i < b.weight.size(); ++i) {
        sum.weight[i] += b.weight[i];
        sum.weighted[i] += std::int64_t{b.weight[i]} * b.distance[i];
      }
      for (const PatchHit& hit : b.hits) sum.hits.ensure(hit.key).add(hit.sums(), 1);
    }
  }
  std::map<VoxelKey, PatchBlock> blocks;
  for (const auto& [key, sum] : sums) {
    PatchBlock& block = blocks[key];
    block.index = {key[0], key[1], key[2]};
    for (std::size_t i = 0; i < block.weight.size(); ++i) {
      if (sum.weight[i] == 0) continue;
      block.weight[i] =
          static_cast<std::uint32_t>(std::min<std::int64_t>(sum.weight[i], kPatchMaxWeight));
      block.distance[i] =
          static_cast<std::int8_t>(detail::divide_rounded(sum.weighted[i], sum.weight[i]));
    }
    detail::set_patch_hits(block, sum.hits);
  }
  whole.notes = merged_notes(notes);
  whole.blocks = detail::sorted_patch_blocks(std::move(blocks));
  return whole;
}
}  // namespace surfleet
