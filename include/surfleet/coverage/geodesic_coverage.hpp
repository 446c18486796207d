// SPDX-License-Identifier: MIT
/// @file
/// @brief Voronoi tessellation and coverage of a polygon under its shortest-path distance: set-up 2
/// of [004 §3.5.3], and the final tessellation of a non-convex deployment.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/coverage_grid.hpp>
#include <surfleet/coverage/density.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>
#include <surfleet/geometry/polygon_geodesic.hpp>

namespace surfleet {
/// For every cell of a grid, whose it is and how far away. Regions are connected (up to the grid),
/// as shortest paths do not leave them.
struct GeodesicTessellation {
  std::vector<std::int32_t> owner;  ///< −1 outside the domain. Ties go to the lower robot.
  std::vector<double> distance;     ///< [m]
  double cost = 0.0;                ///< Σ d² ρ over the cells times their area.
};

/// O(cells · k · r n) with k robots that might be nearest.
template <PlanarDensity Density = UniformDensity>
GeodesicTessellation geodesic_tessellation(const PolygonGeodesics& geodesics,
                                           const CoverageGrid& grid, std::span<const Point2> robots,
                                           const Density& rho = {}) {
  std::vector<GeodesicField> fields;
  for (const Point2& p : robots) fields.push_back(geodesics.from(p));
  GeodesicTessellation t{std::vector<std::int32_t>(grid.cells(), -1),
                         std::vector<double>(grid.cells(), ShortestPaths::kUnreached), 0.0};
  std::vector<std::pair<double, std::size_t>> order(robots.size());
  const double cell_area = grid.cell_size() * grid.cell_size();
  for (std::size_t c = 0; c < grid.cells(); ++c) {
    if (!grid.inside(c)) continue;
    const Point2 q = grid.centre(c);
    for (std::size_t i = 0; i < robots.size(); ++i) order[i] = {(robots[i] - q).norm(), i};
    std::sort(order.begin(), order.end());
    for (const auto& [bound, i] : order) {
      if (bound > t.distance[c]) break;
      const double d = fields[i].distance(q);
      const auto id = static_cast<std::int32_t>(i);
      if (d < t.distance[c] || (d == t.distance[c] && id < t.owner[c])) {
        t.distance[c] = d;
        t.owner[c] = id;
      }
    }
    if (t.owner[c] >= 0) t.cost += t.distance[c] * t.distance[c] * rho(q) * cell_area;
  }
  return t;
}

struct GeodesicCoverageOptions {
  /// Of the grid the regions are counted on [m]; nothing: a sixtieth of the domain.
  std::optional<double> cell{};
};

/// Coverage by gradient descent on H with h = d² and shortest-path distance.
///
/// The gradient of d² with respect to the robot points along the first segment of the path, so the
/// descent direction is the mean of the region's star-shaped image [004 Def. 5.1] about the robot.
/// A step is halved until the cost falls; robots never leave the domain.
template <PlanarDensity Density = UniformDensity>
class GeodesicCoverage {
 public:
  explicit GeodesicCoverage(const Polygon& domain, GeodesicCoverageOptions options = {},
                            Density rho = {})
      : density(std::move(rho)),
        geodesics_(domain),
        grid_(domain, options.cell.value_or(domain.bounds().diagonal().norm() / 60.0)) {}

  const CoverageGrid& grid() const { return grid_; }
  const PolygonGeodesics& geodesics() const { return geodesics_; }
  GeodesicTessellation tessellate(std::span<const Point2> robots) const {
    return geodesic_tessellation(geodesics_, grid_, robots, density);
  }
  /// Every robot steps towards the mean of its image, no farther than `max_step` [m]; returns the
  /// largest move and updates `t`, the tessellation of `robots`.
  double step(std::span<Point2> robots, GeodesicTessellation& t, double max_step) const {
    std::vector<Point2> offset(robots.size(), Point2::Zero());
    std::vector<double> mass(robots.size(), 0.0);
    std::vector<GeodesicField> fields;
    for (const Point2& p : robots) fields.push_back(geodesics_.from(p));
    for (std::size_t c = 0; c < grid_.cells(); ++c) {
      if (t.owner[c] < 0) continue;
      const auto i = static_cast<std::size_t>(t.owner[c]);
      const Point2 q = grid_.centre(c);
      const double w = density(q);
      offset[i] += w * (fields[i].star_image(q) - robots[i]);
      mass[i] += w;
    }
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (mass[i] > 0.0) offset[i] /= mass[i];
      const double length = offset[i].norm();
      if (length == 0.0) continue;
      const double free = free_distance(geodesics_.polygon(), robots[i], offset[i] / length);
      offset[i] *= std::min({1.0, max_step / length, 0.99 * free / length});
    }
    for (double share = 1.0; share > 1e-3; share *= 0.5) {
      std::vector<Point2> moved(robots.begin(), robots.end());
      double largest = 0.0;
      for (std::size_t i = 0; i < moved.size(); ++i) {
        moved[i] += share * offset[i];
        largest = std::max(largest, share * offset[i].norm());
      }
      GeodesicTessellation better = tessellate(moved);
      if (better.cost < t.cost) {
        std::copy(moved.begin(), moved.end(), robots.begin());
        t = std::move(better);
        return largest;
      }
    }
    return 0.0;
  }

  Density density;

 private:
  PolygonGeodesics geodesics_;
  CoverageGrid grid_;
};
}  // namespace surfleet
