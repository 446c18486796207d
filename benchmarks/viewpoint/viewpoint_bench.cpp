// SPDX-License-Identifier: MIT
/// @file
/// @brief From incomplete elements to clusters with gain, stage by stage.
#include <surfleet/viewpoint.hpp>

#include <benchmark/benchmark.h>

#include <memory>

#include "survey_scene.hpp"

namespace {
using namespace surfleet;

/// What was known after a flight of `images` at 15 cm voxels.
struct Known {
  explicit Known(int images) : survey(0.15), states((survey.fly(images), survey.map)) {
    IncompleteSurface incomplete;
    incomplete.update(states);
    elements = incomplete.elements();
    set = generate_viewpoints(std::span<const IncompleteElement>(elements), states,
                              survey::camera(), {}, is_free());
  }
  static const Known& after(int images) {
    static std::vector<std::pair<int, std::unique_ptr<Known>>> kept;
    for (const auto& [n, known] : kept)
      if (n == images) return *known;
    kept.emplace_back(images, std::make_unique<Known>(images));
    return *kept.back().second;
  }
  EmptyBall is_free(double radius = 0.5) const { return {&states, radius}; }

  survey::Survey survey;
  VoxelStateMap states;
  std::vector<IncompleteElement> elements;
  ViewpointSet set;
};

void Viewpoints_Generate(benchmark::State& state) {
  const Known& known = Known::after(static_cast<int>(state.range(0)));
  for (auto _ : state)
    benchmark::DoNotOptimize(generate_viewpoints(std::span<const IncompleteElement>(known.elements),
                                                 known.states, survey::camera(), {},
                                                 known.is_free())
                                 .size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(known.elements.size()));
  state.counters["elements"] = static_cast<double>(known.elements.size());
  state.counters["unseen"] = static_cast<double>(known.set.unseen.size());
}
BENCHMARK(Viewpoints_Generate)->Arg(10)->Arg(80)->Unit(benchmark::kMillisecond);

void Viewpoints_Merge(benchmark::State& state) {
  const Known& known = Known::after(static_cast<int>(state.range(0)));
  const SeesTargets accept{std::span<const IncompleteElement>(known.elements), &known.states,
                           ViewFrustum(survey::camera()), known.is_free()};
  std::size_t merged = 0;
  for (auto _ : state) merged = merge_viewpoints(known.set, {}, accept).size();
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(known.set.size()));
  state.counters["merged"] = static_cast<double>(merged);
}
BENCHMARK(Viewpoints_Merge)->Arg(10)->Arg(80)->Unit(benchmark::kMillisecond);

void Viewpoints_Cluster(benchmark::State& state) {
  const Known& known = Known::after(static_cast<int>(state.range(0)));
  const auto merged = merge_viewpoints(known.set);
  std::size_t clusters = 0;
  for (auto _ : state) clusters = cluster_viewpoints(merged).size();
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(merged.size()));
  state.counters["clusters"] = static_cast<double>(clusters);
}
BENCHMARK(Viewpoints_Cluster)->Arg(10)->Arg(80)->Unit(benchmark::kMillisecond);

void Gain_IncompleteSurface(benchmark::State& state) {
  const Known& known = Known::after(static_cast<int>(state.range(0)));
  const IncompleteSurfaceGain gain(known.elements, known.states, ViewFrustum(survey::camera()));
  std::size_t i = 0, seen = 0;
  for (auto _ : state)
    seen += gain.seen(known.set[i++ * 37 % known.set.size()].configuration).size();
  state.counters["seen"] =
      benchmark::Counter(static_cast<double>(seen), benchmark::Counter::kAvgIterations);
}
BENCHMARK(Gain_IncompleteSurface)->Arg(10)->Arg(80)->Unit(benchmark::kMicrosecond);

void Gain_UnknownVolume(benchmark::State& state) {
  const Known& known = Known::after(static_cast<int>(state.range(0)));
  const UnknownVolumeGain gain(known.states, ViewFrustum(survey::camera()));
  std::size_t i = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        gain.seen(known.set[i++ * 37 % known.set.size()].configuration).size());
}
BENCHMARK(Gain_UnknownVolume)->Arg(80)->Unit(benchmark::kMicrosecond);

void Prediction_Surface(benchmark::State& state) {
  const Known& known = Known::after(static_cast<int>(state.range(0)));
  std::size_t patches = 0;
  for (auto _ : state) patches = predict_surface(known.elements, known.states).size();
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(known.elements.size()));
  state.counters["patches"] = static_cast<double>(patches);
}
BENCHMARK(Prediction_Surface)->Arg(10)->Arg(80)->Unit(benchmark::kMillisecond);
}  // namespace

BENCHMARK_MAIN();
