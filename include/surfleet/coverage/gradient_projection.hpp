// SPDX-License-Identifier: MIT
/// @file
/// @brief The gradient-projection controller for Voronoi coverage among walls [004 §5.3.2].
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/lloyd.hpp>
#include <surfleet/geometry/polygon_visibility.hpp>

namespace surfleet {
/// The negative gradient of one robot, projected onto the walls it touches [004 eq. 5.4–5.6].
///
/// `normals` are the outward normals of the active constraints. Constraints with a negative
/// multiplier are relaxed, most negative first, until none is left; zero means that the point
/// satisfies the Karush–Kuhn–Tucker criterion.
inline Point2 project_gradient(const Point2& descent, std::vector<Point2> normals) {
  constexpr double kParallel =
      1e-14;  // det over trace²: a quarter of the squared sine between two walls
  for (;;) {
    if (normals.empty()) return descent;
    // λ = −(A Aᵀ)⁺ A ∇H = A (Aᵀ A)⁺ descent, with the normals as the rows of A and ∇H = −descent.
    // Aᵀ A is of full rank, or, where all walls are parallel, of rank one: n nᵀ times its trace.
    Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
    for (const Point2& n : normals) square += n * n.transpose();
    const double trace = square.trace(), det = square.determinant();
    const Point2 solved = det > kParallel * trace * trace
                              ? Point2(square.inverse() * descent)
                              : Point2(square * descent / (trace * trace));
    const auto worst = std::min_element(
        normals.begin(), normals.end(),
        [&](const Point2& a, const Point2& b) { return a.dot(solved) < b.dot(solved); });
    if (worst->dot(solved) >= 0.0) {
      const Point2 z = descent - square * solved;
      return z.norm() <= 1e-12 * descent.norm() ? Point2(Point2::Zero()) : z;
    }
    normals.erase(worst);
  }
}

/// Robots that slide along the walls and never leave the domain. A constrained local minimum may
/// lie far from the global one; `NonconvexCoverage` avoids that.
template <PlanarDensity Density = UniformDensity>
class GradientProjectionCoverage {
 public:
  explicit GradientProjectionCoverage(const Polygon& domain, Density rho = {})
      : lloyd_(domain, {}, std::move(rho)), eps_(4.0 * visibility_tolerance(domain)) {}

  /// One time step under u = gain · z, no faster than `max_speed` [m/s].
  LloydStep step(std::span<Point2> robots, double gain, double dt, double max_speed) const {
    const CoverageState state = lloyd_.evaluate(robots);
    LloydStep result{state.cost, 0.0};
    for (std::size_t i = 0; i < robots.size(); ++i) {
      const Point2 before = robots[i];
      double budget = std::min(gain * (state.centroids[i] - before).norm(), max_speed) * dt;
      // A robot that meets a wall goes on along it with what is left of the step.
      for (int bounce = 0; bounce < 4 && budget > eps_; ++bounce) {
        const Point2 z = direction(robots[i], state.centroids[i] - robots[i]);
        const double length = z.norm();
        if (length <= eps_) break;
        const double step =
            std::min({budget, length, free_distance(lloyd_.domain(), robots[i], z / length)});
        if (step <= 0.0) break;
        robots[i] += step / length * z;
        if (!surfleet::contains(lloyd_.domain(), robots[i]))
          robots[i] = project_into(lloyd_.domain(), robots[i]);
        budget -= step;
      }
      result.largest_move = std::max(result.largest_move, (robots[i] - before).norm());
    }
    return result;
  }
  /// The feasible direction from `p`: `descent` itself where it is free, along the walls otherwise.
  Point2 direction(const Point2& p, const Point2& descent) const {
    const double length = descent.norm();
    if (length <= eps_) return Point2::Zero();
    const Polygon& domain = lloyd_.domain();
    // At a reflex corner two walls are touched although the step may be free.
    if (free_distance(domain, p, descent / length) > 2.0 * eps_) return descent;
    std::vector<Point2> normals;
    for_each_edge(domain, [&](const Point2& a, const Point2& b) {
      if ((closest_on_segment(a, b, p) - p).norm() <= 2.0 * eps_)
        normals.push_back(Point2(b.y() - a.y(), a.x() - b.x()).normalized());
    });
    const Point2 all = project_gradient(descent, normals);
    if (all.norm() > 0.0) return all;
    // A reflex corner: either wall alone may permit a step.
    Point2 best = Point2::Zero();
    for (const Point2& n : normals) {
      const Point2 z = project_gradient(descent, {n});
      if (z.norm() > best.norm() && free_distance(domain, p, z.normalized()) > 2.0 * eps_) best = z;
    }
    return best;
  }

 private:
  LloydCoverage<Density> lloyd_;
  double eps_;
};
}  // namespace surfleet
