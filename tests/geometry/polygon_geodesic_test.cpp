// SPDX-License-Identifier: MIT
#include <surfleet/geometry/polygon_geodesic.hpp>  // first: proves it stands alone

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
Polygon u_shape() {
  return make_polygon({{0, 0}, {6, 0}, {6, 4}, {4, 4}, {4, 1}, {2, 1}, {2, 4}, {0, 4}});
}
Polygon rooms() {
  return make_polygon(
      {{0, 0}, {10, 0}, {10, 8}, {0, 8}},
      {{{2, 2}, {4, 2}, {4, 6}, {2, 6}}, {{5, 1}, {8, 1}, {6, 4}}, {{6, 5}, {9, 5}, {9, 7}}});
}
Point2 place(const Polygon& p, Random& random) {
  const Box2 b = p.bounds();
  for (;;) {
    const Point2 q(random.uniform(b.min().x(), b.max().x()),
                   random.uniform(b.min().y(), b.max().y()));
    if (locate(p, q) == Side::Inside) return q;
  }
}
}  // namespace

TEST(sight_along_walls_and_through_corners) {
  const Polygon u = u_shape();
  CHECK(sees(u, {0, 0}, {6, 0}));
  CHECK(sees(u, {2, 4}, {2, 1}));
  CHECK(sees(u, {2, 1}, {4, 1}));
  CHECK(sees(u, {0, 1}, {6, 1}));
  CHECK(!sees(u, {1, 3}, {5, 3}));
  CHECK(!sees(u, {2, 4}, {4, 4}));
  CHECK(!sees(u, {2, 1.1}, {4, 1.1}));
  CHECK(sees(u, {1, 2}, {3, 0}));  // grazes the corner (2, 1)
  CHECK_NEAR(free_distance(u, {1, 2}, {1, 0}), 1.0, 1e-9);
  CHECK_NEAR(free_distance(u, {0, 1}, {1, 0}), 6.0, 1e-9);
  CHECK_NEAR(free_distance(u, {2, 2}, {1, 0}), 0.0, 1e-9);
  CHECK_NEAR(free_distance(u, {2, 2}, {0, 1}), 2.0, 1e-9);
}

TEST(visible_region_is_what_is_seen) {
  Random random(11);
  const Polygon p = rooms();
  for (int round = 0; round < 20; ++round) {
    const Point2 eye = place(p, random);
    const Polygon seen{visibility_polygon(p, eye), {}};
    const Polygon near{visibility_polygon(p, eye, 3.0), {}};
    CHECK(signed_area(seen.outer) > 0.0);
    CHECK(signed_area(near.outer) <= signed_area(seen.outer) + 1e-9);
    for (int k = 0; k < 100; ++k) {
      const Point2 q = place(p, random);
      if (closest_boundary_point(seen, q).distance < 1e-6) continue;
      CHECK(contains(seen, q) == sees(p, eye, q));
      if (std::abs((q - eye).norm() - 3.0) < 0.01) continue;
      if (closest_boundary_point(near, q).distance > 1e-6)
        CHECK(contains(near, q) == (sees(p, eye, q) && (q - eye).norm() < 3.0));
    }
  }
  CHECK(visibility_polygon(p, {3, 3}).empty());
  const Ring whole = visibility_polygon(make_rectangle({0, 0}, {5, 3}), {0, 0});
  CHECK_NEAR(signed_area(whole), 15.0, 1e-6);
  CHECK_NEAR(signed_area(visibility_polygon(make_rectangle({0, 0}, {5, 3}), {2, 0})), 15.0, 1e-6);
}

TEST(distances_round_corners) {
  const PolygonGeodesics solver(u_shape());
  const GeodesicField f = solver.from({1, 4});
  CHECK_NEAR(f.distance({1, 1}), 3.0, 1e-12);
  const double expected = Point2(1, -3).norm() + 2.0 + Point2(1, 3).norm();
  CHECK_NEAR(f.distance({5, 4}), expected, 1e-9);
  const auto path = f.path({5, 4});
  CHECK(path.size() == 4);
  CHECK_NEAR(path_length(path), expected, 1e-9);
  const Point2 image = f.star_image({5, 4});
  CHECK_NEAR((image - f.source()).norm(), expected, 1e-9);
  CHECK_NEAR(cross2((image - f.source()).normalized(), Point2(1, -3).normalized()), 0.0, 1e-12);
  CHECK(f.star_image({1, 1}) == Point2(1, 1));
  CHECK(f.path({3, 3}).empty());
}

TEST(geodesics_are_a_metric_and_no_longer_than_a_fine_grid) {
  Random random(4);
  const Polygon p = rooms();
  const PolygonGeodesics solver(p);
  for (int round = 0; round < 30; ++round) {
    const Point2 a = place(p, random), b = place(p, random), c = place(p, random);
    const GeodesicField fa = solver.from(a), fb = solver.from(b);
    const double ab = fa.distance(b), ba = fb.distance(a);
    CHECK_NEAR(ab, ba, 1e-9);
    CHECK(ab >= (a - b).norm() - 1e-12);
    CHECK(fa.distance(c) <= ab + fb.distance(c) + 1e-9);
    const auto path = fa.path(b);
    CHECK_NEAR(path_length(path), ab, 1e-9);
    for (std::size_t i = 1; i < path.size(); ++i) CHECK(sees(p, path[i - 1], path[i]));
    if (sees(p, a, b)) CHECK_NEAR(ab, (a - b).norm(), 1e-12);
  }
  // Oracle: Dijkstra over all vertices without the tangent rule.
  std::vector<Point2> nodes;
  for (std::size_t r = 0; r < p.rings(); ++r)
    nodes.insert(nodes.end(), p.ring(r).begin(), p.ring(r).end());
  const Point2 s(1, 1), t(9, 7.5);
  nodes.push_back(s);
  nodes.push_back(t);
  std::vector<std::pair<std::int32_t, Arc>> arcs;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (i != j && sees(p, nodes[i], nodes[j]))
        arcs.push_back({static_cast<std::int32_t>(i),
                        {static_cast<std::int32_t>(j), (nodes[i] - nodes[j]).norm()}});
  const auto brute =
      shortest_paths(Graph(nodes.size(), arcs), static_cast<std::int32_t>(nodes.size() - 2));
  CHECK_NEAR(solver.from(s).distance(t), brute.distance.back(), 1e-9);
}
