// SPDX-License-Identifier: MIT
/// @file
/// @brief A polygon with holes as trapezoids between horizontal lines.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <surfleet/geometry/polygon.hpp>

namespace surfleet {
/// Lower left, lower right, upper right, upper left; lower and upper side are horizontal.
using Trapezoid = std::array<Point2, 4>;

/// Where the horizontal line at `y`, which should avoid the vertices, runs inside: sorted pairs.
inline std::vector<std::pair<double, double>> horizontal_intervals(const Polygon& polygon,
                                                                   double y) {
  std::vector<double> x;
  for_each_edge(polygon, [&](const Point2& a, const Point2& b) {
    if ((a.y() > y) != (b.y() > y))
      x.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  });
  std::sort(x.begin(), x.end());
  std::vector<std::pair<double, double>> intervals;
  for (std::size_t i = 0; i + 1 < x.size(); i += 2) intervals.emplace_back(x[i], x[i + 1]);
  return intervals;
}

/// Disjoint trapezoids that fill the polygon; O(n log n + n · edges on a level).
inline std::vector<Trapezoid> trapezoids(const Polygon& polygon) {
  struct Edge {
    Point2 low, high;
    double x_at(double y) const {
      return low.x() + (y - low.y()) / (high.y() - low.y()) * (high.x() - low.x());
    }
  };
  std::vector<Edge> edges;
  std::vector<double> levels;
  for_each_edge(polygon, [&](const Point2& a, const Point2& b) {
    levels.push_back(a.y());
    if (a.y() < b.y()) edges.push_back({a, b});
    if (b.y() < a.y()) edges.push_back({b, a});
  });
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  std::sort(edges.begin(), edges.end(),
            [](const Edge& e, const Edge& f) { return e.low.y() < f.low.y(); });
  std::vector<Trapezoid> result;
  std::vector<const Edge*> active;
  std::size_t next = 0;
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    const double low = levels[k], high = levels[k + 1], middle = 0.5 * (low + high);
    std::erase_if(active, [&](const Edge* e) { return e->high.y() <= low; });
    for (; next < edges.size() && edges[next].low.y() <= low; ++next)
      active.push_back(&edges[next]);
    std::sort(active.begin(), active.end(),
              [&](const Edge* e, const Edge* f) { return e->x_at(middle) < f->x_at(middle); });
    for (std::size_t i = 0; i + 1 < active.size(); i += 2) {
      const Edge &l = *active[i], &r = *active[i + 1];
      result.push_back({Point2(l.x_at(low), low), Point2(r.x_at(low), low),
                        Point2(r.x_at(high), high), Point2(l.x_at(high), high)});
    }
  }
  return result;
}
}  // namespace surfleet
