// SPDX-License-Identifier: MIT
/// @file
/// @brief Paths along which one robot sweeps a region: back and forth, and in a spiral.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/coverage_grid.hpp>
#include <surfleet/coverage/hybrid_coverage.hpp>
#include <surfleet/geometry/polygon_clipping.hpp>
#include <surfleet/geometry/polygon_geodesic.hpp>
#include <surfleet/geometry/polygon_trapezoids.hpp>

namespace surfleet {
/// Appends the shortest path inside the domain from the end of `path` to `to`; nothing if there is
/// none.
inline void append_path(std::vector<Point2>& path, const Point2& to,
                        const PolygonGeodesics& domain) {
  if (path.empty() || sees(domain.polygon(), path.back(), to)) {
    path.push_back(to);
    return;
  }
  const std::vector<Point2> onward = domain.from(path.back()).path(to);
  if (onward.size() > 1) path.insert(path.end(), onward.begin() + 1, onward.end());
}

/// What hybrid coverage asks of a sweep: a path from `from` over one part of a region, whose lanes
/// lie in the part and whose connections lie in the domain. It begins with `from`.
template <typename S>
concept SweepPattern = requires(const S& sweep, const Polygon& part, const Point2& from,
                                const PolygonGeodesics& domain, const HybridOptions& o) {
  { sweep(part, from, domain, o) } -> std::convertible_to<std::vector<Point2>>;
};

/// Lanes along the direction in which the part is longest, swept in turns. A part that is not
/// convex falls into cells that are each swept in one go (boustrophedon decomposition), nearest
/// first.
struct BackAndForthSweep {
  std::optional<double> direction{};  ///< Of the lanes [rad]; chosen for the fewest turns if unset.

  std::vector<Point2> operator()(const Polygon& part, const Point2& from,
                                 const PolygonGeodesics& domain, const HybridOptions& o) const {
    const double angle = direction.value_or(best_direction(part));
    const Eigen::Rotation2Dd turn_back(angle);
    const Polygon level = rotated(part, -angle);
    std::vector<Cell> cells = lanes(level, o);
    std::vector<Point2> path{from};
    while (!cells.empty()) {
      // The nearest of all corners where a cell may be entered.
      std::size_t best = 0;
      int best_corner = 0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t c = 0; c < cells.size(); ++c)
        for (int corner = 0; corner < 4; ++corner) {
          const double d = (turn_back * corner_of(cells[c], corner) - path.back()).norm();
          if (d < nearest) {
            nearest = d;
            best = c;
            best_corner = corner;
          }
        }
      Cell cell = std::move(cells[best]);
      cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(best));
      if ((best_corner & 2) != 0) std::reverse(cell.begin(), cell.end());
      bool rightwards = (best_corner & 1) == 0;
      for (const Lane& lane : cell) {
        const Point2 a(lane.from, lane.y), b(lane.to, lane.y);
        append_path(path, turn_back * (rightwards ? a : b), domain);
        append_path(path, turn_back * (rightwards ? b : a), domain);
        rightwards = !rightwards;
      }
    }
    return path;
  }

  /// The direction across which the part is narrowest: along an edge of its convex hull.
  static double best_direction(const Polygon& part) {
    const Ring hull = convex_hull(part.outer);
    double best = 0.0, narrowest = std::numeric_limits<double>::infinity();
    for_each_edge(hull, [&](const Point2& a, const Point2& b) {
      const Point2 u = (b - a).normalized();
      double width = 0.0;
      for (const Point2& p : hull) width = std::max(width, std::abs(cross2(u, p - a)));
      if (width < narrowest - 1e-12) {
        narrowest = width;
        best = std::atan2(u.y(), u.x());
      }
    });
    return best;
  }

 private:
  struct Lane {
    double y, from, to;
    double low, high;  // uncut, to compare with the next lane
  };
  using Cell = std::vector<Lane>;

  static Polygon rotated(const Polygon& part, double angle) {
    const Eigen::Rotation2Dd r(angle);
    Polygon p = part;
    for (std::size_t k = 0; k < p.rings(); ++k)
      for (Point2& q : p.ring(k)) q = r * q;
    return p;
  }
  static Point2 corner_of(const Cell& cell, int corner) {
    const Lane& lane = (corner & 2) == 0 ? cell.front() : cell.back();
    return {(corner & 1) == 0 ? lane.from : lane.to, lane.y};
  }
  static std::vector<Cell> lanes(const Polygon& level, const HybridOptions& o) {
    const Box2 box = level.bounds();
    const double height = box.sizes().y();
    const int count = std::max(1, static_cast<int>(std::ceil(height / o.lane - 1e-6)));
    std::vector<Cell> done;
    std::vector<Cell> open;
    for (int k = 0; k < count; ++k) {
      const double y = box.min().y() + (k + 0.5) * height / count;
      std::vector<Lane> now;
      for (const auto& [low, high] : horizontal_intervals(level, y)) {
        // The footprint reaches on past the end of a lane.
        const double cut = std::min(0.7 * o.footprint, 0.5 * (high - low));
        now.push_back({y, low + cut, high - cut, low, high});
      }
      const auto touch = [](const Lane& a, const Lane& b) {
        return a.low < b.high && b.low < a.high;
      };
      std::vector<int> below(now.size(), 0), above(open.size(), 0);
      for (std::size_t i = 0; i < now.size(); ++i)
        for (std::size_t c = 0; c < open.size(); ++c)
          if (touch(now[i], open[c].back())) {
            ++below[i];
            ++above[c];
          }
      std::vector<Cell> next;
      for (const Lane& lane : now) {
        const auto i = static_cast<std::size_t>(&lane - now.data());
        std::size_t c = 0;
        while (c < open.size() && !(above[c] == 1 && below[i] == 1 && touch(lane, open[c].back())))
          ++c;
        if (c < open.size()) {
          open[c].push_back(lane);
          next.push_back(std::move(open[c]));
          open.erase(open.begin() + static_cast<std::ptrdiff_t>(c));
          above.erase(above.begin() + static_cast<std::ptrdiff_t>(c));
        } else {
          next.push_back({lane});
        }
      }
      for (Cell& c : open) done.push_back(std::move(c));
      open = std::move(next);
    }
    for (Cell& c : open) done.push_back(std::move(c));
    return done;
  }
};

/// Laps from the boundary inwards. A part that is not convex is swept back and forth.
struct SpiralSweep {
  std::vector<Point2> operator()(const Polygon& part, const Point2& from,
                                 const PolygonGeodesics& domain, const HybridOptions& o) const {
    if (!is_convex(part)) return BackAndForthSweep{}(part, from, domain, o);
    std::vector<Point2> path{from};
    for (int lap = 0;; ++lap) {
      std::vector<HalfPlane> halves = half_planes(part.outer);
      for (HalfPlane& h : halves) h.offset -= (lap + 0.5) * o.lane * h.normal.norm();
      const Region inner = clip(part, halves);
      if (inner.empty()) break;
      const Ring& ring = inner[0].outer;
      std::size_t start = 0;
      for (std::size_t i = 1; i < ring.size(); ++i)
        if ((ring[i] - path.back()).norm() < (ring[start] - path.back()).norm()) start = i;
      for (std::size_t i = 0; i < ring.size(); ++i)
        append_path(path, ring[(start + i) % ring.size()], domain);
      path.push_back(ring[start]);
    }
    append_path(path, centroid(part), domain);
    return path;
  }
};
static_assert(SweepPattern<BackAndForthSweep> && SweepPattern<SpiralSweep>);

/// Extends a path until its footprint has covered every cell of the part: the slivers that straight
/// lanes leave at slanted borders are visited, nearest first.
inline void touch_up(std::vector<Point2>& path, const Polygon& part, const PolygonGeodesics& domain,
                     const HybridOptions& o) {
  CoverageGrid grid(part, 0.5 * o.cell);
  for (std::size_t i = 1; i < path.size(); ++i) grid.cover(path[i - 1], path[i], o.footprint);
  std::vector<std::size_t> left;
  for (std::size_t c = 0; c < grid.cells(); ++c)
    if (grid.inside(c) && !grid.covered(c)) left.push_back(c);
  while (!left.empty()) {
    const auto nearest =
        *std::min_element(left.begin(), left.end(), [&](std::size_t a, std::size_t b) {
          return (grid.centre(a) - path.back()).squaredNorm() <
                 (grid.centre(b) - path.back()).squaredNorm();
        });
    const std::size_t before = path.size();
    append_path(path, project_into(domain.polygon(), grid.centre(nearest)), domain);
    for (std::size_t i = before; i < path.size(); ++i)
      grid.cover(path[i - 1], path[i], o.footprint);
    grid.cover(nearest);
    std::erase_if(left, [&](std::size_t c) { return grid.covered(c); });
  }
}

/// Sweeps every part of a region, nearest first, and leaves nothing out.
template <SweepPattern Sweep>
std::vector<Point2> sweep_region(const Region& region, const Point2& from,
                                 const PolygonGeodesics& domain, const HybridOptions& o,
                                 const Sweep& sweep = {}) {
  std::vector<Point2> path{from};
  std::vector<const Polygon*> left;
  for (const Polygon& part : region)
    if (area(part) > 1e-6 * o.cell * o.cell) left.push_back(&part);
  while (!left.empty()) {
    const auto next =
        std::min_element(left.begin(), left.end(), [&](const Polygon* a, const Polygon* b) {
          return (project_into(*a, path.back()) - path.back()).norm() <
                 (project_into(*b, path.back()) - path.back()).norm();
        });
    std::vector<Point2> piece = sweep(**next, path.back(), domain, o);
    touch_up(piece, **next, domain, o);
    path.insert(path.end(), piece.begin() + 1, piece.end());
    left.erase(next);
  }
  return path;
}
}  // namespace surfleet
