// SPDX-License-Identifier: MIT
/// Everything that follows a map follows one that patches leave.
#include <surfleet/mapping/patch_fusion.hpp>

#include <cmath>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/viewpoint/frontiers.hpp>
#include <surfleet/viewpoint/gain.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/surface_prediction.hpp>
#include <surfleet/viewpoint/view_memory.hpp>

#include "../mapping/patch_scenes.hpp"
#include "check.hpp"

using namespace surfleet;
using namespace surfleet::test;

namespace {
/// At `eye`, towards the sheet.
Configuration facing(const Point3& eye) { return {eye, std::atan2(-eye.y(), -eye.x())}; }

/// What a planner reads, on a fusion of patches.
struct Followers {
  VoxelStateMap states;
  IncompleteSurface incomplete{{.known_weight = 0.3}};
  FreeSpace free;
  LazyPrmStar roadmap;
  Frontiers frontiers;
  SurfacePredictor predict;
  ChangedRegions changed;
  SightMemory sights;
  explicit Followers(const TsdfMap& map)
      : states(map, {.known_weight = 0.3}),
        free(states,
             {.radius = 0.3, .bounds = Box3(Point3(-4, -4, -3), Point3(4, 4, 3)), .margin = 0.2}),
        roadmap(free, {.seed = 3}) {
    incomplete.update(states);
  }
  void update(const TsdfMap& map) {
    states.update(map);
    incomplete.update(states);
    free.update();
    roadmap.update();
    frontiers.update(states, free.options().bounds, 0.4);
    sights.forget(changed(states, states, free));
  }
  std::vector<PredictedPatch> predicted() {
    const auto elements = incomplete.elements();
    return predict(elements, states, {.reach = 1.5});
  }
  /// What views before the sheet show.
  std::vector<std::vector<std::int32_t>> shown() {
    const auto elements = incomplete.elements();
    const ViewFrustum frustum(sheet_camera(), forward_camera_mount());
    std::vector<Viewpoint> views;
    for (int i = 0; i < 45; i += 9)
      views.push_back({.configuration = facing(sheet_pose(i).translation()), .targets = {}});
    const IncompleteSurfaceGain gain(elements, states, frustum);
    return sights(views, elements, frustum, [&](const Configuration& q) { return gain.seen(q); });
  }
};
}  // namespace

TEST(what_planners_read_and_remember_after_removal_equals_what_is_built_afresh) {
  const PatchFusionOptions options{.voxel_size = 0.2, .truncation = 0.6};
  PatchRecorder recorder({.voxel_size = 0.2},
                         TsdfIntegrator({.truncation = 0.6}, drop_off_by_voxels(0.2)));
  std::vector<MapPatch> patches;
  for (int p = 0; p < 5; ++p) {
    for (int i = 0; i < 5; ++i) {
      const Pose T = sheet_pose(9 * p + i);
      recorder.integrate(render(sheet_camera(), T, sheet(0.04)), sheet_camera(), T);
    }
    patches.push_back(recorder.close());
  }
  PatchFusion fusion(options);
  Followers kept(fusion.map());
  Random random(4);
  std::vector<char> in(patches.size(), 0);
  std::size_t elements = 0, reached = 0, cut_off = 0, predicted = 0, shown = 0;
  for (int round = 0; round < 8; ++round) {
    for (std::uint64_t n = 1 + random.below(3); n > 0; --n) {
      const std::size_t p = random.below(patches.size());
      if (in[p] != 0)
        fusion.remove(patches[p]);
      else
        fusion.add(patches[p]);
      in[p] = in[p] != 0 ? 0 : 1;
    }
    kept.update(fusion.map());
    PatchFusion built(options);
    for (std::size_t p = patches.size(); p-- > 0;)
      if (in[p] != 0) built.add(patches[p]);
    Followers fresh(built.map());
    std::size_t wrong = 0;
    const Box3 bounds = kept.free.options().bounds;
    for_each_index(fusion.map().index_of(bounds.min()), fusion.map().index_of(bounds.max()),
                   [&](const VoxelIndex& v) {
                     wrong += kept.states(v) != fresh.states(v) ? 1 : 0;
                     wrong += kept.free.is_free_voxel(v) != fresh.free.is_free_voxel(v) ? 1 : 0;
                   });
    CHECK(wrong == 0);
    const auto a = kept.incomplete.elements(), b = fresh.incomplete.elements();
    CHECK(a.size() == b.size());
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
      CHECK(a[i].voxel == b[i].voxel && a[i].direction == b[i].direction);
    const auto p = kept.predicted(), q = fresh.predicted();
    CHECK(p.size() == q.size());
    for (std::size_t i = 0; i < p.size() && i < q.size(); ++i)
      CHECK(p[i].position == q[i].position && p[i].normal == q[i].normal);
    predicted += p.size();
    fresh.frontiers.update(fresh.states, fresh.free.options().bounds, 0.4);
    CHECK(kept.frontiers.size() == fresh.frontiers.size());
    for (std::size_t i = 0; i < kept.frontiers.size() && i < fresh.frontiers.size(); ++i)
      CHECK(kept.frontiers.center(i) == fresh.frontiers.center(i));
    const auto s = kept.shown(), t = fresh.shown();
    CHECK(s == t);
    for (const auto& ids : s) shown += ids.size();
    elements += a.size();
    const auto here = kept.roadmap.reach_from(sheet_pose(0).translation());
    const auto there = fresh.roadmap.reach_from(sheet_pose(0).translation());
    for (int i = 0; i < 60; ++i) {
      const Point3 goal(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-2, 2));
      CHECK(here(goal) == there(goal));
      (here(goal) ? reached : cut_off) += 1;
    }
  }
  CHECK(elements > 100 && reached > 20 && cut_off > 20);
  CHECK(predicted > 100 && shown > 100);
}
