// SPDX-License-Identifier: MIT
/// @file
/// @brief A robot's state as those see it that keep clear of it.
#pragma once

#include <surfleet/motion/traffic_policy.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/robot_kind.hpp>

namespace surfleet {
inline TrafficAgent as_traffic(const RobotState& robot, const RobotKind& kind) {
  TrafficAgent t;
  t.id = static_cast<int>(robot.id);
  t.position = robot.at.position;
  t.path = robot.ahead;
  t.radius = kind.body_radius;
  t.priority = robot.first ? 1.0 : 0.0;
  t.speed = kind.limits.speed;
  t.idle = robot.idle;
  t.cornered = robot.cornered;
  t.held = robot.held;
  return t;
}
}  // namespace surfleet
