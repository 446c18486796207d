// SPDX-License-Identifier: MIT
/// @file
/// @brief What is written down of a simulated mission while it is flown, whatever the architecture.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/simulation/mission.hpp>

namespace surfleet {
class MissionRecord {
 public:
  MissionResult result;

  explicit MissionRecord(std::size_t robots) {
    result.trajectories.resize(robots);
    result.path_length.assign(robots, 0.0);
  }

  /// Where robots are in truth; those that are `gone`, if that is given, leave no more trace.
  void add(double time, std::span<const Configuration> fleet, const std::vector<bool>& gone = {}) {
    for (std::size_t r = 0; r < fleet.size(); ++r) {
      if (!gone.empty() && gone[r]) continue;
      auto& t = result.trajectories[r];
      if (!t.empty())
        result.path_length[r] += (fleet[r].position - t.back().configuration.position).norm();
      t.push_back({time, fleet[r]});
    }
  }
  /// Takes the mission's own account of its coverage, if it is time.
  void estimate(double time, const SurfaceBelief& belief) {
    if (time < next_estimate_) return;
    estimate_ = belief.estimate_coverage().share();
    next_estimate_ = std::max(kEstimates * time, time + kFirstEstimate);
  }
  /// To be called about once a second: what `watch` says, true if there is none.
  bool report(double time, const SurfaceBelief& belief,
              const std::function<bool(const MissionProgress&)>& watch) {
    const MissionProgress now = progress(time, belief);
    if (result.history.empty() || time >= result.history.back().time + 10.0)
      result.history.push_back(now);
    return !watch || watch(now);
  }
  /// A robot's part, and why it ended.
  template <typename Agent>
  void add_robot(const Agent& agent, StopReason reason) {
    result.path_at_work.push_back(agent.travelled_at_work());
    result.stop_reasons.push_back(reason);
    result.emergency_stops += agent.emergency_stops();
    result.waits += agent.waits();
  }
  /// The same of a robot that plans for itself, whose mission came to an end of its own or not. One
  /// that is cut short on its flight home has not ended as it was to.
  template <typename Robot>
  void add_planning_robot(const Robot& robot, bool over, bool lost = false) {
    result.plans += robot.plans().plans();
    result.planning_time += robot.plans().planning_time();
    const std::optional<StopReason> why = robot.agent().stop_reason();
    StopReason reason = StopReason::ended;
    if (lost)
      reason = StopReason::lost;
    else if (over || (why && robot.agent().at_rest()))
      reason = why.value_or(StopReason::complete);
    add_robot(robot.agent(), reason);
  }
  /// The end, as `belief` has it; `impossible` are the elements that its last plan had no view of.
  void close(double time, const SurfaceBelief& belief,
             std::span<const std::pair<VoxelIndex, LeftReason>> impossible) {
    result.coverage = belief.estimate_coverage();
    estimate_ = result.coverage.share();
    result.history.push_back(progress(time, belief));
    result.completion_time = time;
    result.left_area =
        static_cast<double>(belief.goals().size()) * belief.voxel_size() * belief.voxel_size();
    std::map<VoxelKey, LeftReason> planned;
    for (const auto& [v, reason] : impossible) planned[key_of(v)] = reason;
    belief.incomplete().for_each([&](const IncompleteElement& e) {
      LeftReason reason = LeftReason::not_attempted;
      if (const auto given = belief.ledger().reason(e.voxel)) {
        reason = *given;
      } else if (const auto it = planned.find(key_of(e.voxel)); it != planned.end()) {
        reason = it->second;
      }
      ++result.reasons[reason];
      ++result.remaining;
    });
  }

 private:
  MissionProgress progress(double time, const SurfaceBelief& belief) const {
    return {.time = time,
            .path_length = result.total_path_length(),
            .incomplete = belief.incomplete().size(),
            .known_blocks = belief.known().grid().block_count(),
            .estimated_coverage = estimate_};
  }

  static constexpr double kFirstEstimate = 20.0;  ///< Between accounts of coverage at first [s] …
  static constexpr double kEstimates = 1.25;      ///< … and later, the next over the last.
  double next_estimate_ = 0.0, estimate_ = 0.0;
};
}  // namespace surfleet
