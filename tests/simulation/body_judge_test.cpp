// SPDX-License-Identifier: MIT
#include <surfleet/simulation/body_judge.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "check.hpp"

namespace {
using namespace surfleet;

/// A rod of one metre, ahead of its position, before the wall x = 0.
struct Rod {
  double distance(const Configuration& q) const {
    return std::max(0.0, -q.position.x() - std::max(0.0, std::cos(q.yaw)));
  }
};
static_assert(BodyDistanceJudge<Rod> && !BodyDistanceJudge<int>);

JudgeReport judge_rod(const std::vector<Configuration>& path) {
  JudgeReport report;
  report.collisions_of_robots = 3;
  judge_bodies(Rod{}, std::vector<std::vector<Configuration>>{path}, 1.0, report);
  return report;
}
}  // namespace

TEST(a_body_is_judged_between_the_instants) {
  // Past the wall with the side to it, then turned on the spot through what it has no room for.
  const JudgeReport past =
      judge_rod({{Point3(-0.5, -9, 0), kPi / 2}, {Point3(-0.5, 9, 0), kPi / 2}});
  CHECK(past.collisions_with_scene == 0 && past.collisions == 3);
  CHECK_NEAR(past.min_clearance_m, 0.5, 1e-9);
  const JudgeReport turned =
      judge_rod({{Point3(-0.9, 0, 0), 0.5}, {Point3(-0.9, 0, 0), -0.5}, {Point3(-0.9, 0, 0), 0.5}});
  CHECK(turned.collisions_with_scene == 2 && turned.collisions == 5);
  CHECK(turned.min_clearance_m == 0.0);
  // By the smaller angle, which passes π.
  const JudgeReport round = judge_rod({{Point3(-1.2, 0, 0), 2.6}, {Point3(-1.2, 0, 0), -2.6}});
  CHECK(round.collisions_with_scene == 0);
  CHECK_NEAR(round.min_clearance_m, 1.2, 1e-9);
  // Straight on while it turns.
  const JudgeReport both = judge_rod({{Point3(-4, 0, 0), kPi / 2}, {Point3(-0.5, 0, 0), 0.3}});
  CHECK(both.collisions_with_scene == 1);
  // A touch counts once until the body is clear.
  const auto at = [](double x) { return Configuration{Point3(x, 0, 0), 0.0}; };
  CHECK(judge_rod({at(-3), at(-0.9), at(-0.8), at(-0.9), at(-3), at(-0.9)}).collisions == 3 + 2);
  CHECK(judge_rod({at(-0.5), at(-0.5)}).collisions == 3 + 1);
  CHECK(judge_rod({}).collisions == 3 && judge_rod({}).min_clearance_m == JudgeReport::kNone);
  JudgeReport report;
  CHECK_THROWS(Error, judge_bodies(Rod{}, std::vector<std::vector<Configuration>>{}, 0.0, report));
}
