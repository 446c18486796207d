// SPDX-License-Identifier: MIT
/// @file
/// @brief Vertex areas, principal curvatures and directions of a mesh, after Meyer, Desbrun,
/// Schröder and Barr (2003), "Discrete differential-geometry operators".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// The curvature of a surface at a vertex.
struct Curvature {
  double k1 = 0.0;  ///< Greater principal curvature [1/m]; positive where the surface bends away
                    ///< from its normal, as a sphere does.
  double k2 = 0.0;  ///< Lesser principal curvature [1/m].
  Eigen::Vector3d direction1 = Eigen::Vector3d::Zero();  ///< Of `k1`, unit length, tangent.
  Eigen::Vector3d direction2 = Eigen::Vector3d::Zero();  ///< Of `k2`.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();      ///< Unit length; zero where undefined.
};

namespace detail {
/// The cotangents of a triangle's corner angles, bounded so that slivers cannot blow up.
inline std::array<double, 3> corner_cotangents(const TriangleMesh& mesh, std::size_t t) {
  const double doubled = mesh.area_vector(t).norm();
  std::array<double, 3> cot{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d u = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k);
    const Eigen::Vector3d v = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
    const double limit = 1e4;
    cot[k] = doubled > 0.0 ? std::clamp(u.dot(v) / doubled, -limit, limit) : 0.0;
  }
  return cot;
}
}  // namespace detail

/// The mixed area of every vertex: its Voronoi area in the triangles around it, made safe in
/// obtuse ones. They sum to the area of the mesh. O(n + m).
inline std::vector<double> mixed_vertex_areas(const TriangleMesh& mesh) {
  std::vector<double> area(mesh.vertices.size(), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto cot = detail::corner_cotangents(mesh, t);
    const double whole = mesh.area(t);
    const bool obtuse = cot[0] < 0.0 || cot[1] < 0.0 || cot[2] < 0.0;
    double given = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t p = (k + 1) % 3, q = (k + 2) % 3;
      double share;
      if (obtuse || k == 2) {
        share = obtuse ? (cot[k] < 0.0 ? whole / 2.0 : whole / 4.0) : whole - given;
      } else {
        share = (cot[q] * (mesh.corner(t, p) - mesh.corner(t, k)).squaredNorm() +
                 cot[p] * (mesh.corner(t, q) - mesh.corner(t, k)).squaredNorm()) /
                8.0;
      }
      given += share;
      area[static_cast<std::size_t>(mesh.triangles[t][k])] += share;
    }
  }
  return area;
}

/// Curvature at every vertex; zero at borders and wherever no triangle gives a normal.
///
/// Mean and Gaussian curvature from the mixed area, principal directions by least squares of the
/// normal curvatures along the edges with the principal curvatures held. O(n + m).
inline std::vector<Curvature> principal_curvatures(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  const std::vector<double> area = mixed_vertex_areas(mesh);
  std::vector<Eigen::Vector3d> laplace(n, Eigen::Vector3d::Zero()),
      normal(n, Eigen::Vector3d::Zero());
  std::vector<double> angle(n, 0.0);
  std::vector<Eigen::Vector3d> turn(n, Eigen::Vector3d::Zero());
  std::vector<int> balance(n, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto cot = detail::corner_cotangents(mesh, t);
    const Eigen::Vector3d face = mesh.area_vector(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(mesh.triangles[t][k]);
      const std::size_t p = (k + 1) % 3, q = (k + 2) % 3;
      const Eigen::Vector3d u = mesh.corner(t, p) - mesh.corner(t, k);
      const Eigen::Vector3d v = mesh.corner(t, q) - mesh.corner(t, k);
      laplace[i] -= cot[q] * u + cot[p] * v;
      angle[i] += std::atan2(u.cross(v).norm(), u.dot(v));
      normal[i] += face;
      // Around an inner vertex every neighbour comes once on either side.
      const auto next = mesh.triangles[t][p], last = mesh.triangles[t][q];
      turn[i] +=
          Eigen::Vector3d(static_cast<double>(next) - static_cast<double>(last),
                          static_cast<double>(next) * next - static_cast<double>(last) * last, 0.0);
      ++balance[i];
    }
  }
  std::vector<Curvature> result(n);
  std::vector<Eigen::Matrix3d> system(n, Eigen::Matrix3d::Zero());
  std::vector<Eigen::Vector3d> right(n, Eigen::Vector3d::Zero()), axis1(n, Eigen::Vector3d::Zero()),
      axis2(n, Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    Curvature& c = result[i];
    c.normal = normal[i].stableNormalized();
    if (c.normal.isZero(0.0)) continue;
    c.direction1 = c.normal.unitOrthogonal();
    c.direction2 = c.normal.cross(c.direction1);
    axis1[i] = c.direction1;
    axis2[i] = c.direction2;
    const bool inner = balance[i] > 0 && turn[i].isZero(0.0);
    if (!inner || !(area[i] > 0.0)) continue;
    // The vector K of the paper is laplace / 2A = 2 H n.
    const double mean = 0.5 * (laplace[i] / (2.0 * area[i])).dot(c.normal);
    const double gauss = (2.0 * kPi - angle[i]) / area[i];
    const double root = std::sqrt(std::max(0.0, mean * mean - gauss));
    c.k1 = mean + root;
    c.k2 = mean - root;
  }
  // Least squares for the symmetric form (a b; b c) in the tangent plane, weights by area.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double weight = mesh.area(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(mesh.triangles[t][k]);
      for (std::size_t other = 1; other < 3; ++other) {
        const Eigen::Vector3d edge = mesh.corner(t, k) - mesh.corner(t, (k + other) % 3);
        const double squared = edge.squaredNorm();
        if (!(squared > 0.0)) continue;
        const Eigen::Vector2d d =
            Eigen::Vector2d(edge.dot(axis1[i]), edge.dot(axis2[i])).stableNormalized();
        const double along = 2.0 * edge.dot(result[i].normal) / squared;
        const Eigen::Vector3d row(d.x() * d.x(), 2.0 * d.x() * d.y(), d.y() * d.y());
        system[i] += weight * row * row.transpose();
        right[i] += weight * along * row;
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    Curvature& c = result[i];
    if (c.k1 == 0.0 && c.k2 == 0.0) continue;
    // A little of the identity keeps a vertex with edges in two directions only solvable.
    system[i].diagonal().array() += 1e-12 * system[i].trace();
    const Eigen::Vector3d form = system[i].inverse() * right[i];
    const double turned = 0.5 * std::atan2(2.0 * form[1], form[0] - form[2]);
    const Eigen::Vector2d greater(std::cos(turned), std::sin(turned));
    c.direction1 = greater.x() * axis1[i] + greater.y() * axis2[i];
    c.direction2 = c.normal.cross(c.direction1);
  }
  return result;
}
}  // namespace surfleet
