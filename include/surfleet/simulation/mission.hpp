// SPDX-License-Identifier: MIT
/// @file
/// @brief What a simulated mission is made with, and what comes of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/fleet/agent.hpp>
#include <surfleet/fleet/endurance.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/robot_kind.hpp>
#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/simulation/world_model.hpp>
#include <surfleet/viewpoint/coverage_estimate.hpp>
#include <surfleet/viewpoint/left_reason.hpp>

namespace surfleet {
/// When a mission is over before there is nothing left to do. With any of these, robots end where
/// they started.
struct MissionLimits {
  double least_gain = 0.0;                ///< See `PlanRequests::least_gain` [m²/m].
  std::optional<double> coverage_goal{};  ///< Of the mission's own account, a share.
  EnduranceLimits endurance{};            ///< Of every robot.

  bool any() const { return least_gain > 0.0 || coverage_goal || endurance.any(); }
};

struct MissionOptions {
  RobotKind kind;               ///< Of all robots.
  SurfaceBeliefOptions belief;  ///< Of the map that they share; its region is the task.
  AgentOptions agent;
  /// How robots see one another; empty: as they are.
  NeighbourSense neighbours;
  bool announces = true;  ///< Robots tell where they go; else they keep apart by sight alone.
  double start_clearance = 2.5;  ///< What is known to be free around every start [m].
  MissionLimits limits;
  const TsdfMap* begun = nullptr;  ///< What an earlier mission has left, to go on from; or nothing.
  double max_time = 7200.0;        ///< The mission ends at this time at the latest [s].
  int threads = 1;                 ///< The result is the same for any number.
};

/// Throws `Error` for options out of range, no robots or too many, and starts outside the bounds.
inline void check_mission(const MissionOptions& o, std::span<const Configuration> starts) {
  require(!starts.empty(), "robots: expected at least one");
  require(starts.size() <= 64, "robots: expected at most 64");
  require(o.agent.image_period > 0.0 && o.agent.image_period <= 5.0,
          "image period: expected more than 0 and at most 5 s");
  require(o.kind.limits.speed > 0.0, "speed: expected more than 0 m/s");
  require(!o.kind.bounds.isEmpty(), "bounds: expected a box to fly in");
  for (const Configuration& s : starts)
    require(o.kind.bounds.contains(s.position) &&
                o.kind.keep_out.distance(s.position) >= o.kind.body_radius,
            "start outside the bounds or in a keep-out box: expected a start inside the one and "
            "outside the other");
}

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

/// What a centralised fleet says to its centre and hears from it, as [000 §5.4] counts it [bytes].
struct CentralTraffic {
  std::uint64_t images = 0;  ///< Of 16 bits a pixel's depth or a beam's range, unpacked.
  std::uint64_t poses = 0;   ///< One an image.
  std::uint64_t routes = 0;  ///< As in `robot_news.hpp`.
};

struct MissionResult {
  bool complete = false;         ///< False if ended by time or from outside.
  double completion_time = 0.0;  ///< On the mission's clock [s].
  double planning_time = 0.0;    ///< Of the machine, in the high-level planner [s].
  std::vector<std::vector<TimedConfiguration>> trajectories;  ///< One a robot.
  std::vector<double> path_length;                            ///< One a robot [m].
  std::vector<double> path_at_work;      ///< The same without the flights home at the end [m].
  std::vector<StopReason> stop_reasons;  ///< One a robot.
  /// What its planner expected of going on, by the whole tours of all robots; nothing if it found
  /// nothing more to do.
  std::optional<Yield> left_out;
  double left_area = 0.0;                     ///< Of elements still to be planned for [m²].
  std::size_t remaining = 0;                  ///< Incomplete elements at the end.
  CoverageEstimate coverage;                  ///< By its own account, at the end.
  std::map<LeftReason, std::size_t> reasons;  ///< Of all that remain.
  std::vector<MissionProgress> history;       ///< About once in ten seconds.
  std::size_t images = 0;                     ///< Or scans, of all robots.
  std::size_t plans = 0, emergency_stops = 0, waits = 0;
  CentralTraffic traffic;  ///< Nothing of a robot alone, nor of a distributed fleet.

  /// Whether every robot stopped for a reason that was asked for, but those that were lost, if they
  /// are not all.
  bool enough() const {
    const auto lost = [](StopReason r) { return r == StopReason::lost; };
    return std::all_of(stop_reasons.begin(), stop_reasons.end(),
                       [&](StopReason r) { return is_enough(r) || lost(r); }) &&
           !std::all_of(stop_reasons.begin(), stop_reasons.end(), lost);
  }
  double total_path_length() const {
    return std::accumulate(path_length.begin(), path_length.end(), 0.0);
  }
  double total_path_at_work() const {
    return std::accumulate(path_at_work.begin(), path_at_work.end(), 0.0);
  }
};
}  // namespace surfleet
