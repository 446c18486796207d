// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the planning room, for headers that only name its types.
#pragma once

namespace surfleet {
struct CoverageTour;
struct CoverageTourOptions;
struct KindSpace;
struct KnownSurface;
struct LoneClimbOptions;
struct NamedPlanner;
struct OpeningLookOptions;
class OpeningLooks;
struct Plan;
struct PlannerSettings;
class RatePlanner;
struct RatePlannerOptions;
struct ReplanRule;
struct RobotKind;
struct RobotState;
struct SpaceLooksOptions;
struct Stop;
class SurfaceBelief;
struct SurfaceBeliefOptions;
struct TourAheadOptions;
struct TourAheadStop;
struct TourPlannerOptions;
struct ToursBehindOptions;
struct TourSite;
}  // namespace surfleet
