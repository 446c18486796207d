// SPDX-License-Identifier: MIT
/// @file
/// @brief How a mission is flown behind one call.
#pragma once

#include <span>
#include <utility>

#include <surfleet/simulation/fly_mission.hpp>
#include <surfleet/simulation/simulation.hpp>

namespace surfleet {
SURFLEET_INLINE FlownMission fly_mission(const MissionOptions& options, AnyWorld world,
                                         std::span<const Configuration> starts, AnyPlanner planner,
                                         const MissionWatch& watch,
                                         const MissionObserver& observer) {
  Simulation<AnyPlanner, AnyWorld> simulation(options, world, starts, std::move(planner));
  simulation.observer = observer;
  if (watch)
    simulation.on_progress = [&](const MissionProgress& p) { return watch(p, simulation.map()); };
  MissionResult result = simulation.run();
  return {std::move(result), simulation.take_map()};
}
}  // namespace surfleet
