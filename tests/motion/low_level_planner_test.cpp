// SPDX-License-Identifier: MIT
#include <surfleet/motion/low_level_planner.hpp>

#include "check.hpp"
#include "motion_scenes.hpp"

namespace {
using namespace surfleet;
using namespace motion_scenes;
}  // namespace

TEST(utility_check_counts_what_is_done) {
  const UtilityCheck check{.threshold = 0.8};
  CHECK(!check(100, 100));
  CHECK(!check(100, 21));
  CHECK(check(100, 20));
  CHECK(check(100, 0));
  CHECK(check(0, 0));
  CHECK(!check(10, 50));  // more left than there were: nothing is done
}

TEST(goal_check_wraps_the_heading) {
  const GoalCheck check;
  CHECK(check({{1, 2, 3}, kPi - 0.01}, {{1, 2, 3.04}, -kPi + 0.01}));
  CHECK(!check({{1, 2, 3}, 0.0}, {{1, 2, 3.06}, 0.0}));
  CHECK(!check({{1, 2, 3}, 0.0}, {{1, 2, 3}, 0.1}));
}

TEST(obstacle_check_sees_as_far_as_it_must) {
  TsdfMap tsdf({.voxel_size = 0.3});
  observe(tsdf, box(-8, -5, -5, 8, 5, 5), Boxes{{box(3, -5, -5, 4, 5, 5)}});
  const VoxelStateMap states(tsdf);
  const FreeSpace space(states, {.radius = 1.0});
  const ObstacleCheck check{.lookahead = 0.5, .tolerance = 0.1};
  const auto ahead = [](double x) {
    return std::vector<Point3>{{x, 0, 0}, {x + 0.3, 0, 0}, {8, 0, 0}};
  };
  CHECK(!check(space, ahead(-3), 0.2));
  const auto near = check(space, ahead(1.2), 0.2);
  CHECK(near && *near < 0.8);
  CHECK(!check(space, ahead(0.2), 0.2));
  CHECK(check(space, ahead(0.2), 1.5));
  CHECK(!check(space, std::vector<Point3>{{1.2, 0, 0}}, 0.2));
  // Leaving a blocked place is allowed, going deeper is not.
  CHECK(!check(space, std::vector<Point3>{{2.2, 0, 0}, {-2, 0, 0}}, 0.2));
  CHECK(check(space, std::vector<Point3>{{2.0, 0, 0}, {3, 0, 0}}, 0.2));
  CHECK(check.reaches(space, SphereBody{1.0}, {{2.5, 0, 0}, 0.0}));
  CHECK(!check.reaches(space, SphereBody{1.0}, {{0, 0, 0}, 0.0}));
}
