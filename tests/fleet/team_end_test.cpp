// SPDX-License-Identifier: MIT
#include <surfleet/fleet/team_end.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "check.hpp"

namespace {
using namespace surfleet;

/// What a robot says of itself and its mates, put together by hand.
struct SaidRobot {
  bool done = false, rest = true;
  std::optional<StopReason> reason{};
  std::uint64_t held = 1;
  std::size_t lacks = 0;
  std::map<RobotId, RobotState> mates_heard{};

  const SaidRobot& patches() const { return *this; }
  const SaidRobot& team() const { return *this; }
  const SaidRobot& agent() const { return *this; }
  std::uint64_t digest() const { return held; }
  std::size_t missing() const { return lacks; }
  bool is_current(const RobotState& mate) const { return mate.age <= 3.0; }
  std::vector<RobotState> mates(double, double most) const {
    std::vector<RobotState> all;
    for (const auto& [id, mate] : mates_heard)
      if (mate.age <= most) all.push_back(mate);
    return all;
  }
  std::optional<StopReason> stop_reason() const { return reason; }
  bool at_rest() const { return rest; }
  bool is_done() const { return done; }
  bool finished() const {
    if (!done || lacks > 0) return false;
    for (const RobotState& mate : mates(0.0, 30.0))
      if (!mate.done || mate.holds != held || !is_current(mate)) return false;
    return true;
  }
  void mate(RobotId id, bool idle, double age, std::uint64_t holds) {
    mates_heard[id].id = id;
    mates_heard[id].done = idle;
    mates_heard[id].age = age;
    mates_heard[id].holds = holds;
  }
};
}  // namespace

TEST(who_is_done_lingers_though_its_mates_go_first) {
  SaidRobot robot{.done = true};
  TeamEnd end;
  robot.mate(2, true, 0.5, 1);
  end.observe(robot, 10.0);
  CHECK(!end.over(14.9));
  robot.mate(2, true, 4.0, 1);  // gone
  CHECK(!robot.finished());
  end.observe(robot, 14.0);
  CHECK(end.over(15.0) && end.lost().empty());
}
TEST(new_work_and_new_patches_keep_a_robot_from_going) {
  SaidRobot robot{.done = true};
  TeamEnd end;
  end.observe(robot, 0.0);
  robot.held = 2;
  end.observe(robot, 4.0);
  CHECK(!end.over(6.0) && end.over(9.0));
  robot.done = false;
  end.observe(robot, 6.0);
  CHECK(!end.over(60.0));
  robot.done = true;
  robot.lacks = 1;
  end.observe(robot, 7.0);
  CHECK(!end.over(60.0));
}
TEST(mates_that_fall_silent_at_work_are_lost) {
  SaidRobot robot{.done = true};
  TeamEnd end;
  robot.mate(0, false, 0.5, 1);
  robot.mate(1, true, 0.5, 7);
  robot.mate(2, true, 0.5, 1);
  end.observe(robot, 0.0);
  CHECK(!end.over(100.0));
  for (RobotId id = 0; id < 3; ++id) robot.mate(id, id > 0, 31.0, 1);
  end.observe(robot, 31.0);
  CHECK(end.over(36.0));
  CHECK((end.lost() == std::vector<RobotId>{0, 1}));
  robot.mate(0, true, 0.5, 1);  // back, and done
  end.observe(robot, 32.0);
  CHECK((end.lost() == std::vector<RobotId>{1}));
}
TEST(a_robot_at_its_goal_waits_for_its_mates_maps) {
  SaidRobot robot{.done = true, .reason = StopReason::coverage_goal};
  TeamEnd end;
  robot.mate(1, false, 0.1, 5);
  end.observe(robot, 0.0);
  CHECK(!end.over(60.0));
  robot.mate(1, true, 0.1, 1);
  end.observe(robot, 60.0);
  CHECK(!end.over(64.0) && end.over(65.0));
}
TEST(a_robot_with_a_spent_charge_goes_home_and_then_whatever_its_mates_do) {
  SaidRobot robot{.rest = false, .reason = StopReason::endurance};
  TeamEnd end;
  robot.mate(1, false, 0.1, 5);
  end.observe(robot, 0.0);
  CHECK(!end.over(60.0));
  robot.rest = true;
  end.observe(robot, 10.0);
  robot.held = 9;
  end.observe(robot, 12.0);
  CHECK(!end.over(14.0) && end.over(15.0));
}
