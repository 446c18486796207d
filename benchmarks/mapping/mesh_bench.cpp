// SPDX-License-Identifier: MIT
/// @file
/// @brief Mesh extraction from a map of the benchmark room at 5 cm, about 200 000 triangles, whole
/// and after one more scan.
#include <benchmark/benchmark.h>

#include <vector>

#include <surfleet/mapping/map_file.hpp>
#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>

#include "room_scene.hpp"

namespace {
using namespace surfleet;

TsdfMap room_map() {
  TsdfMap map({.voxel_size = 0.05});
  TsdfIntegrator<> integrate{{.truncation = 0.2}};
  for (const Pose& body : room_scene::body_poses()) {
    const auto scan = room_scene::lidar_scan(body);
    integrate(std::span<const Point3>(scan), 0.1, 8.0, body, map);
  }
  return map;
}

void extract(benchmark::State& state) {
  const TsdfMap map = room_map();
  std::size_t triangles = 0;
  for (auto _ : state) {
    const TriangleMesh mesh = extract_mesh(map, {.threads = static_cast<int>(state.range(0))});
    triangles = mesh.triangles.size();
    benchmark::DoNotOptimize(mesh.vertices.data());
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}
BENCHMARK(extract)
    ->Name("Mesh_ExtractWelded")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void update_blocks(benchmark::State& state) {
  TsdfMap map = room_map();
  MeshExtractor extractor;
  extractor.update(map);
  const auto changed = static_cast<std::uint32_t>(state.range(0));
  std::size_t meshed = 0;
  for (auto _ : state) {
    state.PauseTiming();
    for (std::uint32_t s = 0; s < changed; ++s) map.mark_changed(s);
    state.ResumeTiming();
    meshed = extractor.update(map);
  }
  state.counters["blocks_meshed"] = static_cast<double>(meshed);
}
BENCHMARK(update_blocks)
    ->Name("Mesh_Update")
    ->Arg(10)
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond);

void encode_and_decode(benchmark::State& state) {
  const TsdfMap map = room_map();
  std::size_t bytes = 0;
  for (auto _ : state) {
    const Bytes encoded = encode_map(map);
    bytes = encoded.size();
    benchmark::DoNotOptimize(decode_map(encoded).block_count());
  }
  state.counters["MB"] = static_cast<double>(bytes) * 1e-6;
  state.counters["MB_in_memory"] = static_cast<double>(map.memory_bytes()) * 1e-6;
}
BENCHMARK(encode_and_decode)->Name("Map_EncodeDecode")->Unit(benchmark::kMillisecond);
}  // namespace

BENCHMARK_MAIN();
