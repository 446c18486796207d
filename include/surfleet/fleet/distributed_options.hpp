// SPDX-License-Identifier: MIT
/// @file
/// @brief What the robots of a distributed fleet can be set to.
#pragma once

#include <cstdint>

#include <surfleet/fleet/patch_sync.hpp>
#include <surfleet/fleet/redundancy.hpp>
#include <surfleet/fleet/team_relay.hpp>

namespace surfleet {
struct DistributedAgentOptions {
  std::uint32_t team = 0;          ///< Robots of other teams are not heard.
  std::uint32_t incarnation = 0;   ///< How often this robot was started before.
  std::uint32_t patch_images = 5;  ///< Images in a map patch.
  double memory_of_lost = 30.0;    ///< Mates not heard for so long are out of everything [s].
  PatchSyncOptions sync;
  TeamRelayOptions relay;
  RedundancyOptions redundancy;
};
}  // namespace surfleet
