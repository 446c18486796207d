// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the fleet room, for headers that only name its types.
#pragma once

#include <cstdint>

namespace surfleet {
struct CoverageTour;
struct CoverageTourOptions;
struct KnownSurface;
struct LoneClimbOptions;
struct MissionOptions;
struct MissionProgress;
struct MissionResult;
struct OpeningLookOptions;
class OpeningLooks;
struct PlanRequest;
struct PlanResult;
class RatePlanner;
struct RatePlannerOptions;
struct RobotRequest;
struct SpaceLooksOptions;
struct Stop;
struct TimedConfiguration;
struct TourAheadOptions;
struct TourAheadStop;
struct TourPlannerOptions;
struct ToursBehindOptions;
struct TourSite;
}  // namespace surfleet
