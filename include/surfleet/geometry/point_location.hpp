// SPDX-License-Identifier: MIT
/// @file
/// @brief Many questions "is this point inside?" about one polygon.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <surfleet/geometry/polygon.hpp>

namespace surfleet {
/// Answers like `locate(polygon, p)`, exactly, from edges sorted into horizontal strips.
/// O(n) strips; a query tests the edges of one strip, a handful unless most edges are long.
class PointLocator {
 public:
  explicit PointLocator(const Polygon& polygon) : box_(polygon.bounds()) {
    const std::size_t strips = std::max<std::size_t>(1, polygon.vertices());
    strips_.resize(strips);
    scale_ = static_cast<double>(strips) / std::max(box_.sizes().y(), 1e-300);
    for_each_edge(polygon, [&](const Point2& a, const Point2& b) {
      const std::size_t low = strip(std::min(a.y(), b.y())), high = strip(std::max(a.y(), b.y()));
      for (std::size_t s = low; s <= high; ++s) strips_[s].emplace_back(a, b);
    });
  }
  Side locate(const Point2& p) const {
    if (!box_.contains(p)) return Side::Outside;
    bool inside = false;
    for (const auto& [a, b] : strips_[strip(p.y())]) {
      const bool a_above = a.y() > p.y(), b_above = b.y() > p.y();
      if (a_above == b_above) {
        if (on_segment(a, b, p)) return Side::Boundary;
        continue;
      }
      const int side = turn(a, b, p);
      if (side == 0) return Side::Boundary;
      if ((side > 0) == b_above) inside = !inside;
    }
    return inside ? Side::Inside : Side::Outside;
  }
  bool contains(const Point2& p) const { return locate(p) != Side::Outside; }

 private:
  std::size_t strip(double y) const {
    const double s = std::floor((y - box_.min().y()) * scale_);
    return static_cast<std::size_t>(std::clamp(s, 0.0, static_cast<double>(strips_.size() - 1)));
  }
  Box2 box_;
  double scale_ = 1.0;
  std::vector<std::vector<std::pair<Point2, Point2>>> strips_;
};
}  // namespace surfleet
