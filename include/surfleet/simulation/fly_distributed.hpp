// SPDX-License-Identifier: MIT
/// @file
/// @brief A whole simulated mission of a distributed fleet by one call.
///
///     const FlownDistributed flown =
///         fly_distributed(options, {.network = NetworkConditions::named("wifi")}, world, starts,
///                         [](RobotId) { return make_planner("tsga"); });
#pragma once

#include <functional>
#include <span>

#include <surfleet/core/compiled.hpp>
#include <surfleet/simulation/distributed_mission.hpp>
#include <surfleet/simulation/fly_mission.hpp>

namespace surfleet {
struct FlownDistributed {
  DistributedResult result;
  TsdfMap map;  ///< Of the first robot that is left.
};

/// Runs a `DistributedSimulation` to its end; the planner is asked for once a robot. Throws `Error`
/// as that does.
SURFLEET_INLINE FlownDistributed fly_distributed(const MissionOptions& options,
                                                 const DistributedOptions& distributed,
                                                 AnyWorld world,
                                                 std::span<const Configuration> starts,
                                                 const std::function<AnyPlanner(RobotId)>& planner,
                                                 const MissionWatch& watch = {});
}  // namespace surfleet

#ifndef SURFLEET_COMPILED
#include <surfleet/simulation/detail/fly_distributed.hpp>
#endif
