// SPDX-License-Identifier: MIT
/// @file
/// @brief Paths through what is not known to be blocked: the freespace assumption.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/motion/free_space.hpp>

namespace surfleet {
struct OptimisticLatticeOptions {
  /// What a metre through unknown space costs, level and straight up, 1 or more: there the path has
  /// to be opened by views, and a level camera sees little of what is above it.
  double level_cost = 1.1, climb_cost = 3.0;
};

/// A flight lattice that takes what is unknown for free; what is known to be free is free there.
///
/// Robots fly only where they have seen nothing, so a planner confined to known space sends them
/// along it, and again at the next height when that is open. A goal that is chosen in optimism
/// leads there by the shortest path that may exist; what is flown of it is what is known, and the
/// next view opens more. Copies know nothing: a copy is for another map.
class OptimisticLattice {
 public:
  OptimisticLatticeOptions options;

  explicit OptimisticLattice(OptimisticLatticeOptions o = {}) : options(o) {
    require(o.level_cost >= 1.0 && o.climb_cost >= 1.0,
            "optimistic lattice: expected unknown space to cost no less than known");
  }
  OptimisticLattice(const OptimisticLattice& other) : options(other.options) {}
  OptimisticLattice& operator=(const OptimisticLattice& other) {
    options = other.options;
    follow_.reset();
    return *this;
  }
  OptimisticLattice(OptimisticLattice&&) = default;
  OptimisticLattice& operator=(OptimisticLattice&&) = default;
  ~OptimisticLattice() = default;

  /// Takes over the map, the body and the bounds of `space` as they are now, with nodes where a
  /// lattice of that space has them. O(blocks changed since the last call), all of them at the
  /// first.
  void follow(const FreeSpace& space, double spacing) {
    if (!follow_ || follow_->real != &space || follow_->lattice.spacing() != spacing)
      follow_ = std::make_unique<Follow>(space, spacing);
    FreeSpace& own = follow_->space;
    own.update();
    for (const std::uint32_t slot : own.changed_since(follow_->cursor))
      follow_->lattice.forget(own.influence(slot));
    follow_->cursor = own.revision();
  }

  /// Calls `visit(site, known)` for the nodes that may be reached, in the order of what it costs to
  /// get there (`site.distance`) until it returns false; `known` is the lattice of the space itself
  /// and decides what a step costs. For `passages` see `FlightLattice`. Call `follow` first.
  template <typename Visit, typename Passages = FlightLattice<FreeSpace>::LatticeOnly>
  void search(const Point3& start, FlightLattice<FreeSpace>& known, Visit&& visit,
              Passages&& passages = {}) {
    const auto cost = [&](const Eigen::Vector3d& step, const VoxelIndex& to, double length) {
      if (known.is_free(to)) return length;
      const double x = options.level_cost * step.x(), y = options.level_cost * step.y(),
                   z = options.climb_cost * step.z();
      return std::sqrt(x * x + y * y + z * z);
    };
    follow_->lattice.search(
        start, [&](const auto& site) { return visit(site, known.is_free(site.cell)); },
        std::forward<Passages>(passages), cost);
  }
  /// The path by which the last search came to a node it visited.
  std::vector<VoxelIndex> path_to(const VoxelIndex& cell) const {
    return follow_->lattice.path_to(cell);
  }

 private:
  struct Follow {
    Follow(const FreeSpace& s, double spacing)
        : real(&s),
          space(s.map(), optimistic(s.options())),
          lattice(space, s.options().bounds, spacing) {
      cursor = space.revision();
    }
    static FreeSpaceOptions optimistic(FreeSpaceOptions o) {
      o.unknown_is_obstacle = o.all_blocks = false;
      return o;
    }
    const FreeSpace* real;
    FreeSpace space;
    FlightLattice<FreeSpace> lattice;
    std::uint64_t cursor = 0;
  };
  std::unique_ptr<Follow> follow_;
};
}  // namespace surfleet
