// SPDX-License-Identifier: MIT
/// @file
/// @brief Quadrics fitted to the neighbourhood of a place in a cloud, and short drives on them
/// [004 §8.3].
///
///     const auto patch = fit_quadric(cloud, tree, at, {.noise = 0.005});
///     if (patch) pose = patch->drive(pose, curvature, 0.05);
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/point_cloud.hpp>

namespace surfleet {
/// A place on a patch, the direction driven and the outward normal: unit vectors at right angles.
struct PatchPose {
  Point3 position;
  Eigen::Vector3d forward, normal;
};

/// {x : f(x) = 0} with f(x) = yᵀ Q y + Pᵀ y + C about a centre, y = x − centre, of a surface near
/// that centre: f grows to the side of the normals it was fitted to.
struct QuadricPatch {
  Point3 centre = Point3::Zero();
  Eigen::Matrix3d Q = Eigen::Matrix3d::Zero();
  Eigen::Vector3d P = Eigen::Vector3d::UnitZ();
  double C = 0.0;
  double radius = 0.0;    ///< Valid so far from the centre [m].
  double residual = 0.0;  ///< Root mean square distance of the points, to first order [m].

  double value(const Point3& x) const {
    const Eigen::Vector3d y = x - centre;
    return y.dot(Q * y) + P.dot(y) + C;
  }
  Eigen::Vector3d gradient(const Point3& x) const { return 2.0 * Q * (x - centre) + P; }
  /// To first order [m], positive outside.
  double distance(const Point3& x) const {
    const double slope = gradient(x).norm();
    return slope > 0.0 ? value(x) / slope : value(x);
  }
  /// Along the gradient onto the patch; nothing where that does not lead there.
  std::optional<Point3> projected(Point3 x) const {
    const double far = 2.0 * std::max(radius, (x - centre).norm()) + 1e-9;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d g = gradient(x);
      if (!(g.squaredNorm() > 0.0)) return std::nullopt;
      const Eigen::Vector3d step = value(x) / g.squaredNorm() * g;
      x -= step;
      if (!((x - centre).norm() < far)) return std::nullopt;
      if (step.norm() < 1e-12 * (1.0 + far)) break;
    }
    return x;
  }
  /// On the patch nearest to a place, headed as nearly along `forward` as can be.
  std::optional<PatchPose> pose(const Point3& at, const Eigen::Vector3d& forward) const {
    const auto on = projected(at);
    if (!on) return std::nullopt;
    const Eigen::Vector3d n = gradient(*on).normalized();
    const Eigen::Vector3d ahead = forward - forward.dot(n) * n;
    if (!(ahead.norm() > 1e-12)) return std::nullopt;
    return PatchPose{*on, ahead.normalized(), n};
  }
  /// A motion primitive: `length` [m] at constant geodesic curvature [1/m], positive to the left,
  /// as a bicycle of wheel base L drives at the steering angle atan(L · curvature) [004 eq. 3.18].
  /// Ends early, with nothing, where it would leave what is valid. Steps of `step` [m].
  std::optional<PatchPose> drive(PatchPose at, double curvature, double length,
                                 double step = 2e-3) const {
    const int parts = std::max(1, static_cast<int>(std::ceil(length / step)));
    const double ds = length / parts;
    for (int i = 0; i < parts; ++i) {
      // The middle of the step is better than its beginning by an order.
      const Eigen::Vector3d left = at.normal.cross(at.forward);
      const double half = 0.5 * curvature * ds;
      const Eigen::Vector3d chord = std::cos(half) * at.forward + std::sin(half) * left;
      const Eigen::Vector3d end = std::cos(2.0 * half) * at.forward + std::sin(2.0 * half) * left;
      const auto next = pose(at.position + ds * chord, end);
      if (!next || (next->position - centre).norm() > radius) return std::nullopt;
      at = *next;
    }
    return at;
  }
};

struct QuadricOptions {
  double noise = 0.005;        ///< Standard deviation of the points across the surface [m].
  double least_radius = 0.06;  ///< Of a patch [m].
  double most_radius = 0.3;    ///< [m]
  std::size_t least_points = 15;
};

/// The quadric through the points about a place with the least sum of squared distances along their
/// mean normal, weighted by `saliency` where one value a point is given: of all quadrics one that
/// is a graph over the tangent plane, as others have a second sheet for noise to hide behind. The
/// patch grows by
/// a fifth at a time while its residual stays under twice the noise. The side comes from the
/// cloud's normals, which face the sensor. Nothing where points are too few or fit no patch.
/// Throws `Error` without normals. O(points in the patch).
inline std::optional<QuadricPatch> fit_quadric(const PointCloud& cloud, const KdTree& tree,
                                               const Point3& at, const QuadricOptions& options = {},
                                               std::span<const double> saliency = {}) {
  require(cloud.normals.size() == cloud.size() && tree.size() == cloud.size(),
          "quadric: expected normals and a tree of the cloud's own points");
  require(saliency.empty() || saliency.size() == cloud.size(),
          "quadric: expected one saliency a point or none");
  require(options.noise > 0.0 && options.least_radius > 0.0 &&
              options.most_radius >= options.least_radius,
          "quadric: expected noise and radii of more than 0 m");
  using Row = Eigen::Matrix<double, 6, 1>;
  using Square = Eigen::Matrix<double, 6, 6>;
  std::optional<QuadricPatch> best;
  for (double radius = options.least_radius;;
       radius = std::min(1.2 * radius, options.most_radius)) {
    const std::vector<Neighbor> near = tree.within(at, radius);
    Eigen::Vector3d outward = Eigen::Vector3d::Zero();
    for (const Neighbor& n : near)
      outward += cloud.normals[static_cast<std::size_t>(n.index)].cast<double>();
    outward.normalize();
    const auto counts = [&](const Neighbor& n) {  // not what lies on another sheet
      return cloud.normals[static_cast<std::size_t>(n.index)].cast<double>().dot(outward) > 0.0;
    };
    const Eigen::Vector3d u = outward.unitOrthogonal(), v = outward.cross(u);
    Row right = Row::Zero();
    Square normal = Square::Zero();
    double weight = 0.0;
    std::size_t used = 0;
    for (const Neighbor& n : near) {
      if (!counts(n)) continue;
      const auto i = static_cast<std::size_t>(n.index);
      const double w = saliency.empty() ? 1.0 : std::max(0.0, saliency[i]);
      const Eigen::Vector3d y = (cloud.points[i] - at) / radius;
      const double a = y.dot(u), b = y.dot(v);
      Row row;
      row << a * a, a * b, b * b, a, b, 1.0;
      normal += w * row * row.transpose();
      right += w * y.dot(outward) * row;
      weight += w;
      ++used;
    }
    if (used >= options.least_points && weight > 0.0) {
      const Eigen::LDLT<Square> solver(normal);
      const Row c = solver.solve(right);
      // Too few places apart leave some curvature open.
      if (solver.vectorD().minCoeff() > 1e-9 * weight && c.allFinite()) {
        QuadricPatch patch;
        patch.centre = at;
        patch.radius = radius;
        patch.Q =
            -(c[0] * u * u.transpose() + 0.5 * c[1] * (u * v.transpose() + v * u.transpose()) +
              c[2] * v * v.transpose()) /
            radius;
        patch.P = outward - c[3] * u - c[4] * v;
        patch.C = -c[5] * radius;
        double squares = 0.0;
        for (const Neighbor& n : near) {
          if (!counts(n)) continue;
          const auto i = static_cast<std::size_t>(n.index);
          const double d = patch.distance(cloud.points[i]);
          squares += (saliency.empty() ? 1.0 : std::max(0.0, saliency[i])) * d * d;
        }
        patch.residual = std::sqrt(squares / weight);
        if (!(patch.residual < 2.0 * options.noise) || !patch.projected(at)) return best;
        best = patch;
      }
    }
    if (radius >= options.most_radius) return best;
  }
}
}  // namespace surfleet
