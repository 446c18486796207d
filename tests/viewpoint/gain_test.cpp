// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/gain.hpp>

#include <algorithm>
#include <set>
#include <tuple>

#include "check.hpp"
#include "state_scenes.hpp"

namespace {
using namespace surfleet;
using namespace view_test;

const PinholeCamera kShortCamera =
    PinholeCamera::from_fov(radians(90), radians(60), 320, 240, 0.5, 6.0);

struct ArchetypeGain {
  std::vector<unsigned> seen(const Configuration&) const { return {7U}; }
  float value(std::size_t n) const { return static_cast<float>(n); }
};
static_assert(GainModel<ArchetypeGain> && !GainModel<int>);

TsdfMap cluttered(std::uint64_t seed) {
  Random random(seed);
  TsdfMap map({.voxel_size = 0.25});
  paint(map, {-20, -20, -12}, {20, 20, 12}, [&](const VoxelIndex&) {
    const std::uint64_t r = random.below(200);
    return r == 0 ? VoxelState::occupied : r < 6 ? VoxelState::unknown : VoxelState::empty;
  });
  return map;
}

std::vector<Viewpoint> random_views(Random& random, int n) {
  std::vector<Viewpoint> views(static_cast<std::size_t>(n));
  for (Viewpoint& v : views)
    v.configuration = {Point3(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-3, 3)),
                       random.uniform(-4, 4)};
  return views;
}

TEST(incomplete_surface_gain_agrees_with_testing_every_element) {
  const TsdfMap map = cluttered(4);
  const VoxelStateMap states(map);
  IncompleteSurface incomplete;
  incomplete.update(map);
  const auto elements = incomplete.elements();
  Random random(9);
  const auto views = random_views(random, 40);
  for (const bool unknown_blocks : {false, true}) {
    const ViewFrustum frustum(kShortCamera, forward_camera_mount(0.3, Point3(0.1, 0, 0)));
    const SightOptions sight{.unknown_blocks = unknown_blocks};
    const IncompleteSurfaceGain gain(elements, states, frustum, sight);
    LineOfSight line(states, sight);
    std::size_t most = 0;
    for (const Viewpoint& v : views) {
      std::vector<std::int32_t> expected;
      const auto placed = frustum.at(v.configuration);
      for (std::size_t i = 0; i < elements.size(); ++i)
        if (frustum.contains(v.configuration, elements[i].position) &&
            line.sees(placed.eye(), elements[i].voxel))
          expected.push_back(static_cast<std::int32_t>(i));
      CHECK(gain.seen(v.configuration) == expected);
      most = std::max(most, expected.size());
    }
    CHECK(most > 10);
    const auto one = seen_from_all(gain, views, 1), two = seen_from_all(gain, views, 2);
    CHECK(one == two);
  }
}

TEST(few_elements_in_a_wide_frustum_are_found_too) {
  const TsdfMap map = cluttered(4);
  const VoxelStateMap states(map);
  IncompleteSurface incomplete;
  incomplete.update(map);
  const auto all = incomplete.elements();
  const std::vector<IncompleteElement> one(all.begin(), all.begin() + 1);
  const ViewFrustum frustum(kShortCamera);
  const IncompleteSurfaceGain gain(one, states, frustum);
  Configuration q{one[0].position - Point3(2, 0, 0), 0.0};
  LineOfSight line(states);
  CHECK(gain.seen(q).size() == (line.sees(q.position, one[0].voxel) ? 1U : 0U));
}

TEST(unknown_volume_counts_each_voxel_once_and_stops_at_walls) {
  TsdfMap map = wall_scene(20, 12, 0.25);
  const VoxelStateMap states(map);
  const ViewFrustum frustum(kShortCamera);
  const UnknownVolumeGain gain(states, frustum, {.stride = 8});
  // Facing the wall from near by, nothing unknown is met.
  CHECK(gain.seen({Point3(0.7, 0, 0), kPi}).empty());
  // Facing away, what lies beyond the known space is.
  const Configuration away{Point3(2.0, 0, 0), 0.0};
  const auto keys = gain.seen(away);
  CHECK(std::is_sorted(keys.begin(), keys.end()) &&
        std::adjacent_find(keys.begin(), keys.end()) == keys.end());
  std::set<std::tuple<int, int, int>> expected;
  for (int v = 4; v < kShortCamera.height; v += 8)
    for (int u = 4; u < kShortCamera.width; u += 8) {
      const Point3 end =
          away.pose() * frustum.T_body_camera() * Point3(6.0 * kShortCamera.ray(u, v));
      traverse_voxels(away.position, end, 0.25, [&](const VoxelIndex& i) {
        if (states(i) == VoxelState::unknown) expected.insert({i.x(), i.y(), i.z()});
        return states(i) != VoxelState::occupied;
      });
    }
  CHECK_NEAR(keys.size(), expected.size(), 0.002 * static_cast<double>(expected.size()));
  CHECK(keys.size() > 1000);
  CHECK_NEAR(gain.value(64), 1.0, 1e-12);
  CHECK_THROWS(Error, UnknownVolumeGain(states, frustum, {.stride = 0}));
}

TEST(a_cluster_gains_the_union_of_its_views) {
  const TsdfMap map = cluttered(6);
  const VoxelStateMap states(map);
  IncompleteSurface incomplete;
  incomplete.update(map);
  const auto elements = incomplete.elements();
  Random random(10);
  const auto views = random_views(random, 30);
  auto clusters = cluster_viewpoints(views);
  const auto check = [&](const auto& gain) {
    const auto seen = seen_from_all(gain, views);
    assign_gains(gain, seen, clusters);
    for (const ViewpointCluster& c : clusters) {
      std::set<std::uint64_t> all;
      for (const std::int32_t v : c.views)
        for (const auto id : seen[static_cast<std::size_t>(v)])
          all.insert(static_cast<std::uint64_t>(id));
      CHECK_NEAR(c.gain, gain.value(all.size()), 1e-12);
    }
  };
  const ViewFrustum frustum(kShortCamera);
  const IncompleteSurfaceGain by_elements(elements, states, frustum);
  check(by_elements);
  for (const ViewpointCluster& c : clusters) CHECK(c.gain >= 0.0 && c.gain <= 1.0);
  check(UnknownVolumeGain(states, frustum));
  check(ArchetypeGain{});
}

TEST(no_elements_no_gain) {
  const TsdfMap map;
  const VoxelStateMap states(map);
  const IncompleteSurfaceGain gain({}, states, ViewFrustum(kShortCamera));
  CHECK(gain.seen({}).empty());
  CHECK(gain.value(0) == 0.0);
}
}  // namespace
