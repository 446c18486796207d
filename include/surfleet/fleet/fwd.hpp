// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the fleet room, for headers that only name its types.
#pragma once

namespace surfleet {
struct AgentOptions;
struct Envelope;
struct NetworkConditions;
struct Packet;
class PatchIdSet;
struct PatchSyncOptions;
}  // namespace surfleet
