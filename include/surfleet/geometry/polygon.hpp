// SPDX-License-Identifier: MIT
/// @file
/// @brief The library's one polygon: an outer ring and holes, with its measures and its checks.
///
/// ```cpp
/// const Polygon room = make_polygon({{0, 0}, {5, 0}, {5, 3}, {0, 3}}, {{{2, 1}, {3, 1}, {2.5,
/// 2}}}); const double free_area = area(room);
/// ```
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/predicates.hpp>

namespace surfleet {
/// A closed chain of points; the last is joined to the first.
using Ring = std::vector<Point2>;

/// A bounded, closed, connected part of the plane. The outer ring runs counter-clockwise, holes run
/// clockwise: the inside is on the left of every edge. `make_polygon` sees to it.
struct Polygon {
  Ring outer;
  std::vector<Ring> holes;

  std::size_t rings() const { return 1 + holes.size(); }
  const Ring& ring(std::size_t i) const { return i == 0 ? outer : holes[i - 1]; }
  Ring& ring(std::size_t i) { return i == 0 ? outer : holes[i - 1]; }
  std::size_t vertices() const {
    std::size_t n = outer.size();
    for (const Ring& h : holes) n += h.size();
    return n;
  }
  Box2 bounds() const {
    Box2 box;
    for (const Point2& p : outer) box.extend(p);
    return box;
  }
};

/// A set of polygons with disjoint interiors, such as a Voronoi region cut up by obstacles.
using Region = std::vector<Polygon>;

/// Calls `f(a, b)` for every edge of the ring.
template <typename F>
void for_each_edge(const Ring& ring, F&& f) {
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) f(ring[j], ring[i]);
}
template <typename F>
void for_each_edge(const Polygon& polygon, F&& f) {
  for (std::size_t r = 0; r < polygon.rings(); ++r) for_each_edge(polygon.ring(r), f);
}

/// Positive for a counter-clockwise ring.
inline double signed_area(const Ring& ring) {
  if (ring.size() < 3) return 0.0;
  double twice = 0.0;
  const Point2 o = ring[0];
  for_each_edge(ring, [&](const Point2& a, const Point2& b) { twice += cross2(a - o, b - o); });
  return 0.5 * twice;
}
inline double perimeter(const Ring& ring) {
  double length = 0.0;
  for_each_edge(ring, [&](const Point2& a, const Point2& b) { length += (b - a).norm(); });
  return length;
}
inline double area(const Polygon& polygon) {
  double a = std::abs(signed_area(polygon.outer));
  for (const Ring& h : polygon.holes) a -= std::abs(signed_area(h));
  return a;
}
inline double area(const Region& region) {
  double a = 0.0;
  for (const Polygon& p : region) a += area(p);
  return a;
}

/// The centre of mass under uniform density; rings oriented as `make_polygon` leaves them.
inline Point2 centroid(const Polygon& polygon) {
  const Point2 o = polygon.outer.at(0);
  Point2 sum = Point2::Zero();
  double twice = 0.0;
  for_each_edge(polygon, [&](const Point2& a, const Point2& b) {
    const double c = cross2(a - o, b - o);
    twice += c;
    sum += c * ((a - o) + (b - o));
  });
  return o + sum / (3.0 * twice);
}

enum class Side { Outside, Boundary, Inside };

/// Where `p` lies with respect to the ring, of either orientation. Exact. O(n).
inline Side locate(const Ring& ring, const Point2& p) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Point2 &a = ring[j], &b = ring[i];
    const bool a_above = a.y() > p.y(), b_above = b.y() > p.y();
    if (a_above == b_above) {
      if (a.y() == p.y() && b.y() == p.y() && on_segment(a, b, p)) return Side::Boundary;
      if (b == p || a == p) return Side::Boundary;
      continue;
    }
    const int side = turn(a, b, p);
    if (side == 0) return Side::Boundary;
    if ((side > 0) == b_above) inside = !inside;
  }
  return inside ? Side::Inside : Side::Outside;
}
inline Side locate(const Polygon& polygon, const Point2& p) {
  const Side outer = locate(polygon.outer, p);
  if (outer != Side::Inside) return outer;
  for (const Ring& h : polygon.holes) {
    const Side s = locate(h, p);
    if (s == Side::Boundary) return Side::Boundary;
    if (s == Side::Inside) return Side::Outside;
  }
  return Side::Inside;
}
/// Whether `p` lies in the closed polygon. Exact. O(n).
inline bool contains(const Polygon& polygon, const Point2& p) {
  return locate(polygon, p) != Side::Outside;
}
inline bool contains(const Region& region, const Point2& p) {
  return std::any_of(region.begin(), region.end(),
                     [&](const Polygon& part) { return contains(part, p); });
}

/// A place on the boundary of a polygon.
struct BoundaryPoint {
  Point2 point = Point2::Zero();
  std::size_t ring = 0;  ///< 0 is the outer ring, i is hole i − 1.
  std::size_t edge = 0;  ///< From vertex `edge` of the ring to the next.
  double distance = std::numeric_limits<double>::infinity();  ///< From the point asked about.
};
/// The boundary point nearest to `p`; the first of several. O(n).
inline BoundaryPoint closest_boundary_point(const Polygon& polygon, const Point2& p) {
  BoundaryPoint best;
  for (std::size_t r = 0; r < polygon.rings(); ++r) {
    const Ring& ring = polygon.ring(r);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point2 q = closest_on_segment(ring[i], ring[(i + 1) % ring.size()], p);
      const double d = (q - p).norm();
      if (d < best.distance) best = {q, r, i, d};
    }
  }
  return best;
}
/// The point of the closed polygon nearest to `p`: the goal projection of [004 eq. 5.7].
inline Point2 project_into(const Polygon& polygon, const Point2& p) {
  return contains(polygon, p) ? p : closest_boundary_point(polygon, p).point;
}

namespace detail {
struct PolygonEdge {
  Point2 a, b;
  std::size_t ring, index, ring_size;
  double low() const { return std::min(a.x(), b.x()); }
  double high() const { return std::max(a.x(), b.x()); }
};
inline std::string ring_name(std::size_t ring) {
  return ring == 0 ? "the outer ring" : "hole " + std::to_string(ring - 1);
}
inline std::string edge_name(const PolygonEdge& e) {
  return "edge " + std::to_string(e.index) + " of " + ring_name(e.ring);
}
inline bool edges_conflict(const PolygonEdge& e, const PolygonEdge& f) {
  if (std::max(e.a.y(), e.b.y()) < std::min(f.a.y(), f.b.y()) ||
      std::max(f.a.y(), f.b.y()) < std::min(e.a.y(), e.b.y()))
    return false;
  if (e.ring == f.ring) {
    const bool f_follows = (e.index + 1) % e.ring_size == f.index;
    const bool e_follows = (f.index + 1) % f.ring_size == e.index;
    // Neighbours share a vertex; they conflict only by folding back onto each other.
    if (f_follows && e_follows) return true;
    if (f_follows) return on_segment(e.a, e.b, f.b) || on_segment(f.a, f.b, e.a);
    if (e_follows) return on_segment(f.a, f.b, e.b) || on_segment(e.a, e.b, f.a);
  }
  return segments_intersect(e.a, e.b, f.a, f.b);
}
}  // namespace detail

/// Throws `Error` unless the rings are simple, finite and of positive area, touch neither
/// themselves nor one another, and every hole lies in the outer ring and in no other hole.
/// O(n log n) plus the pairs of edges whose x ranges overlap.
inline void validate(const Polygon& polygon) {
  std::vector<detail::PolygonEdge> edges;
  for (std::size_t r = 0; r < polygon.rings(); ++r) {
    const Ring& ring = polygon.ring(r);
    require(ring.size() >= 3, "polygon: " + detail::ring_name(r) + " has " +
                                  std::to_string(ring.size()) + " vertices, at least 3 are needed");
    for (std::size_t i = 0; i < ring.size(); ++i) {
      require(ring[i].allFinite(), "polygon: vertex " + std::to_string(i) + " of " +
                                       detail::ring_name(r) + " is not finite");
      const std::size_t next = (i + 1) % ring.size();
      require(ring[i] != ring[next], "polygon: vertices " + std::to_string(i) + " and " +
                                         std::to_string(next) + " of " + detail::ring_name(r) +
                                         " are the same point");
      edges.push_back({ring[i], ring[next], r, i, ring.size()});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const auto& e, const auto& f) {
    return std::make_pair(e.low(), std::make_pair(e.ring, e.index)) <
           std::make_pair(f.low(), std::make_pair(f.ring, f.index));
  });
  std::vector<std::size_t> active;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    std::erase_if(active, [&](std::size_t m) { return edges[m].high() < edges[k].low(); });
    for (std::size_t m : active)
      if (detail::edges_conflict(edges[m], edges[k]))
        throw Error("polygon: " + detail::edge_name(edges[m]) + " meets " +
                    detail::edge_name(edges[k]) +
                    "; rings must neither cross nor touch themselves or one another");
    active.push_back(k);
  }
  for (std::size_t r = 0; r < polygon.rings(); ++r)
    require(signed_area(polygon.ring(r)) != 0.0,
            "polygon: " + detail::ring_name(r) + " encloses no area");
  for (std::size_t h = 0; h < polygon.holes.size(); ++h) {
    require(locate(polygon.outer, polygon.holes[h][0]) == Side::Inside,
            "polygon: hole " + std::to_string(h) + " lies outside the outer ring");
    for (std::size_t g = 0; g < polygon.holes.size(); ++g)
      require(g == h || locate(polygon.holes[g], polygon.holes[h][0]) == Side::Outside,
              "polygon: hole " + std::to_string(h) + " lies inside hole " + std::to_string(g));
  }
}

/// Turns the outer ring counter-clockwise and the holes clockwise.
inline void orient_rings(Polygon& polygon) {
  for (std::size_t r = 0; r < polygon.rings(); ++r)
    if ((signed_area(polygon.ring(r)) > 0.0) != (r == 0))
      std::reverse(polygon.ring(r).begin(), polygon.ring(r).end());
}

/// A checked polygon with its rings the right way round. Throws like `validate`.
inline Polygon make_polygon(Ring outer, std::vector<Ring> holes = {}) {
  Polygon polygon{std::move(outer), std::move(holes)};
  validate(polygon);
  orient_rings(polygon);
  return polygon;
}
/// An axis-aligned rectangle [m].
inline Polygon make_rectangle(const Point2& low, const Point2& high) {
  return make_polygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}});
}

/// Whether the polygon has no hole and turns nowhere to the right.
inline bool is_convex(const Polygon& polygon) {
  if (!polygon.holes.empty()) return false;
  const Ring& r = polygon.outer;
  for (std::size_t i = 0; i < r.size(); ++i)
    if (turn(r[i], r[(i + 1) % r.size()], r[(i + 2) % r.size()]) < 0) return false;
  return true;
}

/// The convex hull, counter-clockwise, without vertices on its edges. O(n log n).
inline Ring convex_hull(std::vector<Point2> points) {
  const auto less = [](const Point2& a, const Point2& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Ring hull;
  const auto pass = [&](auto first, auto last) {
    const std::size_t base = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), *first) <= 0)
        hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();
  };
  pass(points.begin(), points.end());
  pass(points.rbegin(), points.rend());
  return hull;
}
}  // namespace surfleet
