// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the allocation room, for headers that only name its types.
#pragma once

namespace surfleet {
struct AlreadyAssigned;
struct Assignment;
class CheapestInsertion;
class CostMatrix;
struct ExactTour;
struct ExponentialUtility;
struct FleetPlan;
struct HamiltonianPath;
struct LinKernighan;
struct Route;
struct ThreeOpt;
struct Tour;
struct TourProblem;
struct TourSearch;
struct TsplibInstance;
}  // namespace surfleet
