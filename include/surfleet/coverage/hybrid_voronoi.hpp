// SPDX-License-Identifier: MIT
/// @file
/// @brief Hybrid Voronoi coverage: deploy into Voronoi regions, then sweep them [004 §4.3.2,
/// variant 3].
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/hybrid_coverage.hpp>
#include <surfleet/coverage/lloyd.hpp>
#include <surfleet/coverage/nonconvex_coverage.hpp>
#include <surfleet/coverage/sweep_paths.hpp>

namespace surfleet {
enum class Deployment {
  Negotiated,  ///< Robots exchange virtual positions until they agree on regions, then drive there.
  Driven,      ///< Robots drive while they descend the coverage cost [004 Alg. 4].
};
struct HybridVoronoiOptions {
  Deployment deployment = Deployment::Negotiated;
  double balance = 0.02;  ///< Relative difference of areas that negotiation stops at; 0: plain CVT.
  int iterations = 400;   ///< At most, of Lloyd's algorithm.
};
struct HybridVoronoiPlan {
  std::vector<Region> regions;
  std::vector<TimedPath> paths;
};

/// Regions of nearly equal area around generators that move with them: a power diagram whose
/// weights grow where a region is too small, so that all sweeps end together. Robot i is given less
/// by `lane` times its distance from `start[i]` to its generator. Stops once the areas differ from
/// what they should be by less than the share `balance`, or after `iterations`.
inline std::vector<Region> balanced_regions(const Polygon& domain, std::span<const Point2> start,
                                            std::span<Point2> generators, double lane,
                                            double balance, int iterations) {
  const std::size_t n = generators.size();
  const double share = area(domain) / static_cast<double>(n);
  std::vector<double> fair(n, share);
  double mean_distance = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    mean_distance += (generators[i] - start[i]).norm() / static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i)
    fair[i] =
        std::max(0.2 * share, share - lane * ((generators[i] - start[i]).norm() - mean_distance));
  std::vector<double> weight(n, 0.0);
  std::vector<Region> regions(n);
  PolygonClipper clipper;
  for (int k = 0; k < iterations; ++k) {
    double worst = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      clipper.load(domain);
      for (std::size_t j = 0; j < n; ++j) {
        if (j == i) continue;
        HalfPlane h = HalfPlane::nearer(generators[i], generators[j]);
        h.offset += 0.5 * (weight[i] - weight[j]);
        clipper.cut(h);
      }
      regions[i] = clipper.region();
    }
    std::vector<Point2> centroids(n);
    for (std::size_t i = 0; i < n; ++i) {
      const RegionMoments m = region_moments(regions[i], generators[i], UniformDensity{}, 0.0);
      centroids[i] = m.centroid();
      worst = std::max(worst, std::abs(m.mass - fair[i]) / fair[i]);
      weight[i] += 0.3 * (fair[i] - m.mass);
    }
    if (worst <= balance) break;
    if (k < iterations / 2)
      for (std::size_t i = 0; i < n; ++i) generators[i] += 0.3 * (centroids[i] - generators[i]);
  }
  return regions;
}

/// One sweep per robot, of its Voronoi region. In a domain with obstacles a region may fall into
/// several parts; the robot visits them by shortest paths. Throws `Error` for bad placements.
template <SweepPattern Sweep = BackAndForthSweep>
HybridVoronoiPlan hybrid_voronoi(const Polygon& domain, std::span<const Point2> start,
                                 const HybridOptions& options = {},
                                 HybridVoronoiOptions settings = {}, const Sweep& sweep = {}) {
  require_valid(options);
  require_placed(domain, start);
  HybridVoronoiPlan plan;
  for (const Point2& p : start) plan.paths.emplace_back(p);
  std::vector<Point2> generators(start.begin(), start.end());
  const double tolerance = 1e-4 * domain.bounds().diagonal().norm();
  if (settings.deployment == Deployment::Driven) {
    NonconvexCoverage<ShortestPathPlanner> cover(domain, start,
                                                 {.speed = options.speed, .dt = 1.0});
    for (int k = 0; k < 20 * settings.iterations && !cover.converged(); ++k) {
      cover.step();
      for (std::size_t i = 0; i < start.size(); ++i)
        plan.paths[i].arrive(cover.robots()[i].real, cover.time());
    }
    generators = cover.real_positions();
  } else {
    const LloydCoverage<> lloyd(domain);
    for (int k = 0; k < settings.iterations && lloyd.step(generators).largest_move > tolerance;
         ++k) {
    }
  }
  if (settings.deployment == Deployment::Negotiated && settings.balance > 0.0 && start.size() > 1) {
    plan.regions = balanced_regions(domain, start, generators, options.lane, settings.balance,
                                    settings.iterations);
  } else {
    for (VoronoiCell& c : voronoi_tessellation(domain, generators).cells)
      plan.regions.push_back(std::move(c.region));
  }
  const PolygonGeodesics geodesics(domain);
  for (std::size_t i = 0; i < start.size(); ++i)
    plan.paths[i].follow(
        sweep_region(plan.regions[i], plan.paths[i].end(), geodesics, options, sweep),
        options.speed);
  return plan;
}
}  // namespace surfleet
