// SPDX-License-Identifier: MIT
/// @file
/// @brief Where and in which direction a surface deserves more robots: a density and a Finsler or
/// metric tensor at every vertex [004 §6.3.1, §6.4.1].
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/curvature.hpp>
#include <surfleet/geometry/geodesic.hpp>

namespace surfleet {
/// Density and metric per vertex of one mesh. Empty arrays stand for 1 and the identity.
struct MetricField {
  std::vector<double> density;          ///< ρ ≥ 0.
  std::vector<Eigen::Matrix3d> tensor;  ///< K̃ = B̃ᵀB̃, symmetric positive definite.
  double norm = 2.0;                    ///< p of the norm ‖B̃ z‖_p, at least 1.
};

/// A rule that makes the field of a mesh.
template <typename F>
concept MetricFieldPolicy = requires(const F& field, const TriangleMesh& mesh) {
  { field(mesh) } -> std::convertible_to<MetricField>;
};

/// The same everywhere and in every direction.
struct UniformField {
  MetricField operator()(const TriangleMesh&) const { return {}; }
};

/// Denser where the surface bends: ρ = 1 + √(k₁² + k₂²) [004 §6.5.2], curvatures in 1/`unit`.
struct CurvatureField {
  double unit = 1.0;  ///< Length in which curvature is read [m].
  MetricField operator()(const TriangleMesh& mesh) const {
    MetricField field;
    for (const Curvature& c : principal_curvatures(mesh))
      field.density.push_back(1.0 + unit * std::hypot(c.k1, c.k2));
    return field;
  }
};

/// Distances across `direction` count `ratio` times: regions stretch along it where ratio > 1.
struct DirectionalField {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double ratio = 2.0;
  MetricField operator()(const TriangleMesh& mesh) const {
    require(ratio > 0.0 && direction.norm() > 0.0,
            "DirectionalField: ratio must be positive and direction not zero");
    const Eigen::Vector3d d = direction.normalized();
    const Eigen::Matrix3d along = d * d.transpose();
    MetricField field;
    field.tensor.assign(mesh.vertices.size(),
                        along + ratio * ratio * (Eigen::Matrix3d::Identity() - along));
    return field;
  }
};

/// Regions stretch along the direction of least curvature, by up to `ratio` where the principal
/// curvatures differ most: round a tube's axis, for back-and-forth sweeps.
struct PrincipalDirectionField {
  double ratio = 2.0;
  MetricField operator()(const TriangleMesh& mesh) const {
    require(ratio >= 1.0, "PrincipalDirectionField: ratio must be at least 1");
    MetricField field;
    for (const Curvature& c : principal_curvatures(mesh)) {
      const bool first = std::abs(c.k1) > std::abs(c.k2);
      const double big = std::max(std::abs(c.k1), std::abs(c.k2));
      const double small = std::min(std::abs(c.k1), std::abs(c.k2));
      const double stretch = big > 0.0 ? 1.0 + (ratio - 1.0) * (big - small) / big : 1.0;
      const Eigen::Vector3d across = first ? c.direction1 : c.direction2;
      field.tensor.push_back(Eigen::Matrix3d::Identity() +
                             (stretch * stretch - 1.0) * across * across.transpose());
    }
    return field;
  }
};
static_assert(MetricFieldPolicy<UniformField> && MetricFieldPolicy<CurvatureField> &&
              MetricFieldPolicy<DirectionalField> && MetricFieldPolicy<PrincipalDirectionField>);

/// The length of a short piece under a field: the mean of ‖B̃ δ‖_p at its two ends (eq. 6.2, made
/// symmetric).
class FieldMetric {
 public:
  FieldMetric(const std::vector<Eigen::Matrix3d>& tensor, double norm)
      : tensor_(&tensor), norm_(norm) {
    require(norm >= 1.0, "metric field: the norm's p must be at least 1");
    if (norm == 2.0) return;
    for (const Eigen::Matrix3d& k : tensor) {
      // Denman and Beavers: y to the square root of k, z to its inverse.
      Eigen::Matrix3d y = k, z = Eigen::Matrix3d::Identity();
      for (int iteration = 0; iteration < 20; ++iteration) {
        const Eigen::Matrix3d next = 0.5 * (y + z.inverse());
        z = 0.5 * (z + y.inverse()).eval();
        y = next;
      }
      root_.push_back(y);
    }
  }
  double operator()(std::int32_t a, std::int32_t b, const Eigen::Vector3d& delta) const {
    return 0.5 * (at(a, delta) + at(b, delta));
  }

 private:
  double at(std::int32_t v, const Eigen::Vector3d& delta) const {
    const auto i = static_cast<std::size_t>(v);
    if (norm_ == 2.0)
      return tensor_->empty() ? delta.norm() : std::sqrt(delta.dot((*tensor_)[i] * delta));
    const Eigen::Vector3d z = root_.empty() ? delta : Eigen::Vector3d(root_[i] * delta);
    return std::pow(z.array().abs().pow(norm_).sum(), 1.0 / norm_);
  }
  const std::vector<Eigen::Matrix3d>* tensor_;
  std::vector<Eigen::Matrix3d> root_;
  double norm_;
};
static_assert(SegmentMetric<FieldMetric>);

/// Throws `Error` unless the field fits the mesh and is positive definite.
inline void require_valid_field(const MetricField& field, const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  require(field.density.empty() || field.density.size() == n,
          "metric field: need one density a vertex");
  require(field.tensor.empty() || field.tensor.size() == n,
          "metric field: need one tensor a vertex");
  for (const double rho : field.density)
    require(rho >= 0.0 && rho < ShortestPaths::kUnreached,
            "metric field: a density is negative or not finite");
  for (const Eigen::Matrix3d& k : field.tensor)
    require(k.allFinite() && (k - k.transpose()).norm() <= 1e-9 * k.norm() && k(0, 0) > 0.0 &&
                k(0, 0) * k(1, 1) > k(0, 1) * k(1, 0) && k.determinant() > 0.0,
            "metric field: a tensor is not symmetric positive definite");
}
}  // namespace surfleet
