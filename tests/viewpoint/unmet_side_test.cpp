// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/incomplete_surface.hpp>

#include <cmath>
#include <cstdint>

#include <surfleet/viewpoint/coverage_estimate.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
constexpr double kSize = 0.25;

/// Everything within four voxels of the origin is known to be empty.
TsdfMap empty_space() {
  TsdfMap map({.voxel_size = kSize});
  for_each_index(VoxelIndex::Constant(-6), VoxelIndex::Constant(6), [&](const VoxelIndex& v) {
    map.ensure(v) = {0.7F, 1.0F};
  });
  for (std::uint32_t s = 0; s < map.block_count(); ++s) map.mark_changed(s);
  return map;
}
void hit(TsdfMap& map, const VoxelIndex& v, const Eigen::Vector3d& normal, double weight) {
  const std::uint32_t slot = map.ensure_slot(TsdfMap::block_of(v));
  SurfaceHit h;
  h.weight = std::llround(weight / SurfaceHit::kWeightUnit);
  for (std::size_t k = 0; k < 3; ++k)
    h.normal[k] = std::llround(static_cast<double>(h.weight) * SurfaceHit::kNormal *
                               normal[static_cast<Eigen::Index>(k)]);
  map.block(slot)
      .layer.ensure(SurfaceHits::key_of(TsdfMap::offset_of(v), side_of_normal(normal)))
      .add(h, 1);
  map.mark_changed(slot);
}
/// A horizontal sheet of 5 × 5 voxels at z = 0, across blocks, met from one side.
void sheet(TsdfMap& map, double side, double weight) {
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) hit(map, {x, y, 0}, {0, 0, side}, weight);
}
}  // namespace

TEST(the_far_side_of_a_sheet_is_incomplete_until_it_is_met) {
  TsdfMap map = empty_space();
  IncompleteSurface incomplete(
      {.known_weight = 0.3, .region = Box3(Point3::Constant(-1.2), Point3::Constant(1.2))});
  incomplete.update(map);
  CHECK(incomplete.empty());
  sheet(map, 1.0, 1.0);
  incomplete.update(map);
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      CHECK(incomplete.contains({x, y, -1}));
      CHECK(!incomplete.contains({x, y, 1}));
      CHECK(!incomplete.contains({x, y, -2}));
    }
  incomplete.for_each([&](const IncompleteElement& e) {
    CHECK(e.unknown == 1U << 13);
    if (e.voxel.z() == -1 && e.voxel.head<2>().cwiseAbs().maxCoeff() < 2)
      CHECK(e.direction.z() < -0.9);
    CHECK((e.frontier(kSize) - e.position).norm() < 1e-12);
  });
  // A few rays do not do, nor such from the side that was met; enough from the far side do.
  sheet(map, 1.0, 1.0);
  sheet(map, -1.0, 0.01);
  incomplete.update(map);
  CHECK(incomplete.contains({0, 0, -1}));
  sheet(map, -1.0, 1.0);
  incomplete.update(map);
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) CHECK(!incomplete.contains({x, y, -1}));

  // The same as what a map read at once gives.
  IncompleteSurface afresh(incomplete.options());
  afresh.update(map);
  CHECK(afresh.size() == incomplete.size());
  const VoxelStateMap states(map, {.known_weight = 0.3});
  IncompleteSurface by_states(incomplete.options());
  by_states.update(states);
  CHECK(by_states.size() == incomplete.size());
}

TEST(a_glimpse_counts_where_no_known_surface_is_near) {
  TsdfMap map = empty_space();
  IncompleteSurface incomplete({.known_weight = 0.3});
  incomplete.update(map);
  const std::size_t before = incomplete.size();
  hit(map, {3, 3, 3}, {1, 0, 0}, 0.03);
  incomplete.update(map);
  CHECK(incomplete.size() == before + 1 && incomplete.contains({3, 3, 3}));
  hit(map, {3, 3, 3}, {1, 0, 0}, 0.5);  // now it is known from that side
  incomplete.update(map);
  CHECK(!incomplete.contains({3, 3, 3}));
  hit(map, {4, 3, 3}, {1, 0, 0}, 0.03);  // beside known surface it is noise of it
  incomplete.update(map);
  CHECK(!incomplete.contains({4, 3, 3}) || incomplete.size() > 0);
  TsdfMap other = empty_space();
  hit(other, {3, 3, 3}, {1, 0, 0}, 0.001);  // too little to mention
  IncompleteSurface none({.known_weight = 0.3});
  none.update(other);
  CHECK(!none.contains({3, 3, 3}));
}

TEST(a_mission_does_not_call_itself_complete_over_a_hole) {
  TsdfMap map = empty_space();
  sheet(map, 1.0, 1.0);
  sheet(map, -1.0, 1.0);
  IncompleteSurface incomplete({.known_weight = 0.3});
  incomplete.update(map);
  const TriangleMesh mesh = extract_surface(map, {.min_weight = 0.3});
  const CoverageEstimate whole = estimate_coverage(map, mesh, incomplete, 0.3);
  CHECK(mesh.area() > 2.0 * 20.0 * kSize * kSize);
  CHECK_NEAR(whole.mesh, mesh.area(), 1e-9);
  CHECK(whole.unmeshed == 0.0);
  // Without one side's triangles the hits of that side have no mesh.
  TriangleMesh half = mesh;
  std::erase_if(half.triangles, [&](const Triangle& t) {
    const TriangleMesh one{
        .vertices = mesh.vertices, .triangles = {t}, .normals = {}, .colors = {}};
    return one.area_vector(0).z() < 0.0;
  });
  const CoverageEstimate torn = estimate_coverage(map, half, incomplete, 0.3);
  CHECK_NEAR(torn.unmeshed + torn.mesh, whole.mesh, 0.7 * whole.mesh);
  CHECK(torn.share() < whole.share());
  CHECK(CoverageEstimate{}.share() == 0.0);
}
