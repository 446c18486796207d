// SPDX-License-Identifier: MIT
/// @file
/// @brief A lattice of flyable positions, searched outward from a robot.
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
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
/// Positions on a regular lattice over a box, joined to their 26 neighbours where the straight
/// flight between them is free. Nodes and edges are judged when a search first meets them, and the
/// verdicts serve later searches until the space changes there.
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
      : free_(&free), spacing_(spacing) {
    for (int i = 0; i < 3; ++i)
      count_[i] = std::max(1, static_cast<int>(std::floor(bounds.sizes()[i] / spacing)) + 1);
    // The lattice is centred in the box.
    for (int i = 0; i < 3; ++i)
      origin_[i] = bounds.min()[i] + 0.5 * (bounds.sizes()[i] - (count_[i] - 1) * spacing);
    nodes_.resize(size());
    for_each_index(VoxelIndex::Constant(-1), VoxelIndex::Ones(), [&](const VoxelIndex& step) {
      if (step.isZero()) return;
      const int direction = (step.x() + 1) + 3 * ((step.y() + 1) + 3 * (step.z() + 1));
      const double length = spacing * std::sqrt(static_cast<double>(step.squaredNorm()));
      steps_.push_back(
          {step, spacing * step.cast<double>(), length, direction, index(step) - index({0, 0, 0})});
    });
  }

  Point3 position(const VoxelIndex& c) const { return origin_ + c.cast<double>() * spacing_; }
  /// The lattice's place nearest to `p`; outside the box it may be no node.
  VoxelIndex nearest(const Point3& p) const {
    return ((p - origin_) / spacing_).array().round().cast<int>();
  }
  const Free& space() const { return *free_; }
  double spacing() const { return spacing_; }
  VoxelIndex count() const { return count_; }  ///< Nodes along each axis.
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

  /// Forgets the verdicts that what has changed in a box may have overturned. O(nodes beside it).
  void forget(const Box3& box) {
    if (box.isEmpty()) return;
    // An edge ends within a step of the node it is kept with.
    const Eigen::Array3d step = Eigen::Array3d::Constant(spacing_);
    const Eigen::Array3d most = (count_ - VoxelIndex::Ones()).cast<double>().array();
    const auto inside = [&](const Eigen::Array3d& c) {
      return VoxelIndex(c.max(0.0).min(most).cast<int>());
    };
    const Eigen::Array3d low = ((box.min() - origin_).array() - step) / spacing_;
    const Eigen::Array3d high = ((box.max() - origin_).array() + step) / spacing_;
    if ((high < 0.0).any() || (low > most).any()) return;
    for_each_index(inside(low.floor()), inside(high.ceil()),
                   [&](const VoxelIndex& c) { nodes_[index(c)] = {}; });
  }

  /// Whether the body is free at a node of the lattice. O(1) from the second time on.
  bool is_free(const VoxelIndex& c) { return is_free(c, index(c)); }

  /// Says that there are no paths but along the lattice.
  struct LatticeOnly {};
  /// Says that a step costs its length.
  struct StepLength {
    double operator()(const Eigen::Vector3d& /*step*/, const VoxelIndex& /*to*/,
                      double length) const {
      return length;
    }
  };

  /// Calls `visit(const Site&)` for the reachable nodes in the order of their distance from
  /// `start` until it returns false. O(visited · log visited).
  ///
  /// When that is done, goes on beyond passages too narrow for the lattice, if told of passages
  /// there: `passages(Point3)` is the length of a path through one from `start` to a free node,
  /// infinite where there is none [m]. Of each part of the lattice that was not met it is asked
  /// about the nodes nearest to `start`, until there is one; what was not met is visited in the
  /// order of the distance, too.
  ///
  /// `cost(step, to, length)` says what a step to a free node counts as, its length or more [m].
  template <typename Visit, typename Passages = LatticeOnly, typename Cost = StepLength>
  void search(const Point3& start, Visit&& visit, Passages&& passages = {}, Cost&& cost = {}) {
    struct Entry {
      double distance;
      std::size_t index;
      bool operator>(const Entry& o) const {
        return distance != o.distance ? distance > o.distance : index > o.index;
      }
    };
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    std::vector<float> best(size(), std::numeric_limits<float>::infinity());
    std::vector<std::uint8_t> closed(size(), 0);
    came_by_.assign(size(), kSelf);
    // Enter the lattice at every node near the start that can be flown to in a straight line.
    const VoxelIndex home = nearest(start);
    for (int r = 1; r <= 3 && open.empty(); ++r)
      for (int z = -r; z <= r; ++z)
        for (int y = -r; y <= r; ++y)
          for (int x = -r; x <= r; ++x) {
            const VoxelIndex c = home + VoxelIndex(x, y, z);
            if (!contains(c)) continue;
            const std::size_t i = index(c);
            const Point3 p = position(c);
            if (!is_free(c, i) || !free_->is_free_segment(start, p)) continue;
            const double d = cost(p - start, c, (p - start).norm());
            best[i] = static_cast<float>(d);
            open.push({d, i});
          }
    const auto expand = [&] {
      while (!open.empty()) {
        const Entry e = open.top();
        open.pop();
        if (closed[e.index] != 0) continue;
        closed[e.index] = 1;
        const VoxelIndex cell = cell_of(e.index);
        if (!visit(Site{cell, position(cell), e.distance})) return false;
        const bool inner = (cell.array() > 0).all() && (cell.array() < count_.array() - 1).all();
        for (const Step& step : steps_) {
          if (!inner && !contains(cell + step.cells)) continue;
          const std::size_t i = e.index + step.offset;
          if (closed[i] != 0 || static_cast<float>(e.distance + step.length) >= best[i]) continue;
          const VoxelIndex c = cell + step.cells;
          if (!is_free(c, i)) continue;
          const double d = e.distance + cost(step.vector, c, step.length);
          if (static_cast<float>(d) >= best[i] || !is_free_edge(cell, e.index, c, step.direction))
            continue;
          best[i] = static_cast<float>(d);
          came_by_[i] = static_cast<std::uint8_t>(step.direction);
          open.push({d, i});
        }
      }
      return true;
    };
    if (!expand()) return;
    if constexpr (!std::same_as<std::remove_cvref_t<Passages>, LatticeOnly>) {
      for (const auto& [i, distance] : entrances(start, closed, passages)) {
        best[i] = static_cast<float>(distance);
        open.push({distance, i});
      }
      expand();
    }
  }
  /// The nodes by which the last search came to a node it visited, from where it entered the
  /// lattice to the node itself.
  std::vector<VoxelIndex> path_to(VoxelIndex c) const {
    std::vector<VoxelIndex> path{c};
    for (int by = came_by_[index(c)]; by != kSelf; by = came_by_[index(c)]) {
      c -= VoxelIndex(by % 3 - 1, by / 3 % 3 - 1, by / 9 - 1);
      path.push_back(c);
    }
    std::reverse(path.begin(), path.end());
    return path;
  }

 private:
  static constexpr int kSelf = 13;  // the middle one of 27 directions
  struct Step {
    VoxelIndex cells;
    Eigen::Vector3d vector;  // [m]
    double length;           // [m]
    int direction;
    std::size_t offset;  // of the index, modulo its range
  };
  VoxelIndex cell_of(std::size_t i) const {
    const auto nx = static_cast<std::size_t>(count_.x()), ny = static_cast<std::size_t>(count_.y());
    return {static_cast<int>(i % nx), static_cast<int>(i / nx % ny), static_cast<int>(i / nx / ny)};
  }
  /// What is known of a node and of the edges that leave it, a bit each by direction.
  struct Node {
    std::uint32_t judged = 0, free = 0;
  };
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
  /// A node, and its distance from the start, for each part of the lattice beyond those that are
  /// `closed`. O(nodes · log nodes).
  template <typename Passages>
  std::vector<std::pair<std::size_t, double>> entrances(const Point3& start,
                                                        std::span<const std::uint8_t> closed,
                                                        Passages&& passages) {
    std::vector<std::pair<double, std::size_t>> rest;
    for (std::size_t i = 0; i < closed.size(); ++i)
      if (const VoxelIndex c = cell_of(i); closed[i] == 0 && is_free(c, i))
        rest.emplace_back((position(c) - start).norm(), i);
    std::sort(rest.begin(), rest.end());
    std::vector<std::uint8_t> joined(closed.begin(), closed.end());
    std::vector<std::pair<std::size_t, double>> found;
    for (const auto& [away, i] : rest) {
      if (joined[i] != 0) continue;
      const double distance = passages(position(cell_of(i)));
      if (!std::isfinite(distance)) continue;
      found.emplace_back(i, distance);
      join(i, joined);
    }
    return found;
  }
  /// Marks all that the lattice joins to a node.
  void join(std::size_t first, std::vector<std::uint8_t>& joined) {
    joined[first] = 1;
    for (std::vector<std::size_t> part{first}; !part.empty();) {
      const std::size_t from = part.back();
      const VoxelIndex cell = cell_of(from);
      part.pop_back();
      for (const Step& step : steps_) {
        const VoxelIndex c = cell + step.cells;
        const std::size_t to = from + step.offset;
        if (!contains(c) || joined[to] != 0 || !is_free(c, to) ||
            !is_free_edge(cell, from, c, step.direction))
          continue;
        joined[to] = 1;
        part.push_back(to);
      }
    }
  }
  bool contains(const VoxelIndex& c) const {
    return (c.array() >= 0).all() && (c.array() < count_.array()).all();
  }
  bool is_free(const VoxelIndex& c, std::size_t i) {
    return verdict(i, kSelf, [&] { return free_->is_free(position(c)); });
  }
  bool is_free_edge(const VoxelIndex& from, std::size_t i, const VoxelIndex& to, int direction) {
    return verdict(i, direction,
                   [&] { return free_->is_free_segment(position(from), position(to)); });
  }

  const Free* free_;
  double spacing_;
  VoxelIndex count_ = VoxelIndex::Ones();
  Point3 origin_ = Point3::Zero();
  std::vector<Step> steps_;
  std::vector<Node> nodes_;
  std::vector<std::uint8_t> came_by_;  // the last search's step to each node; kSelf: none
};
}  // namespace surfleet
