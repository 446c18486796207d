// SPDX-License-Identifier: MIT
/// @file
/// @brief Edges of a noisy cloud: lines in which the tangent planes of the sheets nearby meet.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/kd_tree.hpp>

namespace surfleet {
/// What a point knows of the crease nearest to it.
struct Crease {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< Of its own sheet, of either sign.
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< Along the crease, of either sign.
  double offset = 0.0;  ///< From the point to its own sheet along `normal` [m].
  double share = 0.0;   ///< (λ₂ − λ₃) / λ₁ of the normals' tensor: how far the given
                        ///< ones, which turn over a neighbourhood, are spread.
  double distance = std::numeric_limits<double>::infinity();  ///< To the crease [m].
  Point3 nearest = Point3::Zero();  ///< The nearest place on the crease, where there is one [m].
};

/// Normals first agree with those of alike neighbours alone (a bilateral filter), which makes them
/// jump at a crease instead of turning over a neighbourhood. The place where all tangent planes in
/// reach come closest, in the directions that their normals span, is the crease. A bent sheet has
/// such a place too, but its normals are spread little: `share` tells them apart.
struct CreaseFinder {
  double scale = 0.06;   ///< σ [m].
  double reach = 1.5;    ///< Over which normals are compared and planes meet [scales].
  double filter = 1.5;   ///< Reach of the filter [scales].
  double alike = 0.35;   ///< Sine of the angle between normals at which the weight is 1/e.
  double aligned = 0.7;  ///< Distance off a neighbour's plane at which the weight is 1/e [scales].
  int rounds = 3;        ///< Of the filter.
  int threads = 1;

  /// For each of `places`, an index into the points. `normals` has one a point, of either sign.
  /// The same for any number of threads. O(n k).
  std::vector<Crease> operator()(std::span<const Point3> points,
                                 std::span<const Eigen::Vector3d> normals,
                                 std::span<const std::size_t> places) const {
    require(
        scale > 0.0 && reach > 0.0 && filter > 0.0 && alike > 0.0 && aligned > 0.0 && rounds >= 0,
        "creases: expected positive scales and 0 rounds or more");
    require(points.size() == normals.size(), "creases: expected one normal a point");
    const KdTree tree(points);
    std::vector<Eigen::Vector3d> sharp(normals.begin(), normals.end()), next(sharp);
    for (int round = 0; round < rounds; ++round) {
      parallel_for(
          points.size(), threads,
          [&](std::size_t i) { next[i] = alike_around(tree, points, sharp, i).normal; }, 64);
      sharp.swap(next);
    }
    std::vector<Crease> found(places.size());
    parallel_for(
        places.size(), threads,
        [&](std::size_t k) {
          const std::size_t i = places[k];
          Crease& crease = found[k];
          const Sheet sheet = alike_around(tree, points, sharp, i);
          crease.normal = sharp[i];
          crease.offset = sheet.offset;
          const double radius = reach * scale;
          Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), given = spread;
          Eigen::Vector3d planes = Eigen::Vector3d::Zero();
          tree.for_each_within(points[i], radius, [&](const Neighbor& n) {
            const auto j = static_cast<std::size_t>(n.index);
            const double inside = 1.0 - n.distance2 / (radius * radius), w = inside * inside;
            spread += w * sharp[j] * sharp[j].transpose();
            given += w * normals[j] * normals[j].transpose();
            planes += w * sharp[j].dot(points[j] - points[i]) * sharp[j];
          });
          const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
          const Eigen::Vector3d l = solver.eigenvalues();
          if (!(l[2] > 0.0)) return;
          crease.tangent = solver.eigenvectors().col(0);
          const Eigen::Vector3d g =
              Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(given, Eigen::EigenvaluesOnly)
                  .eigenvalues();
          crease.share = (g[1] - g[0]) / g[2];
          if (!(l[1] > 1e-3 * l[2])) return;
          Eigen::Vector3d to = Eigen::Vector3d::Zero();
          for (int axis = 1; axis < 3; ++axis) {
            const Eigen::Vector3d e = solver.eigenvectors().col(axis);
            to += e * (e.dot(planes) / l[axis]);
          }
          crease.distance = to.norm();
          crease.nearest = points[i] + to;
        },
        64);
    return found;
  }

 private:
  struct Sheet {
    Eigen::Vector3d normal;
    double offset;
  };
  Sheet alike_around(const KdTree& tree, std::span<const Point3> points,
                     const std::vector<Eigen::Vector3d>& normals, std::size_t i) const {
    const double radius = filter * scale, off = aligned * scale;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weight = 0.0, offset = 0.0;
    const Eigen::Vector3d& here = normals[i];
    tree.for_each_within(points[i], radius, [&](const Neighbor& n) {
      const auto j = static_cast<std::size_t>(n.index);
      const double cosine = here.dot(normals[j]), height = here.dot(points[j] - points[i]);
      const double w =
          (1.0 - n.distance2 / (radius * radius)) *
          std::exp((cosine * cosine - 1.0) / (alike * alike) - height * height / (off * off));
      sum += cosine < 0.0 ? Eigen::Vector3d(-w * normals[j]) : Eigen::Vector3d(w * normals[j]);
      weight += w;
      offset += w * height;
    });
    if (!(sum.norm() > 0.0)) return {here, 0.0};
    return {sum.normalized(), offset / weight};
  }
};
}  // namespace surfleet
