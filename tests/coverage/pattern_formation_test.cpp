// SPDX-License-Identifier: MIT
#include <surfleet/coverage/pattern_formation.hpp>  // first: proves it stands alone

#include <algorithm>
#include <numeric>

#include <surfleet/geometry/polygon_visibility.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
Polygon arrow(double angle, const Point2& at) {
  const Eigen::Rotation2Dd r(angle);
  Ring ring{{0, -0.4}, {1.5, -0.4}, {1.5, -0.9}, {2.6, 0}, {1.5, 0.9}, {1.5, 0.4}, {0, 0.4}};
  for (Point2& p : ring) p = at + r * p;
  return make_polygon(ring);
}
}  // namespace

TEST(auction_is_as_good_as_trying_everything) {
  Random random(5);
  for (int round = 0; round < 10; ++round) {
    const auto robots = random_places(make_rectangle({0, 0}, {1, 1}), 6, random);
    const auto goals = random_places(make_rectangle({0, 0}, {1, 1}), 6, random);
    const auto cost = [&](const std::vector<std::size_t>& a) {
      double sum = 0.0;
      for (std::size_t i = 0; i < 6; ++i) sum += (robots[i] - goals[a[i]]).squaredNorm();
      return sum;
    };
    std::vector<std::size_t> order(6);
    std::iota(order.begin(), order.end(), 0UL);
    double best = 1e9;
    do best = std::min(best, cost(order));
    while (std::next_permutation(order.begin(), order.end()));
    CHECK(cost(auction_goals(robots, goals, 1e-5)) <= best + 6e-5 + 1e-12);
  }
  const std::vector<Point2> two{{0, 0}, {1, 0}}, one{{0, 0}};
  CHECK_THROWS(Error, auction_goals(two, one));
  CHECK(auction_goals(one, one)[0] == 0);
}

TEST(goals_follow_a_moving_and_turning_shape) {
  CHECK_NEAR(GoalFormation::matching_rotation(arrow(0.2, {0, 0}), arrow(0.7, {3, 1})), 0.5, 0.05);
  GoalFormation formation(arrow(0.0, {0, 0}), 24, Random(2));
  for (int frame = 1; frame <= 5; ++frame) {
    const auto before = formation.goals();
    const Polygon shape = arrow(0.15 * frame, {0.1 * frame, 0.05 * frame});
    formation.next_frame(shape);
    for (std::size_t i = 0; i < before.size(); ++i) {
      CHECK(contains(shape, formation.goals()[i], 1e-9));
      CHECK((formation.goals()[i] - before[i]).norm() < 0.8);
    }
  }
}

TEST(a_flock_takes_the_shape) {
  Random random(3);
  ShapeFlock flock(random_places(make_rectangle({-2, -2}, {-1, -1}), 25, random));
  const Polygon shape = arrow(0.3, {0, 0});
  for (int k = 0; k < 800; ++k) flock.step(shape);
  int inside = 0;
  for (const Point2& p : flock.positions()) inside += contains(shape, p, 0.05) ? 1 : 0;
  CHECK(inside >= 23);
  for (std::size_t i = 0; i < 25; ++i)
    for (std::size_t j = 0; j < i; ++j)
      CHECK((flock.positions()[i] - flock.positions()[j]).norm() > 0.05);
}
