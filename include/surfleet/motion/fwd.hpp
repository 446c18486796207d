// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the motion room, for headers that only name its types.
#pragma once

namespace surfleet {
struct AerialLimits;
class AerialMotion;
struct BallCover;
struct FollowerLimits;
class FreeSpace;
struct FreeSpaceOptions;
struct LazyPrmOptions;
class LazyPrmStar;
struct Maneuver;
struct ObstacleCheck;
class ObstacleVoxels;
class OptimisticLattice;
struct OptimisticLatticeOptions;
struct Path;
class PathFollower;
class ReachableSet;
class ReachFrom;
class RoadmapPassages;
struct ShortcutOptions;
struct Sphere;
class SweptBody;
class TangentBug;
struct TangentBugOptions;
struct TrafficAgent;
struct TrafficOptions;
class TrafficPolicy;
struct UnicycleLimits;
class UnicycleMotion;
struct UtilityCheck;
}  // namespace surfleet
