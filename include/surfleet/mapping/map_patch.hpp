// SPDX-License-Identifier: MIT
/// @file
/// @brief A map patch: what one robot saw in a few images, in whole numbers, to be shared and fused
/// [000 §4.4.1].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <surfleet/core/transport.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/mapping/view_notes.hpp>

namespace surfleet {
/// Which patch: the `number`-th of a robot since it was started for the `incarnation`-th time.
struct PatchKey {
  RobotId robot = 0;
  std::uint32_t incarnation = 0;
  std::uint32_t number = 0;
  auto operator<=>(const PatchKey&) const = default;
};
/// Which patch, and which content under that name.
struct PatchId {
  PatchKey key{};
  std::uint64_t hash = 0;  ///< Of the content; tells accidents apart, not forgeries.
  auto operator<=>(const PatchId&) const = default;
};
inline std::string to_string(const PatchKey& k) {
  return "patch " + std::to_string(k.number) + " of robot " + std::to_string(k.robot) + "." +
         std::to_string(k.incarnation);
}

inline constexpr int kPatchDistanceSteps = 127;               ///< Steps of a distance up to µ.
inline constexpr double kPatchWeightUnit = 1.0 / (1 << 12);   ///< Of weights in patches.
inline constexpr std::uint32_t kPatchMaxWeight = 0x7FFFFFFF;  ///< In units; more is cut off.

/// A `SurfaceHit` of a patch: weights in patch units, position and normal as means.
struct PatchHit {
  std::uint16_t key = 0;  ///< As of `SurfaceHit`.
  std::uint32_t weight = 0, passed = 0;
  std::array<std::int8_t, 3> position{};  ///< Mean, in ±`SurfaceHit::kSteps`.
  std::array<std::int8_t, 3> normal{};    ///< Mean, in ±`SurfaceHit::kNormal`.
  bool operator==(const PatchHit&) const = default;

  /// The hit's part of sums.
  SurfaceHit sums() const {
    constexpr auto kUnit = static_cast<std::int64_t>(kPatchWeightUnit / SurfaceHit::kWeightUnit);
    SurfaceHit h{.key = key, .weight = weight * kUnit, .passed = passed * kUnit};
    for (std::size_t k = 0; k < 3; ++k) {
      h.position[k] = h.weight * position[k];
      h.normal[k] = h.weight * normal[k];
    }
    return h;
  }
};

/// Distances and weights of a block's voxels, and its hits by ascending key.
struct PatchBlock {
  BlockIndex index = BlockIndex::Zero();
  std::array<std::int8_t, TsdfMap::kBlockVoxels> distance{};  ///< Steps; 0 without weight.
  std::array<std::uint32_t, TsdfMap::kBlockVoxels> weight{};  ///< Units; 0: not seen.
  std::vector<PatchHit> hits;

  bool operator==(const PatchBlock&) const = default;
  std::size_t seen() const {
    return weight.size() -
           static_cast<std::size_t>(std::count(weight.begin(), weight.end(), std::uint32_t{0}));
  }
  bool empty() const { return hits.empty() && seen() == 0; }
};

/// What was seen, on the voxel lattice of the frame in which its robot knows its own poses. A robot
/// that comes to know that frame better moves the patch (`moved_patch`).
struct MapPatch {
  PatchId id;
  double voxel_size = 0.3;         ///< [m]
  double truncation = 0.9;         ///< µ [m]
  Pose anchor = Pose::Identity();  ///< Of the camera at the first image, in the patch's frame.
  std::uint32_t images = 0;        ///< How many it is made of.
  std::vector<PatchBlock> blocks;  ///< In the order of `patch_order`, none of them empty.
  ViewNotes notes;                 ///< What its robot has viewed in vain since the last one.

  std::size_t seen() const {
    std::size_t n = 0;
    for (const PatchBlock& b : blocks) n += b.seen();
    return n;
  }
};

/// The order of a patch's blocks: by z, then y, then x.
inline bool patch_order(const BlockIndex& a, const BlockIndex& b) {
  return std::array{a.z(), a.y(), a.x()} < std::array{b.z(), b.y(), b.x()};
}

namespace detail {
/// a / b to the nearest, halves away from zero; b > 0.
inline std::int64_t divide_rounded(std::int64_t a, std::int64_t b) {
  return a >= 0 ? (a + b / 2) / b : -((-a + b / 2) / b);
}
inline std::uint32_t patch_weight(double weight) {
  return static_cast<std::uint32_t>(
      std::min(std::round(weight / kPatchWeightUnit), double{kPatchMaxWeight}));
}
inline PatchHit quantised(const SurfaceHit& h) {
  constexpr auto kUnit = static_cast<std::int64_t>(kPatchWeightUnit / SurfaceHit::kWeightUnit);
  const auto units = [](std::int64_t w) {
    return static_cast<std::uint32_t>(
        std::min<std::int64_t>(divide_rounded(w, kUnit), kPatchMaxWeight));
  };
  PatchHit q{.key = h.key, .weight = units(h.weight), .passed = units(h.passed)};
  if (q.weight == 0) return q;
  for (std::size_t k = 0; k < 3; ++k) {
    q.position[k] = static_cast<std::int8_t>(divide_rounded(h.position[k], h.weight));
    q.normal[k] = static_cast<std::int8_t>(divide_rounded(h.normal[k], h.weight));
  }
  return q;
}
}  // namespace detail

/// A block of a map as it stands in patches. What weighs less than half a unit is nothing.
inline PatchBlock quantised(const TsdfMap::Block& block, double truncation) {
  PatchBlock q;
  q.index = block.index;
  const double steps = kPatchDistanceSteps / truncation;
  for (std::size_t i = 0; i < block.voxels.size(); ++i) {
    const TsdfVoxel& v = block.voxels[i];
    if (!(v.weight > 0.0F)) continue;
    q.weight[i] = detail::patch_weight(static_cast<double>(v.weight));
    if (q.weight[i] == 0) continue;
    const double d = std::round(static_cast<double>(v.distance) * steps);
    q.distance[i] = static_cast<std::int8_t>(
        std::clamp(d, -double{kPatchDistanceSteps}, double{kPatchDistanceSteps}));
  }
  for (const SurfaceHit& h : block.layer.hits()) {
    const PatchHit hit = detail::quantised(h);
    if (hit.weight != 0 || hit.passed != 0) q.hits.push_back(hit);
  }
  return q;
}

/// All of a map as a patch without a name. O(map).
inline MapPatch make_patch(const TsdfMap& map, double truncation) {
  require(truncation > 0.0 && std::isfinite(truncation),
          "patch: truncation " + std::to_string(truncation) + " m; expected a positive length");
  MapPatch patch;
  patch.voxel_size = map.voxel_size();
  patch.truncation = truncation;
  map.for_each_block([&](const TsdfMap::Block& block) {
    PatchBlock q = quantised(block, truncation);
    if (!q.empty()) patch.blocks.push_back(std::move(q));
  });
  std::sort(patch.blocks.begin(), patch.blocks.end(),
            [](const PatchBlock& a, const PatchBlock& b) { return patch_order(a.index, b.index); });
  return patch;
}
}  // namespace surfleet
