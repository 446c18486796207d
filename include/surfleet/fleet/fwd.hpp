// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the fleet room, for headers that only name its types.
#pragma once

#include <cstdint>

namespace surfleet {
class ChangedRegions;
struct CoverageTour;
struct CoverageTourOptions;
class HeadingTable;
struct KnownSurface;
struct LeftBelowOptions;
struct LoneClimbOptions;
enum class LeftReason : std::uint8_t;
class LookBound;
class LookLedger;
struct LookLedgerOptions;
class MapSight;
struct MissionOptions;
struct MissionProgress;
struct MissionResult;
struct OpeningLookOptions;
class OpeningLooks;
class OptimisticLattice;
struct OptimisticLatticeOptions;
struct PlanRequest;
struct PlanResult;
class RatePlanner;
struct RatePlannerOptions;
struct RobotRequest;
struct Sighting;
class SightMemory;
struct SightTarget;
class SpaceCells;
class SpaceLooks;
struct SpaceLooksOptions;
struct Stop;
struct StopDistance;
struct StraightFlight;
class TeamFlights;
struct TimedConfiguration;
struct TourAheadOptions;
struct TourAheadStop;
struct TourPlannerOptions;
struct ToursBehindOptions;
struct TourSite;
class UnseenSpace;
struct UnseenSpaceOptions;
class ViewAccess;
class ViewpointMemory;
class WorthAround;
}  // namespace surfleet
