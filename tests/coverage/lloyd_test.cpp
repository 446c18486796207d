// SPDX-License-Identifier: MIT
#include <surfleet/coverage/lloyd.hpp>  // first: proves it stands alone

#include <algorithm>
#include <set>
#include <utility>

#include <surfleet/core/random.hpp>
#include <surfleet/coverage/coverage_network.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
struct ArchetypeDensity {
  float operator()(const Point2& q) const { return q.x() > 0.0 ? 1.0F : 0.5F; }
};
struct ArchetypePerformance {
  float operator()(double d) const { return static_cast<float>(d); }
  float slope(double) const { return 1.0F; }
};
static_assert(PlanarDensity<ArchetypeDensity> && !PlanarDensity<int>);
static_assert(PerformanceFunction<ArchetypePerformance> && !PerformanceFunction<UniformDensity>);

Polygon obstacle_course() {
  return make_polygon(
      {{0, 0}, {10, 0}, {10, 4}, {7, 4}, {7, 8}, {0, 8}},
      {{{2, 2}, {4, 2}, {3, 5}}, {{5, 5}, {6, 5}, {6, 7}, {5, 7}}, {{8, 1}, {9, 1}, {9, 3}}});
}
}  // namespace

TEST(cells_are_the_nearest_points_and_fill_the_domain) {
  Random random(2);
  const Polygon domain = obstacle_course();
  for (const std::size_t n : {1UL, 2UL, 3UL, 10UL, 60UL}) {
    const auto robots = random_places(domain, n, random);
    const auto v = voronoi_tessellation(domain, robots);
    double sum = 0.0;
    for (const VoronoiCell& c : v.cells) sum += area(c.region);
    CHECK_NEAR(sum, area(domain), 1e-9);
    for (int k = 0; k < 400; ++k) {
      const Point2 q = random_places(domain, 1, random)[0];
      std::size_t nearest = 0;
      double first = 1e9, second = 1e9;
      for (std::size_t i = 0; i < n; ++i) {
        const double d = (robots[i] - q).norm();
        if (d < first) {
          second = first;
          first = d;
          nearest = i;
        } else {
          second = std::min(second, d);
        }
      }
      if (second - first < 1e-9) continue;
      for (std::size_t i = 0; i < n; ++i) CHECK(contains(v.cells[i].region, q) == (i == nearest));
    }
    for (std::size_t i = 0; i < n; ++i)
      for (const std::int32_t j : v.cells[i].neighbours) {
        const auto& back = v.cells[static_cast<std::size_t>(j)].neighbours;
        CHECK(std::find(back.begin(), back.end(), static_cast<std::int32_t>(i)) != back.end());
      }
  }
}

TEST(a_lattice_and_a_line_have_the_neighbours_one_expects) {
  std::vector<Point2> grid;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 5; ++x) grid.emplace_back(x + 0.5, y + 0.5);
  const auto v = voronoi_tessellation(make_rectangle({0, 0}, {5, 5}), grid);
  CHECK(v.cells[12].neighbours == (std::vector<std::int32_t>{7, 11, 13, 17}));
  CHECK_NEAR(area(v.cells[12].region), 1.0, 1e-12);
  std::vector<Point2> line;
  for (int x = 0; x < 40; ++x) line.emplace_back(0.1 + 0.1 * x, 1.0);
  const auto w = voronoi_tessellation(make_rectangle({0, 0}, {5, 5}), line);
  CHECK(w.cells[20].neighbours == (std::vector<std::int32_t>{19, 21}));
}

TEST(threads_and_generators_outside) {
  Random random(8);
  const Polygon domain = obstacle_course();
  std::vector<Point2> robots = random_places(domain, 40, random);
  robots.emplace_back(30.0, 30.0);  // far outside: owns nothing
  robots.emplace_back(3.0, 3.0);    // in an obstacle: owns what is around it
  const LloydCoverage<> one(domain), two(domain, {.threads = 2});
  const CoverageState a = one.evaluate(robots), b = two.evaluate(robots);
  CHECK(a.cost == b.cost && a.centroids == b.centroids);
  CHECK_NEAR(a.mass[40], 0.0, 0.0);
  CHECK(a.centroids[40] == robots[40]);
  CHECK(a.mass[41] > 0.0);
}

TEST(bad_placements_are_refused) {
  const Polygon domain = obstacle_course();
  const std::vector<Point2> twins{{1, 1}, {5, 1}, {1, 1}}, outside{{1, 1}, {3, 3}}, none;
  CHECK_THROWS(Error, voronoi_tessellation(domain, twins));
  CHECK_THROWS(Error, require_placed(domain, twins));
  CHECK_THROWS(Error, require_placed(domain, outside));
  CHECK_THROWS(Error, require_placed(domain, none));
}

TEST(lloyd_lowers_the_cost_to_a_centroidal_tessellation) {
  Random random(6);
  const Polygon square = make_rectangle({0, 0}, {1, 1});
  std::vector<Point2> robots = random_places(square, 12, random);
  const LloydCoverage<> cover(square);
  double last = 1e9;
  LloydStep step{0, 1};
  for (int k = 0; k < 3000 && step.largest_move > 1e-6; ++k) {
    step = cover.step(robots);
    CHECK(step.cost <= last + 1e-15);
    last = step.cost;
  }
  CHECK(step.largest_move <= 1e-6);
  // Above the hexagonal bound 5 / (18 √3) A² / n, below a sixth more.
  const double bound = 5.0 / (18.0 * std::sqrt(3.0)) / 12.0;
  CHECK(last > bound && last < 1.17 * bound);
  // The controller of single integrators gets there as well.
  std::vector<Point2> driven = random_places(square, 12, random);
  last = 1e9;
  for (int k = 0; k < 400; ++k) {
    const LloydStep s = cover.control_step(driven, 1.0, 0.2, 0.1);
    CHECK(s.cost <= last + 1e-15 && s.largest_move <= 0.02 + 1e-12);
    last = s.cost;
  }
  CHECK(last < 1.2 * bound);
}

TEST(moments_of_an_annulus_sector_and_density_integrals) {
  const Region region{make_polygon({{0, 0}, {2, 0}, {2, 1}, {0, 1}})};
  const RegionMoments m = region_moments(region, {0.3, 0.4}, UniformDensity{}, 0.1);
  CHECK_NEAR(m.mass, 2.0, 1e-12);
  CHECK_NEAR((m.centroid() - Point2(1.0, 0.5)).norm(), 0.0, 1e-12);
  CHECK_NEAR(m.polar({1.0, 0.5}), 2.0 * (4.0 + 1.0) / 12.0, 1e-12);
  CHECK_NEAR(m.polar({0.0, 0.5}), 2.0 * 5.0 / 12.0 + 2.0, 1e-12);
  const auto linear = [](const Point2& q) { return 1.0 + q.x(); };
  const RegionMoments w = region_moments(region, {0.3, 0.4}, linear, 10.0);
  CHECK_NEAR(w.mass, 4.0, 1e-12);
  CHECK_NEAR(w.centroid().x(), (2.0 + 8.0 / 3.0) / 4.0, 1e-12);
  GaussianMixture bell{{{{1.0, 0.5}, 0.05, 1.0}}, 0.0};
  CHECK_NEAR(region_moments(region, {0, 0}, bell, 0.05).mass, 2.0 * kPi * 0.0025, 1e-6);
}

TEST(gradient_is_that_of_the_cost) {
  Random random(7);
  const Polygon domain = obstacle_course();
  const auto rho = [](const Point2& q) { return 1.0 + 0.1 * q.x(); };
  std::vector<Point2> robots = random_places(domain, 8, random);
  const auto v = voronoi_tessellation(domain, robots);
  const auto test = [&](const auto& h) {
    const LloydCoverage cover(domain, {.element = 0.3}, rho, h);
    const auto points = quadrature(v.cells[2].region, 0.3, rho);
    const Point2 g = performance_gradient(points, robots[2], h);
    for (int axis = 0; axis < 2; ++axis) {
      const double eps = 1e-4;
      auto plus = robots, minus = robots;
      plus[2][axis] += eps;
      minus[2][axis] -= eps;
      CHECK_NEAR((cover.cost(plus) - cover.cost(minus)) / (2 * eps), g[axis],
                 0.02 * (1.0 + g.norm()));
    }
  };
  test(SquaredDistance{});
  test(PowerDistance{1.0});
  test(PowerDistance{3.0});
  // eq. 3.32: −2 M (c − p)
  const LloydCoverage uniform(domain);
  const CoverageState s = uniform.evaluate(robots);
  const auto points = quadrature(v.cells[3].region, 0.5);
  const Point2 g = performance_gradient(points, robots[3], SquaredDistance{});
  CHECK_NEAR((g + 2.0 * s.mass[3] * (s.centroids[3] - robots[3])).norm(), 0.0, 1e-9);
}

TEST(general_performance_never_raises_the_cost) {
  Random random(17);
  const Polygon square = make_rectangle({0, 0}, {2, 1});
  const LloydCoverage cover(square, {.element = 0.2},
                            GaussianMixture{{{{0.5, 0.5}, 0.3, 3.0}}, 1.0}, PowerDistance{1.0});
  auto robots = random_places(square, 5, random);
  double last = 1e9;
  for (int k = 0; k < 15; ++k) {
    const double cost = cover.step(robots).cost;
    CHECK(cost <= last * (1.0 + 1e-3));
    last = cost;
  }
  // The median of a symmetric set of points is its centre.
  const auto points = quadrature({make_rectangle({0, 0}, {1, 1})}, 0.2);
  CHECK_NEAR(
      (generalized_centroid(points, {0.2, 0.9}, PowerDistance{1.0}) - Point2(0.5, 0.5)).norm(), 0.0,
      1e-4);
}

TEST(robots_ask_their_voronoi_neighbours_and_nobody_else) {
  Random random(21);
  const Polygon square = make_rectangle({0, 0}, {10, 10});
  DistributedLloyd team(square, random_places(square, 30, random));
  std::set<std::pair<RobotId, RobotId>> asked;
  team.network.on_send = [&](const auto& message) {
    if (message.payload.is_question) asked.emplace(message.from, *message.to);
  };
  for (int round = 0; round < 25; ++round) {
    asked.clear();
    team.exchange();
    CHECK(!asked.empty());
    // Neighbours in the widened frame the tables are kept in, computed centrally.
    const Polygon frame = make_rectangle({-10, -10}, {20, 20});
    const auto central = voronoi_tessellation(frame, team.positions());
    const auto inside = voronoi_tessellation(square, team.positions());
    for (const auto& [asker, other] : asked) {
      const auto& n = central.cells[asker].neighbours;
      CHECK(std::binary_search(n.begin(), n.end(), static_cast<std::int32_t>(other)));
    }
    for (std::size_t i = 0; i < 30; ++i) {
      CHECK(team.cell(i).neighbours == inside.cells[i].neighbours);
      CHECK_NEAR(area(team.cell(i).region), area(inside.cells[i].region), 1e-9);
    }
    team.move(round < 12 ? 0.5 : 1.0);
  }
}
