// SPDX-License-Identifier: MIT
#include <surfleet/coverage/nonconvex_coverage.hpp>  // first: proves it stands alone

#include <surfleet/coverage/geodesic_coverage.hpp>
#include <surfleet/coverage/gradient_projection.hpp>
#include <surfleet/coverage/prism_coverage.hpp>
#include <surfleet/simulation/planar_environments.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
template <typename Planner>
void deploys(const char* scene, Planner planner, double range_of_cost) {
  const PlanarEnvironment world = planar_environment(scene);
  const auto start = group_start(world.domain, world.start, 5, 0.15);
  NonconvexCoverage<Planner> cover(world.domain, start,
                                   {.speed = 0.1, .dt = 0.2, .tolerance = 2e-3}, planner);
  const double before = cover.real_cost();
  int steps = 0;
  for (; steps < 6000 && !cover.converged(); ++steps) {
    const auto last = cover.real_positions();
    cover.step();
    for (std::size_t i = 0; i < 5; ++i) {
      CHECK((cover.robots()[i].real - last[i]).norm() <= 0.02 + 1e-9);
      CHECK(contains(cover.domain(), cover.robots()[i].real, 1e-6));
    }
  }
  CHECK(cover.converged());
  CHECK(cover.real_cost() < range_of_cost * before);
  // A constrained centroidal configuration: every robot at the projection of its virtual goal.
  for (const auto& r : cover.robots()) {
    CHECK((r.real - project_into(cover.domain(), r.virtual_goal)).norm() < 5e-3);
    CHECK(r.constrained == !contains(cover.domain(), r.virtual_goal));
  }
  double sum = 0.0;
  for (const auto& c : cover.final_tessellation().cells) sum += area(c.region);
  CHECK_NEAR(sum, area(world.domain), 1e-9);
}
}  // namespace

TEST(the_environments_of_chapter_5_are_covered) {
  for (const char* scene :
       {"u_shape", "l_shape", "narrow_passage", "two_obstacles", "nonconvex_obstacle"}) {
    deploys(scene, TangentBugPlanner{}, 0.35);
    deploys(scene, ShortestPathPlanner{}, 0.35);
  }
  deploys("u_shape", TangentBugPlanner{{0.4}}, 0.35);
}

TEST(in_a_convex_domain_real_and_virtual_robots_are_the_same) {
  const PlanarEnvironment world = planar_environment("square");
  const auto start = group_start(world.domain, world.start, 4, 0.05);
  NonconvexCoverage<> cover(world.domain, start, {.speed = 0.1, .dt = 0.2});
  for (int k = 0; k < 500 && !cover.converged(); ++k) {
    cover.step();
    for (const auto& r : cover.robots()) CHECK((r.real - r.virtual_position).norm() < 1e-6);
  }
}

TEST(bad_starts_are_refused) {
  const PlanarEnvironment world = planar_environment("u_shape");
  const std::vector<Point2> outside{{1.5, 2.0}}, twins{{0.5, 0.5}, {0.5, 0.5}};
  CHECK_THROWS(Error, NonconvexCoverage<>(world.domain, outside));
  CHECK_THROWS(Error, NonconvexCoverage<>(world.domain, twins));
  CHECK_THROWS(Error, planar_environment("nowhere"));
}

TEST(projected_gradients_satisfy_the_criterion) {
  const Point2 right(1, 0), up(0, 1);
  CHECK_NEAR((project_gradient({1, 1}, {right}) - Point2(0, 1)).norm(), 0.0, 1e-12);
  CHECK_NEAR((project_gradient({-1, 1}, {right}) - Point2(-1, 1)).norm(), 0.0, 1e-12);
  CHECK_NEAR(project_gradient({1, 1}, {right, up}).norm(), 0.0, 1e-12);
  CHECK_NEAR((project_gradient({1, -1}, {right, up}) - Point2(0, -1)).norm(), 0.0, 1e-12);
  CHECK_NEAR((project_gradient({1, 1}, {right, right}) - Point2(0, 1)).norm(), 0.0, 1e-12);
  CHECK_NEAR(project_gradient({1, 0.3}, {right, up, Point2(1, 1).normalized()}).norm(), 0.0, 1e-12);
  CHECK_NEAR((project_gradient({1, 1}, {right, -right}) - Point2(0, 1)).norm(), 0.0, 1e-12);
  // Nearly parallel, and against each other: the two leave no direction but back out of the wedge.
  const Point2 tilted = Point2(-1, 1e-4).normalized();
  CHECK_NEAR(project_gradient({0, 1}, {right, tilted}).dot(tilted), 0.0, 1e-9);
}

TEST(gradient_projection_stays_inside_and_lowers_the_cost) {
  for (const char* scene : {"u_shape", "two_obstacles", "l_shape", "nonconvex_obstacle"}) {
    const PlanarEnvironment world = planar_environment(scene);
    auto robots = group_start(world.domain, world.start, 5, 0.15);
    const GradientProjectionCoverage<> cover(world.domain);
    double first = 0.0, last = 1e9;
    for (int k = 0; k < 600; ++k) {
      const LloydStep s = cover.step(robots, 1.0, 0.2, 0.1);
      if (k == 0) first = s.cost;
      CHECK(s.cost <= last * (1.0 + 1e-6));
      last = s.cost;
      for (const Point2& p : robots) CHECK(contains(world.domain, p, 1e-6));
    }
    CHECK(last < 0.6 * first);
  }
}

TEST(geodesic_regions_are_nearest_and_descent_lowers_the_cost) {
  const PlanarEnvironment world = planar_environment("u_shape");
  auto robots = group_start(world.domain, world.start, 4, 0.15);
  const GeodesicCoverage<> cover(world.domain, {.cell = 0.1});
  GeodesicTessellation t = cover.tessellate(robots);
  const double before = t.cost;
  for (int k = 0; k < 25; ++k) {
    const double last = t.cost;
    if (cover.step(robots, t, 0.1) == 0.0) break;
    CHECK(t.cost < last);
  }
  CHECK(t.cost < 0.5 * before);
  const GeodesicField f0 = cover.geodesics().from(robots[0]);
  for (std::size_t c = 0; c < cover.grid().cells(); c += 3)
    if (t.owner[c] >= 0) {
      const double d = f0.distance(cover.grid().centre(c));
      CHECK(t.distance[c] <= d + 1e-12);
      CHECK(t.owner[c] != 0 || t.distance[c] == d);
    }
}

TEST(prism_cells_and_flight) {
  const Prism box{make_rectangle({0, 0}, {2, 1}), 0.0, 1.0};
  const std::vector<Point3> pair{{0.5, 0.5, 0.5}, {1.5, 0.5, 0.5}};
  const PrismCells c = prism_cells(box, pair);
  CHECK_NEAR(c.volume[0], 1.0, 1e-12);
  CHECK_NEAR((c.centroid[1] - pair[1]).norm(), 0.0, 1e-12);
  CHECK_NEAR(c.cost, 2.0 * 3.0 / 12.0, 1e-9);
  const std::vector<Point3> stack{{1.0, 0.5, 0.25}, {1.0, 0.5, 0.75}};
  CHECK_NEAR(prism_cells(box, stack).volume[0], 1.0, 1e-12);
  // [004 Fig. 5.7]: five robots take off from the ground of the U.
  std::vector<Point3> start;
  for (const Point2& p : group_start(u_prism().ground, {0.4, 1.9}, 5, 0.15))
    start.emplace_back(p.x(), p.y(), 0.05);
  PrismCoverage cover(u_prism(), start, {.speed = 0.1, .dt = 0.5, .slices = 8, .tolerance = 0.02});
  const double before = cover.cells().cost;
  for (int k = 0; k < 1500 && !cover.converged(); ++k) cover.step();
  CHECK(cover.converged());
  CHECK(cover.cells().cost < 0.3 * before);
  for (const auto& r : cover.robots())
    CHECK(contains(u_prism().ground, Point2(r.real.head<2>()), 1e-6));
}
