// SPDX-License-Identifier: MIT
/// @file
/// @brief One robot with a belief and a planner of its own: the single architecture [000 ch. 2], at
/// whatever times its owner calls it.
///
///     SingleAgent<MyRobot> agent(robot, kind, {.region = box}, make_planner("surfleet"));
///     while (!agent.finished()) agent.step(seconds());   // after each image and pose
#pragma once

#include <array>
#include <memory>
#include <span>
#include <utility>

#include <surfleet/fleet/agent.hpp>
#include <surfleet/fleet/central_planning.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
/// Drives a body, real or simulated, by what it senses alone. No clock, no thread.
template <RobotBody Body, FleetPlanner Planner = AnyPlanner>
class SingleAgent {
 public:
  /// The body must outlive it. What is within `start_clearance` of the body is taken for free [m].
  /// Throws `Error` on options out of range.
  SingleAgent(Body& body, const RobotKind& kind, SurfaceBeliefOptions belief, Planner planner,
              double start_clearance, AgentOptions options = {})
      : belief_(belief_for(planner, std::move(belief)), std::span<const RobotKind>(&kind, 1)),
        planning_(std::move(planner)) {
    belief_.add_known_free(0, {body.estimate().position, start_clearance});
    belief_.update();
    agents_[0] = std::make_unique<Agent<Body>>(0, 0, body, belief_, options);
  }
  SingleAgent(const SingleAgent&) = delete;
  SingleAgent& operator=(const SingleAgent&) = delete;

  /// Observes, maps, checks its stop, plans if that is due, and moves on. To be called about every
  /// `AgentOptions::image_period`, with the time [s].
  void step(double now) {
    Agent<Body>& agent = *agents_[0];
    agent.sense();
    agent.integrate();
    belief_.update();
    agent.check_stop();
    planning_(agents_, belief_, now);
    finished_ = planning_.finished(agents_, belief_);
    if (!finished_) agent.move(now);
  }
  /// Whether there is nothing left to do.
  bool finished() const { return finished_; }
  const SurfaceBelief& belief() const { return belief_; }

 private:
  SurfaceBelief belief_;
  CentralPlanning<Planner> planning_;
  std::array<std::unique_ptr<Agent<Body>>, 1> agents_;
  bool finished_ = false;
};
}  // namespace surfleet
