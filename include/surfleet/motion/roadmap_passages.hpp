// SPDX-License-Identifier: MIT
/// @file
/// @brief The passages of a roadmap that lead beyond what a lattice joins.
#pragma once

#include <limits>
#include <utility>

#include <surfleet/core/types.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/motion/reachable_set.hpp>

namespace surfleet {
/// Lengths of the roadmap's paths from one place, for a `FlightLattice` of its space to go on
/// beyond passages too narrow for the lattice. The roadmap must outlive it; holds until the space
/// changes.
class RoadmapPassages {
 public:
  RoadmapPassages(const LazyPrmStar& roadmap, ReachFrom reach)
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
