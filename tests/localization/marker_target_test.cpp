// SPDX-License-Identifier: MIT
#include <surfleet/localization/marker_target.hpp>

#include <algorithm>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(the_printed_target_has_the_printed_distances) {
  const MarkerTarget t = printed_target();
  std::vector<double> d;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = i + 1; k < 4; ++k) d.push_back((t.markers[i] - t.markers[k]).norm());
  std::sort(d.begin(), d.end());
  for (std::size_t i = 0; i < 6; ++i) CHECK_NEAR(d[i], 0.15 + 0.03 * static_cast<double>(i), 1e-3);
  CHECK(check_target(t).empty());
  CHECK_NEAR(printed_target(0.5).markers[1].norm(), 0.5 * t.markers[1].norm(), 1e-15);
  CHECK_NEAR(printed_target(0.5).marker_radius, 0.0075, 1e-15);
}
TEST(bad_targets_are_refused_and_odd_ones_named) {
  const auto make = [](std::vector<Point3> points) { return MarkerTarget{std::move(points), 0.0}; };
  CHECK_THROWS(Error, check_target(make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})));
  CHECK_THROWS(Error, check_target(make({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3.5, 0, 0}})));
  CHECK_THROWS(Error, check_target(make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}})));
  CHECK_THROWS(Error, check_target(make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, NAN, 1}})));
  MarkerTarget fat = printed_target();
  fat.marker_radius = 0.1;
  CHECK_THROWS(Error, check_target(fat));
  // A square: flat, and a rotation takes it to itself.
  const auto square = check_target(make({{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}}));
  CHECK(square.size() == 2);
  CHECK(square.back().find("can be confused") != std::string::npos);
  // A flat one without symmetry, a regular tetrahedron, one with a mirror plane alone.
  CHECK(check_target(make({{0, 0, 0}, {1, 0, 0}, {0.2, 0.6, 0}, {1.5, 1.1, 0}})).size() == 1);
  CHECK(check_target(make({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}})).size() == 1);
  CHECK(check_target(make({{0.5, 0, 0}, {-0.5, 0, 0}, {0, 0.9, 0}, {0, 0.3, 1.3}})).empty());
}
TEST(files_of_targets) {
  const auto t = parse_target("# mine\nradius 0.01\n0 0 0\n0.1 0 0 # second\n\n0 0.2 0\n0 0 0.3\n");
  CHECK(t.markers.size() == 4 && t.marker_radius == 0.01 && t.markers[3].z() == 0.3);
  CHECK_THROWS(Error, parse_target("0 0 0\n1 0 0\n0 1 0\n0 0 x\n"));
  CHECK_THROWS(Error, parse_target("0 0 0\n1 0 0\n0 1 0\n0 0\n"));
  CHECK_THROWS(Error, parse_target("0 0 0\n1 0 0\n0 1 0\n"));
  CHECK_THROWS(Error, parse_target("radius\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"));
  CHECK_THROWS(Error, parse_target(""));
}
}  // namespace
