// SPDX-License-Identifier: MIT
/// @file
/// @brief Predicates of plane geometry whose sign is exact.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <surfleet/core/types.hpp>

namespace surfleet {
namespace detail {
/// A sum of doubles held without rounding: non-overlapping terms, smallest first.
template <std::size_t Capacity>
class ExactSum {
 public:
  void add(double b) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double a = term_[i], sum = a + b, part = sum - a;
      const double error = (a - (sum - part)) + (b - part);
      if (error != 0.0) term_[kept++] = error;
      b = sum;
    }
    if (b != 0.0) term_[kept++] = b;
    size_ = kept;
  }
  void add_product(double a, double b) {
    const double p = a * b;
    add(std::fma(a, b, -p));
    add(p);
  }
  /// Adds the product of all; rounds nothing while nothing over- or underflows.
  template <typename... More>
  void add_product(double a, double b, double c, More... more) {
    const double p = a * b, rest = std::fma(a, b, -p);
    if (rest != 0.0) add_product(rest, c, more...);
    add_product(p, c, more...);
  }
  /// A number with the sign of the sum, close to its value.
  double estimate() const { return size_ == 0 ? 0.0 : term_[size_ - 1]; }

 private:
  std::array<double, Capacity> term_{};
  std::size_t size_ = 0;
};
}  // namespace detail

/// Twice the signed area of the triangle abc: positive if it turns left. The sign is exact while
/// no product over- or underflows; a floating-point filter answers all but nearly straight triples.
inline double orient2d(const Point2& a, const Point2& b, const Point2& c) {
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double det = left - right;
  if (std::abs(det) > 3.3306690738754716e-16 * (std::abs(left) + std::abs(right))) return det;
  if (left == 0.0 && right == 0.0) return 0.0;
  detail::ExactSum<16> exact;
  exact.add_product(a.x(), b.y());
  exact.add_product(-a.y(), b.x());
  exact.add_product(b.x(), c.y());
  exact.add_product(-b.y(), c.x());
  exact.add_product(c.x(), a.y());
  exact.add_product(-c.y(), a.x());
  return exact.estimate();
}

/// Positive if `d` lies inside the circle through a, b and c that turn left, negative outside, 0 on
/// it; the other way round if they turn right. The sign is exact while no product over- or
/// underflows; a floating-point filter answers all but nearly concyclic points.
inline double in_circle(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const Point2 p = a - d, q = b - d, r = c - d;
  const auto cross = [](const Point2& u, const Point2& v, double& size) {
    const double left = u.x() * v.y(), right = u.y() * v.x();
    size = std::abs(left) + std::abs(right);
    return left - right;
  };
  double sp = 0.0, sq = 0.0, sr = 0.0;
  const double p2 = p.squaredNorm(), q2 = q.squaredNorm(), r2 = r.squaredNorm();
  const double det = p2 * cross(q, r, sp) + q2 * cross(r, p, sq) + r2 * cross(p, q, sr);
  if (std::abs(det) > 1.2e-15 * (p2 * sp + q2 * sq + r2 * sr)) return det;
  if (p2 == 0.0 || q2 == 0.0 || r2 == 0.0) return 0.0;
  // Where no difference was rounded, they stand for the points.
  const auto rounded = [](double x, double y) {
    const double difference = x - y, part = x - difference;
    return (x - (difference + part)) + (part - y) != 0.0;
  };
  bool same = true;
  for (const Point2* e : {&a, &b, &c})
    same = same && !rounded(e->x(), d.x()) && !rounded(e->y(), d.y());
  detail::ExactSum<400> exact;
  const auto add = [&](const Point2& lifted, double sign, const Point2& u, const Point2& v) {
    for (const double l : {lifted.x(), lifted.y()}) {
      exact.add_product(sign * l, l, u.x(), v.y());
      exact.add_product(-sign * l, l, u.y(), v.x());
    }
  };
  if (same) {
    add(p, 1.0, q, r);
    add(q, 1.0, r, p);
    add(r, 1.0, p, q);
    return exact.estimate();
  }
  const auto minor = [&](const Point2& lifted, double sign, const Point2& u, const Point2& v,
                         const Point2& w) {
    add(lifted, sign, u, v);
    add(lifted, sign, v, w);
    add(lifted, sign, w, u);
  };
  minor(a, 1.0, b, c, d);
  minor(b, -1.0, a, c, d);
  minor(c, 1.0, a, b, d);
  minor(d, -1.0, a, b, c);
  return exact.estimate();
}

/// −1, 0 or 1.
inline int turn(const Point2& a, const Point2& b, const Point2& c) {
  const double d = orient2d(a, b, c);
  return d > 0.0 ? 1 : d < 0.0 ? -1 : 0;
}

/// Whether `p` lies on the closed segment ab. Exact.
inline bool on_segment(const Point2& a, const Point2& b, const Point2& p) {
  return turn(a, b, p) == 0 && p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) &&
         p.y() >= std::min(a.y(), b.y()) && p.y() <= std::max(a.y(), b.y());
}

/// Whether the closed segments ab and cd have a point in common. Exact.
inline bool segments_intersect(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const int c_side = turn(a, b, c), d_side = turn(a, b, d);
  const int a_side = turn(c, d, a), b_side = turn(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return on_segment(a, b, c) || on_segment(a, b, d) || on_segment(c, d, a) || on_segment(c, d, b);
}

/// The point of the closed segment ab nearest to `p`.
inline Point2 closest_on_segment(const Point2& a, const Point2& b, const Point2& p) {
  const Point2 ab = b - a;
  const double squared = ab.squaredNorm();
  if (squared == 0.0) return a;
  const double t = std::clamp((p - a).dot(ab) / squared, 0.0, 1.0);
  return t == 1.0 ? b : Point2(a + t * ab);
}

/// The z component of the cross product.
inline double cross2(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }
}  // namespace surfleet
