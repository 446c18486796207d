// SPDX-License-Identifier: MIT
/// @file
/// @brief Following the map, and asking it: free space, components, roadmap.
#include <surfleet/core/random.hpp>
#include <surfleet/motion/lazy_prm.hpp>

#include <benchmark/benchmark.h>

#include "plant_map.hpp"

namespace {
using namespace surfleet;

struct World {
  explicit World(double voxel)
      : map({.voxel_size = voxel}), states((plant_map::observe(map, known, plant), map)) {}
  plant_map::Plant plant;
  Box3 known = Box3(plant_map::bounds().min() - Point3::Constant(1.5),
                    plant_map::bounds().max() + Point3::Constant(1.5));
  TsdfMap map;
  VoxelStateMap states;
};

/// As many blocks as a view changes turn unknown, then known again.
void FreeSpace_Update(benchmark::State& state) {
  World w(0.3);
  FreeSpace space(w.states, {.radius = 1.0, .bounds = plant_map::bounds()});
  ReachableSet components(space);
  LazyPrmStar roadmap(space);
  const Box3 view(Point3(0, -6, 1), Point3(9.5, 3.5, 8));  // about 4 × 4 × 3 blocks
  std::size_t changed = 0, updates = 0, blocks = 0;
  const bool whole = state.range(0) != 0;
  bool hide = true;
  for (auto _ : state) {
    state.PauseTiming();
    for (std::uint32_t slot = 0; slot < w.map.block_count(); ++slot) {
      auto& b = w.map.block(slot);
      if (!view.intersects(
              Box3(w.map.center(b.origin()), w.map.center(b.origin() + VoxelIndex::Constant(7)))))
        continue;
      for (std::size_t o = 0; o < TsdfMap::kBlockVoxels; ++o) {
        const Point3 c = w.map.center(TsdfMap::index_in(b, o));
        if (view.contains(c) && w.plant(c) > -0.45) b.voxels[o].weight = hide ? 0.0F : 1.0F;
      }
      w.map.mark_changed(slot);
    }
    hide = !hide;
    blocks += w.states.update(w.map);
    state.ResumeTiming();
    changed += space.update();
    ++updates;
    if (whole) {
      components.update();
      roadmap.update();
    }
  }
  state.counters["map_blocks"] = static_cast<double>(blocks) / static_cast<double>(updates);
  state.counters["free_blocks"] = static_cast<double>(changed) / static_cast<double>(updates);
}
BENCHMARK(FreeSpace_Update)->ArgName("with_roadmap")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void FreeSpace_Build(benchmark::State& state) {
  const World w(0.3);
  for (auto _ : state) {
    FreeSpace space(w.states, {.radius = 1.0, .bounds = plant_map::bounds()});
    benchmark::DoNotOptimize(space.revision());
    state.counters["bytes"] = static_cast<double>(space.memory_bytes());
  }
}
BENCHMARK(FreeSpace_Build)->Unit(benchmark::kMillisecond);

void FreeSpace_Segment(benchmark::State& state) {
  const World w(0.3);
  const FreeSpace space(w.states, {.radius = 1.0, .bounds = plant_map::bounds()});
  Random random(1);
  const double length = static_cast<double>(state.range(0));
  std::vector<std::pair<Point3, Point3>> segments;
  while (segments.size() < 1000) {
    const Point3 a(random.uniform(-34, 32), random.uniform(-22, 21), random.uniform(1.5, 16));
    const Eigen::Vector3d d(random.normal(), random.normal(), random.normal());
    const Point3 b = a + length * d.normalized();
    if (space.is_free(a) && space.is_free(b)) segments.emplace_back(a, b);
  }
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(space.is_free_segment(segments[i].first, segments[i].second));
    i = (i + 1) % segments.size();
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(FreeSpace_Segment)->Arg(3)->Arg(20);

void LazyPrm_Reachable(benchmark::State& state) {
  const World w(0.3);
  const FreeSpace space(w.states, {.radius = 1.0, .bounds = plant_map::bounds()});
  LazyPrmStar roadmap(space);
  Random random(1);
  for (auto _ : state) {
    const Point3 b(random.uniform(-34, 32), random.uniform(-22, 21), random.uniform(1.5, 16));
    benchmark::DoNotOptimize(roadmap.reachable({-33, -21, 3}, b));
  }
}
BENCHMARK(LazyPrm_Reachable);
}  // namespace

BENCHMARK_MAIN();
