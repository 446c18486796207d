// SPDX-License-Identifier: MIT
/// @file
/// @brief Shortest paths inside a polygon with holes.
///
/// ```cpp
/// const PolygonGeodesics geodesics{floor_plan};
/// const GeodesicField from_door = geodesics.from(door);
/// const double metres = from_door.distance(desk);
/// ```
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/polygon.hpp>
#include <surfleet/geometry/polygon_visibility.hpp>

namespace surfleet {
class GeodesicField;

/// The reduced visibility graph of a polygon: its reflex corners, joined where they see each other.
/// Exact up to rounding. Building it is O(r² n) with r reflex corners and n vertices.
class PolygonGeodesics {
 public:
  explicit PolygonGeodesics(Polygon polygon) : polygon_(std::move(polygon)) {
    for (std::size_t r = 0; r < polygon_.rings(); ++r) {
      const Ring& ring = polygon_.ring(r);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point2 &before = ring[(i + ring.size() - 1) % ring.size()], &at = ring[i],
                     &after = ring[(i + 1) % ring.size()];
        if (turn(before, at, after) < 0) corners_.push_back({at, before, after});
      }
    }
    std::vector<std::pair<std::int32_t, Arc>> arcs;
    for (std::size_t i = 0; i < corners_.size(); ++i)
      for (std::size_t j = i + 1; j < corners_.size(); ++j) {
        const Point2 &a = corners_[i].at, &b = corners_[j].at;
        if (!tangent(corners_[i], b) || !tangent(corners_[j], a) || !sees(polygon_, a, b)) continue;
        const double length = (b - a).norm();
        arcs.push_back({static_cast<std::int32_t>(i), {static_cast<std::int32_t>(j), length}});
        arcs.push_back({static_cast<std::int32_t>(j), {static_cast<std::int32_t>(i), length}});
      }
    graph_ = Graph(corners_.size(), arcs);
  }
  const Polygon& polygon() const { return polygon_; }
  std::size_t corners() const { return corners_.size(); }
  const Point2& corner(std::size_t i) const { return corners_[i].at; }
  const Graph& graph() const { return graph_; }
  /// Whether a shortest path may bend at corner `i` on a line to or from `p`.
  bool tangent_at(std::size_t i, const Point2& p) const { return tangent(corners_[i], p); }
  /// Shortest paths from `source`; this object must outlive the result. O(r n + r² log r).
  GeodesicField from(const Point2& source) const;

 private:
  struct Corner {
    Point2 at, before, after;
  };
  /// A line through a reflex corner supports a shortest path only if it leaves both edges on one
  /// side; a line that runs into the wedge between them can always be shortened.
  static bool tangent(const Corner& c, const Point2& p) {
    const int s = turn(p, c.at, c.before), t = turn(p, c.at, c.after);
    return s * t >= 0;
  }
  Polygon polygon_;
  std::vector<Corner> corners_;
  Graph graph_;
};

/// Distances and paths to one point of the polygon.
class GeodesicField {
 public:
  GeodesicField(const PolygonGeodesics& solver, const Point2& source)
      : solver_(&solver), source_(source) {
    std::vector<Source> seeds;
    for (std::size_t i = 0; i < solver.corners(); ++i)
      if (solver.tangent_at(i, source) && sees(solver.polygon(), source, solver.corner(i)))
        seeds.emplace_back(static_cast<std::int32_t>(i), (solver.corner(i) - source).norm());
    paths_ = shortest_paths(solver.graph(), seeds);
  }
  const Point2& source() const { return source_; }

  /// Along the shortest path [m]; infinite if there is none, as for a point outside. O(r n).
  double distance(const Point2& q) const { return last_corner(q).second; }
  /// From the source to `q`, both included; empty if there is none.
  std::vector<Point2> path(const Point2& q) const {
    const auto [corner, length] = last_corner(q);
    std::vector<Point2> points;
    if (length == ShortestPaths::kUnreached) return points;
    points.push_back(source_);
    if (corner >= 0)
      for (const std::int32_t c : paths_.path(corner))
        points.push_back(solver_->corner(static_cast<std::size_t>(c)));
    points.push_back(q);
    return points;
  }
  /// Where the transformation to the star-shaped domain of the source takes `q` [004 Def. 5.1]: as
  /// far away as the path is long, in the direction in which the path sets out. `q` must be
  /// reachable.
  Point2 star_image(const Point2& q) const {
    const std::vector<Point2> p = path(q);
    for (std::size_t i = 1; i < p.size(); ++i) {
      const Point2 w = p[i] - source_;
      if (w.norm() > 0.0) return p.size() == 2 ? q : Point2(source_ + distance(q) * w.normalized());
    }
    return q;
  }

 private:
  /// The corner before `q` (−1: none) and the length of the path.
  std::pair<std::int32_t, double> last_corner(const Point2& q) const {
    if (sees(solver_->polygon(), source_, q)) return {-1, (q - source_).norm()};
    std::vector<std::pair<double, std::int32_t>> order;
    for (std::size_t i = 0; i < solver_->corners(); ++i)
      if (paths_.distance[i] < ShortestPaths::kUnreached && solver_->tangent_at(i, q))
        order.emplace_back(paths_.distance[i] + (q - solver_->corner(i)).norm(),
                           static_cast<std::int32_t>(i));
    std::sort(order.begin(), order.end());
    for (const auto& [length, i] : order)
      if (sees(solver_->polygon(), solver_->corner(static_cast<std::size_t>(i)), q))
        return {i, length};
    return {-1, ShortestPaths::kUnreached};
  }
  const PolygonGeodesics* solver_;
  Point2 source_;
  ShortestPaths paths_;
};

inline GeodesicField PolygonGeodesics::from(const Point2& source) const {
  return GeodesicField(*this, source);
}

inline double path_length(std::span<const Point2> path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}
}  // namespace surfleet
