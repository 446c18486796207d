// SPDX-License-Identifier: MIT
/// @file
/// @brief A distributed fleet in a simulated world and on a simulated network [000 ch. 4].
///
///     DistributedSimulation simulation(options, {.network = NetworkConditions::named("wifi")},
///                                      world, starts, [](RobotId) { return make_planner("tsga");
///                                      });
///     const DistributedResult result = simulation.run();
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/fleet/distributed_agent.hpp>
#include <surfleet/fleet/impaired.hpp>
#include <surfleet/simulation/distributed_mission.hpp>
#include <surfleet/simulation/mission.hpp>
#include <surfleet/simulation/mission_record.hpp>
#include <surfleet/simulation/simulated_drone.hpp>

namespace surfleet {
/// Clock, bodies, network, events, records; every robot has a `DistributedAgent`. In a tick all
/// hear, observe and plan at once, then all move and speak; messages pass between ticks. The same
/// options, world and planners give the same result on any number of threads.
template <WorldModel World>
class DistributedSimulation {
 public:
  using Body = SimulatedDrone<World>;
  using Robot = DistributedAgent<Body>;
  std::function<bool(const MissionProgress&)> on_progress;  ///< As in `Simulation`.

  /// Throws `Error` on options out of range.
  DistributedSimulation(MissionOptions options, DistributedOptions distributed, World& world,
                        std::span<const Configuration> starts,
                        const std::function<AnyPlanner(RobotId)>& planner)
      : options_(std::move(options)),
        distributed_(std::move(distributed)),
        homes_(starts.begin(), starts.end()),
        fleet_(starts.begin(), starts.end()),
        planner_(planner),
        network_(starts.size(), distributed_.network),
        alive_(starts.size(), true),
        gone_(starts.size(), false),
        catching_up_(distributed_.network),
        record_(starts.size()) {
    check_mission(options_, starts);
    require(options_.max_time > 0.0, "time: expected more than 0 s");
    for (const FleetEvent& e : distributed_.events)
      require(e.robot < fleet_.size(), "event: of a robot that is not there");
    options_.agent.endurance = options_.limits.endurance;
    distributed_.agent = limited(distributed_.agent, options_.limits);
    for (std::size_t r = 0; r < fleet_.size(); ++r) {
      bodies_.push_back(
          std::make_unique<Body>(world, r, fleet_, options_.kind.limits, options_.neighbours));
      robots_.push_back(started(r, 0));
    }
    std::stable_sort(distributed_.events.begin(), distributed_.events.end(),
                     [](const FleetEvent& a, const FleetEvent& b) { return a.time < b.time; });
    network_.position = [this](RobotId r) { return fleet_[r].position; };
    if constexpr (SightWorld<World>)
      network_.line_of_sight = [&world](const Point3& a, const Point3& b) {
        return world.sees(a, b);
      };
  }
  DistributedSimulation(const DistributedSimulation&) = delete;
  DistributedSimulation& operator=(const DistributedSimulation&) = delete;

  const Robot& robot(RobotId id) const { return *robots_[id]; }
  /// The first robot that is left.
  const Robot& first_left() const {
    for (std::size_t r = 0; r < robots_.size(); ++r)
      if (alive_[r]) return *robots_[r];
    return *robots_.front();
  }

  /// Runs to the end. Once only.
  DistributedResult run() {
    record_.add(time_, fleet_, gone_);
    double next_report = 0.0;
    while (time_ < options_.max_time) {
      happen();
      network_.advance(time_);
      std::vector<std::vector<Message<Packet>>> inbox(robots_.size());
      for (std::size_t r = 0; r < robots_.size(); ++r)
        inbox[r] = network_.receive(static_cast<RobotId>(r));
      each([&](std::size_t r) { robots_[r]->observe(time_, inbox[r]); });
      record_.result.images +=
          static_cast<std::size_t>(std::count(alive_.begin(), alive_.end(), true));
      watch();
      if (finished()) {
        ended_ = true;
        break;
      }
      std::vector<std::vector<Message<Packet>>> outbox(robots_.size());
      each([&](std::size_t r) { outbox[r] = robots_[r]->act(time_); });
      for (auto& messages : outbox)
        for (Message<Packet>& m : messages) network_.send(std::move(m));
      time_ = static_cast<double>(++step_) * options_.agent.image_period;
      record_.add(time_, fleet_, gone_);
      if (time_ >= next_report) {
        next_report += 1.0;
        if (!report()) break;
      }
    }
    return summary();
  }

 private:
  template <typename F>
  void each(const F& f) {
    parallel_for(robots_.size(), options_.threads, [&](std::size_t r) {
      if (alive_[r]) f(r);
    });
  }
  std::unique_ptr<Robot> started(std::size_t r, std::uint32_t incarnation) {
    const auto id = static_cast<RobotId>(r);
    DistributedAgentOptions own = distributed_.agent;
    own.incarnation += incarnation;
    own.sync.robots = own.relay.robots = static_cast<RobotId>(fleet_.size());
    AgentOptions agent = options_.agent;
    agent.home = homes_[r];
    return std::make_unique<Robot>(id, options_.kind, *bodies_[r], options_.belief, agent,
                                   options_.start_clearance, planner_(id), own,
                                   distributed_.packer);
  }
  void happen() {
    for (; next_event_ < distributed_.events.size(); ++next_event_) {
      const FleetEvent& e = distributed_.events[next_event_];
      if (e.time > time_) return;
      if (gone_[e.robot]) continue;
      if (e.kind == FleetEvent::Kind::restarted) {
        bodies_[e.robot]->stop();
        robots_[e.robot] = started(e.robot, static_cast<std::uint32_t>(next_event_) + 1);
        std::erase(result_.lost, e.robot);
        alive_[e.robot] = true;
        catching_up_.add(time_);
        continue;
      }
      if (alive_[e.robot]) result_.lost.push_back(e.robot);
      alive_[e.robot] = false;
      // Far from everything, where no camera and no judge meets it.
      if (e.kind == FleetEvent::Kind::vanished) {
        gone_[e.robot] = true;
        fleet_[e.robot].position = Point3::Constant(-1e6 - 1e3 * e.robot);
      }
    }
  }
  void watch() {
    std::vector<const PatchIdSet*> held;
    for (std::size_t r = 0; r < robots_.size(); ++r)
      if (alive_[r]) held.push_back(&robots_[r]->patches().held());
    catching_up_.observe(time_, held);
  }
  bool finished() const {
    bool any_alive = false;
    for (std::size_t r = 0; r < robots_.size(); ++r) {
      if (!alive_[r]) continue;
      any_alive = true;
      if (!robots_[r]->finished()) return false;
    }
    return any_alive;
  }
  bool report() {
    const SurfaceBelief& belief = first_left().belief();
    record_.estimate(time_, belief);
    return record_.report(time_, belief, on_progress);
  }
  DistributedResult summary() {
    const Robot& first = first_left();
    record_.close(time_, first.belief(), first.plans().impossible());
    MissionResult& m = record_.result;
    m.left_out = first.plans().left_out();
    m.complete = ended_;
    result_.maps_equal = true;
    for (std::size_t r = 0; r < robots_.size(); ++r) {
      const Robot& robot = *robots_[r];
      record_.add_planning_robot(robot, ended_, !alive_[r]);
      result_.redundant_stops += robot.redundant_stops();
      result_.refused += robot.drops();
      result_.bytes_sent.push_back(network_.bytes_sent(static_cast<RobotId>(r)));
      if (!alive_[r]) continue;
      m.complete = m.complete && robot.agent().stop_reason().value_or(StopReason::complete) ==
                                     StopReason::complete;
      if (&robot != &first)
        result_.maps_equal = result_.maps_equal && equal_maps(first.map(), robot.map());
    }
    for (std::size_t k = 0; k < kMessageKinds; ++k)
      result_.bytes_by_kind[k] = network_.bytes_sent_by_kind(static_cast<std::uint8_t>(k));
    for (std::size_t k = 0; k < kNetworkDrops; ++k)
      result_.dropped[k] = network_.dropped(static_cast<NetworkDrop>(k));
    result_.catch_ups = catching_up_.catch_ups();
    result_.mission = std::move(m);
    return std::move(result_);
  }

  MissionOptions options_;
  DistributedOptions distributed_;
  std::vector<Configuration> homes_;
  std::vector<Configuration> fleet_;  // the truth
  std::function<AnyPlanner(RobotId)> planner_;
  SimulatedNetwork<Packet> network_;
  std::vector<bool> alive_, gone_;
  CatchUpWatch catching_up_;
  std::size_t next_event_ = 0;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::unique_ptr<Robot>> robots_;
  bool ended_ = false;  // by the robots themselves
  std::uint64_t step_ = 0;
  double time_ = 0.0;
  MissionRecord record_;
  DistributedResult result_;
};
}  // namespace surfleet
