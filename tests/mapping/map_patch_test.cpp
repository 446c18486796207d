// SPDX-License-Identifier: MIT
#include <surfleet/mapping/patch_recorder.hpp>

#include <cmath>
#include <cstdlib>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"
#include "patch_scenes.hpp"
#include "seen_sheet.hpp"

using namespace surfleet;
using namespace surfleet::test;

TEST(a_patch_is_its_images_to_half_a_step) {
  PatchRecorder recorder = sheet_recorder(3);
  const std::vector<DepthImage> images = sheet_images(5);
  for (int i = 0; i < 5; ++i) {
    CHECK(!recorder.due());
    recorder.integrate(images[static_cast<std::size_t>(i)], sheet_camera(), sheet_pose(i));
  }
  CHECK(recorder.due());
  const TsdfMap whole = recorder.open();
  const MapPatch patch = recorder.close();
  CHECK(recorder.open().empty() && recorder.number() == 1 && recorder.images() == 0);
  CHECK(patch.id.key.robot == 3 && patch.id.key.number == 0 && patch.images == 5);
  CHECK(patch.anchor.matrix() == sheet_pose(0).matrix());
  std::size_t seen = 0, hits = 0;
  for (std::size_t i = 1; i < patch.blocks.size(); ++i)
    CHECK(patch_order(patch.blocks[i - 1].index, patch.blocks[i].index));
  for (const PatchBlock& b : patch.blocks) {
    CHECK(!b.empty());
    const TsdfMap::Block& from = *whole.find_block(b.index);
    for (std::size_t i = 0; i < b.weight.size(); ++i) {
      CHECK_NEAR(b.weight[i] * kPatchWeightUnit, from.voxels[i].weight, 0.51 * kPatchWeightUnit);
      if (b.weight[i] == 0) continue;
      ++seen;
      CHECK_NEAR(b.distance[i] * patch.truncation / kPatchDistanceSteps, from.voxels[i].distance,
                 0.51 * patch.truncation / kPatchDistanceSteps);
    }
    for (const PatchHit& h : b.hits) {
      ++hits;
      const SurfaceHit sums = h.sums();
      const SurfaceHit* of = from.layer.find(h.key);
      CHECK(of != nullptr);
      if (of == nullptr || h.weight == 0) continue;
      CHECK_NEAR(sums.weight_value(), of->weight_value(), 0.51 * kPatchWeightUnit);
      CHECK((sums.mean_offset(0.1) - of->mean_offset(0.1)).cwiseAbs().maxCoeff() <
            0.51 * 0.5 * 0.1 / SurfaceHit::kSteps);
      CHECK(sums.mean_normal().dot(of->mean_normal()) > 0.999);
    }
  }
  CHECK(seen == patch.seen() && seen > 10000 && hits > 100);
}

TEST(a_patch_is_due_by_images_or_by_distance) {
  for (const bool by_distance : {false, true}) {
    PatchRecorder recorder({.voxel_size = 0.2,
                            .images = 4,
                            .distance = by_distance ? std::optional(1.0) : std::nullopt},
                           TsdfIntegrator({.truncation = 0.6}));
    const PinholeCamera camera = sheet_camera();
    const DepthImage image(camera.width, camera.height);
    int count = 0;
    while (!recorder.due()) {
      Pose T = Pose::Identity();
      T.translation().x() = 0.6 * count++;
      recorder.integrate(image, camera, T);
    }
    CHECK(count == (by_distance ? 3 : 4));
  }
  CHECK_THROWS(Error, PatchRecorder({.images = 0}));
  CHECK_THROWS(Error, PatchRecorder({.distance = -1.0}));
  CHECK_THROWS(Error, make_patch(TsdfMap({.voxel_size = 0.1}), 0.0));
}

TEST(numbers_are_cut_not_wrapped) {
  TsdfMap map({.voxel_size = 0.3});
  TsdfMap::Block& block = map.ensure_block({0, 0, 0});
  block.voxels[0] = {5.0F, 1e9F};
  block.voxels[1] = {-5.0F, 1e-5F};
  block.voxels[2] = {-5.0F, 1.0F};
  SurfaceHit h{.key = 16, .weight = 3, .passed = 0};
  h.position = {-3 * 64, 2, -2};
  h.normal = {3 * 64, 0, 0};
  block.layer.ensure(16) = h;
  block.layer.ensure(17) = {.key = 17, .weight = 512, .position = {-512 * 64, 511 * 64, 0}};
  const MapPatch patch = make_patch(map, 0.9);
  CHECK(patch.blocks.size() == 1);
  const PatchBlock& q = patch.blocks[0];
  CHECK(q.distance[0] == 127 && q.weight[0] == kPatchMaxWeight);
  CHECK(q.weight[1] == 0 && q.distance[1] == 0);
  CHECK(q.distance[2] == -127 && q.weight[2] == 4096);
  CHECK(q.hits.size() == 1 && q.hits[0].key == 17 && q.hits[0].weight == 2);
  CHECK(q.hits[0].position[0] == -64 && q.hits[0].position[1] == 64 && q.hits[0].normal[0] == 0);
  CHECK(detail::divide_rounded(-5, 2) == -3 && detail::divide_rounded(5, 2) == 3 &&
        detail::divide_rounded(-4, 3) == -1);
}
