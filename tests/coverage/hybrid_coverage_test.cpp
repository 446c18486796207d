// SPDX-License-Identifier: MIT
#include <surfleet/coverage/hybrid_coverage.hpp>  // first: proves it stands alone

#include <surfleet/coverage/hybrid_flocking.hpp>
#include <surfleet/coverage/hybrid_voronoi.hpp>
#include <surfleet/coverage/random_coverage.hpp>
#include <surfleet/coverage/robotic_band.hpp>
#include <surfleet/simulation/planar_environments.hpp>

#include <array>

#include "check.hpp"

using namespace surfleet;

namespace {
/// No robot is faster than allowed, none leaves the domain.
void legal(const Polygon& domain, const std::vector<TimedPath>& paths, const HybridOptions& o) {
  for (const TimedPath& p : paths)
    for (std::size_t i = 1; i < p.points().size(); ++i) {
      const TimedPoint &a = p.points()[i - 1], &b = p.points()[i];
      CHECK((b.point - a.point).norm() <= o.speed * (b.time - a.time) + 1e-9);
      if (i % 7 == 0) CHECK(sees(domain, a.point, b.point, 1e-6));
    }
}
// Larger robots than in 004, to keep the runs short.
constexpr HybridOptions kCoarse{.speed = 0.1, .footprint = 0.1, .lane = 0.195, .cell = 0.04};
}  // namespace

TEST(sweeps_cover_every_cell_of_odd_parts) {
  const Polygon comb =
      make_polygon({{0, 0}, {3, 0}, {3, 2}, {2.4, 2}, {2.2, 0.5}, {1.6, 2.2}, {1, 0.7}, {0.3, 2}},
                   {{{0.5, 0.4}, {0.9, 0.4}, {0.7, 0.9}}});
  const PolygonGeodesics geodesics(comb);
  const HybridOptions o{.footprint = 0.05, .lane = 0.09, .cell = 0.02};
  const auto check_covered = [&](const auto& sweep) {
    const auto path = sweep_region({comb}, Point2(0.1, 0.1), geodesics, o, sweep);
    CoverageGrid grid(comb, 0.011);
    for (std::size_t i = 1; i < path.size(); ++i) {
      grid.cover(path[i - 1], path[i], o.footprint + 0.01);
      CHECK(sees(comb, path[i - 1], path[i], 1e-6));
    }
    CHECK(grid.fraction() == 1.0);
    CHECK(path_length(path) < 1.6 * area(comb) / o.lane);
  };
  check_covered(BackAndForthSweep{});
  check_covered(BackAndForthSweep{0.7});
  check_covered(SpiralSweep{});
  const Polygon box = make_rectangle({0, 0}, {2, 1});
  const auto spiral = SpiralSweep{}(box, {0, 0}, PolygonGeodesics(box), o);
  CHECK(path_length(spiral) < 1.2 * 2.0 / o.lane);
}

TEST(reeb_graph_of_an_obstacle_and_of_a_notch) {
  const ReebGraph free = reeb_graph(make_rectangle({0, 0}, {5, 3}));
  CHECK(free.cells.size() == 1 && free.points.size() == 2);
  const Polygon triangle = planar_environment("arena_triangle").domain;
  const ReebGraph g = reeb_graph(triangle);
  CHECK(g.cells.size() == 4);
  std::array<int, 5> kinds{};
  for (const CriticalPoint& p : g.points) ++kinds[static_cast<std::size_t>(p.kind)];
  CHECK(kinds == (std::array<int, 5>{1, 1, 0, 1, 1}));
  for (const char* scene :
       {"arena_triangle", "u_shape", "two_obstacles", "nonconvex_obstacle", "office"}) {
    const Polygon domain = planar_environment(scene).domain;
    double sum = 0.0;
    for (const ReebCell& c : reeb_graph(domain).cells) {
      CHECK(c.from >= 0 && c.to >= 0);
      validate(c.region);
      sum += area(c.region);
    }
    CHECK_NEAR(sum, area(domain), 1e-9);
  }
}

TEST(band_and_voronoi_cover_everything_and_beat_random) {
  for (const char* scene : {"arena", "arena_triangle"})
    for (const std::size_t n : {4UL, 7UL}) {
      const PlanarEnvironment world = planar_environment(scene);
      const auto start = group_start(world.domain, world.start, n, 0.12);
      const auto random = random_coverage(world.domain, start, Random(3), kCoarse);
      legal(world.domain, random, kCoarse);
      const auto baseline = replay(world.domain, random, kCoarse).time_to(0.95);
      CHECK(baseline.has_value());
      const RoboticBandPlan band = robotic_band(world.domain, start, kCoarse);
      legal(world.domain, band.paths, kCoarse);
      const CoverageHistory band_history = replay(world.domain, band.paths, kCoarse);
      CHECK(band_history.fraction.back() > 0.999);
      CHECK(band_history.time_to(0.95).value_or(1e9) < 0.75 * *baseline);
      double sum = 0.0;
      for (const ReebCell& c : band.graph.cells) sum += area(c.region);
      CHECK_NEAR(sum, area(world.domain), 1e-6);
      const HybridVoronoiPlan plan = hybrid_voronoi(world.domain, start, kCoarse);
      legal(world.domain, plan.paths, kCoarse);
      const CoverageHistory history = replay(world.domain, plan.paths, kCoarse);
      CHECK(history.fraction.back() > 0.999);
      CHECK(history.time_to(0.95).value_or(1e9) < 0.6 * *baseline);
      sum = 0.0;
      for (const Region& r : plan.regions) sum += area(r);
      CHECK_NEAR(sum, area(world.domain), 1e-9);
    }
}

TEST(band_with_given_cell_sizes_leaves_open_tasks_to_idle_robots) {
  const PlanarEnvironment world = planar_environment("arena_triangle");
  for (const std::size_t n : {1UL, 2UL, 3UL, 5UL}) {
    const auto start = group_start(world.domain, world.start, n, 0.12);
    const RoboticBandPlan band =
        robotic_band(world.domain, start, kCoarse, {.cell_area = 1.1, .max_advance = 1.0});
    legal(world.domain, band.paths, kCoarse);
    CHECK(replay(world.domain, band.paths, kCoarse).fraction.back() > 0.999);
    CHECK(band.graph.cells.size() >= 9);
  }
  const RoboticBandPlan across =
      robotic_band(world.domain, group_start(world.domain, {2.5, 0.3}, 4, 0.12), kCoarse,
                   {.direction = kPi / 2});
  CHECK(replay(world.domain, across.paths, kCoarse).fraction.back() > 0.999);
}

TEST(other_variants_and_driven_deployment) {
  const PlanarEnvironment world = planar_environment("arena_triangle");
  const auto start = group_start(world.domain, world.start, 5, 0.12);
  const FlockingRun flock = flocking_coverage(world.domain, start, kCoarse);
  legal(world.domain, flock.paths, kCoarse);
  CHECK(replay(world.domain, flock.paths, kCoarse).fraction.back() > 0.98);
  CHECK(flock.main_direction.size() > 1);
  const HybridVoronoiPlan driven = hybrid_voronoi(
      world.domain, start, kCoarse, {.deployment = Deployment::Driven}, SpiralSweep{});
  legal(world.domain, driven.paths, kCoarse);
  CHECK(replay(world.domain, driven.paths, kCoarse).fraction.back() > 0.99);
}

TEST(defects_are_found_and_bad_settings_refused) {
  const PlanarEnvironment world = planar_environment("arena");
  Random random(1);
  const auto defects = random_defects(world.domain, 10, random);
  const auto start = group_start(world.domain, world.start, 4, 0.12);
  const auto plan = hybrid_voronoi(world.domain, start, kCoarse);
  std::vector<double> found(defects.size(), -1.0);
  replay(world.domain, plan.paths, kCoarse, 1.0,
         [&](std::size_t, const Point2& a, const Point2& b, double t) {
           for (std::size_t d = 0; d < defects.size(); ++d)
             if (found[d] < 0.0 && defects[d].found_from(a, b, kCoarse.footprint)) found[d] = t;
         });
  for (const double t : found) CHECK(t >= 0.0);
  CHECK_THROWS(Error, hybrid_voronoi(world.domain, start, {.lane = 0.1}));
  CHECK_THROWS(Error, robotic_band(world.domain, start, {.speed = 0.0}));
  CHECK_THROWS(Error, CoverageGrid(world.domain, 0.0));
  const std::vector<Point2> twins{{1, 1}, {1, 1}};
  CHECK_THROWS(Error, robotic_band(world.domain, twins));
}
