// SPDX-License-Identifier: MIT
/// @file
/// @brief What the robots of a distributed fleet can be set to.
#pragma once

#include <cstdint>
#include <optional>

#include <surfleet/fleet/patch_sync.hpp>
#include <surfleet/fleet/redundancy.hpp>
#include <surfleet/fleet/team_relay.hpp>
#include <surfleet/mapping/patch_limits.hpp>

namespace surfleet {
struct DistributedAgentOptions {
  std::uint32_t team = 0;          ///< Robots of other teams are not heard.
  std::uint32_t incarnation = 0;   ///< How often this robot was started before.
  std::uint32_t patch_images = 5;  ///< Images in a map patch.
  /// A patch is closed once its robot has come so far, too [m].
  std::optional<double> patch_distance{};
  double memory_of_lost = 30.0;  ///< Mates not heard for so long are out of everything [s].
  double least_gain = 0.0;       ///< See `PlanRequests::least_gain` [m²/m].
  /// A robot by whose own account so much is covered flies home, a share.
  std::optional<double> coverage_goal{};
  bool returns_home = false;  ///< When nothing is left for any robot, before it is finished.
  /// Of patches, one's own and others'; nothing: what this robot's own sensor gives, as in a team
  /// of which all see as far.
  std::optional<PatchLimits> patches{};
  PatchSyncOptions sync;
  TeamRelayOptions relay;
  RedundancyOptions redundancy;
};
}  // namespace surfleet
