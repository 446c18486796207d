// SPDX-License-Identifier: MIT
/// @file
/// @brief Time of the assignment bound and of the tour solvers.
#include <benchmark/benchmark.h>

#include <surfleet/allocation/assignment.hpp>
#include <surfleet/allocation/exact_tour.hpp>
#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/allocation/three_opt.hpp>

#include "tour_instances.hpp"

namespace {
using namespace surfleet;

void Assignment_Solve(benchmark::State& state) {
  const CostMatrix c = tour_instances::random_costs(static_cast<int>(state.range(0)), 1, 1e4);
  for (auto _ : state) benchmark::DoNotOptimize(solve_assignment(c, true).cost);
}
BENCHMARK(Assignment_Solve)->Arg(50)->Arg(170)->Arg(450)->Unit(benchmark::kMicrosecond);

void ExactTour_Solve(benchmark::State& state) {
  const TourProblem p{tour_instances::city(static_cast<int>(state.range(0)), 1, 0.5)};
  for (auto _ : state) benchmark::DoNotOptimize(ExactTour{}(p).length);
}
BENCHMARK(ExactTour_Solve)->Arg(8)->Arg(12)->Arg(15)->Unit(benchmark::kMicrosecond);

void ThreeOpt_Solve(benchmark::State& state) {
  const TourProblem p{tour_instances::city(static_cast<int>(state.range(0)), 1, 0.5)};
  const ThreeOpt solve{{.max_iterations = 0}};
  for (auto _ : state) benchmark::DoNotOptimize(solve(p).length);
}
BENCHMARK(ThreeOpt_Solve)->Arg(10)->Arg(30)->Arg(100)->Unit(benchmark::kMicrosecond);

/// Items are perturbations with the descent after each.
void LinKernighan_Iterate(benchmark::State& state) {
  const TourProblem p{tour_instances::city(static_cast<int>(state.range(0)), 1, 0.5),
                      state.range(1) != 0};
  LinKernighan solve;
  solve.search.max_iterations = 2000;
  double gap = 0.0;
  for (auto _ : state) gap = solve(p).gap();
  state.counters["gap_percent"] = 100.0 * gap;
  state.SetItemsProcessed(state.iterations() * solve.search.max_iterations);
}
BENCHMARK(LinKernighan_Iterate)
    ->Args({30, 0})
    ->Args({100, 0})
    ->Args({170, 0})
    ->Args({400, 0})
    ->Unit(benchmark::kMillisecond);
}  // namespace

BENCHMARK_MAIN();
