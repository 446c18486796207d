// SPDX-License-Identifier: MIT
// One coordination round of 20 robots on a surface of 100 000 vertices.
#include <benchmark/benchmark.h>

#include <surfleet/coverage/covering_strip.hpp>
#include <surfleet/coverage/surface_coverage.hpp>
#include <surfleet/simulation/surfaces.hpp>

namespace {
using namespace surfleet;

const TriangleMesh& slope() {
  static const TriangleMesh mesh = bumpy_slope({.edge = 1.2 / 293.0});  // about 100 000 vertices
  return mesh;
}
template <typename Surface, typename Distance, typename Coordinator>
void rounds(benchmark::State& state) {
  static auto cover = [] {
    const SurfaceGraph sites = Surface{}(slope(), EdgeGeodesic{});
    return SurfaceCoverage<Surface, Distance, Coordinator>(slope(),
                                                           random_robot_sites(sites, 20, 3));
  }();
  // An exchange has something to trade only once the regions have grown together.
  while (std::find(cover.partition().region.begin(), cover.partition().region.end(), -1) !=
         cover.partition().region.end())
    cover.step();
  for (auto _ : state) cover.step();
  state.counters["sites"] = static_cast<double>(cover.graph().size());
}
void Wavefront_RoundEdges(benchmark::State& state) {
  rounds<MeshGraph, EdgeGeodesic, WavefrontPropagation>(state);
}
void Wavefront_RoundFaces(benchmark::State& state) {
  rounds<MeshGraph, FaceGeodesic, WavefrontPropagation>(state);
}
void Exchange_RoundVertices(benchmark::State& state) {
  rounds<MeshGraph, EdgeGeodesic, VertexExchange>(state);
}
void Exchange_RoundTriangles(benchmark::State& state) {
  rounds<DualMeshGraph, EdgeGeodesic, VertexExchange>(state);
}
void Substitution_FirstPass(benchmark::State& state) {
  const SurfaceGraph sites = MeshGraph{}(slope(), EdgeGeodesic{});
  const auto starts = random_robot_sites(sites, 20, 3);
  for (auto _ : state) {
    DeploymentState coverage;
    coverage.graph = &sites;
    coverage.partition.generator = starts;
    VertexSubstitution coordinator;
    coordinator.start(coverage);
    benchmark::DoNotOptimize(coordinator.step(coverage));
  }
}
BENCHMARK(Wavefront_RoundEdges)->Unit(benchmark::kMillisecond);
BENCHMARK(Wavefront_RoundFaces)->Unit(benchmark::kMillisecond);
BENCHMARK(Exchange_RoundVertices)->Unit(benchmark::kMillisecond);
BENCHMARK(Exchange_RoundTriangles)->Unit(benchmark::kMillisecond);
BENCHMARK(Substitution_FirstPass)->Unit(benchmark::kMillisecond);

void CoveringStrip_Slope(benchmark::State& state) {
  const TriangleMesh mesh = bumpy_slope({.edge = 1.2 / static_cast<double>(state.range(0))});
  const SurfaceGraph dual = DualMeshGraph{}(mesh, EdgeGeodesic{});
  std::vector<std::int32_t> all(mesh.triangles.size());
  for (std::size_t t = 0; t < all.size(); ++t) all[t] = static_cast<std::int32_t>(t);
  double length = 0.0;
  for (auto _ : state) length = covering_strip(mesh, dual.links, all, 0).length();
  state.counters["triangles"] = static_cast<double>(all.size());
  state.counters["path_ratio"] = length * strip_footprint(mesh) / mesh.area();
}
BENCHMARK(CoveringStrip_Slope)->Arg(24)->Arg(48)->Unit(benchmark::kMillisecond);
}  // namespace
