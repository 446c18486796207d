// SPDX-License-Identifier: MIT
#include <surfleet/coverage/balance_regions.hpp>

#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/simulation/steam_chest.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(balance_keeps_regions_whole) {
  const TriangleMesh chest = steam_chest(0.08);
  const SurfaceGraph dual = DualMeshGraph{}(chest, EdgeGeodesic{});
  const auto part = connected_components(dual.links);
  CHECK(*std::max_element(part.begin(), part.end()) == 0);
  SurfaceRegions regions;
  regions.mesh = std::make_shared<const TriangleMesh>(chest);
  regions.dual = std::make_shared<const SurfaceGraph>(dual);
  const auto p = voronoi_partition(dual, {1, 200, 300, 500, 900});
  regions.region = p.region;
  regions.start = p.generator;
  const double before = balance_regions(regions, sweep_work(regions), {.rounds = 0});
  const double after = balance_regions(regions, sweep_work(regions));
  CHECK(after < before && after < 1.15);
  CHECK(regions_connected(dual.links, regions.region));
  for (std::size_t i = 0; i < 5; ++i)
    CHECK(regions.region[static_cast<std::size_t>(regions.start[i])] == static_cast<int>(i));
}

TEST(the_steam_chest_has_seven_openings) {
  const TriangleMesh chest = steam_chest(0.05);
  const MeshAdjacency adjacency(chest);
  CHECK(adjacency.non_manifold_edges().empty());
  // Borders as a graph of their own: one loop an opening.
  std::vector<std::pair<std::int32_t, Arc>> list;
  std::vector<std::uint8_t> on(chest.vertices.size(), 0);
  for (const std::int32_t e : adjacency.boundary_edges()) {
    const auto& v = adjacency.edges()[static_cast<std::size_t>(e)].vertices;
    list.push_back({v[0], {v[1], 1.0}});
    list.push_back({v[1], {v[0], 1.0}});
    on[static_cast<std::size_t>(v[0])] = on[static_cast<std::size_t>(v[1])] = 1;
  }
  const auto loops = connected_components(Graph(chest.vertices.size(), list), KeepMarked{&on});
  CHECK(*std::max_element(loops.begin(), loops.end()) == 6);
  const Box3 box = chest.bounds();
  CHECK_NEAR(box.sizes().x(), 5.0, 0.1);
  CHECK(chest.area() > 6.0 && chest.area() < 14.0);
  double outward = 0.0;
  for (std::size_t t = 0; t < chest.triangles.size(); ++t) {
    const Point3 c = chest.centroid(t);
    if (c.x() < 0.5) outward += chest.area_vector(t).dot(Eigen::Vector3d(0, c.y(), c.z()));
  }
  CHECK(outward > 0.0);
}
}  // namespace
