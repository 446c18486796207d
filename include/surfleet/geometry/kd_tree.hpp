// SPDX-License-Identifier: MIT
/// @file
/// @brief A k-d tree over points in space: nearest, k nearest, all within a radius.
///
///     const KdTree tree(cloud.points);
///     if (const auto hit = tree.nearest(p)) use(hit->index, hit->distance());
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// A point found by a neighbour search. Ordered by distance, then index.
struct Neighbor {
  double distance2 = 0.0;  ///< Squared distance [m²].
  std::int32_t index = 0;  ///< In the points that the index was built from.
  double distance() const { return std::sqrt(distance2); }
  friend bool operator<(const Neighbor& a, const Neighbor& b) {
    return std::tie(a.distance2, a.index) < std::tie(b.distance2, b.index);
  }
  friend bool operator==(const Neighbor&, const Neighbor&) = default;
};

/// A balanced tree split at medians of the widest side, with buckets of up to 12 points.
///
/// Holds a copy of the points. Among equal distances the lower index wins, so results do not
/// depend on the tree. Build O(n log n), nearest typically O(log n). Points must be finite.
class KdTree {
 public:
  KdTree() = default;
  explicit KdTree(std::span<const Point3> points) : index_(points.size()) {
    std::iota(index_.begin(), index_.end(), 0);
    if (points.empty()) return;
    // Halved until a bucket holds it: as many leaves as there are at most, and their parents.
    nodes_.reserve(2 * std::bit_ceil((points.size() + kBucket - 1) / kBucket) - 1);
    nodes_.emplace_back();
    split(points, 0, 0, points.size());
    points_.reserve(points.size());
    for (const std::int32_t i : index_) points_.push_back(points[static_cast<std::size_t>(i)]);
  }

  std::size_t size() const { return points_.size(); }

  /// The nearest point within `max_distance` [m]; nothing if there is none.
  std::optional<Neighbor> nearest(
      const Point3& p, double max_distance = std::numeric_limits<double>::infinity()) const {
    Neighbor best{max_distance * max_distance, std::numeric_limits<std::int32_t>::max()};
    if (!nodes_.empty() && max_distance >= 0.0)
      visit(
          0, p, [&] { return best.distance2; },
          [&](const Neighbor& n) {
            if (n < best) best = n;
          });
    if (best.index == std::numeric_limits<std::int32_t>::max()) return std::nullopt;
    return best;
  }

  /// The `k` nearest points, or all if there are fewer, nearest first.
  std::vector<Neighbor> k_nearest(const Point3& p, std::size_t k) const {
    std::vector<Neighbor> heap;
    if (k == 0 || nodes_.empty()) return heap;
    heap.reserve(std::min(k, size()) + 1);
    visit(
        0, p,
        [&] {
          return heap.size() < k ? std::numeric_limits<double>::infinity() : heap.front().distance2;
        },
        [&](const Neighbor& n) {
          if (heap.size() == k) {
            if (!(n < heap.front())) return;
            std::pop_heap(heap.begin(), heap.end());
            heap.pop_back();
          }
          heap.push_back(n);
          std::push_heap(heap.begin(), heap.end());
        });
    std::sort_heap(heap.begin(), heap.end());
    return heap;
  }

  /// All points at most `radius` [m] away, nearest first.
  std::vector<Neighbor> within(const Point3& p, double radius) const {
    std::vector<Neighbor> found;
    for_each_within(p, radius, [&](const Neighbor& n) { found.push_back(n); });
    std::sort(found.begin(), found.end());
    return found;
  }

  /// Calls `use(neighbor)` for every point at most `radius` [m] away, in no particular order but
  /// always the same.
  template <typename Use>
  void for_each_within(const Point3& p, double radius, Use&& use) const {
    if (nodes_.empty() || !(radius >= 0.0)) return;
    const double radius2 = radius * radius;
    visit(
        0, p, [&] { return radius2; },
        [&](const Neighbor& n) {
          if (n.distance2 <= radius2) use(n);
        });
  }

 private:
  static constexpr std::size_t kBucket = 12;
  struct Node {
    Box3 box;
    std::uint32_t begin = 0, end = 0;  // its points
    std::uint32_t child = 0;           // the left one, the right one after it; 0 in a leaf
  };

  void split(std::span<const Point3> points, std::uint32_t at, std::size_t begin, std::size_t end) {
    Box3 box;
    for (std::size_t i = begin; i < end; ++i)
      box.extend(points[static_cast<std::size_t>(index_[i])]);
    nodes_[at].box = box;
    nodes_[at].begin = static_cast<std::uint32_t>(begin);
    nodes_[at].end = static_cast<std::uint32_t>(end);
    if (end - begin <= kBucket) return;
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto iterator = [&](std::size_t i) {
      return index_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(iterator(begin), iterator(middle), iterator(end),
                     [&](std::int32_t a, std::int32_t b) {
                       const double x = points[static_cast<std::size_t>(a)][axis];
                       const double y = points[static_cast<std::size_t>(b)][axis];
                       return x != y ? x < y : a < b;
                     });
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_[at].child = child;
    nodes_.resize(nodes_.size() + 2);
    split(points, child, begin, middle);
    split(points, child + 1, middle, end);
  }

  template <typename Bound, typename Use>
  void visit(std::uint32_t at, const Point3& p, const Bound& bound2, const Use& use) const {
    const Node& node = nodes_[at];
    if (node.child == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        use(Neighbor{(points_[i] - p).squaredNorm(), index_[i]});
      return;
    }
    const double left = nodes_[node.child].box.squaredExteriorDistance(p);
    const double right = nodes_[node.child + 1].box.squaredExteriorDistance(p);
    const bool left_first = left <= right;
    const double near = left_first ? left : right, far = left_first ? right : left;
    if (near <= bound2()) visit(node.child + (left_first ? 0U : 1U), p, bound2, use);
    if (far <= bound2()) visit(node.child + (left_first ? 1U : 0U), p, bound2, use);
  }

  std::vector<Point3> points_;       // in leaf order
  std::vector<std::int32_t> index_;  // the caller's index of each entry of points_
  std::vector<Node> nodes_;
};
}  // namespace surfleet
