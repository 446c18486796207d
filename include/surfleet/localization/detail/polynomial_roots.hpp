// SPDX-License-Identifier: MIT
/// @file
/// @brief Real roots of cubic and quartic polynomials in closed form, polished.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <surfleet/core/types.hpp>

namespace surfleet::detail {
struct RealRoots {
  std::array<double, 4> value{};
  std::size_t count = 0;
  void add(double x) { value[count++] = x; }
};

/// The real roots of x³ + b x² + c x + d, largest first, not polished.
inline RealRoots cubic_roots(double b, double c, double d) {
  RealRoots roots;
  const double shift = b / 3.0;
  const double p = c - b * shift, q = d + shift * (2.0 * shift * shift - c);
  const double half = 0.5 * q, third = p / 3.0;
  const double disc = half * half + third * third * third;
  if (disc > 0.0) {
    const double s = std::cbrt(std::abs(half) + std::sqrt(disc));
    const double t = half > 0.0 ? -s : s;
    roots.add((t != 0.0 ? t - third / t : 0.0) - shift);
  } else {
    const double r = std::sqrt(std::max(0.0, -third));
    const double cosine = r > 0.0 ? std::clamp(-half / (r * r * r), -1.0, 1.0) : 1.0;
    const double angle = std::acos(cosine) / 3.0;
    const double c0 = std::cos(angle), s0 = std::sin(angle) * std::sqrt(3.0);
    roots.add(2.0 * r * c0 - shift);
    roots.add(r * (s0 - c0) - shift);
    roots.add(r * (-s0 - c0) - shift);
  }
  return roots;
}
/// A root of x³ + b x² + c x + d as cubic_roots gives it, after two steps of Newton's method.
inline double polished_cubic_root(double x, double b, double c, double d) {
  for (int k = 0; k < 2; ++k) {
    const double slope = c + x * (2.0 * b + 3.0 * x);
    if (slope == 0.0) break;
    x -= (d + x * (c + x * (b + x))) / slope;
  }
  return x;
}

/// The real roots of a4 x⁴ + … + a0, by way of the resolvent cubic (Ferrari). Pairs that are double
/// but for rounding count as real. Expects a4 ≠ 0.
inline RealRoots quartic_roots(double a4, double a3, double a2, double a1, double a0) {
  const double b = a3 / a4, c = a2 / a4, d = a1 / a4, e = a0 / a4;
  const double b2 = b * b;
  const double p = c - 0.375 * b2;
  const double q = d - 0.5 * b * c + 0.125 * b2 * b;
  const double r = e - 0.25 * b * d + 0.0625 * b2 * c - 3.0 / 256.0 * b2 * b2;
  // y⁴ + p y² + q y + r = (y² + m y + n)(y² − m y + k) with u = m² a root of the resolvent.
  const double cb = 2.0 * p, cc = p * p - 4.0 * r, cd = -q * q;
  const double u = std::max(0.0, polished_cubic_root(cubic_roots(cb, cc, cd).value[0], cb, cc, cd));
  RealRoots roots;
  const auto pair = [&](double half, double product) {
    const double scale = half * half + std::abs(product) + 1e-300;
    double disc = half * half - product;
    if (disc < -1e-7 * scale) return;
    disc = std::sqrt(std::max(0.0, disc));
    roots.add(-half + disc);
    roots.add(-half - disc);
  };
  if (u > 1e-14 * (std::abs(p) + std::sqrt(std::abs(r)))) {
    const double m = std::sqrt(u), s = 0.5 * (p + u), t = 0.5 * q / m;
    pair(0.5 * m, s - t);
    pair(-0.5 * m, s + t);
  } else {  // y⁴ + p y² + r
    const double disc = std::sqrt(std::max(0.0, 0.25 * p * p - r));
    for (const double square : {-0.5 * p + disc, -0.5 * p - disc})
      if (square >= 0.0) {
        roots.add(std::sqrt(square));
        roots.add(-std::sqrt(square));
      }
  }
  for (std::size_t i = 0; i < roots.count; ++i) {
    double& x = roots.value[i];
    x -= 0.25 * b;
    for (int k = 0; k < 2; ++k) {
      const double value = e + x * (d + x * (c + x * (b + x)));
      const double slope = d + x * (2.0 * c + x * (3.0 * b + 4.0 * x));
      if (std::abs(slope) < 1e-12) break;
      x -= value / slope;
    }
  }
  return roots;
}
}  // namespace surfleet::detail
