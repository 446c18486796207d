// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the localization room, for headers that only name its types.
#pragma once

namespace surfleet {
struct Identification;
struct IdentifyOptions;
struct KneipP3p;
struct LambdaTwistP3p;
struct MarkerTarget;
struct Observation;
class P3pSolutions;
struct RefinedPose;
struct RefineOptions;
struct TargetFit;
struct UncertainPose;
}  // namespace surfleet
