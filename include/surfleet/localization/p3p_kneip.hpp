// SPDX-License-Identifier: MIT
/// @file
/// @brief P3P by the direct parametrisation of the camera's pose [004 §9.2, eq. 9.1–9.5].
#pragma once

#include <cmath>
#include <utility>

#include <surfleet/localization/detail/polynomial_roots.hpp>
#include <surfleet/localization/p3p.hpp>

namespace surfleet {
/// Two angles of the plane through the camera and the first two points: θ, its inclination, from a
/// quartic, and α in that plane, linear in the rest [004 eq. 9.4].
///
/// Eq. 9.2 holds for θ in [0, π], where sin θ ≥ 0, if the third ray has no positive z in C'; points
/// 1 and 2 are exchanged otherwise. The depths that follow are polished.
struct KneipP3p {
  P3pSolutions operator()(const Bearings3& bearings, const Points3& points) const {
    Bearings3 f = bearings;
    Points3 p = points;
    P3pSolutions solutions;
    Eigen::Vector3d mz = f[0].cross(f[1]);
    if (mz.dot(f[2]) > 0.0) {
      std::swap(f[0], f[1]);
      std::swap(p[0], p[1]);
      mz = -mz;
    }
    const detail::P3pProblem problem(f, p);
    const double sine = mz.norm();  // of β
    if (!problem.solvable || sine == 0.0) return solutions;
    mz /= sine;
    // The third ray in C' (eq. 9.1) and the third point (x, y) in T'.
    const double fx = f[0].dot(f[2]), fy = mz.cross(f[0]).dot(f[2]), fz = mz.dot(f[2]);
    const double d = std::sqrt(problem.a12), cot = problem.b12 / sine;
    const Eigen::Vector3d p13 = p[2] - p[0];
    const double x = (p[1] - p[0]).dot(p13) / d;
    const double y = std::sqrt(std::max(0.0, problem.a13 - x * x));
    // Point 3 lies along ray 3, with c = cos θ and s = sin θ:
    //   cos α (d − x) + sin α (d cot β − y c) = −y s fx / fz
    //        −y c cos α + x sin α              = −y s fy / fz
    // so cos α = −y s n1 / (fz det), sin α = −y s n2 / (fz det), and their squares add to 1.
    const double n10 = fx * x - fy * d * cot, n11 = fy * y;
    const double n20 = fy * (d - x), n21 = fx * y;
    const double det0 = x * (d - x), det1 = y * d * cot, det2 = -y * y;
    const double q0 = n10 * n10 + n20 * n20, q1 = 2.0 * (n10 * n11 + n20 * n21),
                 q2 = n11 * n11 + n21 * n21;
    const double y2 = y * y, z2 = fz * fz;
    const auto roots = detail::quartic_roots(
        z2 * det2 * det2 + y2 * q2,  //
        2.0 * z2 * det1 * det2 + y2 * q1, z2 * (det1 * det1 + 2.0 * det0 * det2) + y2 * (q0 - q2),
        2.0 * z2 * det0 * det1 - y2 * q1, z2 * det0 * det0 - y2 * q0);
    for (std::size_t i = 0; i < roots.count; ++i) {
      const double c = roots.value[i];
      if (!(std::abs(c) <= 1.0 + 1e-9)) continue;
      const double s = std::sqrt(std::max(0.0, 1.0 - c * c));
      double ca = n10 + n11 * c, sa = n20 + n21 * c;
      const double length = std::hypot(ca, sa);
      if (length == 0.0) continue;
      const double sign = (det0 + c * (det1 + c * det2)) > 0.0 ? 1.0 : -1.0;
      ca *= sign / length;
      sa *= sign / length;
      const double l1 = d * (sa * cot + ca);
      const Eigen::Vector3d camera = l1 * Eigen::Vector3d(ca, sa * c, sa * s);  // in T', eq. 9.2
      Eigen::Vector3d depths(l1, (camera - Eigen::Vector3d(d, 0, 0)).norm(),
                             (camera - Eigen::Vector3d(x, y, 0)).norm());
      if (problem.polish(depths)) solutions.add(problem.pose(depths));
    }
    return solutions;
  }
};
static_assert(P3pSolver<KneipP3p>);
}  // namespace surfleet
