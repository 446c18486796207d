// SPDX-License-Identifier: MIT
#include <surfleet/coverage/wavefront_propagation.hpp>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

std::vector<std::int32_t> random_sites(std::size_t n, int robots, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::int32_t> all(n);
  for (std::size_t i = 0; i < n; ++i) all[i] = static_cast<std::int32_t>(i);
  random.shuffle(all);
  all.resize(static_cast<std::size_t>(robots));
  return all;
}

void check_partition(const SurfaceGraph& graph, const SurfacePartition& p) {
  CHECK(regions_connected(graph.links, p.region));
  for (const std::int32_t r : p.region) CHECK(r >= 0);
  for (std::size_t i = 0; i < p.robots(); ++i)
    CHECK(p.region[static_cast<std::size_t>(p.generator[i])] == static_cast<std::int32_t>(i));
}

template <typename Distance, typename Model>
void partition_is_voronoi(const TriangleMesh& mesh, const Distance& distance, const Model& model) {
  const SurfaceGraph graph = model(mesh, distance, MetricField{});
  const auto sites = random_sites(graph.size(), 9, 4);
  const auto p = voronoi_partition(graph, sites);
  check_partition(graph, p);
  std::size_t mended = 0;
  std::vector<ShortestPaths> each;
  for (const std::int32_t s : sites) each.push_back(shortest_paths(graph, s));
  for (std::size_t v = 0; v < graph.size(); ++v) {
    std::int32_t best = 0;
    for (std::int32_t i = 1; i < 9; ++i)
      if (each[static_cast<std::size_t>(i)].distance[v] <
          each[static_cast<std::size_t>(best)].distance[v])
        best = i;
    const double own = each[static_cast<std::size_t>(p.region[v])].distance[v];
    CHECK(p.distance[v] >= own - 1e-12);
    if (p.region[v] != best)
      ++mended;
    else
      CHECK_NEAR(p.distance[v], own, 1e-12);
  }
  CHECK(graph.across.size() == 0 ? mended == 0 : mended < graph.size() / 50);
  if (graph.across.size() > 0) return;
  for (std::int32_t i = 0; i < 9; ++i) {
    auto region = propagate_wavefront(graph, sites, i);
    std::sort(region.sites.begin(), region.sites.end());
    CHECK(region.sites == region_sites(p)[static_cast<std::size_t>(i)]);
  }
}

TEST(partition_matches_brute_force_and_each_robots_own_wave) {
  const TriangleMesh slope = bumpy_slope({.edge = 0.05});
  partition_is_voronoi(slope, EdgeGeodesic{}, MeshGraph{});
  partition_is_voronoi(slope, FaceGeodesic{}, MeshGraph{});
  partition_is_voronoi(slope, EdgeGeodesic{}, DualMeshGraph{});
  partition_is_voronoi(make_torus(Point3::Zero(), 1.0, 0.4, 40, 16), EdgeGeodesic{}, MeshGraph{});
}

TEST(ties_go_to_the_lower_robot_and_regions_stay_whole) {
  // A regular flat grid has many equal distances.
  TriangleMesh mesh;
  const int n = 21;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) mesh.vertices.push_back({double(i), double(j), 0.0});
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i;
      mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, a + n + 1}, {a, a + n + 1, a + n}});
    }
  const SurfaceGraph graph = MeshGraph{}(mesh, EdgeGeodesic{});
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto sites = random_sites(graph.size(), 7, seed);
    const auto p = voronoi_partition(graph, sites);
    check_partition(graph, p);
    for (std::int32_t i = 0; i < 7; ++i) {
      auto region = propagate_wavefront(graph, sites, i);
      std::sort(region.sites.begin(), region.sites.end());
      CHECK(region.sites == region_sites(p)[static_cast<std::size_t>(i)]);
    }
  }
}

TEST(abort_criterion_saves_work_on_a_large_surface) {
  const SurfaceGraph graph = MeshGraph{}(make_sphere(Point3::Zero(), 1.0, 4), EdgeGeodesic{});
  const auto sites = random_sites(graph.size(), 40, 2);
  std::size_t aborted = 0;
  for (std::int32_t i = 0; i < 40; ++i) {
    const auto region = propagate_wavefront(graph, sites, i);
    aborted += region.aborted && region.visited < graph.size() / 2 ? 1U : 0U;
  }
  CHECK(aborted > 30);
}

template <typename Coordinator, typename Distance>
double deploys(const TriangleMesh& mesh, Coordinator coordinator, const Distance& distance,
               bool asynchronous) {
  const SurfaceGraph graph = MeshGraph{}(mesh, distance, MetricField{});
  DeploymentState state;
  state.graph = &graph;
  state.asynchronous = asynchronous;
  state.partition.generator = random_sites(graph.size(), 8, 11);
  coordinator.start(state);
  const double initial = coordinator.cost(state);
  double last = initial;
  int idle = 0, steps = 0;
  while (idle < (asynchronous ? 8 : 1) && steps < 2000) {
    idle = coordinator.step(state) ? 0 : idle + 1;
    const double now = coordinator.cost(state);
    CHECK(now <= last);
    last = now;
    check_partition(graph, state.partition);
    ++steps;
  }
  CHECK(steps < 2000);
  return last / initial;
}

TEST(cost_never_rises_and_comes_to_rest) {
  const TriangleMesh slope = bumpy_slope({.edge = 0.1});
  CHECK(deploys(slope, WavefrontPropagation{}, EdgeGeodesic{}, false) < 0.9);
  CHECK(deploys(slope, WavefrontPropagation{}, EdgeGeodesic{}, true) < 0.9);
  CHECK(deploys(slope, WavefrontPropagation{}, FaceGeodesic{}, false) < 0.9);
  CHECK(deploys(slope, BasicWavefrontPropagation<LeastSquaresGradient>{}, EdgeGeodesic{}, false) <
        0.9);
  CHECK(deploys(slope, BasicWavefrontPropagation<RingWeights>{}, EdgeGeodesic{}, false) < 0.95);
}

TEST(two_robots_on_one_site_are_refused) {
  const SurfaceGraph graph = MeshGraph{}(bumpy_slope({.edge = 0.2}), EdgeGeodesic{});
  CHECK_THROWS(Error, voronoi_partition(graph, {3, 3}));
  CHECK_THROWS(Error, voronoi_partition(graph, {3, 100000}));
}
}  // namespace
