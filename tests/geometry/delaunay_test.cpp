// SPDX-License-Identifier: MIT
#include <surfleet/geometry/delaunay.hpp>

#include <map>

#include "check.hpp"

namespace {
using namespace surfleet;

/// No point inside a circle, sides matched, the hull covered: `area2` is twice its area.
void check_delaunay(const std::vector<Point2>& points, double area2) {
  const std::vector<Triangle> triangles = delaunay(points);
  double sum = 0.0;
  std::map<std::pair<std::int32_t, std::int32_t>, int> sides;
  bool left = true, empty = true;
  for (const Triangle& t : triangles) {
    const auto at = [&](std::size_t k) { return points[static_cast<std::size_t>(t[k])]; };
    const double area = orient2d(at(0), at(1), at(2));
    left = left && area > 0.0;
    sum += area;
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
    for (const Point2& p : points) empty = empty && in_circle(at(0), at(1), at(2), p) <= 0.0;
  }
  CHECK(left);
  CHECK(empty);
  CHECK_NEAR(sum, area2, 1e-9 * (1.0 + area2));
  bool once = true;
  for (const auto& [side, count] : sides) once = once && count == 1;
  CHECK(once);
}
}  // namespace

TEST(in_circle_has_the_exact_sign) {
  const Point2 a(5, 0), b(3, 4), c(-4, 3);
  CHECK(in_circle(a, b, c, Point2(0, 0)) > 0.0);
  CHECK(in_circle(a, b, c, Point2(6, 0)) < 0.0);
  CHECK(in_circle(a, c, b, Point2(0, 0)) < 0.0);
  for (const Point2& on : {Point2(0, 5), Point2(0, -5), Point2(-3, -4), Point2(4, -3), a, b, c}) {
    CHECK(in_circle(a, b, c, on) == 0.0);
    // Far away the same grid of doubles holds the same circle.
    const Point2 far(1e9, -3e9);
    CHECK(in_circle(a + far, b + far, c + far, on + far) == 0.0);
  }
  // One step of a double to either side of the circle, where differences are rounded.
  const auto next = [](double x, double towards) { return std::nextafter(x, towards); };
  CHECK(in_circle(a, b, c, Point2(0, next(5, 6))) < 0.0);
  CHECK(in_circle(a, b, c, Point2(0, next(5, 4))) > 0.0);
  const double tiny = 1e-30;
  CHECK(in_circle(a, b, c, Point2(tiny, 5)) < 0.0);  // a tangent's point is outside
  CHECK(in_circle(a, b, c, Point2(tiny, -5)) < 0.0);
  // A point off the circle by tiny²/10 takes the circle along by as little.
  CHECK(in_circle(a, b, Point2(-5, tiny), Point2(0, -5)) > 0.0);
  CHECK(in_circle(a, b, Point2(-5, -tiny), Point2(0, 5)) > 0.0);
  CHECK(in_circle(a, b, Point2(-5, tiny), Point2(0, 5)) > 0.0);
}

TEST(delaunay_circles_are_empty) {
  Random random(5);
  for (int round = 0; round < 8; ++round) {
    std::vector<Point2> points{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int k = 0; k < 150; ++k) points.emplace_back(random.uniform(0, 1), random.uniform(0, 1));
    points.push_back(points[17]);  // twice
    check_delaunay(points, 2.0);
  }
}

TEST(delaunay_of_grids_lines_and_little) {
  std::vector<Point2> grid;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 9; ++j) grid.emplace_back(0.1 * i, 0.1 * j);
  check_delaunay(grid, 2.0 * 1.1 * 0.8);
  CHECK(delaunay(std::span(grid).first(9)).empty());  // one column
  CHECK(delaunay({}).empty());
  CHECK(delaunay(std::vector<Point2>(4, Point2(1, 2))).empty());
  const std::vector<Point2> three{{0, 0}, {0, 2}, {2, 0}};
  CHECK(delaunay(three) == (std::vector<Triangle>{{0, 2, 1}}));
  std::vector<Point2> circle;
  for (int k = 0; k < 40; ++k)
    circle.emplace_back(std::cos(2 * kPi * k / 40.0), std::sin(2 * kPi * k / 40.0));
  check_delaunay(circle, 40.0 * std::sin(2 * kPi / 40.0));
  std::vector<Point2> fan{{0, 1}};  // a line, then a point beside it
  for (int k = 0; k < 30; ++k) fan.emplace_back(k, 0);
  check_delaunay(fan, 29.0);
  CHECK_THROWS(Error, delaunay(std::vector<Point2>{{0, 0}, {1, std::nan("")}, {0, 1}}));
  // The order of the points does not matter where no four are concyclic.
  Random random(9);
  std::vector<Point2> cloud, turned;
  for (int k = 0; k < 500; ++k) cloud.emplace_back(random.normal(), random.normal());
  turned.assign(cloud.rbegin(), cloud.rend());
  CHECK(delaunay(cloud).size() == delaunay(turned).size());
}
