// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the fleet room, for headers that only name its types.
#pragma once

namespace surfleet {
struct AgentOptions;
class CoverageGoal;
struct Envelope;
class MessageDrops;
class MessageError;
class MessageGuard;
struct MessageGuardOptions;
struct NetworkConditions;
struct NewsHead;
struct Packet;
class PatchIdSet;
struct PatchSyncOptions;
struct TeamAgreement;
class TeamEnd;
struct TeamEndOptions;
class TeamRelay;
struct TeamRelayOptions;
}  // namespace surfleet
