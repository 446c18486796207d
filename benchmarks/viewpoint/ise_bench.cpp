// SPDX-License-Identifier: MIT
/// @file
/// @brief Incomplete surface per image, for maps of growing size: the cost follows the change.
#include <surfleet/viewpoint/incomplete_surface.hpp>

#include <benchmark/benchmark.h>

#include <chrono>

#include "survey_scene.hpp"

namespace {
using namespace surfleet;

template <typename Work>
double seconds(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// After `range(0)` images at a voxel of `range(1)` mm, one more image an iteration.
void IncompleteSurface_UpdatePerImage(benchmark::State& state) {
  survey::Survey survey(static_cast<double>(state.range(1)) * 1e-3);
  survey.fly(static_cast<int>(state.range(0)));
  IncompleteSurface incomplete;
  incomplete.update(survey.map);
  std::size_t read = 0;
  for (auto _ : state) {
    survey.fly(1);
    state.SetIterationTime(seconds([&] { read += incomplete.update(survey.map).blocks_read; }));
  }
  state.counters["map_blocks"] = static_cast<double>(survey.map.block_count());
  state.counters["blocks_read"] =
      benchmark::Counter(static_cast<double>(read), benchmark::Counter::kAvgIterations);
  state.counters["elements"] = static_cast<double>(incomplete.size());
}
BENCHMARK(IncompleteSurface_UpdatePerImage)
    ->ArgsProduct({{10, 100, 1000}, {300}})
    ->Args({100, 150})
    ->UseManualTime()
    ->Iterations(40)
    ->Unit(benchmark::kMicrosecond);

/// The same by way of the state map, both updates timed.
void IncompleteSurface_UpdatePerImageFromStates(benchmark::State& state) {
  survey::Survey survey(0.3);
  survey.fly(static_cast<int>(state.range(0)));
  VoxelStateMap states(survey.map);
  IncompleteSurface incomplete;
  incomplete.update(states);
  for (auto _ : state) {
    survey.fly(1);
    state.SetIterationTime(seconds([&] {
      states.update(survey.map);
      incomplete.update(states);
    }));
  }
  state.counters["map_blocks"] = static_cast<double>(survey.map.block_count());
}
BENCHMARK(IncompleteSurface_UpdatePerImageFromStates)
    ->Arg(10)
    ->Arg(1000)
    ->UseManualTime()
    ->Iterations(40)
    ->Unit(benchmark::kMicrosecond);

void IncompleteSurface_FromScratch(benchmark::State& state) {
  survey::Survey survey(0.3);
  survey.fly(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    IncompleteSurface incomplete;
    incomplete.update(survey.map);
    benchmark::DoNotOptimize(incomplete.size());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(survey.map.block_count()));
}
BENCHMARK(IncompleteSurface_FromScratch)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
}  // namespace

BENCHMARK_MAIN();
