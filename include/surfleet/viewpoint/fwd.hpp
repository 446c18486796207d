// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the viewpoint room, for headers that only name its types.
#pragma once

#include <cstdint>

namespace surfleet {
struct ClusterOptions;
struct IncompleteElement;
class IncompleteSurfaceGain;
struct IncompleteSurfaceOptions;
class LineOfSight;
struct MergeOptions;
enum class NoViewReason : std::uint8_t;
struct PredictedPatch;
struct PredictionOptions;
struct SightOptions;
class UnknownVolumeGain;
struct UnknownVolumeOptions;
struct UnseenElement;
class ViewFrustum;
struct Viewpoint;
struct ViewpointChoice;
struct ViewpointCluster;
class ViewpointGenerator;
struct ViewpointOptions;
struct ViewpointSet;
}  // namespace surfleet
