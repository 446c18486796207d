// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the coverage room, for headers that only name its types.
#pragma once

namespace surfleet {
struct BackAndForthSweep;
class CoverageGrid;
struct CoverageState;
struct CoveringStrip;
class DisCoverage;
struct DisCoverageOptions;
struct GaussianMixture;
struct HybridOptions;
struct LloydOptions;
struct MetricField;
struct NonconvexOptions;
class PMedianProblem;
class PMedianSolution;
class PrismCoverage;
struct ReebGraph;
struct RoboticBandPlan;
struct SpiralSweep;
struct SurfaceCoverageOptions;
struct SurfaceGraph;
struct SurfaceMapReport;
struct SurfacePartition;
struct UniformDensity;
struct VertexExchange;
struct VertexSubstitution;
struct VoronoiTessellation;
}  // namespace surfleet
