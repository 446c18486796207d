// SPDX-License-Identifier: MIT
/// @file
/// @brief A ray against a triangle and the point of a triangle nearest to a point.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// The point of segment ab nearest to `p`; `a` if the segment has no length.
inline Point3 closest_on_segment(const Point3& p, const Point3& a, const Point3& b) {
  const Eigen::Vector3d ab = b - a;
  const double length2 = ab.squaredNorm();
  if (!(length2 > 0.0)) return a;
  return a + std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) * ab;
}

/// The point of triangle abc nearest to `p`, by the Voronoi regions of its features. Triangles
/// without area, even single points, are fine; in a sliver, where rounding decides which region
/// `p` is in, the nearest of its edges and of its inside is taken, whose points all lie in it.
inline Point3 closest_on_triangle(const Point3& p, const Point3& a, const Point3& b,
                                  const Point3& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const Eigen::Vector3d n = ab.cross(ac);
  const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  constexpr double kSliver = 1e-4;  // height over longest edge
  if (const double n2 = n.squaredNorm(); n2 <= kSliver * kSliver * longest2 * longest2) {
    Point3 best = closest_on_segment(p, a, b);
    const auto consider = [&](const Point3& q) {
      if ((q - p).squaredNorm() < (best - p).squaredNorm()) best = q;
    };
    consider(closest_on_segment(p, b, c));
    consider(closest_on_segment(p, c, a));
    if (n2 > 0.0) {
      const double v = n.dot(ap.cross(ac)) / n2, w = n.dot(ab.cross(ap)) / n2;
      if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) consider(a + v * ab + w * ac);
    }
    return best;
  }
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + d1 / (d1 - d3) * ab;
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double scale = 1.0 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

/// Where `origin + t * direction`, 0 <= t <= `t_max`, meets triangle abc from either side; a
/// triangle without area is never met. Edges count as inside by a relative 1e-12, so that a ray
/// cannot slip between neighbours.
inline std::optional<double> intersect_triangle(const Point3& origin,
                                                const Eigen::Vector3d& direction, const Point3& a,
                                                const Point3& b, const Point3& c, double t_max) {
  constexpr double kEdge = 1e-12;
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const Eigen::Vector3d h = direction.cross(ac);
  const double det = ab.dot(h);
  if (det == 0.0) return std::nullopt;
  const double inverse = 1.0 / det;
  const Eigen::Vector3d s = origin - a;
  const double u = inverse * s.dot(h);
  if (!(u >= -kEdge && u <= 1.0 + kEdge)) return std::nullopt;
  const Eigen::Vector3d q = s.cross(ab);
  const double v = inverse * direction.dot(q);
  if (!(v >= -kEdge && u + v <= 1.0 + kEdge)) return std::nullopt;
  const double t = inverse * ac.dot(q);
  if (!(t >= 0.0 && t <= t_max)) return std::nullopt;
  return t;
}
}  // namespace surfleet
