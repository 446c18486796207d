// SPDX-License-Identifier: MIT
/// @file
/// @brief The Perspective-Three-Point problem: what a solver gives, and what all solvers share
/// [004 §9.2].
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// The poses from which three points appear along three rays: at most four.
class P3pSolutions {
 public:
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  const Pose& operator[](std::size_t i) const { return poses_[i]; }
  const Pose* begin() const { return poses_.data(); }
  const Pose* end() const { return poses_.data() + count_; }
  void add(const Pose& T_camera_target) {
    if (count_ < poses_.size()) poses_[count_++] = T_camera_target;
  }

 private:
  std::array<Pose, 4> poses_;
  std::size_t count_ = 0;
};

using Bearings3 = std::array<Eigen::Vector3d, 3>;
using Points3 = std::array<Point3, 3>;

/// A solver of P3P: `solver(bearings, points)` gives every `T_camera_target` with each of the three
/// points of the target frame in front of the camera along its bearing (a unit vector). Nothing for
/// collinear or coinciding points. Pure.
template <typename S>
concept P3pSolver = std::copyable<S> && requires(const S& s, const Bearings3& f, const Points3& p) {
  { s(f, p) } -> std::same_as<P3pSolutions>;
};

namespace detail {
/// The three points' distances, the rays' cosines, and the frame of the points: all that the depths
/// λ along the rays must fit, λi² + λj² − 2 λi λj cos_ij = d_ij².
class P3pProblem {
 public:
  P3pProblem(const Bearings3& f, const Points3& p) : bearings(f), origin_(p[0]) {
    const Eigen::Vector3d a = p[1] - p[0], b = p[2] - p[0];
    a12 = a.squaredNorm();
    a13 = b.squaredNorm();
    a23 = (p[2] - p[1]).squaredNorm();
    b12 = f[0].dot(f[1]);
    b13 = f[0].dot(f[2]);
    b23 = f[1].dot(f[2]);
    const Eigen::Vector3d n = a.cross(b);
    // The square of a collinear triple's area is rounding alone.
    solvable = n.squaredNorm() > 1e-20 * a12 * a13 && a12 > 0.0 && a13 > 0.0 && a23 > 0.0;
    if (solvable) frame_ = frame(a, n).transpose();
  }

  /// Newton's method on the depths; false where they fit no pose.
  bool polish(Eigen::Vector3d& l) const {
    const double scale = a12 + a13 + a23;
    double off = 0.0;
    for (int i = 0;; ++i) {
      const double r12 = l[0] * (l[0] - 2.0 * b12 * l[1]) + l[1] * l[1] - a12;
      const double r13 = l[0] * (l[0] - 2.0 * b13 * l[2]) + l[2] * l[2] - a13;
      const double r23 = l[1] * (l[1] - 2.0 * b23 * l[2]) + l[2] * l[2] - a23;
      off = std::abs(r12) + std::abs(r13) + std::abs(r23);
      if (off < 1e-13 * scale || i == 5) break;
      // Half of the Jacobian: rows (x1 x2 0), (y1 0 y3), (0 z2 z3).
      const double x1 = l[0] - b12 * l[1], x2 = l[1] - b12 * l[0];
      const double y1 = l[0] - b13 * l[2], y3 = l[2] - b13 * l[0];
      const double z2 = l[1] - b23 * l[2], z3 = l[2] - b23 * l[1];
      const double det = x1 * y3 * z2 + x2 * y1 * z3;
      if (det == 0.0) return false;
      const double s = 0.5 / det;
      l[0] -= s * (y3 * z2 * r12 + x2 * z3 * r13 - x2 * y3 * r23);
      l[1] -= s * (y1 * z3 * r12 - x1 * z3 * r13 + x1 * y3 * r23);
      l[2] -= s * (-y1 * z2 * r12 + x1 * z2 * r13 + x2 * y1 * r23);
    }
    // Near double roots the steps are slow and the last digits lost.
    return l.minCoeff() > 0.0 && off < 1e-10 * scale;
  }
  /// The pose with the points at these depths.
  Pose pose(const Eigen::Vector3d& l) const {
    const Eigen::Vector3d p1 = l[0] * bearings[0];
    const Eigen::Vector3d a = l[1] * bearings[1] - p1, b = l[2] * bearings[2] - p1;
    Pose T;
    T.linear().noalias() = frame(a, a.cross(b)) * frame_;
    T.translation() = p1 - T.linear() * origin_;
    return T;
  }

  Bearings3 bearings;
  double a12, a13, a23;  ///< Squared distances [m²].
  double b12, b13, b23;  ///< Cosines between rays.
  bool solvable;

 private:
  static Eigen::Matrix3d frame(const Eigen::Vector3d& x, const Eigen::Vector3d& z) {
    Eigen::Matrix3d m;
    m.col(0) = x * (1.0 / std::sqrt(x.squaredNorm()));
    m.col(2) = z * (1.0 / std::sqrt(z.squaredNorm()));
    m.col(1) = m.col(2).cross(m.col(0));
    return m;
  }
  Point3 origin_;
  Eigen::Matrix3d frame_ = Eigen::Matrix3d::Identity();
};
}  // namespace detail
}  // namespace surfleet
