// SPDX-License-Identifier: MIT
/// @file
/// @brief What a simulated mission of a distributed fleet is set to, and what it comes to.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/fleet/distributed_options.hpp>
#include <surfleet/fleet/impaired.hpp>
#include <surfleet/fleet/message_drops.hpp>
#include <surfleet/fleet/packet.hpp>
#include <surfleet/mapping/patch_codec.hpp>
#include <surfleet/simulation/catch_up.hpp>
#include <surfleet/simulation/mission.hpp>

namespace surfleet {
/// Something that befalls a robot at a time.
struct FleetEvent {
  enum class Kind : std::uint8_t { killed, vanished, restarted };
  double time = 0.0;  ///< [s]
  RobotId robot = 0;
  /// Its process ends; its body hovers where it is, or is gone; or its process begins again, with
  /// nothing, where its body is.
  Kind kind = Kind::killed;
};

/// An agent's options with what a mission is limited to.
inline DistributedAgentOptions limited(DistributedAgentOptions o, const MissionLimits& limits) {
  o.least_gain = limits.least_gain;
  o.coverage_goal = limits.coverage_goal;
  o.returns_home = limits.any();
  return o;
}

struct DistributedOptions {
  NetworkConditions network{};
  DistributedAgentOptions agent{};
  AnyPacker packer{};  ///< Of patches, in the air and in robots' memory.
  std::vector<FleetEvent> events{};
};

struct DistributedResult {
  MissionResult mission;    ///< `coverage` and `remaining` are of the first robot that is left.
  bool maps_equal = false;  ///< All that are left hold the same map, every voxel.
  std::vector<std::uint64_t> bytes_sent;  ///< One a robot.
  std::array<std::uint64_t, kMessageKinds> bytes_by_kind{};
  std::array<std::uint64_t, kNetworkDrops> dropped{};  ///< By the network …
  MessageDrops refused;                                ///< … and by whom they reached.
  std::size_t redundant_stops = 0;
  std::vector<RobotId> lost;       ///< Killed or vanished.
  std::vector<CatchUp> catch_ups;  ///< In the order of time.
};
}  // namespace surfleet
