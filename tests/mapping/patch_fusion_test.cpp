// SPDX-License-Identifier: MIT
#include <surfleet/mapping/patch_fusion.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"
#include "patch_scenes.hpp"

using namespace surfleet;
using namespace surfleet::test;

namespace {
/// By content: blocks in which nothing is are as good as none.
bool same_fused(const TsdfMap& a, const TsdfMap& b) {
  const auto covers = [](const TsdfMap& from, const TsdfMap& to) {
    bool all = true;
    from.for_each_block([&](const TsdfMap::Block& block) {
      static const TsdfMap::Block kNone{};
      const TsdfMap::Block* other = to.find_block(block.index);
      if (other == nullptr) other = &kNone;
      all = all && block.layer == other->layer;
      for (std::size_t i = 0; i < block.voxels.size(); ++i)
        all = all && block.voxels[i].distance == other->voxels[i].distance &&
              block.voxels[i].weight == other->voxels[i].weight;
    });
    return all;
  };
  return covers(a, b) && covers(b, a);
}
PatchFusion fused(const std::vector<MapPatch>& patches) {
  PatchFusion fusion;
  for (const MapPatch& p : patches) CHECK(fusion.add(p));
  return fusion;
}
std::vector<MapPatch> random_patches(std::uint64_t first, int count) {
  std::vector<MapPatch> patches;
  for (int i = 0; i < count; ++i) {
    patches.push_back(random_patch(first + static_cast<std::uint64_t>(i), 10));
    patches.back().id = encode_patch(patches.back()).id;
  }
  return patches;
}
}  // namespace

TEST(what_was_open_is_the_same_map_in_one_patch_or_in_many) {
  PatchRecorder recorder = sheet_recorder(0);
  PatchFusion fusion({.voxel_size = kSheetVoxel, .truncation = 3.0 * kSheetVoxel});
  recorder.integrate(sheet_images(1)[0], sheet_camera(), sheet_pose(0));
  fusion.show_open(recorder.open());
  const std::uint64_t revision = fusion.map().revision();
  const std::vector<MapPatch> parts = recorder.close({}, {.blocks = 9});
  CHECK(parts.size() > 3);
  fusion.close_open(parts);
  CHECK(fusion.map().revision() == revision && fusion.size() == parts.size());
  for (const MapPatch& part : parts) fusion.remove(part);
  CHECK(fusion.size() == 0 && fusion.map().revision() != revision);
}
TEST(fusion_is_the_sum_of_whole_numbers_whatever_comes_and_goes) {
  Random random(5);
  for (int trial = 0; trial < 12; ++trial) {
    const std::vector<MapPatch> patches = random_patches(1000 + 40 * random.below(100), 12);
    PatchFusion fusion;
    std::vector<char> in(patches.size(), 0);
    for (int step = 0; step < 60; ++step) {
      const std::size_t n = random.below(patches.size());
      const std::uint64_t before = fusion.map().revision();
      if (in[n] != 0)
        fusion.remove(patches[n]);
      else
        CHECK(fusion.add(patches[n]) && !fusion.add(patches[n]));
      in[n] = in[n] != 0 ? 0 : 1;
      CHECK(fusion.holds(patches[n].id.key) == (in[n] != 0));
      // What changed lies in the patch's own blocks.
      for (const std::uint32_t slot : fusion.map().changed_since(before)) {
        const BlockIndex& b = fusion.map().block(slot).index;
        CHECK(std::any_of(patches[n].blocks.begin(), patches[n].blocks.end(),
                          [&](const PatchBlock& own) { return own.index == b; }));
      }
    }
    std::map<VoxelKey, std::array<std::int64_t, 2>> sums;
    std::map<std::pair<VoxelKey, int>, SurfaceHit> hits;
    for (std::size_t n = 0; n < patches.size(); ++n)
      for (const PatchBlock& b : patches[n].blocks)
        if (in[n] != 0) {
          for (int i = 0; i < 512; ++i) {
            const auto at = static_cast<std::size_t>(i);
            auto& sum = sums[{b.index.x() * 8 + i % 8, b.index.y() * 8 + i / 8 % 8,
                              b.index.z() * 8 + i / 64}];
            sum[0] += b.weight[at];
            sum[1] += std::int64_t{b.distance[at]} * b.weight[at];
          }
          for (const PatchHit& h : b.hits) {
            SurfaceHit& hit = hits[{key_of(b.index), h.key}];
            hit.key = h.key;
            hit.add(h.sums(), 1);
          }
        }
    std::size_t wrong = 0, found_hits = 0;
    fusion.map().for_each_block([&](const TsdfMap::Block& b) {
      for (std::size_t i = 0; i < 512; ++i) {
        const auto it = sums.find(key_of(TsdfMap::index_in(b, i)));
        const std::array<std::int64_t, 2> sum =
            it == sums.end() ? std::array<std::int64_t, 2>{} : it->second;
        const TsdfVoxel& v = b.voxels[i];
        const double d = sum[0] == 0 ? 0.0 : static_cast<double>(sum[1]) / double(sum[0]);
        wrong += v.weight != static_cast<float>(static_cast<double>(sum[0]) / 4096.0) ? 1 : 0;
        wrong += std::abs(static_cast<double>(v.distance) - d * 0.9 / 127.0) > 1e-6 ? 1 : 0;
        sums.erase(key_of(TsdfMap::index_in(b, i)));
      }
      for (const SurfaceHit& h : b.layer.hits()) {
        ++found_hits;
        const auto it = hits.find({key_of(b.index), h.key});
        wrong += it == hits.end() || !(it->second == h) ? 1 : 0;
      }
    });
    CHECK(wrong == 0 && found_hits == hits.size());
    CHECK(std::all_of(sums.begin(), sums.end(), [](const auto& s) { return s.second[0] == 0; }));

    // Afresh, in another order.
    std::vector<MapPatch> left;
    for (std::size_t n = 0; n < patches.size(); ++n)
      if (in[n] != 0) left.push_back(patches[n]);
    random.shuffle(left);
    CHECK(same_fused(fusion.map(), fused(left).map()));
    for (const MapPatch& p : left) fusion.remove(p);
    CHECK(fusion.size() == 0 && same_fused(fusion.map(), TsdfMap({.voxel_size = 0.3})));
  }
}

TEST(fusion_refuses_what_does_not_belong) {
  const std::vector<MapPatch> patches = random_patches(50, 3);
  PatchFusion fusion;
  fusion.add(patches[0]);
  CHECK_THROWS(Error, fusion.remove(patches[1]));
  MapPatch other = patches[0];
  other.id.hash ^= 1;
  CHECK_THROWS(Error, fusion.remove(other));
  CHECK(!fusion.add(other));
  other = patches[1];
  other.truncation = 0.8;
  CHECK_THROWS(Error, fusion.add(other));
  other.truncation = 0.9;
  other.voxel_size = 0.2;
  CHECK_THROWS(Error, fusion.add(other));
  Pose scaled = Pose::Identity();
  scaled.linear() *= 2.0;
  CHECK_THROWS(Error, fusion.add(patches[1], scaled));
  CHECK_THROWS(Error, fusion.move(patches[0], scaled));
  CHECK_THROWS(Error, fusion.replace(patches, random_patch(99, 2)));
  CHECK_THROWS(Error, PatchFusion({.truncation = 0.0}));
  CHECK(fusion.size() == 1 && same_fused(fusion.map(), fused({patches[0]}).map()));
}

TEST(what_is_open_counts_as_it_will_when_it_is_closed) {
  PatchRecorder recorder = sheet_recorder(1);
  PatchFusion fusion({.voxel_size = kSheetVoxel, .truncation = 3.0 * kSheetVoxel});
  const MapPatch mate = sheet_patches(1, 2).front();
  for (int i = 0; i < 3; ++i) {
    recorder.integrate(sheet_images(1, i).front(), sheet_camera(), sheet_pose(i));
    fusion.show_open(recorder.open());
    if (i == 1) fusion.add(mate);
    PatchFusion afresh(fusion.options());
    if (i >= 1) afresh.add(mate);
    afresh.add(make_patch(recorder.open(), 3.0 * kSheetVoxel));
    CHECK(same_fused(fusion.map(), afresh.map()));
  }
  const std::uint64_t before = fusion.map().revision();
  const MapPatch patch = recorder.close();
  fusion.close_open({&patch, 1});
  CHECK(fusion.map().revision() == before && fusion.size() == 2);
  fusion.show_open(recorder.open());
  CHECK(fusion.map().revision() == before);
  // What is shown and then given up is gone.
  recorder.integrate(sheet_images(1, 7).front(), sheet_camera(), sheet_pose(7));
  fusion.show_open(recorder.open());
  CHECK(fusion.map().revision() > before);
  fusion.close_open({});
  PatchFusion two(fusion.options());
  two.add(patch);
  two.add(mate);
  CHECK(same_fused(fusion.map(), two.map()));
}

TEST(patches_move_exactly_by_whole_steps) {
  Random random(6);
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const MapPatch patch = random_patch(seed, 5, 3);
    MapPatch bare = patch;  // random hits need not face the sides they are filed under
    for (PatchBlock& b : bare.blocks) b.hits.clear();
    std::erase_if(bare.blocks, [](const PatchBlock& b) { return b.empty(); });
    CHECK(moved_patch(bare, Pose::Identity()).blocks == bare.blocks);
    // Quarter turns and whole voxels: every voxel and hit lands on one, and back again.
    Pose T = Pose::Identity();
    T.linear() = (Eigen::AngleAxisd(0.5 * kPi * static_cast<double>(random.below(4)),
                                    Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(0.5 * kPi * static_cast<double>(random.below(4)),
                                    Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
    for (int k = 0; k < 3; ++k)
      T.translation()[k] = 0.3 * (static_cast<double>(random.below(40)) - 20.0);
    const MapPatch moved = moved_patch(patch, T);
    CHECK(moved.seen() == patch.seen());
    TsdfMap lattice({.voxel_size = 0.3});
    std::map<VoxelKey, std::pair<std::uint32_t, int>> there;
    for (const PatchBlock& b : moved.blocks)
      for (int i = 0; i < 512; ++i)
        there[{b.index.x() * 8 + i % 8, b.index.y() * 8 + i / 8 % 8, b.index.z() * 8 + i / 64}] = {
            b.weight[static_cast<std::size_t>(i)], b.distance[static_cast<std::size_t>(i)]};
    for (const PatchBlock& b : patch.blocks)
      for (int i = 0; i < 512; ++i) {
        const auto n = static_cast<std::size_t>(i);
        if (b.weight[n] == 0) continue;
        const VoxelIndex v = b.index * 8 + VoxelIndex(i % 8, i / 8 % 8, i / 64);
        const auto it = there.find(key_of(lattice.index_of(T * lattice.center(v))));
        CHECK(it != there.end() &&
              it->second == std::pair<std::uint32_t, int>(b.weight[n], b.distance[n]));
      }
    std::int64_t weight = 0, moved_weight = 0;
    for (const PatchBlock& b : patch.blocks)
      for (const PatchHit& h : b.hits) weight += h.weight + h.passed;
    for (const PatchBlock& b : moved.blocks)
      for (const PatchHit& h : b.hits) moved_weight += h.weight + h.passed;
    CHECK(weight == moved_weight);
  }
}

TEST(patches_moved_by_less_are_resampled) {
  // A plane's distances are linear, so trilinear samples are right but for rounding.
  TsdfMap map({.voxel_size = 0.3});
  const Eigen::Vector3d n = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  for_each_index({-12, -12, -12}, {11, 11, 11}, [&](const VoxelIndex& v) {
    const double d = n.dot(map.center(v));
    if (std::abs(d) < 0.9) map.ensure(v) = {static_cast<float>(d), 0.5F};
  });
  map.ensure_block({0, 0, 0}).layer.ensure(SurfaceHits::key_of(0, 4)) = {
      .key = SurfaceHits::key_of(0, 4), .weight = 1 << 20, .normal = {0, 0, 64 << 20}};
  const MapPatch patch = make_patch(map, 0.9);
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  T.translation() = Point3(0.11, -0.47, 0.2);
  const MapPatch moved = moved_patch(patch, T);
  CHECK(moved.seen() > patch.seen() / 3);
  std::size_t hits = 0;
  for (const PatchBlock& b : moved.blocks) {
    for (std::size_t i = 0; i < b.weight.size(); ++i) {
      if (b.weight[i] == 0) continue;
      const auto o = static_cast<int>(i);
      const VoxelIndex v = b.index * 8 + VoxelIndex(o & 7, o >> 3 & 7, o >> 6);
      const Point3 at = T.inverse() * map.center(v);
      CHECK(b.weight[i] == 2048);
      CHECK_NEAR(b.distance[i] * 0.9 / 127, n.dot(at), 1.1 * 0.9 / 127);
      // Every voxel around it was seen.
      CHECK(std::abs(n.dot(at)) < 0.9 && at.cwiseAbs().maxCoeff() < 3.46);
    }
    for (const PatchHit& h : b.hits) {
      ++hits;
      const Point3 at =
          map.center(b.index * 8 + VoxelIndex(h.key >> 3 & 7, h.key >> 6 & 7, h.key >> 9)) +
          h.sums().mean_offset(0.3);
      CHECK((at - T * map.center({0, 0, 0})).norm() < 0.01);
      CHECK(h.sums().mean_normal().dot(T.linear() * Eigen::Vector3d::UnitZ()) > 0.999);
    }
  }
  CHECK(hits == 1);
  // Moved away and home again by the fusion, nothing is left of the motion.
  MapPatch named = patch;
  named.id = encode_patch(patch).id;
  PatchFusion fusion;
  fusion.add(named, T);
  PatchFusion moved_late;
  moved_late.add(named);
  moved_late.move(named, T);
  CHECK(same_fused(fusion.map(), moved_late.map()));
  fusion.move(named, Pose::Identity());
  CHECK(same_fused(fusion.map(), fused({named}).map()));
}

TEST(many_patches_become_one) {
  const std::vector<MapPatch> patches = random_patches(300, 6);
  PatchFusion fusion = fused(patches);
  const PatchFusion before = fused(patches);
  MapPatch whole = coalesced_patch(patches, {9, 0, 0});
  whole.id = encode_patch(whole).id;
  CHECK(whole.images == 30);
  fusion.replace(patches, whole);
  CHECK(fusion.size() == 1);
  before.map().for_each_block([&](const TsdfMap::Block& b) {
    const TsdfMap::Block* now = fusion.map().find_block(b.index);
    CHECK(now != nullptr);
    for (std::size_t i = 0; now != nullptr && i < 512; ++i) {
      CHECK(now->voxels[i].weight == b.voxels[i].weight);
      CHECK_NEAR(now->voxels[i].distance, b.voxels[i].distance, 0.51 * 0.9 / 127);
    }
    for (const SurfaceHit& h : b.layer.hits()) {
      const SurfaceHit* hit = now == nullptr ? nullptr : now->layer.find(h.key);
      CHECK(hit != nullptr && hit->weight == h.weight && hit->passed == h.passed);
    }
  });
  fusion.remove(whole);
  CHECK(same_fused(fusion.map(), TsdfMap({.voxel_size = 0.3})));
  CHECK_THROWS(Error, coalesced_patch({}, {}));
}
