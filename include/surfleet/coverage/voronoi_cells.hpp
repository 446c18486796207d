// SPDX-License-Identifier: MIT
/// @file
/// @brief The Voronoi tessellation of a polygon with holes.
///
/// ```cpp
/// const VoronoiTessellation v = voronoi_tessellation(domain, robots);
/// // v.cells[i].region, v.cells[i].neighbours
/// ```
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/polygon_clipping.hpp>

namespace surfleet {
/// The part of the domain that belongs to one generator, and those it borders on.
struct VoronoiCell {
  Region region;                         ///< In several parts where obstacles cut it up.
  std::vector<std::int32_t> neighbours;  ///< Voronoi neighbours, ascending.
};
struct VoronoiTessellation {
  std::vector<VoronoiCell> cells;
};

/// Throws `Error` if two of the points coincide, or one is not finite.
inline void require_distinct(std::span<const Point2> points) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
    require(points[i].allFinite(), "robot " + std::to_string(i) + ": its position is not finite");
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(points[a].x(), points[a].y()) <
           std::make_pair(points[b].x(), points[b].y());
  });
  for (std::size_t k = 1; k < order.size(); ++k)
    if (points[order[k]] == points[order[k - 1]])
      throw Error("robots " + std::to_string(std::min(order[k], order[k - 1])) + " and " +
                  std::to_string(std::max(order[k], order[k - 1])) +
                  " stand on the same place; each needs a place of its own");
}
/// Throws `Error` unless every robot stands in the domain, on a place of its own.
inline void require_placed(const Polygon& domain, std::span<const Point2> robots) {
  require(!robots.empty(), "there is no robot; at least one is needed");
  require_distinct(robots);
  for (std::size_t i = 0; i < robots.size(); ++i)
    require(contains(domain, robots[i]),
            "robot " + std::to_string(i) + " at (" + std::to_string(robots[i].x()) + ", " +
                std::to_string(robots[i].y()) + ") stands outside the domain or in an obstacle");
}

/// Finds, for one generator after another, the others that bound its cell in a box.
///
/// The others are met ring by ring of a grid, nearest first, and the search ends when the next is
/// more than twice as far as the farthest corner of the cell [004 Fig. 3.4]: O(1) of them for an
/// even spread. Generators may lie outside the box.
class VoronoiNeighbourSearch {
 public:
  /// The bisector with `other` bounds the cell.
  struct Bound {
    std::int32_t other;
    HalfPlane half;
  };

  VoronoiNeighbourSearch(std::span<const Point2> generators, const Box2& box)
      : generators_(generators), box_(box) {
    for (const Point2& p : generators) grid_box_.extend(p);
    const double n = static_cast<double>(std::max<std::size_t>(generators.size(), 1));
    const Point2 size = grid_box_.sizes();
    width_ = std::max({std::sqrt(size.x() * size.y() / n), size.maxCoeff() / n, 1e-300});
    columns_ = column(grid_box_.max().x(), 0) + 1;
    rows_ = column(grid_box_.max().y(), 1) + 1;
    first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    for (const Point2& p : generators) ++first_[bucket(p) + 1];
    for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
    entries_.resize(generators.size());
    std::vector<std::size_t> at(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < generators.size(); ++i)
      entries_[at[bucket(generators[i])]++] = static_cast<std::int32_t>(i);
  }

  /// The bounds of generator i's cell, nearest first.
  std::vector<Bound> bounds(std::size_t i) const {
    const Point2& p = generators_[i];
    PolygonClipper cell;
    cell.load(Polygon{{box_.min(),
                       {box_.max().x(), box_.min().y()},
                       box_.max(),
                       {box_.min().x(), box_.max().y()}},
                      {}});
    std::vector<std::pair<double, std::int32_t>> near;
    std::vector<std::int32_t> kept;
    double reach = radius(cell, p);
    const std::int64_t cx = column(p.x(), 0), cy = column(p.y(), 1);
    const std::int64_t last = std::max(columns_, rows_);
    for (std::int64_t k = 0; k <= last && !cell.empty(); ++k) {
      // Everything in ring k is at least k − 1 widths away.
      if (static_cast<double>(k - 1) * width_ > 2.0 * reach) break;
      near.clear();
      for (std::int64_t y = std::max<std::int64_t>(cy - k, 0); y <= std::min(cy + k, rows_ - 1);
           ++y) {
        const bool whole = y == cy - k || y == cy + k;
        for (std::int64_t x = cx - k; x <= cx + k;
             x += whole ? 1 : std::max<std::int64_t>(2 * k, 1)) {
          if (x < 0 || x >= columns_) continue;
          const auto b = static_cast<std::size_t>(y * columns_ + x);
          for (std::size_t e = first_[b]; e < first_[b + 1]; ++e) {
            const std::int32_t j = entries_[e];
            if (static_cast<std::size_t>(j) != i)
              near.emplace_back((generators_[static_cast<std::size_t>(j)] - p).squaredNorm(), j);
          }
        }
      }
      std::sort(near.begin(), near.end());
      for (const auto& [squared, j] : near) {
        if (squared > 4.0 * reach * reach) break;
        cell.cut(HalfPlane::nearer(p, generators_[static_cast<std::size_t>(j)]), j);
        if (cell.empty()) break;
        reach = radius(cell, p);
      }
    }
    std::vector<Bound> result;
    cell.for_each_tagged_edge([&](const Point2& a, const Point2& b, std::int32_t tag) {
      if (tag >= 0 && a != b) kept.push_back(tag);
    });
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    for (const std::int32_t j : kept)
      result.push_back({j, HalfPlane::nearer(p, generators_[static_cast<std::size_t>(j)])});
    std::sort(result.begin(), result.end(), [&](const Bound& a, const Bound& b) {
      const double da = a.half.normal.squaredNorm(), db = b.half.normal.squaredNorm();
      return da < db || (da == db && a.other < b.other);
    });
    // A generator so far outside the box that nothing of the box is its own.
    if (cell.empty()) result.assign(1, {static_cast<std::int32_t>(i), {Point2::Zero(), -1.0}});
    return result;
  }

 private:
  static double radius(const PolygonClipper& cell, const Point2& p) {
    double squared = 0.0;
    cell.for_each_tagged_edge([&](const Point2& a, const Point2&, std::int32_t) {
      squared = std::max(squared, (a - p).squaredNorm());
    });
    return std::sqrt(squared);
  }
  std::int64_t column(double x, int axis) const {
    return static_cast<std::int64_t>(std::max(0.0, (x - grid_box_.min()[axis]) / width_));
  }
  std::size_t bucket(const Point2& p) const {
    return static_cast<std::size_t>(column(p.y(), 1) * columns_ + column(p.x(), 0));
  }
  std::span<const Point2> generators_;
  Box2 box_, grid_box_;
  double width_ = 1.0;
  std::int64_t columns_ = 1, rows_ = 1;
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> entries_;
};

namespace detail {
/// Calls `visit(i, clipper)` with what each generator owns of the domain still in the clipper.
///
/// The domain is cut down for halves of the generators, then for quarters, and so on, so that a
/// cell is cut from a small piece of the domain and not from the whole: O((n + m) log n).
template <typename Visit>
class CellCutter {
 public:
  CellCutter(const Polygon& domain, std::span<const Point2> generators, int threads, Visit& visit)
      : visit_(visit),
        generators_(generators),
        bounds_(generators.size()),
        boxes_(generators.size()) {
    const Box2 box = domain.bounds();
    margin_ = 1e-6 * box.diagonal().norm();
    const VoronoiNeighbourSearch search(generators, box);
    parallel_for(
        generators.size(), threads,
        [&](std::size_t i) {
          bounds_[i] = search.bounds(i);
          PolygonClipper cell;
          cell.load(Polygon{{box.min(),
                             {box.max().x(), box.min().y()},
                             box.max(),
                             {box.min().x(), box.max().y()}},
                            {}});
          for (const auto& b : bounds_[i]) cell.cut(b.half);
          Box2 own;
          cell.for_each_tagged_edge(
              [&](const Point2& a, const Point2&, std::int32_t) { own.extend(a); });
          boxes_[i] = own;
        },
        8);
    std::vector<std::size_t> order(generators.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    PolygonClipper whole;
    whole.load(domain);
    split(order, whole, 0);
  }

 private:
  void split(std::span<std::size_t> group, const PolygonClipper& piece, int depth) {
    if (group.size() > 2 && depth < 40) {
      Box2 spread;
      for (const std::size_t i : group) spread.extend(generators_[i]);
      const int axis = spread.sizes().x() >= spread.sizes().y() ? 0 : 1;
      const auto middle = group.begin() + static_cast<std::ptrdiff_t>(group.size() / 2);
      std::nth_element(group.begin(), middle, group.end(), [&](std::size_t a, std::size_t b) {
        return std::make_pair(generators_[a][axis], a) < std::make_pair(generators_[b][axis], b);
      });
      const std::size_t left = group.size() / 2;
      for (const auto& half : {group.first(left), group.subspan(left)}) {
        Box2 box;
        for (const std::size_t i : half) box.extend(boxes_[i]);
        PolygonClipper part;
        part.load(piece);
        if (box.isEmpty())
          part.cut({Point2::Zero(), -1.0});
        else
          for (int a = 0; a < 2; ++a) {
            const Point2 n = Point2::Unit(a);
            part.cut({n, box.max()[a] + margin_});
            part.cut({-n, -box.min()[a] + margin_});
          }
        split(half, part, depth + 1);
      }
      return;
    }
    PolygonClipper cell;
    for (const std::size_t i : group) {
      cell.load(piece);
      for (const auto& b : bounds_[i]) cell.cut(b.half, b.other);
      visit_(i, std::as_const(cell));
    }
  }
  Visit& visit_;
  std::span<const Point2> generators_;
  std::vector<std::vector<VoronoiNeighbourSearch::Bound>> bounds_;
  std::vector<Box2> boxes_;
  double margin_ = 0.0;  // keeps the edges of the pieces clear of the bisectors
};
}  // namespace detail

/// Calls `visit(i, clipper)` once for every generator, in no particular order, with its region of
/// the domain in the clipper and neighbours as tags.
template <typename Visit>
void for_each_voronoi_cell(const Polygon& domain, std::span<const Point2> generators, Visit&& visit,
                           int threads = 1) {
  require_distinct(generators);
  if (generators.empty()) return;
  detail::CellCutter<std::remove_reference_t<Visit>> cutter(domain, generators, threads, visit);
}

/// Regions and neighbours of all generators [004 Def. 3.1, bounded]. Generators may lie outside the
/// domain, as virtual ones do; a region may then be empty. Throws `Error` if two coincide.
/// Near-linear: O((n + m) log n) for n evenly spread generators and m vertices.
inline VoronoiTessellation voronoi_tessellation(const Polygon& domain,
                                                std::span<const Point2> generators,
                                                int threads = 1) {
  VoronoiTessellation result;
  result.cells.resize(generators.size());
  const double eps = 1e-12 * domain.bounds().diagonal().norm();
  for_each_voronoi_cell(
      domain, generators,
      [&](std::size_t i, const PolygonClipper& clipper) {
        result.cells[i].region = clipper.region();
        clipper.for_each_tagged_edge([&](const Point2& a, const Point2& b, std::int32_t tag) {
          if (tag < 0 || (a - b).norm() <= eps) return;
          result.cells[i].neighbours.push_back(tag);
          result.cells[static_cast<std::size_t>(tag)].neighbours.push_back(
              static_cast<std::int32_t>(i));
        });
      },
      threads);
  for (VoronoiCell& cell : result.cells) {
    std::sort(cell.neighbours.begin(), cell.neighbours.end());
    cell.neighbours.erase(std::unique(cell.neighbours.begin(), cell.neighbours.end()),
                          cell.neighbours.end());
  }
  return result;
}

/// The region of `own` among `others` [004 eq. 3.4b]. O(n (n + m)); for a robot that has been told
/// where its neighbours are.
inline VoronoiCell voronoi_cell(const Polygon& domain, const Point2& own,
                                std::span<const std::pair<std::int32_t, Point2>> others) {
  PolygonClipper clipper;
  clipper.load(domain);
  for (const auto& [id, p] : others) clipper.cut(HalfPlane::nearer(own, p), id);
  VoronoiCell cell{clipper.region(), {}};
  const double eps = 1e-12 * domain.bounds().diagonal().norm();
  clipper.for_each_tagged_edge([&](const Point2& a, const Point2& b, std::int32_t tag) {
    if (tag >= 0 && (a - b).norm() > eps) cell.neighbours.push_back(tag);
  });
  std::sort(cell.neighbours.begin(), cell.neighbours.end());
  cell.neighbours.erase(std::unique(cell.neighbours.begin(), cell.neighbours.end()),
                        cell.neighbours.end());
  return cell;
}
}  // namespace surfleet
