// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the surface room, for headers that only name its types.
#pragma once

namespace surfleet {
struct CloudTokenOptions;
struct CloudTokens;
class ContinuousField;
struct Crease;
struct CreaseFinder;
struct DensePath;
class DensePlanner;
struct EdgeCrossing;
struct EdgePoint;
struct FeatureCell;
struct FeatureMapOptions;
class FeatureMaps;
struct FieldDrive;
struct FrontDriveBicycle;
struct GaussianKernel;
class GeodesicStrips;
struct GreedyProjection;
struct GreedyProjectionOptions;
struct MovingLeastSquaresOptions;
struct OrientedCloudOptions;
class PerpendicularField;
struct RearDriveBicycle;
struct Scan;
struct ScanTriangulation;
struct SheetTokens;
struct SingleStrip;
struct SmoothPath;
class SplineReference;
struct StripCosts;
struct StripPath;
class StripPlace;
class StripReplanner;
class StripSearch;
struct SurfacePath;
struct SurfacePoint;
struct SurfacePose;
struct SurfaceStep;
class SurfaceWalk;
class TautStrips;
struct Token;
class TokenSheet;
struct TrackedDrive;
struct TrackingControl;
struct UnfoldedStrip;
struct Unicycle;
class UnwrappedPath;
struct WendlandKernel;
}  // namespace surfleet
