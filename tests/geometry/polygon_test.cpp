// SPDX-License-Identifier: MIT
#include <surfleet/geometry/polygon.hpp>  // first: proves it stands alone

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/point_location.hpp>
#include <surfleet/geometry/polygon_clipping.hpp>
#include <surfleet/geometry/polygon_trapezoids.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
std::string refusal(Ring outer, std::vector<Ring> holes = {}) {
  try {
    make_polygon(std::move(outer), std::move(holes));
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}
/// A star-shaped ring with jagged radius: simple for any radii.
Ring jagged(Random& random, const Point2& centre, double low, double high, int n) {
  Ring ring;
  for (int i = 0; i < n; ++i) {
    const double a = 2.0 * kPi * i / n, r = random.uniform(low, high);
    ring.emplace_back(centre.x() + r * std::cos(a), centre.y() + r * std::sin(a));
  }
  return ring;
}
Polygon jagged_with_holes(Random& random) {
  Ring outer = jagged(random, {0, 0}, 7.0, 10.0, 120);
  std::vector<Ring> holes;
  for (int k = 0; k < 6; ++k)
    holes.push_back(
        jagged(random, 4.0 * Point2(std::cos(k * kPi / 3), std::sin(k * kPi / 3)), 0.4, 1.5, 20));
  return make_polygon(outer, holes);
}
}  // namespace

TEST(orientation_is_exact_on_nearly_straight_triples) {
  // Kettner's example: rounding makes the naive determinant lie about these.
  const Point2 q(12.0, 12.0), r(24.0, 24.0);
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Point2 p(0.5 + i * 0x1.0p-53, 0.5 + j * 0x1.0p-53);
      CHECK(turn(p, q, r) == (j > i) - (j < i) || turn(p, q, r) == -((j > i) - (j < i)));
      CHECK(turn(p, q, r) == turn(q, r, p) && turn(p, q, r) == -turn(q, p, r));
    }
  CHECK(turn({0, 0}, {1, 0}, {0, 1}) == 1);
}

TEST(measures_of_a_square_with_a_hole) {
  const Polygon p =
      make_polygon({{0, 0}, {0, 4}, {4, 4}, {4, 0}}, {{{2, 2}, {3, 2}, {3, 3}, {2, 3}}});
  CHECK_NEAR(area(p), 15.0, 1e-12);
  CHECK_NEAR(signed_area(p.outer), 16.0, 1e-12);
  CHECK(signed_area(p.holes[0]) < 0.0);
  CHECK_NEAR(centroid(p).x(), (16 * 2.0 - 2.5) / 15.0, 1e-12);
  CHECK(locate(p, {0, 2}) == Side::Boundary);
  CHECK(locate(p, {2, 2}) == Side::Boundary);
  CHECK(locate(p, {4, 4}) == Side::Boundary);
  CHECK(locate(p, {2.5, 2.5}) == Side::Outside);
  CHECK(locate(p, {1, 2}) == Side::Inside);
  CHECK(locate(p, {5, 2}) == Side::Outside);
  CHECK_NEAR((project_into(p, {2.4, 2.1}) - Point2(2.4, 2.0)).norm(), 0.0, 1e-12);
}

TEST(bad_polygons_are_refused_with_a_reason) {
  const Ring square{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  CHECK(refusal(square).empty());
  CHECK(refusal({{0, 0}, {4, 4}, {4, 0}, {0, 4}}).find("meets") != std::string::npos);
  CHECK(refusal({{0, 0}, {1, 0}}).find("at least 3") != std::string::npos);
  CHECK(refusal({{0, 0}, {2, 0}, {1, 0}}) != "");
  CHECK(refusal({{0, 0}, {4, 0}, {4, 4}, {2, 4}, {2, 5}, {2, 4.5}, {0, 4}}) != "");
  CHECK(refusal({{0, 0}, {4, 0}, {4, 0}, {0, 4}}).find("same point") != std::string::npos);
  CHECK(refusal({{0, 0}, {4, 0}, {4, std::nan("")}}).find("finite") != std::string::npos);
  CHECK(refusal(square, {{{5, 5}, {6, 5}, {5, 6}}}).find("outside") != std::string::npos);
  CHECK(refusal(square, {{{3, 3}, {6, 3}, {3, 6}}}).find("meets") != std::string::npos);
  CHECK(refusal(square, {{{1, 1}, {3, 1}, {1, 3}}, {{1.2, 1.2}, {1.4, 1.2}, {1.2, 1.4}}})
            .find("inside hole") != std::string::npos);
  CHECK(refusal(square, {{{0, 1}, {1, 1}, {1, 2}}}) != "");  // touches the outer ring
}

TEST(clipping_keeps_area_and_membership) {
  Random random(5);
  PolygonClipper clipper;
  for (int round = 0; round < 40; ++round) {
    const Polygon p = jagged_with_holes(random);
    const double angle = random.uniform(0.0, 2.0 * kPi);
    const HalfPlane half{{std::cos(angle), std::sin(angle)}, random.uniform(-8.0, 8.0)};
    const Region left = clip(p, {{half}});
    const Region right = clip(p, {{HalfPlane{-half.normal, -half.offset}}});
    CHECK_NEAR(area(left) + area(right), area(p), 1e-9);
    for (int k = 0; k < 200; ++k) {
      const Point2 q(random.uniform(-10, 10), random.uniform(-10, 10));
      CHECK(contains(left, q) == (contains(p, q) && half.signed_distance(q) <= 0.0));
    }
    // A cell of random half-planes against membership in all of them.
    std::vector<HalfPlane> cell;
    for (int k = 0; k < 6; ++k) {
      const double a = random.uniform(0.0, 2.0 * kPi);
      cell.push_back({{std::cos(a), std::sin(a)}, random.uniform(0.5, 6.0)});
    }
    const Region inner = clip(p, cell);
    for (int k = 0; k < 200; ++k) {
      const Point2 q(random.uniform(-7, 7), random.uniform(-7, 7));
      bool in = contains(p, q);
      for (const HalfPlane& h : cell) in = in && h.signed_distance(q) <= 0.0;
      CHECK(contains(inner, q) == in);
    }
  }
}

TEST(clipping_along_vertices_and_edges) {
  const Polygon comb =
      make_polygon({{0, 0}, {6, 0}, {6, 2}, {5, 1}, {4, 2}, {3, 1}, {2, 2}, {1, 1}, {0, 2}});
  CHECK_NEAR(area(clip(comb, {{HalfPlane{{0, 1}, 1.0}}})), 6.0, 1e-12);
  CHECK_NEAR(area(clip(comb, {{HalfPlane{{0, -1}, -1.0}}})), area(comb) - 6.0, 1e-12);
  CHECK(clip(comb, {{HalfPlane{{0, -1}, -1.5}}}).size() == 4);
  CHECK(clip(comb, {{HalfPlane{{0, -1}, -2.5}}}).empty());
  CHECK_NEAR(area(clip(comb, {{HalfPlane{{0, 1}, 2.0}}})), area(comb), 1e-12);
  const Polygon frame =
      make_polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{{1, 1}, {3, 1}, {3, 3}, {1, 3}}});
  const Region half = clip(frame, {{HalfPlane{{1, 0}, 1.0}}});
  CHECK_NEAR(area(half), 4.0, 1e-12);
  CHECK_NEAR(area(clip(frame, {{HalfPlane{{1, 0}, 2.0}}})), 6.0, 1e-12);
  const Region strip = clip(frame, Ring{{1.5, -1}, {2.5, -1}, {2.5, 5}, {1.5, 5}});
  CHECK(strip.size() == 2);
  CHECK_NEAR(area(strip), 2.0, 1e-12);
}

TEST(trapezoids_fill_the_polygon) {
  Random random(9);
  for (int round = 0; round < 20; ++round) {
    const Polygon p = jagged_with_holes(random);
    double sum = 0.0;
    for (const Trapezoid& t : trapezoids(p)) {
      const Ring ring(t.begin(), t.end());
      CHECK(signed_area(ring) >= 0.0);
      CHECK(contains(p, Point2(0.25 * (t[0] + t[1] + t[2] + t[3]))) || signed_area(ring) < 1e-9);
      sum += signed_area(ring);
    }
    CHECK_NEAR(sum, area(p), 1e-9);
  }
}

TEST(point_locator_agrees_with_the_definition) {
  Random random(3);
  const Polygon p = jagged_with_holes(random);
  const PointLocator fast(p);
  for (int k = 0; k < 5000; ++k) {
    const Point2 q(random.uniform(-11, 11), random.uniform(-11, 11));
    CHECK(fast.locate(q) == locate(p, q));
  }
  for (std::size_t r = 0; r < p.rings(); ++r)
    for (const Point2& v : p.ring(r)) CHECK(fast.locate(v) == Side::Boundary);
}

TEST(far_from_the_origin) {
  const Point2 o(1e7, -1e7);
  const Polygon p = make_rectangle(o, o + Point2(3, 5));
  CHECK_NEAR(area(p), 15.0, 1e-6);
  CHECK_NEAR((centroid(p) - o - Point2(1.5, 2.5)).norm(), 0.0, 1e-6);
  CHECK_NEAR(area(clip(p, {{HalfPlane{{0, 1}, o.y() + 2.0}}})), 6.0, 1e-6);
}
