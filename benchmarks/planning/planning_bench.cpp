// SPDX-License-Identifier: MIT
/// @file
/// @brief What one drone's plan is made of: lattices searched, views counted, an orienteering tour.
#include <surfleet/core/random.hpp>
#include <surfleet/motion/optimistic_lattice.hpp>
#include <surfleet/planning/team_tour.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

#include <benchmark/benchmark.h>

#include <vector>

#include "../motion/plant_map.hpp"

namespace {
using namespace surfleet;

const Point3 kStart(-33, -21, 3);

/// The western half of a plant is known, where it is free.
struct HalfKnown {
  HalfKnown() : map({.voxel_size = 0.3}), states((plant_map::observe(map, known, plant), map)) {}
  plant_map::Plant plant;
  Box3 known = Box3(plant_map::bounds().min() - Point3::Constant(1.5),
                    Point3(0.0, plant_map::bounds().max().y() + 1.5, 20.0));
  TsdfMap map;
  VoxelStateMap states;
  FreeSpace space{states, {.radius = 1.0, .bounds = plant_map::bounds()}};
};

/// All verdicts are there, as they are in a mission where nothing has changed.
void FlightLattice_Search(benchmark::State& state) {
  const HalfKnown w;
  FlightLattice<FreeSpace> lattice(w.space, plant_map::bounds(), 1.2);
  std::size_t nodes = 0;
  const auto search = [&] { lattice.search(kStart, [&](const auto&) { return ++nodes > 0; }); };
  search();
  nodes = 0;
  for (auto _ : state) search();
  state.SetItemsProcessed(static_cast<std::int64_t>(nodes));
}
BENCHMARK(FlightLattice_Search)->Unit(benchmark::kMillisecond);

void OptimisticLattice_Search(benchmark::State& state) {
  const HalfKnown w;
  FlightLattice<FreeSpace> known(w.space, plant_map::bounds(), 1.2);
  OptimisticLattice hope;
  hope.follow(w.space, 1.2);
  std::size_t nodes = 0;
  const auto search = [&] {
    hope.search(kStart, known, [&](const auto&, bool) { return ++nodes > 0; });
  };
  search();
  nodes = 0;
  for (auto _ : state) search();
  state.SetItemsProcessed(static_cast<std::int64_t>(nodes));
}
BENCHMARK(OptimisticLattice_Search)->Unit(benchmark::kMillisecond);

std::vector<SightTarget> targets_in(const Box3& box, std::size_t count) {
  Random random(3);
  std::vector<SightTarget> targets;
  for (std::size_t i = 0; i < count; ++i) {
    const Point3 p(random.uniform(box.min().x(), box.max().x()),
                   random.uniform(box.min().y(), box.max().y()),
                   random.uniform(box.min().z(), box.max().z()));
    targets.push_back(
        {p, Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized(), 1.0});
  }
  return targets;
}
struct Anything {
  bool operator()(const Point3&, const SightTarget&) const { return true; }
};

/// Targets a place could show, by distance or by depth; items are those within the range.
void SightTargets_InView(benchmark::State& state) {
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(90.0), radians(60.0), 160, 92, 1.6, 8.0);
  const HeadingTable headings(camera, forward_camera_mount());
  const SightTargets<Anything> targets(targets_in(plant_map::bounds(), 20000), Anything{}, headings,
                                       {.by_depth = state.range(0) != 0});
  std::vector<Sighting> buffer;
  std::size_t seen = 0;
  for (auto _ : state) seen += targets.in_view({0.0, 0.0, 6.0}, buffer).size();
  state.SetItemsProcessed(static_cast<std::int64_t>(seen));
}
BENCHMARK(SightTargets_InView)->ArgName("by_depth")->Arg(0)->Arg(1);

/// What places show is told by a table, so that the tours alone are timed.
struct TableViews {
  std::vector<double> gain;
  double most(std::size_t s) const { return gain[s]; }
  double evaluate(std::size_t s, double /*enough*/, GainByView& by_view) const {
    by_view.fill(gain[s]);
    return gain[s];
  }
  void take(std::size_t s, int /*view*/) { gain[s] = 0.0; }
};

/// By sites and robots.
void TeamTours_Plan(benchmark::State& state) {
  Random random(4);
  std::vector<Point3> sites;
  TableViews views;
  std::vector<TourStart> team(static_cast<std::size_t>(state.range(1)));
  for (const SightTarget& t :
       targets_in(plant_map::bounds(), static_cast<std::size_t>(state.range(0)))) {
    sites.push_back(t.position);
    views.gain.push_back(random.uniform(0.0, 30.0));
  }
  for (std::size_t r = 0; r < team.size(); ++r) {
    team[r].from = {kStart + Eigen::Vector3d(2.0 * static_cast<double>(r), 0.0, 0.0), 0.0};
    for (const Point3& p : sites) team[r].distance.push_back((p - team[r].from.position).norm());
  }
  for (auto _ : state) {
    TableViews fresh = views;
    benchmark::DoNotOptimize(TeamTours(team, sites, fresh, {})());
  }
}
BENCHMARK(TeamTours_Plan)
    ->ArgNames({"sites", "robots"})
    ->Args({1000, 1})
    ->Args({20000, 1})
    ->Args({1000, 5})
    ->Args({20000, 5})
    ->Unit(benchmark::kMillisecond);
}  // namespace
