// SPDX-License-Identifier: MIT
/// @file
/// @brief When one robot of a distributed fleet is to go, and which of its team did not end with
/// it.
///
///     end.observe(robot, now);
///     if (end.over(now)) break;
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <surfleet/core/transport.hpp>
#include <surfleet/fleet/endurance.hpp>
#include <surfleet/planning/plan.hpp>

namespace surfleet {
struct TeamEndOptions {
  double linger = 5.0;   ///< It goes on telling that it is done for so long [s].
  double memory = 30.0;  ///< Mates not heard for so long are not waited for [s].
};

/// A robot that is done and has every mate's word for it may not leave at once: its mates would
/// wait for its own. So it lingers, unless there is work again. A robot whose charge is spent, or
/// that finds no path home, does not wait for its mates: it goes when it is at rest.
class TeamEnd {
 public:
  explicit TeamEnd(TeamEndOptions options = {}) : options_(options) {}

  /// Call after every `observe`. `Robot` is a `DistributedAgent`.
  template <typename Robot>
  void observe(const Robot& robot, double now) {
    const std::uint64_t digest = robot.patches().digest();
    for (const RobotState& mate : robot.team().mates(now, options_.memory)) {
      bool& well = ended_well_.try_emplace(mate.id, false).first->second;
      if (robot.team().is_current(mate)) well = mate.done && mate.holds == digest;
    }
    const std::optional<StopReason> why = robot.agent().stop_reason();
    if ((why == StopReason::endurance || why == StopReason::stranded) && robot.agent().at_rest()) {
      if (!since_) since_ = now;
    } else if (robot.finished()) {
      if (!since_ || digest != digest_) since_ = now;
    } else if (!robot.is_done() || robot.patches().missing() > 0 || digest != digest_) {
      since_.reset();
    }
    digest_ = digest;
  }
  /// Since when it could go [s]; nothing while it could not.
  std::optional<double> since() const { return since_; }
  bool over(double now) const { return since_ && now - *since_ >= options_.linger; }
  /// Mates that went, or fell silent, before they held the same and had nothing left to do.
  std::vector<RobotId> lost() const {
    std::vector<RobotId> lost;
    for (const auto& [id, well] : ended_well_)
      if (!well) lost.push_back(id);
    return lost;
  }

 private:
  TeamEndOptions options_;
  std::map<RobotId, bool> ended_well_;  // of all that were ever heard
  std::optional<double> since_;         // it could go [s]
  std::uint64_t digest_ = 0;
};
}  // namespace surfleet
