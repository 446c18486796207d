// SPDX-License-Identifier: MIT
/// @file
/// @brief What a simulated mission is made with, and what comes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/fleet/agent.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/robot_kind.hpp>
#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/simulation/world_model.hpp>
#include <surfleet/viewpoint/coverage_estimate.hpp>
#include <surfleet/viewpoint/left_reason.hpp>

namespace surfleet {
struct MissionOptions {
  RobotKind kind;               ///< Of all robots.
  SurfaceBeliefOptions belief;  ///< Of the map that they share; its region is the task.
  AgentOptions agent;
  /// How robots see one another; empty: as they are.
  NeighbourSense neighbours;
  bool announces = true;  ///< Robots tell where they go; else they keep apart by sight alone.
  double start_clearance = 2.5;  ///< What is known to be free around every start [m].
  double max_time = 7200.0;      ///< The mission ends at this time at the latest [s].
  int threads = 1;               ///< The result is the same for any number.
};

/// A row of the mission's history.
struct MissionProgress {
  double time = 0.0;         ///< [s]
  double path_length = 0.0;  ///< Of all robots [m].
  std::size_t incomplete = 0;
  std::size_t known_blocks = 0;
  /// The mission's own account of how complete its mesh is (`estimate_coverage`), as of the last
  /// time it was taken: ever more seldom, as the map grows.
  double estimated_coverage = 0.0;
};

struct TimedConfiguration {
  double time = 0.0;  ///< [s]
  Configuration configuration;
};

/// A tick of the clock, after robots have moved; its views last for the call.
struct MissionStep {
  double time = 0.0;                      ///< [s]
  std::span<const Configuration> robots;  ///< Where they are in truth.
  /// `belief.map().changed_since(r)` are the blocks that have changed since revision r.
  const SurfaceBelief& belief;
};

/// What an observer of a mission is told as it happens; it changes nothing. Why elements were given
/// up is in the plans (`Plan::impossible`) and in the belief's ledger.
struct MissionObserver {
  std::function<void(const MissionStep&)> on_step;
  std::function<void(const SurfaceSituation&, const Plan&)> on_plan;
};

struct MissionResult {
  bool complete = false;         ///< False if ended by time or from outside.
  double completion_time = 0.0;  ///< On the mission's clock [s].
  double planning_time = 0.0;    ///< Of the machine, in the high-level planner [s].
  std::vector<std::vector<TimedConfiguration>> trajectories;  ///< One a robot.
  std::vector<double> path_length;                            ///< One a robot [m].
  std::size_t remaining = 0;                                  ///< Incomplete elements at the end.
  CoverageEstimate coverage;                                  ///< By its own account, at the end.
  std::map<LeftReason, std::size_t> reasons;                  ///< Of all that remain.
  std::vector<MissionProgress> history;                       ///< About once in ten seconds.
  std::size_t images = 0, plans = 0, emergency_stops = 0, waits = 0;

  double total_path_length() const {
    double sum = 0.0;
    for (const double l : path_length) sum += l;
    return sum;
  }
};
}  // namespace surfleet
