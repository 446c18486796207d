// SPDX-License-Identifier: MIT
/// @file
/// @brief A robot and its limits as those see them that keep clear of each other.
#pragma once

#include <surfleet/motion/traffic_policy.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/robot_kind.hpp>

namespace surfleet {
/// Corners are cut, so robots are not quite where their paths say. `period` is that of decisions
/// [s].
inline TrafficOptions traffic_options(const AerialLimits& limits, double period) {
  TrafficOptions o;
  o.least_gap += limits.corner_tolerance;
  o.period = period;
  o.braking = limits.braking;
  return o;
}
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
  t.age = robot.age;
  return t;
}
}  // namespace surfleet
