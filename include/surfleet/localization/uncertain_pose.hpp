// SPDX-License-Identifier: MIT
/// @file
/// @brief A pose with its covariance; inversion and chains of such.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>

#include <surfleet/core/types.hpp>

namespace surfleet {
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The inverse of a covariance or an information matrix.
inline Matrix6 inverse_of(const Matrix6& symmetric) {
  return symmetric.ldlt().solve(Matrix6::Identity());
}
/// ln det of a covariance or an information matrix; ln 1e-300 if it is not positive definite.
inline double log_determinant(const Matrix6& symmetric) {
  const Eigen::LLT<Matrix6> root(symmetric);
  double log = 0.0;
  for (Eigen::Index i = 0; i < 6; ++i) log += 2.0 * std::log(root.matrixLLT()(i, i));
  const double least = std::log(1e-300);
  return root.info() == Eigen::Success && log > least ? log : least;
}
/// The matrix of the cross product with `v`.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}
/// The rotation about `w` by its length [rad].
inline Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity() + cross_matrix(w);
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}
/// The vector w with `rotation_exp(w)` = `r`, no longer than π.
inline Eigen::Vector3d rotation_log(const Eigen::Matrix3d& r) {
  const Eigen::AngleAxisd a(r);
  return a.angle() * a.axis();
}

/// The pose as far from `T` as ξ = (ω, v) says: R ← exp(ω) R, t ← t + v. Both parts are in the
/// frame that the pose leads to, rad and m.
inline Pose perturbed(const Pose& T, const Vector6& xi) {
  Pose out = T;
  out.linear() = rotation_exp(xi.head<3>()) * T.linear();
  out.translation() += xi.tail<3>();
  return out;
}
/// The ξ with `perturbed(from, ξ)` = `to`.
inline Vector6 difference(const Pose& from, const Pose& to) {
  Vector6 xi;
  xi << rotation_log(to.linear() * from.linear().transpose()),
      to.translation() - from.translation();
  return xi;
}

/// `T_a_b` and the covariance of its ξ (`perturbed`): angles first [rad, m], in frame a.
struct UncertainPose {
  Pose pose = Pose::Identity();
  Matrix6 covariance = Matrix6::Zero();

  /// `T_b_a`, to first order.
  UncertainPose inverse() const {
    const Eigen::Matrix3d rt = pose.linear().transpose();
    Matrix6 j = Matrix6::Zero();
    j.topLeftCorner<3, 3>() = -rt;
    j.bottomLeftCorner<3, 3>() = -rt * cross_matrix(pose.translation());
    j.bottomRightCorner<3, 3>() = -rt;
    return {pose.inverse(), j * covariance * j.transpose()};
  }
  /// The error of another pose that is thought to be this one, squared and weighed by the
  /// covariance: χ² with six degrees of freedom (NEES).
  double normalized_error(const Pose& truth) const {
    const Vector6 xi = difference(pose, truth);
    return xi.dot(Vector6(inverse_of(covariance) * xi));
  }
};

/// `T_a_c` of `T_a_b` and `T_b_c`, whose errors are independent, to first order.
inline UncertainPose operator*(const UncertainPose& ab, const UncertainPose& bc) {
  const Eigen::Matrix3d r = ab.pose.linear();
  Matrix6 first = Matrix6::Identity(), second = Matrix6::Zero();
  first.bottomLeftCorner<3, 3>() = -cross_matrix(r * bc.pose.translation());
  second.topLeftCorner<3, 3>() = r;
  second.bottomRightCorner<3, 3>() = r;
  return {ab.pose * bc.pose,
          first * ab.covariance * first.transpose() + second * bc.covariance * second.transpose()};
}
}  // namespace surfleet
