// SPDX-License-Identifier: MIT
/// @file
/// @brief Patches for tests: of a sheet that is flown around, and of random numbers.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/mapping/patch_codec.hpp>
#include <surfleet/mapping/patch_recorder.hpp>

#include "seen_sheet.hpp"

namespace surfleet::test {
inline constexpr double kSheetVoxel = 0.1;
inline Pose sheet_pose(int shot) {
  const double a = 0.12 * shot + 0.3;
  const Point3 eye(2.5 * std::cos(a), 2.5 * std::sin(a), 0.13);
  return facing(eye, -eye);
}
inline std::vector<DepthImage> sheet_images(int count, int first = 0) {
  std::vector<DepthImage> images;
  for (int i = 0; i < count; ++i)
    images.push_back(render(sheet_camera(), sheet_pose(first + i), sheet(0.04)));
  return images;
}
inline PatchRecorder sheet_recorder(RobotId robot, std::uint32_t incarnation = 0) {
  return PatchRecorder(
      {.robot = robot, .incarnation = incarnation, .voxel_size = kSheetVoxel},
      TsdfIntegrator({.truncation = 3.0 * kSheetVoxel}, drop_off_by_voxels(kSheetVoxel)));
}
/// Patches of five images each along the circle.
inline std::vector<MapPatch> sheet_patches(int count, RobotId robot = 0) {
  PatchRecorder recorder = sheet_recorder(robot);
  std::vector<MapPatch> patches;
  for (int p = 0; p < count; ++p) {
    const std::vector<DepthImage> images = sheet_images(5, 5 * p);
    for (int i = 0; i < 5; ++i)
      recorder.integrate(images[static_cast<std::size_t>(i)], sheet_camera(),
                         sheet_pose(5 * p + i));
    patches.push_back(recorder.close());
  }
  return patches;
}

inline PatchBlock random_patch_block(Random& random, const BlockIndex& index) {
  PatchBlock b;
  b.index = index;
  const std::uint64_t kind = random.below(4);  // sparse, full, free, hits alone
  for (std::size_t i = 0; i < b.weight.size() && kind != 3; ++i) {
    if (kind == 0 && random.below(3) != 0) continue;
    b.weight[i] = 1 + static_cast<std::uint32_t>(random.below(random.below(9) == 0 ? 400000 : 900));
    b.distance[i] = kind == 2 ? std::int8_t{kPatchDistanceSteps}
                              : static_cast<std::int8_t>(static_cast<int>(random.below(255)) - 127);
  }
  int key = 0;
  const std::uint64_t hits = kind == 3 ? 1 + random.below(40) : random.below(20);
  for (std::uint64_t i = 0; i < hits; ++i) {
    key += 1 + static_cast<int>(random.below(60));
    if ((key & 7) > 5) key += 2;
    PatchHit h{.key = static_cast<std::uint16_t>(key),
               .weight = static_cast<std::uint32_t>(random.below(4) == 0 ? 0 : random.below(3000)),
               .passed = static_cast<std::uint32_t>(random.below(300))};
    if (h.weight == 0) h.passed += 1;
    for (std::size_t k = 0; k < 3 && h.weight != 0; ++k) {
      h.position[k] = static_cast<std::int8_t>(static_cast<int>(random.below(129)) - 64);
      h.normal[k] = static_cast<std::int8_t>(static_cast<int>(random.below(129)) - 64);
    }
    b.hits.push_back(h);
  }
  return b;
}
/// Of a few views and failures about the origin, each once.
inline ViewNotes random_notes(Random& random, int count) {
  ViewNotes notes;
  const auto place = [&] {
    VoxelKey p{};
    for (int& v : p) v = static_cast<int>(random.below(9)) - 4;
    return p;
  };
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d d(random.normal(), random.normal(), random.normal());
    notes.views.push_back({place(), quantised(Eigen::Vector3d(d.normalized()))});
    notes.failures.push_back({place(), static_cast<std::uint8_t>(1 + random.below(3))});
  }
  return merged_notes(std::span<const ViewNotes>(&notes, 1));
}
/// About `blocks` of them, none empty, in a box of `side` blocks about the origin.
inline MapPatch random_patch(std::uint64_t seed, int blocks, int side = 4) {
  Random random(seed);
  MapPatch patch;
  patch.id.key = {static_cast<RobotId>(seed % 5), 1, static_cast<std::uint32_t>(seed / 5)};
  patch.images = 5;
  patch.anchor.translation() = Point3(0.5, -0.25, 1.0);
  patch.anchor.linear() =
      Eigen::AngleAxisd(0.01 * static_cast<double>(seed % 300), Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  const auto coordinate = [&] {
    return static_cast<int>(random.below(static_cast<std::uint64_t>(side))) - side / 2;
  };
  for (int n = 0; n < blocks; ++n) {
    const int x = coordinate(), y = coordinate(), z = coordinate();
    patch.blocks.push_back(random_patch_block(random, {x, y, z}));
    if (patch.blocks.back().empty()) patch.blocks.pop_back();
  }
  std::sort(patch.blocks.begin(), patch.blocks.end(),
            [](const PatchBlock& a, const PatchBlock& b) { return patch_order(a.index, b.index); });
  patch.blocks.erase(
      std::unique(patch.blocks.begin(), patch.blocks.end(),
                  [](const PatchBlock& a, const PatchBlock& b) { return a.index == b.index; }),
      patch.blocks.end());
  patch.notes = random_notes(random, static_cast<int>(seed % 4));
  patch.notes.kind = 7;
  return patch;
}
inline bool same_content(const MapPatch& a, const MapPatch& b) {
  return a.id.key == b.id.key && a.voxel_size == b.voxel_size && a.truncation == b.truncation &&
         a.images == b.images && a.anchor.matrix() == b.anchor.matrix() && a.blocks == b.blocks &&
         a.notes == b.notes;
}
}  // namespace surfleet::test
