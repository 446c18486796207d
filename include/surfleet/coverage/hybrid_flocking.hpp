// SPDX-License-Identifier: MIT
/// @file
/// @brief Coverage by flocking and sweeping: every robot steers by an angular histogram of
/// uncovered ground, weighted by attraction, repulsion and enhancement [004 §4.3.1, variant 1].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/hybrid_coverage.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>
#include <surfleet/geometry/polygon_visibility.hpp>

namespace surfleet {
struct FlockingOptions {
  double scan_radius = 0.4;        ///< Ground within it is counted [m].
  double critical_distance = 0.8;  ///< From the group's centre; beyond it robots turn back [m].
  double separation = 0.12;        ///< Directions to robots nearer than this are devalued [m].
  double inertia = 0.6;            ///< Spread of the preference for the present direction [rad].
  double main_spread = 1.5;        ///< Spread of the preference for the main sweep direction [rad].
  double main_period = 30.0;       ///< Between agreements on a new main sweep direction [s].
  double dt = 1.0;                 ///< [s]
  double share = 1.0;              ///< Stop once this share is covered.
  double max_time = 20000.0;       ///< [s]
  /// A robot that has covered nothing new for this long heads for the nearest uncovered ground [s].
  /// Infinite: never, as in [004 Fig. 4.7], where coverage ends at about nine tenths.
  double patience = 20.0;
};
struct FlockingRun {
  std::vector<TimedPath> paths;
  std::vector<std::pair<double, double>> main_direction;  ///< (time, angle) of every agreement.
};

inline FlockingRun flocking_coverage(const Polygon& domain, std::span<const Point2> start,
                                     const HybridOptions& options = {},
                                     FlockingOptions settings = {}) {
  require_valid(options);
  require_placed(domain, start);
  constexpr std::size_t kBins = 36;
  using Histogram = std::array<double, kBins>;
  const auto angle_of = [](std::size_t bin) {
    return 2.0 * kPi * static_cast<double>(bin) / kBins;
  };
  const auto bell = [](double angle, double spread) {
    const double a = wrap_angle(angle) / spread;
    return std::exp(-0.5 * a * a);
  };
  CoverageGrid grid(domain, options.cell);
  const PolygonGeodesics geodesics(domain);
  FlockingRun run;
  std::vector<Point2> at(start.begin(), start.end());
  std::vector<double> heading(start.size(), 0.0);
  std::vector<std::vector<Point2>> path(start.size());  // to remaining ground, while none is near
  for (const Point2& p : at) {
    run.paths.emplace_back(p);
    grid.cover(p, p, options.footprint);
  }
  std::vector<double> last_new(start.size(), 0.0);
  double main = 0.0, next_agreement = settings.main_period;
  Histogram seen{};
  run.main_direction.emplace_back(0.0, main);
  for (double t = settings.dt; t <= settings.max_time && grid.fraction() < settings.share;
       t += settings.dt) {
    Point2 centre = Point2::Zero();
    for (const Point2& p : at) centre += p / static_cast<double>(at.size());
    const double reach = options.speed * settings.dt;
    for (std::size_t i = 0; i < at.size(); ++i) {
      Histogram count{};
      grid.for_each_near(at[i], at[i], settings.scan_radius, [&](std::size_t c) {
        if (!grid.inside(c) || grid.covered(c)) return;
        const Point2 d = grid.centre(c) - at[i];
        const double range = std::max(d.norm(), options.cell);
        const double turn = std::atan2(d.y(), d.x()) / (2.0 * kPi) * kBins;
        const auto bin = static_cast<std::size_t>(std::lround(turn + kBins)) % kBins;
        count[bin] += options.footprint / range;  // near ground counts several times
      });
      double total = 0.0;
      for (std::size_t b = 0; b < kBins; ++b) {
        seen[b] += count[b];
        total += count[b];
      }
      Point2 goal = at[i];
      const bool bored = t - last_new[i] > settings.patience;
      if (total > 0.0 && path[i].empty() && !bored) {
        const Point2 home = centre - at[i];
        const double to_centre = std::atan2(home.y(), home.x());
        const double strayed = home.norm() / settings.critical_distance;
        double best = 0.0;
        for (std::size_t b = 0; b < kBins; ++b) {
          const double a = angle_of(b);
          const Point2 u(std::cos(a), std::sin(a));
          double w = count[b] + 1e-3 * total / kBins;
          // Attraction: a narrow bell towards the centre once the robot is too far away.
          w *= bell(a - to_centre, strayed > 1.0 ? 0.5 : 4.0);
          for (std::size_t j = 0; j < at.size(); ++j) {
            if (j == i) continue;
            const Point2 d = at[j] - at[i];
            if (d.norm() < settings.separation)
              w *= 1.0 - 0.95 * bell(a - std::atan2(d.y(), d.x()), 0.7);
          }
          w *= 0.1 + bell(a - heading[i], settings.inertia);
          w *= 0.3 + bell(a - main, settings.main_spread);
          if (w <= best || free_distance(domain, at[i], u) < reach) continue;
          best = w;
          heading[i] = a;
          goal = at[i] + reach * u;
        }
      } else if (bored || !path[i].empty()) {
        if (path[i].empty()) {
          std::size_t nearest = grid.cells();
          double least = std::numeric_limits<double>::infinity();
          for (std::size_t c = 0; c < grid.cells(); ++c)
            if (grid.inside(c) && !grid.covered(c) &&
                (grid.centre(c) - at[i]).squaredNorm() < least) {
              least = (grid.centre(c) - at[i]).squaredNorm();
              nearest = c;
            }
          if (nearest < grid.cells()) {
            path[i] = geodesics.from(at[i]).path(grid.centre(nearest));
            std::reverse(path[i].begin(), path[i].end());
            if (!path[i].empty()) path[i].pop_back();
          }
        }
        if (!path[i].empty()) {
          const Point2 d = path[i].back() - at[i];
          if (d.norm() <= reach) {
            goal = path[i].back();
            path[i].pop_back();
          } else {
            goal = at[i] + reach * d.normalized();
          }
          heading[i] = std::atan2(d.y(), d.x());
        }
      }
      if (!contains(domain, goal)) goal = project_into(domain, goal);
      grid.cover(at[i], goal, options.footprint, [&](std::size_t) { last_new[i] = t; });
      at[i] = goal;
      run.paths[i].arrive(goal, t);
    }
    if (t >= next_agreement) {
      // The direction with most uncovered ground, summed over the robots and the period.
      std::size_t best = 0;
      for (std::size_t b = 1; b < kBins; ++b)
        if (seen[b] > seen[best]) best = b;
      main = wrap_angle(angle_of(best));
      run.main_direction.emplace_back(t, main);
      seen.fill(0.0);
      next_agreement += settings.main_period;
    }
  }
  return run;
}
}  // namespace surfleet
