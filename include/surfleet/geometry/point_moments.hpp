// SPDX-License-Identifier: MIT
/// @file
/// @brief Mean and covariance of points, and the axes along which they spread.
#pragma once

#include <Eigen/Eigenvalues>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// Weighted sums over points, taken relative to a place near them so that nothing cancels.
struct PointMoments {
  double weight = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  void add(const Eigen::Vector3d& offset, double w = 1.0) {
    weight += w;
    first += w * offset;
    second += w * offset * offset.transpose();
  }
  /// Of the offsets.
  Eigen::Vector3d mean() const { return first / weight; }
  Eigen::Matrix3d covariance() const {
    const Eigen::Vector3d m = mean();
    return second / weight - m * m.transpose();
  }
};

/// Eigenvalues of a symmetric matrix, ascending, and their unit vectors in columns.
struct PrincipalAxes {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;

  explicit PrincipalAxes(const Eigen::Matrix3d& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
    values = solver.eigenvalues();
    vectors = solver.eigenvectors();
  }
};
}  // namespace surfleet
