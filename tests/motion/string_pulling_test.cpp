// SPDX-License-Identifier: MIT
#include <surfleet/motion/string_pulling.hpp>

#include <limits>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/motion/path.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

double length_from(const Point3& start, std::vector<Point3> path) {
  path.insert(path.begin(), start);
  return polyline_length(path);
}

TEST(a_pulled_string_is_straight_where_the_slack_allows) {
  const Point3 start(0, 0, 0);
  const std::vector<Point3> places{{2, 0.5, 0}, {4, -0.5, 0}, {6, 0, 0}};
  const std::vector<Point3> path = pulled_string(start, places, 1.0);
  CHECK_NEAR(length_from(start, path), (path.back() - start).norm(), 1e-3);
  CHECK((path.back() - places.back()).norm() <= 1.0 + 1e-12);
  // A place alone is met on the near side; without slack nothing moves.
  const Point3 met = pulled_string(start, std::vector<Point3>{{3, 4, 0}}, 1.0)[0];
  CHECK_NEAR((met - Point3(2.4, 3.2, 0)).norm(), 0.0, 1e-12);
  CHECK(pulled_string(start, places, 0.0) == places);
}

TEST(a_pulled_string_keeps_within_the_slack_and_is_never_longer) {
  Random random(11);
  const auto point = [&] {
    return Point3(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5));
  };
  for (int i = 0; i < 200; ++i) {
    const Point3 start = point();
    std::vector<Point3> places(static_cast<std::size_t>(i % 12));
    for (Point3& p : places) p = point();
    const double slack = random.uniform(0.0, 2.0);
    for (const int sweeps : {1, 2, 20}) {
      const std::vector<Point3> path = pulled_string(start, places, slack, sweeps);
      CHECK(path.size() == places.size());
      for (std::size_t k = 0; k < path.size(); ++k)
        CHECK((path[k] - places[k]).norm() <= slack + 1e-9);
      CHECK(length_from(start, path) <= length_from(start, places) + 1e-9);
    }
  }
}

TEST(a_pulled_string_by_one_place_over_and_over) {
  const Point3 start(1, 2, 3);
  for (const Point3& p : pulled_string(start, std::vector<Point3>(5, start), 0.5))
    CHECK(p == start);
  CHECK(pulled_string(start, {}, 0.5).empty());
  CHECK_THROWS(Error, pulled_string(start, {}, -0.1));
  CHECK_THROWS(Error, pulled_string(start, {}, std::numeric_limits<double>::quiet_NaN()));
}
}  // namespace
