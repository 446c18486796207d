// SPDX-License-Identifier: MIT
/// @file
/// @brief The ways of a roadmap that lead beyond what a lattice joins.
#pragma once

#include <limits>
#include <utility>

#include <surfleet/core/types.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/motion/reachable_set.hpp>

namespace surfleet {
/// How long the ways from one place are, for a `FlightLattice` of the roadmap's space to go on
/// beyond passages too narrow for it. The roadmap must outlive it; holds until the space changes.
class RoadmapWays {
 public:
  RoadmapWays(const LazyPrmStar& roadmap, ReachFrom reach)
      : roadmap_(&roadmap), reach_(std::move(reach)) {}

  /// Infinite where there is none, which is told in O(1) of what is not free [m].
  double operator()(const Point3& to) const {
    const auto path = roadmap_->query(reach_, to);
    return path ? path->length : std::numeric_limits<double>::infinity();
  }

 private:
  const LazyPrmStar* roadmap_;
  ReachFrom reach_;
};
}  // namespace surfleet
