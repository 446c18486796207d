// SPDX-License-Identifier: MIT
/// @file
/// @brief P3P by the depths along the rays: two conics, and the pair of lines through what they
/// share (Persson & Nordberg 2018).
#pragma once

#include <cmath>

#include <surfleet/localization/detail/polynomial_roots.hpp>
#include <surfleet/localization/p3p.hpp>

namespace surfleet {
/// One real root of a cubic gives the conic of the pencil that is a pair of lines; each line meets
/// a conic in at most two ratios of depths.
struct LambdaTwistP3p {
  P3pSolutions operator()(const Bearings3& bearings, const Points3& points) const {
    P3pSolutions solutions;
    const detail::P3pProblem t(bearings, points);
    if (!t.solvable) return solutions;
    // λᵀ D1 λ = 0: equation 12 times a23 less equation 23 times a12; λᵀ D2 λ = 0 with 13 for 12.
    Eigen::Matrix3d d1, d2;
    d1 << t.a23, -t.a23 * t.b12, 0.0, -t.a23 * t.b12, t.a23 - t.a12, t.a12 * t.b23, 0.0,
        t.a12 * t.b23, -t.a12;
    d2 << t.a23, 0.0, -t.a23 * t.b13, 0.0, -t.a13, t.a13 * t.b23, -t.a23 * t.b13, t.a13 * t.b23,
        t.a23 - t.a13;
    // det(D1 + γ D2) = c0 + c1 γ + c2 γ² + c3 γ³
    const Eigen::Matrix3d m1 = adjugate(d1), m2 = adjugate(d2);
    const double c0 = d1.row(0).dot(m1.col(0)), c3 = d2.row(0).dot(m2.col(0));
    const double c1 = m1.cwiseProduct(d2).sum(), c2 = m2.cwiseProduct(d1).sum();
    // The pencil is the same from its other end, where the leading coefficient may be larger.
    const bool swapped = std::abs(c0) > std::abs(c3);
    const double lead = swapped ? c0 : c3;
    if (lead == 0.0) return solutions;
    const double scale = 1.0 / lead;
    const double k2 = scale * (swapped ? c1 : c2), k1 = scale * (swapped ? c2 : c1),
                 k0 = scale * (swapped ? c3 : c0);
    const detail::RealRoots roots = detail::cubic_roots(k2, k1, k0);
    const auto pencil = [&](double g) {
      return swapped ? Eigen::Matrix3d(g * d1 + d2) : Eigen::Matrix3d(d1 + g * d2);
    };
    // Of several roots the one whose pair of lines is clearest: by the product of the conic's two
    // eigenvalues, which differ in sign.
    double clearest = 0.0, weight = 0.0;
    for (std::size_t i = 0; i < roots.count; ++i) {
      const Eigen::Matrix3d m = pencil(roots.value[i]);
      const double product = m(0, 0) * m(1, 1) + m(0, 0) * m(2, 2) + m(1, 1) * m(2, 2) -
                             m(0, 1) * m(0, 1) - m(0, 2) * m(0, 2) - m(1, 2) * m(1, 2);
      const double clear = -product / m.squaredNorm();
      if (clear > clearest) {
        clearest = clear;
        weight = roots.value[i];
      }
    }
    if (!(clearest > 0.0)) return solutions;
    weight = detail::polished_cubic_root(weight, k2, k1, k0);
    const Eigen::Matrix3d conic = pencil(weight), minors = adjugate(conic);
    // Lines l, m with 2 conic = l mᵀ + m lᵀ: the conic and the cross matrix of the point where they
    // meet add to a matrix of rank one.
    int k = 0;
    (-minors.diagonal()).maxCoeff(&k);
    const double root = std::sqrt(-minors(k, k));
    if (!(root > 0.0)) return solutions;
    const Eigen::Vector3d meet = -minors.col(k) / root;
    Eigen::Matrix3d rank_one = conic;
    rank_one(0, 1) -= meet.z();
    rank_one(0, 2) += meet.y();
    rank_one(1, 0) += meet.z();
    rank_one(1, 2) -= meet.x();
    rank_one(2, 0) -= meet.y();
    rank_one(2, 1) += meet.x();
    int row = 0, column = 0;
    rank_one.cwiseAbs().maxCoeff(&row, &column);
    // On the lines both conics vanish together; the one with the larger part says more.
    const Eigen::Matrix3d& other = swapped == (std::abs(weight) > 1.0) ? d2 : d1;
    intersect(rank_one.row(row).transpose(), other, t, solutions);
    intersect(rank_one.col(column), other, t, solutions);
    return solutions;
  }

 private:
  static Eigen::Matrix3d adjugate(const Eigen::Matrix3d& m) {  // of a symmetric matrix
    Eigen::Matrix3d a;
    a(0, 0) = m(1, 1) * m(2, 2) - m(1, 2) * m(1, 2);
    a(1, 1) = m(0, 0) * m(2, 2) - m(0, 2) * m(0, 2);
    a(2, 2) = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1);
    a(0, 1) = a(1, 0) = m(0, 2) * m(1, 2) - m(0, 1) * m(2, 2);
    a(0, 2) = a(2, 0) = m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1);
    a(1, 2) = a(2, 1) = m(0, 1) * m(0, 2) - m(0, 0) * m(1, 2);
    return a;
  }
  static void intersect(const Eigen::Vector3d& line, const Eigen::Matrix3d& conic,
                        const detail::P3pProblem& t, P3pSolutions& out) {
    int k = 0;
    line.cwiseAbs().maxCoeff(&k);
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double wi = -line[i] / line[k], wj = -line[j] / line[k];  // λk = wi λi + wj λj
    const double a = conic(i, i) + wi * (2.0 * conic(i, k) + wi * conic(k, k));
    const double b = conic(i, j) + wi * conic(j, k) + wj * conic(i, k) + wi * wj * conic(k, k);
    const double c = conic(j, j) + wj * (2.0 * conic(j, k) + wj * conic(k, k));
    // a τ² + 2 b τ + c = 0 with τ = λi / λj. Double roots are kept in spite of rounding.
    double disc = b * b - a * c;
    if (disc < -1e-6 * b * b) return;
    disc = std::sqrt(std::max(0.0, disc));
    const double big = b > 0.0 ? -b - disc : -b + disc;
    const double cosine = k == 0 ? t.b23 : k == 1 ? t.b13 : t.b12;
    const double square = k == 0 ? t.a23 : k == 1 ? t.a13 : t.a12;
    const auto add = [&](double numerator, double denominator) {
      if (!(numerator * denominator > 0.0)) return;
      const double tau = numerator / denominator;
      const double lj = std::sqrt(square / (1.0 + tau * (tau - 2.0 * cosine)));
      Eigen::Vector3d l;
      l[i] = tau * lj;
      l[j] = lj;
      l[k] = wi * l[i] + wj * l[j];
      if (l[k] > 0.0 && t.polish(l)) out.add(t.pose(l));
    };
    add(big, a);
    add(c, big);
  }
};
static_assert(P3pSolver<LambdaTwistP3p>);
}  // namespace surfleet
