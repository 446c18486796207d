// SPDX-License-Identifier: MIT
#include <surfleet/motion/shortcut.hpp>

#include <cmath>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;
/// Whether a segment stays out of a vertical unit cylinder at the origin.
bool clear_of_cylinder(const Point3& a, const Point3& b) {
  const Point2 p = a.head<2>(), d = b.head<2>() - p;
  const double t = d.squaredNorm() > 0 ? std::clamp(-p.dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p + t * d).norm() >= 1.0;
}
}  // namespace

TEST(straightens_what_is_in_sight) {
  const auto all = [](const Point3&, const Point3&) { return true; };
  const Path p = shortcut({{0, 0, 0}, {1, 1, 0}, {2, -1, 3}, {4, 0, 0}}, all);
  CHECK(p.points.size() == 2);
  CHECK_NEAR(p.length, 4.0, 1e-12);
}

TEST(keeps_a_path_that_cannot_be_cut_and_short_ones) {
  const auto none = [](const Point3&, const Point3&) { return false; };
  const Path p = shortcut({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}}, none);
  CHECK(p.points.size() == 3);
  CHECK(shortcut({}, none).empty());
  CHECK(shortcut({{1, 2, 3}}, none).points.size() == 1);
  CHECK_NEAR(shortcut({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, none).length, 0.0, 1e-12);
}

TEST(pulls_the_string_round_a_cylinder) {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Point3> rough{{-3, 0, 0}};
    for (double angle = 150; angle >= 30; angle -= 20) {
      const double r = random.uniform(1.8, 3.0);
      rough.emplace_back(r * std::cos(radians(angle)), r * std::sin(radians(angle)),
                         random.uniform(-1, 1));
    }
    rough.emplace_back(3, 0, 0);
    bool valid = true;
    for (std::size_t i = 1; i < rough.size(); ++i)
      valid = valid && clear_of_cylinder(rough[i - 1], rough[i]);
    if (!valid) continue;
    const Path p = shortcut(rough, clear_of_cylinder);
    for (std::size_t i = 1; i < p.points.size(); ++i)
      CHECK(clear_of_cylinder(p.points[i - 1], p.points[i]));
    // Two tangents of length √8 and the arc between them.
    const double shortest = 2 * std::sqrt(8.0) + kPi - 2 * std::acos(1.0 / 3.0);
    CHECK(p.length >= shortest - 1e-9);
    CHECK(p.length < 1.03 * shortest);
    CHECK(p.length <= polyline_length(rough) + 1e-9);
  }
}
