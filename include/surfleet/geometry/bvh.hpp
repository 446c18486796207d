// SPDX-License-Identifier: MIT
/// @file
/// @brief A bounding volume hierarchy over a triangle mesh: first hits of rays, nearest points.
///
///     const Bvh bvh(mesh);
///     if (const auto hit = bvh.cast(origin, direction, 100.0)) use(origin + hit->t * direction);
///     if (const auto near = bvh.closest_point(p, 5.0)) use(near->distance);
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/geometry/triangle_queries.hpp>

namespace surfleet {
/// The point of a mesh nearest to a query.
struct ClosestPoint {
  Point3 point = Point3::Zero();
  double distance = 0.0;      ///< [m]
  std::int32_t triangle = 0;  ///< One that holds the point; the lowest index among equals.
};

/// A hierarchy of axis-aligned boxes, split where the surface-area heuristic is least over 16
/// bins. It holds a copy of the corners, so the mesh need not live on. Any soup is fine; triangles
/// with a coordinate that is not finite are left out.
///
/// Build O(n log n); a query typically O(log n). Queries are const and safe from many threads.
class Bvh {
 public:
  Bvh() = default;
  explicit Bvh(const TriangleMesh& mesh) {
    std::vector<Build> items;
    items.reserve(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      Build item;
      bool finite = true;
      for (std::size_t k = 0; k < 3; ++k) {
        finite = finite && mesh.corner(t, k).allFinite();
        item.box.extend(mesh.corner(t, k));
      }
      if (!finite) continue;
      item.centre = item.box.center();
      item.triangle = static_cast<std::int32_t>(t);
      items.push_back(item);
    }
    const std::size_t n = items.size();
    if (n == 0) return;
    nodes_.reserve(2 * n / kLeaf + 2);
    nodes_.emplace_back();
    split(0, items, 0, n, 0);
    corners_.reserve(n);
    index_.reserve(n);
    for (const Build& item : items) {
      const auto t = static_cast<std::size_t>(item.triangle);
      corners_.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
      index_.push_back(item.triangle);
    }
  }

  /// Those that are held.
  std::size_t triangle_count() const { return index_.size(); }
  Box3 bounds() const { return nodes_.empty() ? Box3() : nodes_[0].box; }

  /// The first hit of a ray; the lowest triangle among exactly equal ones. See `RayCaster`.
  std::optional<RayHit> cast(const Point3& origin, const Eigen::Vector3d& direction,
                             double t_max = std::numeric_limits<double>::infinity()) const {
    if (nodes_.empty()) return std::nullopt;
    t_max = std::min(t_max, std::numeric_limits<double>::max());  // a missed box is at infinity
    const Eigen::Vector3d inverse = direction.cwiseInverse();
    std::optional<RayHit> best;
    std::array<std::pair<double, std::uint32_t>, kStack> stack;
    std::size_t top = 0;
    if (const double t = enter(nodes_[0].box, origin, inverse, t_max); t <= t_max)
      stack[top++] = {t, 0};
    while (top > 0) {
      const auto [entry, at] = stack[--top];
      if (entry > t_max) continue;
      const Node& node = nodes_[at];
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          const auto& [a, b, c] = corners_[i];
          const std::optional<double> t = intersect_triangle(origin, direction, a, b, c, t_max);
          if (!t || (best && *t == best->t && index_[i] > best->triangle)) continue;
          t_max = *t;
          best = RayHit{*t, index_[i]};
        }
        continue;
      }
      std::pair<double, std::uint32_t> near{enter(nodes_[node.first].box, origin, inverse, t_max),
                                            node.first};
      std::pair<double, std::uint32_t> far{
          enter(nodes_[node.first + 1].box, origin, inverse, t_max), node.first + 1};
      if (far.first < near.first) std::swap(near, far);
      if (far.first <= t_max) stack[top++] = far;
      if (near.first <= t_max) stack[top++] = near;
    }
    return best;
  }

  /// Calls `visit(t, triangle)` for every triangle that the ray meets, in no order.
  template <typename Visit>
  void for_each_hit(const Point3& origin, const Eigen::Vector3d& direction, double t_max,
                    Visit&& visit) const {
    if (nodes_.empty()) return;
    t_max = std::min(t_max, std::numeric_limits<double>::max());
    const Eigen::Vector3d inverse = direction.cwiseInverse();
    std::array<std::uint32_t, kStack> stack;
    std::size_t top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const Node& node = nodes_[stack[--top]];
      if (enter(node.box, origin, inverse, t_max) > t_max) continue;
      if (node.count == 0) {
        stack[top++] = node.first;
        stack[top++] = node.first + 1;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const auto& [a, b, c] = corners_[i];
        if (const auto t = intersect_triangle(origin, direction, a, b, c, t_max))
          visit(*t, index_[i]);
      }
    }
  }

  /// The nearest point of the mesh within `max_distance` [m] of `p`; nothing if there is none.
  std::optional<ClosestPoint> closest_point(
      const Point3& p, double max_distance = std::numeric_limits<double>::infinity()) const {
    return closest_point_where(p, max_distance, [](std::int32_t) { return true; });
  }

  /// The same among the triangles for which `accept(triangle)` is true. It is asked about those
  /// alone that would be the nearest so far; where few are accepted, the query visits all within
  /// `max_distance`.
  template <typename Accept>
  std::optional<ClosestPoint> closest_point_where(const Point3& p, double max_distance,
                                                  Accept&& accept) const {
    if (nodes_.empty() || !(max_distance >= 0.0)) return std::nullopt;
    double best2 = max_distance * max_distance;
    std::optional<ClosestPoint> best;
    std::array<std::pair<double, std::uint32_t>, kStack> stack;
    std::size_t top = 0;
    stack[top++] = {nodes_[0].box.squaredExteriorDistance(p), 0};
    while (top > 0) {
      const auto [box2, at] = stack[--top];
      if (box2 > best2) continue;
      const Node& node = nodes_[at];
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          const auto& [a, b, c] = corners_[i];
          const Point3 q = closest_on_triangle(p, a, b, c);
          const double d2 = (q - p).squaredNorm();
          if (d2 > best2 || (best && d2 == best2 && index_[i] > best->triangle)) continue;
          if (!accept(index_[i])) continue;
          best2 = d2;
          best = ClosestPoint{q, 0.0, index_[i]};
        }
        continue;
      }
      std::pair<double, std::uint32_t> near{nodes_[node.first].box.squaredExteriorDistance(p),
                                            node.first};
      std::pair<double, std::uint32_t> far{nodes_[node.first + 1].box.squaredExteriorDistance(p),
                                           node.first + 1};
      if (far.first < near.first) std::swap(near, far);
      if (far.first <= best2) stack[top++] = far;
      if (near.first <= best2) stack[top++] = near;
    }
    if (best) best->distance = std::sqrt(best2);
    return best;
  }

  /// Distance from `p` to the mesh [m]; infinite if the mesh is empty.
  double distance(const Point3& p) const {
    const auto near = closest_point(p);
    return near ? near->distance : std::numeric_limits<double>::infinity();
  }

 private:
  static constexpr std::size_t kLeaf = 4, kBins = 16, kStack = 128;
  static constexpr int kHeuristicDepth = 64;  // below it halves are equal, so depth stays < 64 + 32

  struct Node {
    Box3 box;
    std::uint32_t first = 0;  // its first triangle, or its left child with the right one after it
    std::uint32_t count = 0;  // triangles; none in an inner node
  };
  struct Build {
    Box3 box;
    Point3 centre;
    std::int32_t triangle = 0;
  };

  static double half_area(const Box3& b) {
    if (b.isEmpty()) return 0.0;
    const Eigen::Vector3d s = b.sizes();
    return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
  }

  /// Where the ray enters the box, infinite if it misses it. Slabs a ray lies in exactly are
  /// counted as hit.
  static double enter(const Box3& box, const Point3& origin, const Eigen::Vector3d& inverse,
                      double t_max) {
    double low = 0.0, high = t_max;
    for (int k = 0; k < 3; ++k) {
      double t0 = (box.min()[k] - origin[k]) * inverse[k];
      double t1 = (box.max()[k] - origin[k]) * inverse[k];
      if (t0 > t1) std::swap(t0, t1);
      // NaN (0 * inf: along a face) leaves the bounds alone.
      if (t0 > low) low = t0;
      if (t1 < high) high = t1;
    }
    constexpr double kSlack = 1.0 + 1e-12;  // covers rounding, here and in a triangle's own t
    return low <= high * kSlack ? std::min(low, t_max) : std::numeric_limits<double>::infinity();
  }

  void split(std::uint32_t at, std::vector<Build>& items, std::size_t begin, std::size_t end,
             int depth) {
    Box3 box, centres;
    for (std::size_t i = begin; i < end; ++i) {
      box.extend(items[i].box);
      centres.extend(items[i].centre);
    }
    nodes_[at].box = box;
    const std::size_t n = end - begin;
    if (n <= kLeaf) {
      nodes_[at].first = static_cast<std::uint32_t>(begin);
      nodes_[at].count = static_cast<std::uint32_t>(n);
      return;
    }
    const auto first = items.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = items.begin() + static_cast<std::ptrdiff_t>(end);
    std::size_t middle = begin;
    if (depth < kHeuristicDepth) {
      int best_axis = -1;
      std::size_t best_bin = 0;
      double best_cost = std::numeric_limits<double>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        const double extent = centres.sizes()[axis];
        if (!(extent > 0.0)) continue;
        std::array<Box3, kBins> boxes;
        std::array<std::size_t, kBins> counts{};
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t b = bin(items[i], axis, centres);
          boxes[b].extend(items[i].box);
          ++counts[b];
        }
        std::array<double, kBins> right_cost{};
        Box3 right;
        std::size_t right_count = 0;
        for (std::size_t b = kBins - 1; b > 0; --b) {
          right.extend(boxes[b]);
          right_count += counts[b];
          right_cost[b] = half_area(right) * static_cast<double>(right_count);
        }
        Box3 left;
        std::size_t left_count = 0;
        for (std::size_t b = 1; b < kBins; ++b) {
          left.extend(boxes[b - 1]);
          left_count += counts[b - 1];
          const double cost = half_area(left) * static_cast<double>(left_count) + right_cost[b];
          if (left_count > 0 && left_count < n && cost < best_cost) {
            best_cost = cost;
            best_axis = axis;
            best_bin = b;
          }
        }
      }
      if (best_axis >= 0) {
        const auto cut = std::partition(first, last, [&](const Build& item) {
          return bin(item, best_axis, centres) < best_bin;
        });
        middle = static_cast<std::size_t>(cut - items.begin());
      }
    }
    if (middle == begin || middle == end) {
      middle = begin + n / 2;
      int axis = 0;
      centres.sizes().maxCoeff(&axis);
      std::nth_element(first, items.begin() + static_cast<std::ptrdiff_t>(middle), last,
                       [axis](const Build& x, const Build& y) {
                         return x.centre[axis] != y.centre[axis] ? x.centre[axis] < y.centre[axis]
                                                                 : x.triangle < y.triangle;
                       });
    }
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_[at].first = child;
    nodes_.resize(nodes_.size() + 2);
    split(child, items, begin, middle, depth + 1);
    split(child + 1, items, middle, end, depth + 1);
  }

  static std::size_t bin(const Build& item, int axis, const Box3& centres) {
    const double extent = centres.sizes()[axis];
    const double x = (item.centre[axis] - centres.min()[axis]) / extent * double{kBins};
    return std::min(kBins - 1, static_cast<std::size_t>(std::max(x, 0.0)));
  }

  std::vector<Node> nodes_;
  std::vector<std::array<Point3, 3>> corners_;  // in leaf order
  std::vector<std::int32_t> index_;             // the mesh's triangle of each entry of corners_
};
static_assert(RayCaster<Bvh>);

/// How often a closed, outward oriented surface winds around `p`: 1 or more inside, 0 outside.
/// Overlapping parts add up. Counted along one slanted ray; meaningless for open meshes.
inline int winding_number(const Bvh& bvh, const TriangleMesh& mesh, const Point3& p) {
  const Eigen::Vector3d direction(0.0123456789, 0.0317281931, 0.9991234567);
  int winding = 0;
  bvh.for_each_hit(p, direction, std::numeric_limits<double>::infinity(),
                   [&](double, std::int32_t t) {
                     const Eigen::Vector3d n = mesh.area_vector(static_cast<std::size_t>(t));
                     winding += n.dot(direction) > 0.0 ? 1 : -1;
                   });
  return winding;
}
}  // namespace surfleet
