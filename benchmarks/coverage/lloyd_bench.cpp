// SPDX-License-Identifier: MIT
/// @file
/// @brief One Lloyd step of 10 to 1000 robots in a 1000-vertex polygon with 20 holes.
#include <benchmark/benchmark.h>

#include <surfleet/core/random.hpp>
#include <surfleet/coverage/lloyd.hpp>

namespace {
using namespace surfleet;

/// A jagged disc of 600 vertices with 20 jagged holes of 20 vertices.
Polygon jagged_domain() {
  Random random(7);
  const auto ring = [&](const Point2& centre, double low, double high, int n) {
    Ring r;
    for (int i = 0; i < n; ++i) {
      const double a = 2.0 * kPi * i / n, radius = random.uniform(low, high);
      r.emplace_back(centre.x() + radius * std::cos(a), centre.y() + radius * std::sin(a));
    }
    return r;
  };
  std::vector<Ring> holes;
  for (int k = 0; k < 20; ++k) {
    const double a = 2.0 * kPi * k / 10, d = k < 10 ? 4.0 : 7.0;
    holes.push_back(ring({d * std::cos(a), d * std::sin(a)}, 0.4, 1.0, 20));
  }
  return make_polygon(ring({0, 0}, 9.0, 10.0, 600), holes);
}

void Lloyd_Step(benchmark::State& state) {
  Random random(1);
  const LloydCoverage<> cover(jagged_domain());
  const auto start =
      random_places(cover.domain(), static_cast<std::size_t>(state.range(0)), random);
  for (auto _ : state) {
    auto robots = start;
    benchmark::DoNotOptimize(cover.step(robots).cost);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(Lloyd_Step)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

void Voronoi_Regions(benchmark::State& state) {
  Random random(1);
  const Polygon domain = jagged_domain();
  const auto robots = random_places(domain, static_cast<std::size_t>(state.range(0)), random);
  for (auto _ : state) benchmark::DoNotOptimize(voronoi_tessellation(domain, robots).cells.size());
}
BENCHMARK(Voronoi_Regions)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

void Polygon_Validate(benchmark::State& state) {
  const Polygon domain = jagged_domain();
  for (auto _ : state) validate(domain);
}
BENCHMARK(Polygon_Validate)->Unit(benchmark::kMillisecond);
}  // namespace
