// SPDX-License-Identifier: MIT
/// @file
/// @brief Time of giving clusters to robots, by allocator; quality as counters.
#include <benchmark/benchmark.h>

#include <surfleet/allocation.hpp>

namespace {
using namespace surfleet;

ClusterGraph<Point3> power_plant_like(int clusters, int robots) {
  Random random(3);
  std::vector<ConfigurationCluster<Point3>> list(clusters);
  for (auto& c : list) {
    c.gain = random.uniform(0.01, 0.1);
    const Point3 centre(random.uniform(0, 65), random.uniform(0, 42), random.uniform(0, 15));
    const int n = 1 + static_cast<int>(random.below(8));
    for (int k = 0; k < n; ++k)
      c.configurations.push_back(centre +
                                 Point3(random.normal(), random.normal(), random.normal()));
  }
  std::vector<Point3> starts;
  for (int r = 0; r < robots; ++r)
    starts.emplace_back(random.uniform(0, 65), random.uniform(0, 42), 1.0);
  return ClusterGraph<Point3>(list, starts);
}

/// The graph is made anew each time: its distances and inner paths are part of the time.
template <typename Plan>
void run(benchmark::State& state, Plan&& plan_for) {
  const int clusters = static_cast<int>(state.range(0)), robots = static_cast<int>(state.range(1));
  FleetPlan plan;
  for (auto _ : state) {
    const auto graph = power_plant_like(clusters, robots);
    plan = plan_for(graph);
  }
  state.counters["utility"] = plan.total_utility();
  state.counters["total_m"] = plan.total_length();
  state.counters["longest_m"] = plan.longest();
}
void sizes(benchmark::internal::Benchmark* b) {
  b->Args({60, 5})->Args({60, 1})->Args({200, 3})->Unit(benchmark::kMillisecond);
}

void Allocation_Tsga(benchmark::State& state) {
  run(state, [](const auto& g) { return TspGreedyAllocator{}(g); });
}
BENCHMARK(Allocation_Tsga)->Apply(sizes);
void Allocation_Insertion(benchmark::State& state) {
  run(state, [](const auto& g) { return GreedyAllocator<InsertionValue<>>{}(g); });
}
BENCHMARK(Allocation_Insertion)->Apply(sizes);
void Allocation_NearestNeighbour(benchmark::State& state) {
  run(state, [](const auto& g) { return NearestNeighbourAllocator{}(g); });
}
BENCHMARK(Allocation_NearestNeighbour)->Apply(sizes);
void Allocation_Makespan(benchmark::State& state) {
  run(state, [](const auto& g) { return MakespanAllocator{}(g); });
}
BENCHMARK(Allocation_Makespan)->Apply(sizes);
void Allocation_TsgaImproved(benchmark::State& state) {
  run(state, [](const auto& g) { return ImproveAllocation<>{}(g, TspGreedyAllocator{}(g)); });
}
BENCHMARK(Allocation_TsgaImproved)->Args({60, 5})->Unit(benchmark::kMillisecond);
void Allocation_MakespanImproved(benchmark::State& state) {
  run(state, [](const auto& g) {
    return ImproveAllocation<Makespan, TourShortness<>>{}(g, MakespanAllocator{}(g));
  });
}
BENCHMARK(Allocation_MakespanImproved)->Args({60, 5})->Unit(benchmark::kMillisecond);
}  // namespace

BENCHMARK_MAIN();
