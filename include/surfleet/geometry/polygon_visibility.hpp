// SPDX-License-Identifier: MIT
/// @file
/// @brief What can be seen inside a polygon: segments, rays, and the visible region of a point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <surfleet/geometry/polygon.hpp>

namespace surfleet {
/// How far from the boundary a point may be, through rounding, and still count as being on it.
inline double visibility_tolerance(const Polygon& polygon) {
  return 1e-9 * polygon.bounds().diagonal().norm();
}

/// Whether the closed polygon, widened by `tolerance` [m], contains `p`. O(n).
inline bool contains(const Polygon& polygon, const Point2& p, double tolerance) {
  return contains(polygon, p) || closest_boundary_point(polygon, p).distance <= tolerance;
}

/// Whether the segment ab stays in the closed polygon, grazing corners and edges allowed, up to
/// `tolerance` [m] (0: that of `visibility_tolerance`). O(n), or O(n k) if it grazes k edges.
inline bool sees(const Polygon& polygon, const Point2& a, const Point2& b, double tolerance = 0.0) {
  const double eps = tolerance > 0.0 ? tolerance : visibility_tolerance(polygon);
  const Point2 ab = b - a;
  const double length = ab.norm();
  if (length <= eps) return contains(polygon, a, eps);
  const Point2 u = ab / length;
  const Box2 box(a.cwiseMin(b) - Point2::Constant(eps), a.cwiseMax(b) + Point2::Constant(eps));
  std::vector<double> touches{0.0, length};
  bool blocked = false;
  for_each_edge(polygon, [&](const Point2& c, const Point2& d) {
    if (blocked || !box.intersects(Box2(c.cwiseMin(d), c.cwiseMax(d)))) return;
    const double side_c = cross2(u, c - a), side_d = cross2(u, d - a);
    if ((side_c > eps && side_d > eps) || (side_c < -eps && side_d < -eps)) return;
    if ((side_c > 0.0) != (side_d > 0.0)) {
      const double t = u.dot(c - a) + side_c / (side_c - side_d) * u.dot(d - c);
      if (t > -eps && t < length + eps) {
        const double edge = (d - c).norm();
        const double side_a = cross2(d - c, a - c) / edge, side_b = cross2(d - c, b - c) / edge;
        if (std::min(std::abs(side_c), std::abs(side_d)) > eps && side_a * side_b < 0.0 &&
            std::min(std::abs(side_a), std::abs(side_b)) > eps) {
          blocked = true;
          return;
        }
        touches.push_back(std::clamp(t, 0.0, length));
      }
    }
    if (std::abs(side_c) <= eps) touches.push_back(std::clamp(u.dot(c - a), 0.0, length));
    if (std::abs(side_d) <= eps) touches.push_back(std::clamp(u.dot(d - a), 0.0, length));
  });
  if (blocked) return false;
  std::sort(touches.begin(), touches.end());
  for (std::size_t i = 0; i + 1 < touches.size(); ++i)
    if (touches[i + 1] - touches[i] > 2.0 * eps &&
        !contains(polygon, a + 0.5 * (touches[i] + touches[i + 1]) * u, eps))
      return false;
  return true;
}

/// How far one can go from `p` along the unit vector `direction` before leaving the polygon [m];
/// 0 if the direction leads out at once. Touching a corner does not stop it. O(n).
inline double free_distance(const Polygon& polygon, const Point2& p, const Point2& direction) {
  const double eps = visibility_tolerance(polygon);
  std::vector<double> stops;
  for_each_edge(polygon, [&](const Point2& c, const Point2& d) {
    const double side_c = cross2(direction, c - p), side_d = cross2(direction, d - p);
    if ((side_c > eps && side_d > eps) || (side_c < -eps && side_d < -eps)) return;
    if ((side_c > 0.0) != (side_d > 0.0)) {
      const double t = direction.dot(c - p) + side_c / (side_c - side_d) * direction.dot(d - c);
      if (t > -eps) stops.push_back(std::max(t, 0.0));
    }
    if (std::abs(side_c) <= eps && direction.dot(c - p) > -eps)
      stops.push_back(std::max(direction.dot(c - p), 0.0));
    if (std::abs(side_d) <= eps && direction.dot(d - p) > -eps)
      stops.push_back(std::max(direction.dot(d - p), 0.0));
  });
  stops.push_back(0.0);
  std::sort(stops.begin(), stops.end());
  double reached = 0.0;
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    if (stops[i + 1] - stops[i] > 2.0 * eps &&
        !contains(polygon, p + 0.5 * (stops[i] + stops[i + 1]) * direction, eps))
      return stops[i];
    reached = stops[i + 1];
  }
  return reached;
}

/// The region seen from `p`, within `range` [m] (arcs become chords of at most 5°). Star-shaped
/// around `p`, counter-clockwise; empty if `p` is outside. O(n²), for any position of `p`.
inline Ring visibility_polygon(const Polygon& polygon, const Point2& p,
                               double range = std::numeric_limits<double>::infinity()) {
  const double eps = visibility_tolerance(polygon);
  const double to_boundary = closest_boundary_point(polygon, p).distance;
  Ring seen;
  if (!contains(polygon, p) && to_boundary > eps) return seen;
  struct Edge {
    Point2 c, d;  // relative to p
  };
  std::vector<Edge> edges;
  std::vector<double> angles;
  const auto add_angle = [&](const Point2& v) {
    if (v.norm() > eps) angles.push_back(std::atan2(v.y(), v.x()));
  };
  const bool limited = std::isfinite(range);
  for_each_edge(polygon, [&](const Point2& c, const Point2& d) {
    edges.push_back({c - p, d - p});
    const Edge& e = edges.back();
    add_angle(e.c);
    if (!limited) return;
    const Point2 u = e.d - e.c;  // places where the edge crosses the circle of the range
    const double a = u.squaredNorm(), b = e.c.dot(u), c2 = e.c.squaredNorm() - range * range;
    const double root = b * b - a * c2;
    if (root <= 0.0) return;
    for (const double t : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a})
      if (t > 0.0 && t < 1.0) add_angle(e.c + t * u);
  });
  for (int k = 0; limited && k < 72; ++k) angles.push_back(-kPi + k * kPi / 36.0);
  std::sort(angles.begin(), angles.end());
  angles.erase(
      std::unique(angles.begin(), angles.end(), [](double a, double b) { return b - a < 1e-12; }),
      angles.end());
  const auto push = [&](const Point2& v) {
    if (seen.empty() || (seen.back() - (p + v)).norm() > eps) seen.push_back(p + v);
  };
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double from = angles[i];
    const double to = i + 1 < angles.size() ? angles[i + 1] : angles[0] + 2.0 * kPi;
    if (to - from < 1e-12) continue;
    const double middle = 0.5 * (from + to);
    const Point2 m(std::cos(middle), std::sin(middle));
    if (to_boundary <= eps && !contains(polygon, Point2(p + 8.0 * eps * m))) {
      push(Point2::Zero());
      continue;
    }
    double nearest = std::numeric_limits<double>::infinity();
    const Edge* hit = nullptr;
    for (const Edge& e : edges) {
      const double side_c = cross2(m, e.c), side_d = cross2(m, e.d);
      if ((side_c > 0.0) == (side_d > 0.0)) continue;
      const double t = m.dot(e.c) + side_c / (side_c - side_d) * m.dot(e.d - e.c);
      if (t > 2.0 * eps && t < nearest) {
        nearest = t;
        hit = &e;
      }
    }
    for (const double angle : {from, to}) {
      const Point2 u(std::cos(angle), std::sin(angle));
      if (hit == nullptr || nearest > range) {
        if (limited) push(range * u);
        continue;
      }
      const double side_c = cross2(u, hit->c), side_d = cross2(u, hit->d);
      const double s = side_c == side_d ? 0.0 : std::clamp(side_c / (side_c - side_d), 0.0, 1.0);
      push(hit->c + s * (hit->d - hit->c));
    }
  }
  while (seen.size() > 1 && (seen.front() - seen.back()).norm() <= eps) seen.pop_back();
  return seen;
}
}  // namespace surfleet
