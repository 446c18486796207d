// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the localization room, for headers that only name its types.
#pragma once

namespace surfleet {
struct Blob;
struct BlobOptions;
struct Circle;
struct Identification;
struct IdentifyOptions;
struct KneipP3p;
struct LambdaTwistP3p;
struct MarkerTarget;
struct Observation;
struct NelderMeadOptions;
class P3pSolutions;
struct RefinedPose;
struct RefineOptions;
struct TargetDesign;
struct TargetDesignOptions;
struct TargetFit;
struct TargetQuality;
struct TrackedFrame;
struct TrackerOptions;
struct UncertainPose;
}  // namespace surfleet
