// SPDX-License-Identifier: MIT
/// @file
/// @brief Critical points of a sweep line and the cells between them, as a Reeb graph [004 §4.3.2].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/geometry/polygon.hpp>
#include <surfleet/geometry/polygon_clipping.hpp>
#include <surfleet/geometry/polygon_trapezoids.hpp>

namespace surfleet {
enum class CriticalKind {
  Start,   ///< Where the sweep begins.
  In,      ///< An obstacle parts the line.
  Middle,  ///< A cell has grown large or long enough.
  Out,     ///< An obstacle ends and the parts of the line meet.
  End,     ///< The line shrinks to nothing.
};
inline const char* name_of(CriticalKind kind) {
  constexpr const char* names[] = {"START", "IN", "MIDDLE", "OUT", "END"};
  return names[static_cast<int>(kind)];
}
struct CriticalPoint {
  CriticalKind kind;
  Point2 position;
};
/// A stretch of ground that the line crosses in one piece, between two critical points.
struct ReebCell {
  std::int32_t from = -1, to = -1;  ///< Critical points.
  Polygon region;                   ///< Monotone in the sweep direction.
  bool covered = false;
};
struct ReebGraph {
  std::vector<CriticalPoint> points;
  std::vector<ReebCell> cells;
};

/// The graph of START, IN, OUT and END points when a line sweeps the domain along +x. O(n² log n).
inline ReebGraph reeb_graph(const Polygon& domain) {
  struct Slab {
    double x0, x1;
    Point2 low0, low1, high0, high1;  // corners at x0 and x1
    std::vector<std::size_t> before, after;
  };
  // A line x = const is a level of the polygon with its axes exchanged.
  Polygon turned = domain;
  for (std::size_t r = 0; r < turned.rings(); ++r)
    for (Point2& p : turned.ring(r)) std::swap(p.x(), p.y());
  std::vector<Slab> slabs;
  for (const Trapezoid& t : trapezoids(turned)) {
    const auto back = [](const Point2& p) { return Point2(p.y(), p.x()); };
    slabs.push_back({t[0].y(), t[3].y(), back(t[0]), back(t[3]), back(t[1]), back(t[2]), {}, {}});
  }
  for (std::size_t a = 0; a < slabs.size(); ++a)
    for (std::size_t b = 0; b < slabs.size(); ++b)
      if (slabs[a].x1 == slabs[b].x0 && std::min(slabs[a].high1.y(), slabs[b].high0.y()) >
                                            std::max(slabs[a].low1.y(), slabs[b].low0.y())) {
        slabs[a].after.push_back(b);
        slabs[b].before.push_back(a);
      }
  const auto begins = [&](std::size_t s) {
    return slabs[s].before.size() != 1 || slabs[slabs[s].before[0]].after.size() != 1;
  };
  ReebGraph graph;
  std::vector<std::int32_t> begin_point(slabs.size(), -1);  // of the cell that begins with slab s
  const auto add_point = [&](CriticalKind kind, const Point2& position) {
    graph.points.push_back({kind, position});
    return static_cast<std::int32_t>(graph.points.size() - 1);
  };
  // Points first: one for every slab side at which the line begins, parts, meets or ends.
  std::vector<std::int32_t> end_point(slabs.size(), -1);
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    Slab& slab = slabs[s];
    if (slab.before.empty())
      begin_point[s] = add_point(CriticalKind::Start, 0.5 * (slab.low0 + slab.high0));
    if (slab.after.empty())
      end_point[s] = add_point(CriticalKind::End, 0.5 * (slab.low1 + slab.high1));
    if (slab.after.size() > 1) {
      std::sort(slab.after.begin(), slab.after.end(), [&](std::size_t a, std::size_t b) {
        return slabs[a].low0.y() < slabs[b].low0.y();
      });
      end_point[s] = add_point(CriticalKind::In,
                               0.5 * (slabs[slab.after[0]].high0 + slabs[slab.after[1]].low0));
      for (const std::size_t a : slab.after) begin_point[a] = end_point[s];
    }
  }
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    Slab& slab = slabs[s];
    if (slab.before.size() < 2) continue;
    std::sort(slab.before.begin(), slab.before.end(),
              [&](std::size_t a, std::size_t b) { return slabs[a].low1.y() < slabs[b].low1.y(); });
    const std::int32_t p = add_point(
        CriticalKind::Out, 0.5 * (slabs[slab.before[0]].high1 + slabs[slab.before[1]].low1));
    begin_point[s] = p;
    for (const std::size_t b : slab.before)
      if (end_point[b] < 0) end_point[b] = p;
  }
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    if (!begins(s)) continue;
    ReebCell cell;
    cell.from = begin_point[s];
    Ring low, high;
    std::size_t last = s;
    for (std::size_t k = s;; k = slabs[k].after[0]) {
      low.push_back(slabs[k].low0);
      low.push_back(slabs[k].low1);
      high.push_back(slabs[k].high0);
      high.push_back(slabs[k].high1);
      last = k;
      if (slabs[k].after.size() != 1 || begins(slabs[k].after[0])) break;
    }
    cell.to = end_point[last];
    low.insert(low.end(), high.rbegin(), high.rend());
    for (const Point2& p : low)
      if (cell.region.outer.empty() || cell.region.outer.back() != p)
        cell.region.outer.push_back(p);
    while (cell.region.outer.size() > 1 && cell.region.outer.front() == cell.region.outer.back())
      cell.region.outer.pop_back();
    graph.cells.push_back(std::move(cell));
  }
  return graph;
}
}  // namespace surfleet
