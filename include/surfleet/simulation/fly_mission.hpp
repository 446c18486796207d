// SPDX-License-Identifier: MIT
/// @file
/// @brief A whole simulated mission by one call, whatever the planner and the world.
///
///     DroneWorld<EmbreeRayCaster> world(caster, camera, forward_camera_mount());
///     const FlownMission flown = fly_mission(options, world, starts, make_planner("tsga"));
///     write_ply(extract_surface(flown.map), "reconstruction.ply");
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <surfleet/core/compiled.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/simulation/mission.hpp>
#include <surfleet/simulation/world_model.hpp>

namespace surfleet {
/// Any world behind one type, so that what takes a world is compiled once. The world must outlive
/// it. Models `WorldModel`.
class AnyWorld {
 public:
  template <WorldModel World>
  AnyWorld(World& world)  // NOLINT(google-explicit-constructor): takes the place of any of them
      : capture_(
            [&world](std::size_t robot, std::uint64_t shot, std::span<const Configuration> fleet) {
              return world.capture(robot, shot, fleet);
            }) {
    if constexpr (SightWorld<World>)
      sees_ = [&world](const Point3& a, const Point3& b) { return world.sees(a, b); };
  }
  SensorReading capture(std::size_t robot, std::uint64_t shot,
                        std::span<const Configuration> fleet) const {
    return capture_(robot, shot, fleet);
  }
  /// Throws `Error` for a world that does not know.
  bool sees(const Point3& a, const Point3& b) const {
    require(sees_ != nullptr, "world: expected one that knows lines of sight");
    return sees_(a, b);
  }

 private:
  std::function<SensorReading(std::size_t, std::uint64_t, std::span<const Configuration>)> capture_;
  std::function<bool(const Point3&, const Point3&)> sees_;
};

struct FlownMission {
  MissionResult result;
  TsdfMap map;
};
/// Told about once a simulated second; ends the mission by returning false.
using MissionWatch = std::function<bool(const MissionProgress&, const TsdfMap&)>;

/// Runs a `Simulation` to its end. Throws `Error` as that does.
SURFLEET_INLINE FlownMission fly_mission(const MissionOptions& options, AnyWorld world,
                                         std::span<const Configuration> starts, AnyPlanner planner,
                                         const MissionWatch& watch = {},
                                         const MissionObserver& observer = {});
}  // namespace surfleet

#ifndef SURFLEET_COMPILED
#include <surfleet/simulation/detail/fly_mission.hpp>
#endif
