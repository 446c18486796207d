// SPDX-License-Identifier: MIT
/// @file
/// @brief How a mission of a distributed fleet is flown behind one call.
#pragma once

#include <functional>
#include <span>
#include <utility>

#include <surfleet/simulation/distributed_simulation.hpp>
#include <surfleet/simulation/fly_distributed.hpp>

namespace surfleet {
SURFLEET_INLINE FlownDistributed fly_distributed(const MissionOptions& options,
                                                 const DistributedOptions& distributed,
                                                 AnyWorld world,
                                                 std::span<const Configuration> starts,
                                                 const std::function<AnyPlanner(RobotId)>& planner,
                                                 const MissionWatch& watch) {
  DistributedSimulation<AnyWorld> simulation(options, distributed, world, starts, planner);
  if (watch)
    simulation.on_progress = [&](const MissionProgress& p) {
      return watch(p, simulation.first_left().map());
    };
  DistributedResult result = simulation.run();
  return {std::move(result), simulation.first_left().map()};
}
}  // namespace surfleet
