// SPDX-License-Identifier: MIT
// Distances from one vertex to all others of a mesh of 50 000 vertices, set-up and search apart.
#include <benchmark/benchmark.h>

#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/simulation/surfaces.hpp>

namespace {
using namespace surfleet;

const TriangleMesh& slope() {
  static const TriangleMesh mesh = bumpy_slope({.edge = 1.2 / 207.0});  // about 50 000 vertices
  return mesh;
}
template <typename Policy>
void setup(benchmark::State& state, const Policy& policy) {
  const TriangleMesh& mesh = slope();
  for (auto _ : state) benchmark::DoNotOptimize(policy(mesh, EuclideanMetric{}));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.vertices.size()));
}
template <typename Policy>
void search(benchmark::State& state, const Policy& policy) {
  const TriangleMesh& mesh = slope();
  const Graph graph = policy(mesh, EuclideanMetric{});
  const auto source = static_cast<std::int32_t>(mesh.vertices.size() / 2);
  for (auto _ : state) benchmark::DoNotOptimize(shortest_paths(graph, source));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.vertices.size()));
}
void Geodesic_EdgesSetup(benchmark::State& state) { setup(state, EdgeGeodesic{}); }
void Geodesic_EdgesSearch(benchmark::State& state) { search(state, EdgeGeodesic{}); }
void Geodesic_FacesSetup(benchmark::State& state) {
  setup(state, FaceGeodesic{static_cast<int>(state.range(0))});
}
void Geodesic_FacesSearch(benchmark::State& state) {
  search(state, FaceGeodesic{static_cast<int>(state.range(0))});
}
BENCHMARK(Geodesic_EdgesSetup)->Unit(benchmark::kMillisecond);
BENCHMARK(Geodesic_EdgesSearch)->Unit(benchmark::kMillisecond);
BENCHMARK(Geodesic_FacesSetup)->Arg(1)->Arg(2)->Arg(3)->Unit(benchmark::kMillisecond);
BENCHMARK(Geodesic_FacesSearch)->Arg(1)->Arg(2)->Arg(3)->Unit(benchmark::kMillisecond);
}  // namespace
