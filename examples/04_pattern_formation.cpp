// SPDX-License-Identifier: MIT
// Forty robots form an arrow that moves and turns, each driving to the goal it won in an auction.
#include <algorithm>
#include <cstdio>
#include <vector>

#include <surfleet/coverage/pattern_formation.hpp>

using namespace surfleet;

int main() {
  const auto arrow = [](double frame) {
    const Eigen::Rotation2Dd turn_by(0.1 * frame);
    Ring ring{{0, -0.4}, {1.5, -0.4}, {1.5, -0.9}, {2.6, 0}, {1.5, 0.9}, {1.5, 0.4}, {0, 0.4}};
    for (Point2& p : ring) p = Point2(0.2 * frame, 0) + turn_by * p;
    return make_polygon(ring);
  };
  Random random(1);
  std::vector<Point2> robots = random_places(make_rectangle({-3, -1}, {-1, 1}), 40, random);
  GoalFormation formation(arrow(0), robots.size(), random);
  double farthest = 0.0;
  for (int frame = 0; frame < 10; ++frame) {
    if (frame > 0) formation.next_frame(arrow(frame));
    const auto goal_of = auction_goals(robots, formation.goals());
    farthest = 0.0;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      farthest = std::max(farthest, (formation.goals()[goal_of[i]] - robots[i]).norm());
      robots[i] = formation.goals()[goal_of[i]];
    }
    std::printf("frame %d: the longest path is %.2f m\n", frame, farthest);
  }
  return farthest < 0.8 ? 0 : 1;
}
