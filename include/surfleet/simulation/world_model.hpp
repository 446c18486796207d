// SPDX-License-Identifier: MIT
/// @file
/// @brief What the robots of a simulation see.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/fleet/robot_body.hpp>
#include <surfleet/geometry/sensor_reading.hpp>

namespace surfleet {
/// What sensors see: a simulator, or the world itself.
///
/// `capture(robot, shot, fleet)` is the depth image or scan that robot takes as its shot-th, with
/// all robots at the given configurations. It is asked for different robots at once, and must give
/// the same image for the same arguments. Models: `DroneWorld`, `LidarWorld`, `AnyWorld`.
template <typename W>
concept WorldModel = requires(W& world, std::size_t robot, std::uint64_t shot,
                              std::span<const Configuration> fleet) {
  { world.capture(robot, shot, fleet) } -> std::convertible_to<SensorReading>;
};

/// A world that also knows what is between places: `sees(a, b)`, whether nothing is. Networks whose
/// robots hear each other along lines of sight need one. Models: `DroneWorld`, `AnyWorld`.
template <typename W>
concept SightWorld = WorldModel<W> && requires(const W& world, const Point3& a, const Point3& b) {
  { world.sees(a, b) } -> std::same_as<bool>;
};

/// What a robot sees of its teammates: `sense(robot, shot, fleet)` with its image of that number,
/// where all robots are in truth. Asked for different robots at once, for each in the order of its
/// images. Models: `MarkerSight`.
using NeighbourSense = std::function<std::vector<SeenRobot>(std::size_t robot, std::uint64_t shot,
                                                            std::span<const Configuration> fleet)>;
}  // namespace surfleet
