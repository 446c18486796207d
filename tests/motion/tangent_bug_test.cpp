// SPDX-License-Identifier: MIT
#include <surfleet/motion/tangent_bug.hpp>  // first: proves it stands alone

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/polygon_geodesic.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
Polygon u_shape() {
  return make_polygon({{0, 0}, {6, 0}, {6, 4}, {4, 4}, {4, 1}, {2, 1}, {2, 4}, {0, 4}});
}
Polygon clutter() {
  return make_polygon({{0, 0}, {12, 0}, {12, 9}, {0, 9}},
                      {{{2, 1}, {5, 1}, {5, 6}, {4, 6}, {4, 2}, {2, 2}},                  // an L
                       {{6, 3}, {9, 3}, {9, 7}, {6, 7}, {6, 6}, {8, 6}, {8, 4}, {6, 4}},  // a trap
                       {{1, 5}, {3, 7}, {1, 8}}});
}
Point2 place(const Polygon& p, Random& random) {
  const Box2 b = p.bounds();
  for (;;) {
    const Point2 q(random.uniform(b.min().x(), b.max().x()),
                   random.uniform(b.min().y(), b.max().y()));
    if (locate(p, q) == Side::Inside) return q;
  }
}
double drive(const Polygon& domain, TangentBug& bug, double step) {
  for (int k = 0; k < 3000 && !bug.arrived(); ++k) {
    const Point2 before = bug.position();
    bug.advance(step);
    CHECK((bug.position() - before).norm() <= step + 1e-9);
    CHECK(contains(domain, bug.position(), 1e-6));
  }
  CHECK(bug.arrived());
  return bug.travelled();
}
}  // namespace

TEST(reachable_goals_are_reached_with_any_range) {
  const double inf = std::numeric_limits<double>::infinity();
  Random random(3);
  for (const Polygon& domain : {u_shape(), clutter()}) {
    const PolygonGeodesics geodesics(domain);
    for (const double range : {0.0, 0.3, 1.0, 4.0, inf})
      for (int k = 0; k < 12; ++k) {
        const Point2 start = place(domain, random), goal = place(domain, random);
        TangentBug bug(domain, start, goal, {range});
        const double length = drive(domain, bug, 0.1);
        CHECK((bug.position() - goal).norm() < 1e-6);
        CHECK(!bug.projection());
        CHECK(length >= geodesics.from(start).distance(goal) - 1e-6);
      }
  }
}

TEST(an_unlimited_sensor_takes_the_shortest_path_round_one_convex_obstacle) {
  const Polygon domain =
      make_polygon({{0, 0}, {10, 0}, {10, 6}, {0, 6}}, {{{4, 1}, {6, 1}, {6, 4}, {4, 4}}});
  TangentBug bug(domain, {1, 3}, {9, 3});
  const double length = drive(domain, bug, 0.05);
  CHECK_NEAR(length, PolygonGeodesics(domain).from({1, 3}).distance({9, 3}), 1e-6);
}

TEST(goals_in_obstacles_are_projected_onto_their_boundary) {
  for (const double range : {0.0, 1.0, 100.0}) {
    const Polygon domain = clutter();
    TangentBug bug(domain, {0.5, 0.5}, {8.6, 5.0}, {range});
    drive(domain, bug, 0.1);
    CHECK(bug.projection().has_value());
    CHECK_NEAR((bug.position() - project_into(domain, {8.6, 5.0})).norm(), 0.0, 1e-6);
    // In the notch of the U, outside the outer ring.
    const Polygon u = u_shape();
    TangentBug notch(u, {1, 3}, {3.6, 3.0}, {range});
    drive(u, notch, 0.1);
    CHECK_NEAR((notch.position() - Point2(4, 3)).norm(), 0.0, 1e-6);
  }
}

TEST(nasty_starts_and_goals) {
  const Polygon u = u_shape();
  TangentBug still(u, {1, 1}, {1, 1});
  drive(u, still, 0.1);
  TangentBug corner(u, {2, 1}, {4, 1});
  CHECK_NEAR(drive(u, corner, 0.1), 2.0, 1e-9);
  TangentBug wall(u, {2, 3}, {4, 3});
  CHECK(drive(u, wall, 10.0) <= 20.0 + 1e-6);  // along the wall, round the outside at worst
  TangentBug far(u, {1, 1}, {-100, 2});
  drive(u, far, 0.3);
  CHECK_NEAR((far.position() - Point2(0, 2)).norm(), 0.0, 1e-6);
  CHECK_THROWS(Error, TangentBug(u, {3, 3}, {1, 1}));
  CHECK_THROWS(Error, TangentBug(u, {1, 1}, {1, 2}, {-1.0}));
}
