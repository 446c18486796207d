// SPDX-License-Identifier: MIT
/// @file  A lattice of flyable positions, searched outward from a robot.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <type_traits>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
/// Positions on a regular lattice over a box, joined to their 26 neighbours where the straight
/// flight between them is free. Nodes and edges are judged when a search first meets them, and the
/// verdicts serve later searches: a lattice is for one state of the map.
template <typename Free>
class FlightLattice {
 public:
  /// A node reached by a search.
  struct Site {
    VoxelIndex cell;
    Point3 position;
    double distance;  ///< Along the lattice from the start [m].
  };

  /// `free` offers `is_free(Point3)` and `is_free_segment(Point3, Point3)`. Spacing in metres.
  FlightLattice(const Free& free, const Box3& bounds, double spacing)
      : free_(&free), bounds_(bounds), spacing_(spacing) {
    for (int i = 0; i < 3; ++i)
      count_[i] = std::max(1, static_cast<int>(std::floor(bounds.sizes()[i] / spacing)) + 1);
    // The lattice is centred in the box.
    for (int i = 0; i < 3; ++i)
      origin_[i] = bounds.min()[i] + 0.5 * (bounds.sizes()[i] - (count_[i] - 1) * spacing);
    nodes_.resize(size());
  }

  Point3 position(const VoxelIndex& c) const { return origin_ + c.cast<double>() * spacing_; }
  /// The lattice's place nearest to `p`; outside the box it may be no node.
  VoxelIndex nearest(const Point3& p) const {
    return ((p - origin_) / spacing_).array().round().cast<int>();
  }
  double spacing() const { return spacing_; }
  std::size_t index(const VoxelIndex& c) const {
    return (static_cast<std::size_t>(c.z()) * static_cast<std::size_t>(count_.y()) +
            static_cast<std::size_t>(c.y())) *
               static_cast<std::size_t>(count_.x()) +
           static_cast<std::size_t>(c.x());
  }
  std::size_t size() const {
    return static_cast<std::size_t>(count_.x()) * static_cast<std::size_t>(count_.y()) *
           static_cast<std::size_t>(count_.z());
  }

  /// Says that there is no way but along the lattice.
  struct LatticeOnly {};

  /// Calls `visit(const Site&)` for the reachable nodes in the order of their distance from
  /// `start` until it returns false. O(visited · log visited).
  ///
  /// When that is done, goes on beyond passages too narrow for the lattice, if told of ways there:
  /// `ways(std::span<const Point3>)` gives the lengths of the ways from `start` to the free nodes
  /// that were not met, infinite where there is none [m]. It is called once at most.
  template <typename Visit, typename Ways = LatticeOnly>
  void search(const Point3& start, Visit&& visit, Ways&& ways = {}) {
    struct Entry {
      double distance;
      std::size_t index;
      VoxelIndex cell;
      bool operator>(const Entry& o) const {
        return distance != o.distance ? distance > o.distance : index > o.index;
      }
    };
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    std::vector<float> best(size(), std::numeric_limits<float>::infinity());
    std::vector<std::uint8_t> closed(size(), 0);
    const auto inside = [&](const VoxelIndex& c) {
      return (c.array() >= 0).all() && (c.array() < count_.array()).all();
    };
    // Enter the lattice at every node near the start that can be flown to in a straight line.
    const VoxelIndex home = nearest(start);
    for (int r = 1; r <= 3 && open.empty(); ++r)
      for (int z = -r; z <= r; ++z)
        for (int y = -r; y <= r; ++y)
          for (int x = -r; x <= r; ++x) {
            const VoxelIndex c = home + VoxelIndex(x, y, z);
            if (!inside(c)) continue;
            const std::size_t i = index(c);
            const Point3 p = position(c);
            if (!is_free(c, i) || !free_->is_free_segment(start, p)) continue;
            const double d = (p - start).norm();
            best[i] = static_cast<float>(d);
            open.push({d, i, c});
          }
    const auto expand = [&] {
      while (!open.empty()) {
        const Entry e = open.top();
        open.pop();
        if (closed[e.index] != 0) continue;
        closed[e.index] = 1;
        if (!visit(Site{e.cell, position(e.cell), e.distance})) return false;
        for (int z = -1; z <= 1; ++z)
          for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
              const VoxelIndex step(x, y, z), c = e.cell + step;
              if (step.isZero() || !inside(c)) continue;
              const std::size_t i = index(c);
              if (closed[i] != 0) continue;
              const double d =
                  e.distance + spacing_ * std::sqrt(static_cast<double>(step.squaredNorm()));
              if (static_cast<float>(d) >= best[i] || !is_free(c, i)) continue;
              if (!is_free_edge(e.cell, e.index, c, (x + 1) + 3 * ((y + 1) + 3 * (z + 1))))
                continue;
              best[i] = static_cast<float>(d);
              open.push({d, i, c});
            }
      }
      return true;
    };
    if (!expand()) return;
    if constexpr (!std::same_as<std::remove_cvref_t<Ways>, LatticeOnly>) {
      // What the lattice does not join to the start.
      std::vector<VoxelIndex> rest;
      std::vector<Point3> places;
      for (int z = 0; z < count_.z(); ++z)
        for (int y = 0; y < count_.y(); ++y)
          for (int x = 0; x < count_.x(); ++x) {
            const VoxelIndex c(x, y, z);
            const std::size_t i = index(c);
            if (closed[i] != 0 || !is_free(c, i)) continue;
            rest.push_back(c);
            places.push_back(position(c));
          }
      if (rest.empty()) return;
      const std::vector<double> lengths = ways(std::span<const Point3>(places));
      for (std::size_t k = 0; k < rest.size(); ++k)
        if (std::isfinite(lengths[k])) open.push({lengths[k], index(rest[k]), rest[k]});
      expand();
    }
  }

 private:
  /// What is known of a node and of the edges that leave it, a bit each by direction.
  struct Node {
    std::uint32_t judged = 0, free = 0;
  };
  static constexpr int kSelf = 13;  // the middle one of 27 directions
  template <typename Ask>
  bool verdict(std::size_t i, int bit, Ask&& ask) {
    Node& n = nodes_[i];
    const std::uint32_t mask = std::uint32_t{1} << bit;
    if ((n.judged & mask) == 0) {
      n.judged |= mask;
      if (ask()) n.free |= mask;
    }
    return (n.free & mask) != 0;
  }
  bool is_free(const VoxelIndex& c, std::size_t i) {
    return verdict(i, kSelf, [&] { return free_->is_free(position(c)); });
  }
  bool is_free_edge(const VoxelIndex& from, std::size_t i, const VoxelIndex& to, int direction) {
    return verdict(i, direction,
                   [&] { return free_->is_free_segment(position(from), position(to)); });
  }

  const Free* free_;
  Box3 bounds_;
  double spacing_;
  VoxelIndex count_ = VoxelIndex::Ones();
  Point3 origin_ = Point3::Zero();
  std::vector<Node> nodes_;
};
}  // namespace surfleet
