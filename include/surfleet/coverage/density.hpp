// SPDX-License-Identifier: MIT
/// @file
/// @brief Where coverage matters more: density functions and integrals of them over polygons.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include <surfleet/geometry/polygon.hpp>
#include <surfleet/geometry/polygon_trapezoids.hpp>

namespace surfleet {
/// What coverage asks of a density ρ: `rho(q)` ≥ 0, finite, for every q of the domain [004 §3.5.3].
/// A lambda will do.
template <typename D>
concept PlanarDensity = std::copyable<D> && requires(const D& rho, const Point2& q) {
  { rho(q) } -> std::convertible_to<double>;
};

/// The same everywhere; integrals over polygons are exact.
struct UniformDensity {
  double operator()(const Point2&) const { return 1.0; }
};
/// A floor and a sum of bells.
struct GaussianMixture {
  struct Bell {
    Point2 mean = Point2::Zero();
    double sigma = 1.0;   ///< [m]
    double weight = 1.0;  ///< Height of the peak.
  };
  std::vector<Bell> bells;
  double floor = 0.0;
  double operator()(const Point2& q) const {
    double rho = floor;
    for (const Bell& b : bells)
      rho += b.weight * std::exp(-0.5 * (q - b.mean).squaredNorm() / (b.sigma * b.sigma));
    return rho;
  }
};
static_assert(PlanarDensity<UniformDensity> && PlanarDensity<GaussianMixture>);

/// A point of a quadrature rule and the area it stands for.
struct QuadraturePoint {
  Point2 point;
  double weight;
};

/// Appends points and weights whose weighted sum is the integral over the triangle: exact for
/// polynomials up to degree five (seven points, Radon), on parts no longer than `element` [m].
inline void append_quadrature(const Point2& a, const Point2& b, const Point2& c, double element,
                              std::vector<QuadraturePoint>& points) {
  const double twice = std::abs(cross2(b - a, c - a));
  if (twice == 0.0) return;
  const double longest =
      std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
  if (longest > element) {  // halve the longest side
    const double ab = (b - a).norm(), bc = (c - b).norm();
    const Point2 &p = longest == ab   ? a
                      : longest == bc ? b
                                      : c,
                 &q = longest == ab   ? b
                      : longest == bc ? c
                                      : a,
                 &r = longest == ab   ? c
                      : longest == bc ? a
                                      : b;
    const Point2 middle = 0.5 * (p + q);
    append_quadrature(p, middle, r, element, points);
    append_quadrature(middle, q, r, element, points);
    return;
  }
  const double s = std::sqrt(15.0), area = 0.5 * twice;
  const std::array<double, 2> inner{(6.0 - s) / 21.0, (6.0 + s) / 21.0};
  const std::array<double, 2> weight{(155.0 - s) / 1200.0, (155.0 + s) / 1200.0};
  points.push_back({(a + b + c) / 3.0, 0.225 * area});
  for (std::size_t k = 0; k < 2; ++k) {
    const double u = inner[k], v = 1.0 - 2.0 * u, w = weight[k] * area;
    points.push_back({v * a + u * b + u * c, w});
    points.push_back({u * a + v * b + u * c, w});
    points.push_back({u * a + u * b + v * c, w});
  }
}

/// Quadrature points of a region; `element` is the longest side of a part [m]. Without a density
/// the weights are areas, with one they are masses.
inline std::vector<QuadraturePoint> quadrature(const Region& region, double element) {
  std::vector<QuadraturePoint> points;
  for (const Polygon& part : region)
    for (const Trapezoid& t : trapezoids(part)) {
      append_quadrature(t[0], t[1], t[2], element, points);
      append_quadrature(t[0], t[2], t[3], element, points);
    }
  return points;
}
template <PlanarDensity Density>
std::vector<QuadraturePoint> quadrature(const Region& region, double element,
                                        const Density& density) {
  std::vector<QuadraturePoint> points = quadrature(region, element);
  for (QuadraturePoint& q : points) q.weight *= density(q.point);
  return points;
}
}  // namespace surfleet
