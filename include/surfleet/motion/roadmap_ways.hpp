// SPDX-License-Identifier: MIT
/// @file
/// @brief The ways of a roadmap that lead beyond what a lattice joins.
#pragma once

#include <limits>

#include <surfleet/core/types.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/motion/reachable_set.hpp>

namespace surfleet {
/// How long the ways from one place are, for a `FlightLattice` of the roadmap's space to go on
/// beyond passages too narrow for it. The roadmap must outlive it; holds until the space changes.
class RoadmapWays {
 public:
  RoadmapWays(const LazyPrmStar& roadmap, const Point3& start)
      : roadmap_(&roadmap), reach_(roadmap.reach_from(start)) {}

  /// Infinite where there is none, which is told in O(1) [m].
  double operator()(const Point3& to) const {
    const auto path = reach_(to) ? roadmap_->query(reach_.start(), to) : std::nullopt;
    return path ? path->length : std::numeric_limits<double>::infinity();
  }

 private:
  const LazyPrmStar* roadmap_;
  ReachFrom reach_;
};
}  // namespace surfleet
