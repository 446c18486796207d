// SPDX-License-Identifier: MIT
/// @file
/// @brief Voronoi coverage of the plane: Lloyd's algorithm and the gradient-descent controller.
///
/// ```cpp
/// std::vector<Point2> robots = ...;
/// LloydCoverage<> cover{domain};
/// while (cover.step(robots).largest_move > 1e-3) {}
/// ```
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/centroid.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>

namespace surfleet {
struct LloydOptions {
  /// Longest side of a quadrature part [m]; nothing: a fortieth of the domain.
  std::optional<double> element{};
  int threads = 1;
};
/// What one evaluation of the tessellation tells.
struct CoverageState {
  std::vector<Point2> centroids;  ///< (Generalised) centroid of each region; the generator itself
                                  ///< where the region is empty.
  std::vector<double> mass;
  double cost = 0.0;  ///< H [004 eq. 3.25].
};
struct LloydStep {
  double cost = 0.0;          ///< Before the step.
  double largest_move = 0.0;  ///< [m]
};

/// Coverage of a polygon under Euclidean distance, a density and a performance function.
///
/// With `SquaredDistance` and `UniformDensity`, which is set-up 1 of [004 §3.5.3], all integrals
/// are exact; otherwise they are sums over a quadrature of each region.
template <PlanarDensity Density = UniformDensity, PerformanceFunction Performance = SquaredDistance>
class LloydCoverage {
 public:
  explicit LloydCoverage(Polygon domain, LloydOptions options = {}, Density rho = {},
                         Performance h = {})
      : density(std::move(rho)),
        performance(std::move(h)),
        domain_(std::move(domain)),
        options_(options),
        element_(options.element.value_or(domain_.bounds().diagonal().norm() / 40.0)) {}
  const Polygon& domain() const { return domain_; }

  /// Centroids, masses and cost of the tessellation of `robots`.
  CoverageState evaluate(std::span<const Point2> robots) const {
    CoverageState state;
    state.centroids.assign(robots.begin(), robots.end());
    state.mass.assign(robots.size(), 0.0);
    std::vector<double> costs(robots.size(), 0.0);
    for_each_voronoi_cell(
        domain_, robots,
        [&](std::size_t i, const PolygonClipper& clipper) {
          evaluate_cell(robots[i], clipper, state.centroids[i], state.mass[i], costs[i]);
        },
        options_.threads);
    for (const double c : costs) state.cost += c;
    return state;
  }
  /// H for the tessellation that belongs to the positions.
  double cost(std::span<const Point2> robots) const { return evaluate(robots).cost; }

  /// One iteration of Lloyd's algorithm [004 Alg. 1]: every robot to its centroid. In a domain that
  /// is not convex a centroid may lie outside; see `nonconvex_coverage.hpp`.
  LloydStep step(std::span<Point2> robots) const {
    const CoverageState state = evaluate(robots);
    LloydStep result{state.cost, 0.0};
    for (std::size_t i = 0; i < robots.size(); ++i) {
      result.largest_move = std::max(result.largest_move, (state.centroids[i] - robots[i]).norm());
      robots[i] = state.centroids[i];
    }
    return result;
  }
  /// One time step of single integrators under u = gain (c − p), no faster than `max_speed` [m/s]
  /// [004 eq. 3.33]. `gain · dt` ≤ 1.
  LloydStep control_step(std::span<Point2> robots, double gain, double dt,
                         double max_speed = std::numeric_limits<double>::infinity()) const {
    const CoverageState state = evaluate(robots);
    LloydStep result{state.cost, 0.0};
    for (std::size_t i = 0; i < robots.size(); ++i) {
      Point2 u = gain * (state.centroids[i] - robots[i]);
      if (u.norm() > max_speed) u *= max_speed / u.norm();
      robots[i] += dt * u;
      result.largest_move = std::max(result.largest_move, dt * u.norm());
    }
    return result;
  }

  Density density;
  Performance performance;

 private:
  void evaluate_cell(const Point2& robot, const PolygonClipper& clipper, Point2& centroid,
                     double& mass, double& cost) const {
    constexpr bool squared = std::same_as<Performance, SquaredDistance>;
    if constexpr (squared && std::same_as<Density, UniformDensity>) {
      RegionMoments m{robot, 0.0, Point2::Zero(), 0.0};
      clipper.for_each_tagged_edge(
          [&](const Point2& a, const Point2& b, std::int32_t) { m.add_edge(a, b); });
      centroid = m.centroid();
      mass = m.mass;
      cost = m.polar(robot);
    } else {
      const auto points = quadrature(clipper.region(), element_, density);
      RegionMoments m{robot, 0.0, Point2::Zero(), 0.0};
      for (const QuadraturePoint& q : points) m.add_point(q);
      mass = m.mass;
      if constexpr (squared) {
        centroid = m.centroid();
        cost = m.polar(robot);
      } else {
        centroid = generalized_centroid(points, robot, performance);
        cost = performance_cost(points, robot, performance);
      }
    }
  }
  Polygon domain_;
  LloydOptions options_;
  double element_;  // [m]
};

/// Robots at distinct random places of the domain, uniformly.
template <typename Generator>
std::vector<Point2> random_places(const Polygon& domain, std::size_t count, Generator& random) {
  const Box2 box = domain.bounds();
  std::vector<Point2> places;
  while (places.size() < count) {
    const double x = random.uniform(box.min().x(), box.max().x());
    const Point2 p(x, random.uniform(box.min().y(), box.max().y()));
    if (locate(domain, p) == Side::Inside) places.push_back(p);
  }
  return places;
}
}  // namespace surfleet
