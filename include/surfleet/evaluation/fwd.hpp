// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the evaluation room, for headers that only name its types.
#pragma once

namespace surfleet {
struct DistanceStatistics;
struct EvaluationOptions;
struct Image;
struct M3C2Options;
struct M3C2Result;
class MeasuredSurface;
struct MeshStyle;
class Moments;
struct ObservabilityOptions;
struct ObservableSurface;
struct OrientedCoverage;
struct OrientedCoverageOptions;
class OrientedSurface;
struct Plot;
class Rasterizer;
class ReachableLattice;
struct ReconstructionEvaluation;
struct ReconstructionMetrics;
struct RenderView;
class Report;
struct StampedPose;
struct SurfaceSamples;
struct Table;
}  // namespace surfleet
