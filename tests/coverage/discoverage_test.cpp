// SPDX-License-Identifier: MIT
#include <surfleet/coverage/discoverage.hpp>  // first: proves it stands alone

#include <surfleet/simulation/planar_environments.hpp>

#include "check.hpp"

using namespace surfleet;

TEST(an_office_is_explored_to_the_last_cell_by_three_robots) {
  const PlanarEnvironment world = planar_environment("office");
  const auto start = group_start(world.domain, world.start, 3, 0.4);
  DisCoverage explore(world.domain, start, {.range = 4.0, .cell = 0.2});
  double last = 0.0;
  for (int k = 0; k < 2000 && !explore.finished(); ++k) {
    explore.step();
    CHECK(explore.explored().fraction() >= last);
    last = explore.explored().fraction();
    for (const Point2& p : explore.robots()) CHECK(contains(world.domain, p, 1e-6));
  }
  CHECK(explore.finished());
  CHECK(explore.explored().covered_count() ==
        reachable_cells(world.domain, explore.explored(), start));
  CHECK(explore.explored().covered_count() == explore.explored().size());
}

TEST(two_robots_are_faster_than_one_and_small_worlds_end_at_once) {
  const PlanarEnvironment world = planar_environment("office");
  double time[2];
  for (std::size_t n = 1; n <= 2; ++n) {
    DisCoverage explore(world.domain, group_start(world.domain, {10.0, 6.0}, n, 0.4),
                        {.range = 4.0, .cell = 0.25});
    while (!explore.finished() && explore.time() < 1000.0) explore.step();
    CHECK(explore.finished());
    time[n - 1] = explore.time();
  }
  CHECK(time[1] < 0.8 * time[0]);
  const PlanarEnvironment box = planar_environment("square");
  DisCoverage at_once(box.domain, group_start(box.domain, box.start, 1, 0.1),
                      {.range = 3.0, .cell = 0.05});
  at_once.step();
  CHECK(at_once.finished());
  const std::vector<Point2> outside{{-1, 0}};
  CHECK_THROWS(Error, DisCoverage(box.domain, outside));
  CHECK_THROWS(
      Error, DisCoverage(box.domain, group_start(box.domain, box.start, 1, 0.1), {.range = 0.01}));
}

namespace {
/// How far a robot gets to the right of its start in so many steps. It stands in a hall that goes
/// on to the right; a pillar beside it hides a little of the hall, and is the nearest frontier.
double to_the_right(double distance_scale, int steps) {
  Polygon hall;
  hall.outer = {{0, 0}, {20, 0}, {20, 6}, {0, 6}};
  hall.holes = {{{2.4, 4.8}, {2.4, 5.0}, {2.7, 5.0}, {2.7, 4.8}}};
  const std::vector<Point2> start{{3.0, 3.0}};
  DisCoverage explore(hall, start, {.range = 4.0, .cell = 0.1, .distance_scale = distance_scale});
  for (int k = 0; k < steps; ++k) explore.step();
  return explore.robots()[0].x() - start[0].x();
}
}  // namespace

TEST(a_robot_heads_for_where_most_frontier_lies_and_not_for_the_nearest) {
  CHECK(to_the_right(DisCoverageOptions{}.distance_scale, 6) > 1.0);
  // The less that far frontier counts, the more it is a matter of the nearest.
  CHECK(to_the_right(0.02, 6) < 0.6);
}
