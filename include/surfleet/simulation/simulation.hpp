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
#include <surfleet/fleet/coverage_goal.hpp>
#include <surfleet/fleet/robot_news.hpp>
#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/simulation/mission.hpp>
#include <surfleet/simulation/mission_record.hpp>
#include <surfleet/simulation/simulated_drone.hpp>

namespace surfleet {
/// A fleet with one map and one planner: the centralised architecture; with one robot, the single
/// one.
///
/// In every step of the clock the robots observe, and the belief follows the change; then stops are
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
      : options_(checked(std::move(options), starts, planner)),
        belief_(
            options_.belief, std::span<const RobotKind>(&options_.kind, 1),
            options_.begun ? *options_.begun : TsdfMap({.voxel_size = options_.belief.voxel_size})),
        planning_(std::move(planner)),
        fleet_(starts.begin(), starts.end()),
        air_(starts.size()),
        goal_(options_.limits.coverage_goal),
        record_(starts.size()) {
    if constexpr (std::is_same_v<Planner, AnyPlanner>)
      require(static_cast<bool>(planning_.requests.planner), "planner: expected one, not none");
    planning_.requests.least_gain = options_.limits.least_gain;
    options_.agent.endurance = options_.limits.endurance;
    for (std::size_t r = 0; r < fleet_.size(); ++r) {
      belief_.add_known_free(0, {fleet_[r].position, options_.start_clearance});
      bodies_.push_back(
          std::make_unique<Body>(world, r, fleet_, options_.kind.limits, options_.neighbours));
      agents_.push_back(std::make_unique<Agent<Body>>(static_cast<RobotId>(r), 0, *bodies_[r],
                                                      belief_, options_.agent));
    }
    belief_.update();
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
    planning_.requests.on_plan = [this](const SurfaceSituation& situation, const Plan& plan) {
      count_routes(plan);
      if (observer.on_plan) observer.on_plan(situation, plan);
    };
    record_.add(time_, fleet_);
    double next_report = 0.0;
    while (time_ < options_.max_time) {
      observe();
      for (const auto& agent : agents_) agent->check_stop();
      if (goal_.is_reached(belief_, time_))
        for (const auto& agent : agents_) agent->retire(StopReason::coverage_goal);
      planning_(agents_, belief_, time_);
      if (planning_.finished(agents_, belief_) && over()) break;
      move();
      time_ = static_cast<double>(++step_) * options_.agent.image_period;
      record_.add(time_, fleet_);
      if (observer.on_step) observer.on_step({time_, fleet_, belief_});
      if (time_ >= next_report) {
        next_report += 1.0;
        if (!report()) break;
      }
    }
    record_.close(time_, belief_, planning_.requests.impossible());
    record_.result.plans = planning_.requests.plans();
    record_.result.planning_time = planning_.requests.planning_time();
    if (agents_.size() > 1) {
      const RobotKind& kind = options_.kind;
      const auto pixels = static_cast<std::uint64_t>(kind.camera.width) *
                          static_cast<std::uint64_t>(kind.camera.height);
      const std::uint64_t readings = kind.lidar ? kind.lidar->beams() : pixels;
      record_.result.traffic.images = record_.result.images * readings * sizeof(std::uint16_t);
      record_.result.traffic.poses = record_.result.images * kPoseBytes;
    }
    for (const auto& agent : agents_)
      record_.add_robot(
          *agent, ended_ ? agent->stop_reason().value_or(StopReason::complete) : StopReason::ended);
    return std::move(record_.result);
  }

 private:
  using Body = SimulatedDrone<World>;
  static constexpr std::uint64_t kPoseBytes = 7 * sizeof(double);  // position and quaternion

  static MissionOptions checked(MissionOptions o, std::span<const Configuration> starts,
                                const Planner& planner) {
    check_mission(o, starts);
    o.belief = belief_for(planner, std::move(o.belief));
    o.belief.tsdf.threads = o.threads;
    return o;
  }

  /// With nothing left to do, or no robot to do it: true once all are where they are to end.
  bool over() {
    ended_ = true;
    const auto& left_out = planning_.requests.left_out();
    if (left_out) record_.result.left_out = *left_out;
    if (options_.limits.any())
      for (const auto& agent : agents_) {
        agent->retire(left_out ? StopReason::enough : StopReason::complete);
        ended_ = ended_ && agent->at_rest();
      }
    record_.result.complete = ended_;
    for (const auto& agent : agents_)
      if (agent->stop_reason().value_or(StopReason::complete) != StopReason::complete)
        record_.result.complete = false;
    return ended_;
  }
  void observe() {
    parallel_for(agents_.size(), options_.threads, [&](std::size_t r) { agents_[r]->sense(); });
    for (const auto& agent : agents_) agent->integrate();
    record_.result.images += agents_.size();
    belief_.update();
  }
  void count_routes(const Plan& plan) {
    if (agents_.size() < 2) return;
    for (const auto& [robot, route] : plan.routes)
      record_.result.traffic.routes +=
          encode_routes({{.head = {.robot = robot}, .route = route}}).size();
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

  /// False if the mission is to end here.
  bool report() {
    record_.estimate(time_, belief_);
    return record_.report(time_, belief_, on_progress);
  }

  MissionOptions options_;
  SurfaceBelief belief_;
  CentralPlanning<Planner> planning_;
  std::vector<Configuration> fleet_;  // the truth
  PerfectTransport<TrafficAgent> air_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::unique_ptr<Agent<Body>>> agents_;
  CoverageGoal goal_;
  bool ended_ = false;  // by the robots themselves
  std::uint64_t step_ = 0;
  double time_ = 0.0;
  MissionRecord record_;
};
}  // namespace surfleet
