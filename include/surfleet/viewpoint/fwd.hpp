// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the viewpoint room, for headers that only name its types.
#pragma once

#include <cstdint>

namespace surfleet {
class ChangedRegions;
struct ClusterOptions;
class HeadingTable;
struct IncompleteElement;
class IncompleteSurfaceGain;
struct IncompleteSurfaceOptions;
enum class LeftReason : std::uint8_t;
class LineOfSight;
class GainBound;
class ViewLedger;
struct ViewLedgerOptions;
class MapSight;
struct MergeOptions;
enum class NoViewReason : std::uint8_t;
struct PredictedPatch;
struct PredictionOptions;
struct Sighting;
class SightMemory;
struct SightOptions;
struct SightTarget;
class SpaceCells;
class FrontierViews;
struct StopDistance;
class UnknownVolumeGain;
struct UnknownVolumeOptions;
struct UnseenElement;
class Frontiers;
struct FrontierOptions;
class ViewAccess;
class ViewFrustum;
struct Viewpoint;
struct ViewpointChoice;
struct ViewpointCluster;
class ViewpointGenerator;
class ViewpointMemory;
struct ViewpointOptions;
struct ViewpointSet;
class GainAround;
}  // namespace surfleet
