// SPDX-License-Identifier: MIT
/// @file
/// @brief Mass, centroid and coverage cost of a region, for squared and for general performance.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <span>
#include <type_traits>
#include <vector>

#include <surfleet/coverage/density.hpp>
#include <surfleet/geometry/polygon_clipping.hpp>

namespace surfleet {
/// Integrals of ρ, ρ q and ρ |q|² over a region, with q taken relative to `origin`.
struct RegionMoments {
  Point2 origin = Point2::Zero();
  double mass = 0.0;
  Point2 first = Point2::Zero();
  double second = 0.0;

  /// [004 eq. 3.6]; the origin if there is no mass.
  Point2 centroid() const { return mass > 0.0 ? Point2(origin + first / mass) : origin; }
  /// The polar moment of inertia about `p`, which is the cost of serving the region from there
  /// [004 eq. 3.30].
  double polar(const Point2& p) const {
    const Point2 d = p - origin;
    return second - 2.0 * d.dot(first) + d.squaredNorm() * mass;
  }
  /// One edge of a boundary with the inside on its left, under uniform density.
  void add_edge(const Point2& a, const Point2& b) {
    const Point2 u = a - origin, v = b - origin;
    const double c = cross2(u, v);
    mass += c / 2.0;
    first += c / 6.0 * (u + v);
    second += c / 12.0 * (u.squaredNorm() + u.dot(v) + v.squaredNorm());
  }
  void add_point(const QuadraturePoint& q) {
    const Point2 d = q.point - origin;
    mass += q.weight;
    first += q.weight * d;
    second += q.weight * d.squaredNorm();
  }
};

/// Of a region under a density. Exact for `UniformDensity`; otherwise by quadrature on parts of at
/// most `element` [m].
template <PlanarDensity Density>
RegionMoments region_moments(const Region& region, const Point2& origin, const Density& density,
                             double element) {
  RegionMoments m{origin, 0.0, Point2::Zero(), 0.0};
  if constexpr (std::same_as<Density, UniformDensity>) {
    for (const Polygon& part : region)
      for_each_edge(part, [&](const Point2& a, const Point2& b) { m.add_edge(a, b); });
  } else {
    for (const QuadraturePoint& q : quadrature(region, element, density)) m.add_point(q);
  }
  return m;
}

/// What general coverage asks of a performance function h(d): its value and slope for d ≥ 0,
/// strictly increasing [004 §3.5.3].
template <typename H>
concept PerformanceFunction = std::copyable<H> && requires(const H& h, double d) {
  { h(d) } -> std::convertible_to<double>;
  { h.slope(d) } -> std::convertible_to<double>;
};
/// h(d) = d², set-up 1 of [004 §3.5.3].
struct SquaredDistance {
  double operator()(double d) const { return d * d; }
  double slope(double d) const { return 2.0 * d; }
};
/// h(d) = d^p with p ≥ 1.
struct PowerDistance {
  double power = 1.0;
  double operator()(double d) const { return std::pow(d, power); }
  double slope(double d) const { return power * std::pow(d, power - 1.0); }
};
static_assert(PerformanceFunction<SquaredDistance> && PerformanceFunction<PowerDistance>);

/// ∫ h(|q − p|) ρ over the points of a quadrature whose weights are masses.
template <PerformanceFunction H>
double performance_cost(std::span<const QuadraturePoint> points, const Point2& p, const H& h) {
  double cost = 0.0;
  for (const QuadraturePoint& q : points) cost += q.weight * h((q.point - p).norm());
  return cost;
}
/// Its gradient with respect to p [004 eq. 3.29].
template <PerformanceFunction H>
Point2 performance_gradient(std::span<const QuadraturePoint> points, const Point2& p, const H& h) {
  Point2 gradient = Point2::Zero();
  for (const QuadraturePoint& q : points) {
    const Point2 d = p - q.point;
    const double length = d.norm();
    if (length > 0.0) gradient += q.weight * h.slope(length) / length * d;
  }
  return gradient;
}
/// The generalised centroid [004 eq. 3.27], from `start`: fixed-point steps towards the mean
/// weighted with h'(d)/d, halved until the cost falls. Stops below `tolerance` [m].
template <PerformanceFunction H>
Point2 generalized_centroid(std::span<const QuadraturePoint> points, Point2 start, const H& h,
                            double tolerance = 1e-9) {
  double cost = performance_cost(points, start, h);
  for (int iteration = 0; iteration < 500; ++iteration) {
    double weight = 0.0;
    Point2 sum = Point2::Zero();
    for (const QuadraturePoint& q : points) {
      const double d = std::max((q.point - start).norm(), 1e-12);
      const double w = q.weight * h.slope(d) / d;
      weight += w;
      sum += w * (q.point - start);
    }
    if (weight <= 0.0) return start;
    Point2 step = sum / weight;
    for (;;) {
      if (step.norm() < tolerance) return start;
      const double better = performance_cost(points, Point2(start + step), h);
      if (better < cost) {
        cost = better;
        start += step;
        break;
      }
      step *= 0.5;
    }
  }
  return start;
}
}  // namespace surfleet
