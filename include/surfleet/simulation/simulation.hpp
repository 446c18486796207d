// SPDX-License-Identifier: MIT
/// @file
/// @brief A fleet reconstructs what it does not know, in a simulated world: clock, bodies, records
/// [000 ch. 2, 3].
///
///     Simulation<TsgaPlanner, DroneWorld<EmbreeRayCaster>> simulation(options, world, starts);
///     const MissionResult result = simulation.run();
///     write_ply(extract_surface(simulation.map()), "reconstruction.ply");
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/transport.hpp>
#include <surfleet/fleet/agent.hpp>
#include <surfleet/fleet/central_planning.hpp>
#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/simulation/mission.hpp>
#include <surfleet/simulation/simulated_drone.hpp>

namespace surfleet {
/// A fleet with one map and one planner: the centralised architecture; with one robot, the single
/// one.
///
/// In every step of the clock the robots look, and the belief follows the change; then stops are
/// checked off, obstacles are watched, robots without a route are planned for, all tell what they
/// are about, and all move at once. The same options, world and planner give the same result on any
/// number of threads.
template <FleetPlanner Planner, WorldModel World>
class Simulation {
 public:
  /// Called about once a simulated second; false ends the mission.
  std::function<bool(const MissionProgress&)> on_progress;
  MissionObserver observer;

  /// Throws `Error` on options out of range, no robots, no planner, or starts outside the bounds.
  Simulation(MissionOptions options, World& world, std::span<const Configuration> starts,
             Planner planner = {})
      : options_(checked(std::move(options), starts)),
        belief_(
            options_.belief, std::span<const RobotKind>(&options_.kind, 1),
            options_.begun ? *options_.begun : TsdfMap({.voxel_size = options_.belief.voxel_size})),
        planning_(std::move(planner)),
        fleet_(starts.begin(), starts.end()),
        air_(starts.size()) {
    if constexpr (std::is_same_v<Planner, AnyPlanner>)
      require(planning_.planner != nullptr, "planner: expected one, not an empty function");
    planning_.least_gain = options_.limits.least_gain;
    options_.agent.endurance = options_.limits.endurance;
    for (std::size_t r = 0; r < fleet_.size(); ++r) {
      belief_.add_known_free(0, {fleet_[r].position, options_.start_clearance});
      bodies_.push_back(
          std::make_unique<Body>(world, r, fleet_, options_.kind.limits, options_.neighbours));
      agents_.push_back(std::make_unique<Agent<Body>>(static_cast<RobotId>(r), 0, *bodies_[r],
                                                      belief_, options_.agent));
    }
    belief_.update();
    result_.trajectories.resize(agents_.size());
    result_.path_length.assign(agents_.size(), 0.0);
  }
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  const SurfaceBelief& belief() const { return belief_; }
  const TsdfMap& map() const { return belief_.map(); }
  /// The map, when the mission is over; nothing else of the simulation may be used after.
  TsdfMap take_map() { return belief_.take_map(); }
  const MissionOptions& options() const { return options_; }

  /// Runs to the end. Once only.
  MissionResult run() {
    planning_.on_plan = observer.on_plan;
    record();
    double next_report = 0.0;
    while (time_ < options_.max_time) {
      look();
      for (const auto& agent : agents_) agent->check_stop();
      planning_(agents_, belief_, time_);
      if (planning_.finished(agents_, belief_) && over()) break;
      move();
      time_ = static_cast<double>(++step_) * options_.agent.image_period;
      record();
      if (observer.on_step) observer.on_step({time_, fleet_, belief_});
      if (time_ >= next_report) {
        next_report += 1.0;
        if (!report()) break;
      }
    }
    result_.coverage = belief_.estimate_coverage();
    estimate_ = result_.coverage.share();
    result_.history.push_back(current());
    result_.completion_time = time_;
    result_.plans = planning_.plans();
    result_.planning_time = planning_.planning_time();
    result_.left_area =
        static_cast<double>(belief_.goals().size()) * belief_.voxel_size() * belief_.voxel_size();
    for (const auto& agent : agents_) {
      result_.path_at_work.push_back(agent->travelled_at_work());
      result_.stop_reasons.push_back(!ended_                ? StopReason::ended
                                     : agent->stop_reason() ? *agent->stop_reason()
                                                            : StopReason::complete);
      result_.emergency_stops += agent->emergency_stops();
      result_.waits += agent->waits();
    }
    account_for_rest();
    return std::move(result_);
  }

 private:
  using Body = SimulatedDrone<World>;

  static MissionOptions checked(MissionOptions o, std::span<const Configuration> starts) {
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
    o.belief.tsdf.threads = o.threads;
    return o;
  }

  /// With nothing left to do, or nobody to do it: true once all are where they are to end.
  bool over() {
    ended_ = true;
    if (options_.limits.any())
      for (const auto& agent : agents_) {
        agent->retire(StopReason::complete);
        ended_ = ended_ && agent->at_rest();
      }
    result_.complete = ended_;
    for (const auto& agent : agents_)
      if (agent->stop_reason().value_or(StopReason::complete) != StopReason::complete)
        result_.complete = false;
    return ended_;
  }
  void look() {
    parallel_for(agents_.size(), options_.threads, [&](std::size_t r) { agents_[r]->sense(); });
    for (const auto& agent : agents_) agent->integrate();
    result_.images += agents_.size();
    belief_.update();
  }
  /// All tell where they are and will be; then all move, each by what it has heard.
  void move() {
    const std::size_t n = agents_.size();
    for (std::size_t r = 0; options_.announces && n > 1 && r < n; ++r)
      air_.send(
          {.time = time_, .from = static_cast<RobotId>(r), .payload = agents_[r]->announce(time_)});
    for (std::size_t r = 0; r < n; ++r)
      for (const auto& told : air_.receive(static_cast<RobotId>(r))) agents_[r]->hear(told.payload);
    belief_.goals();  // made now, as agents ask for them at once
    parallel_for(n, options_.threads, [&](std::size_t r) { agents_[r]->move(time_); });
  }

  // -- records -----------------------------------------------------------------------------------
  void record() {
    for (std::size_t r = 0; r < fleet_.size(); ++r) {
      auto& t = result_.trajectories[r];
      if (!t.empty())
        result_.path_length[r] += (fleet_[r].position - t.back().configuration.position).norm();
      t.push_back({time_, fleet_[r]});
    }
  }
  /// False if the mission is to end here.
  bool report() {
    if (time_ >= next_estimate_) {
      estimate_ = belief_.estimate_coverage().share();
      next_estimate_ = std::max(kEstimates * time_, time_ + kFirstEstimate);
      if (estimate_ >= options_.limits.coverage_goal.value_or(2.0))
        for (const auto& agent : agents_) agent->retire(StopReason::coverage_goal);
    }
    const MissionProgress progress = current();
    if (result_.history.empty() || time_ >= result_.history.back().time + 10.0)
      result_.history.push_back(progress);
    return !on_progress || on_progress(progress);
  }
  MissionProgress current() const {
    return {.time = time_,
            .path_length = result_.total_path_length(),
            .incomplete = belief_.incomplete().size(),
            .known_blocks = belief_.known().grid().block_count(),
            .estimated_coverage = estimate_};
  }
  void account_for_rest() {
    std::map<VoxelKey, LeftReason> planned;
    for (const auto& [v, reason] : planning_.impossible()) planned[key_of(v)] = reason;
    belief_.incomplete().for_each([&](const IncompleteElement& e) {
      LeftReason reason = LeftReason::not_attempted;
      if (const auto given = belief_.ledger().reason(e.voxel)) {
        reason = *given;
      } else if (const auto it = planned.find(key_of(e.voxel)); it != planned.end()) {
        reason = it->second;
      }
      ++result_.reasons[reason];
      ++result_.remaining;
    });
  }

  static constexpr double kFirstEstimate = 20.0;  ///< Between accounts of coverage at first [s] …
  static constexpr double kEstimates = 1.25;      ///< … and later, the next over the last.

  MissionOptions options_;
  SurfaceBelief belief_;
  CentralPlanning<Planner> planning_;
  std::vector<Configuration> fleet_;  // the truth
  PerfectTransport<TrafficAgent> air_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::unique_ptr<Agent<Body>>> agents_;
  bool ended_ = false;  // by the robots themselves
  std::uint64_t step_ = 0;
  double time_ = 0.0, next_estimate_ = 0.0, estimate_ = 0.0;
  MissionResult result_;
};
}  // namespace surfleet
