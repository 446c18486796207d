// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the planning room, for headers that only name its types.
#pragma once

namespace surfleet {
struct CoverageTour;
struct CoverageTourOptions;
struct ElementsInSight;
class Interest;
struct InterestOptions;
struct KindSpace;
struct KnownSurface;
class LatticeViews;
struct NamedPlanner;
class OpeningViews;
struct Plan;
struct PlannerSettings;
struct ReplanRule;
struct RobotKind;
struct RobotState;
class RollingTours;
struct RollingToursOptions;
struct FrontierViewsOptions;
struct Stop;
class SurfaceBelief;
struct SurfaceBeliefOptions;
struct TeamTourOptions;
struct TeamTourStop;
struct TourPlannerOptions;
struct TourStart;
struct UnknownInSight;
class ViewsInVain;
struct ViewsToValue;
}  // namespace surfleet
