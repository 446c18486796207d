// SPDX-License-Identifier: MIT
/// @file
/// @brief The Delaunay triangulation of points in the plane [004 §3.3.1].
///
///     for (const Triangle& t : delaunay(points)) use(points[t[0]], points[t[1]], points[t[2]]);
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/predicates.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
namespace detail {
/// Points one by one: the triangles whose circle holds the new one give way to a fan around it
/// (Bowyer and Watson 1981). Behind every side of the hull stands a triangle with a corner at
/// infinity, so that a point outside is like one inside.
class DelaunayBuilder {
 public:
  explicit DelaunayBuilder(std::span<const Point2> points) : points_(points) {
    const std::vector<std::int32_t> order = insertion_order();
    std::size_t second = 0, third = 0;  // with the first, a triangle
    while (second < order.size() && at(order[second]) == at(order[0])) ++second;
    third = second + 1;
    while (third < order.size() &&
           orient2d(at(order[0]), at(order[second]), at(order[third])) == 0.0)
      ++third;
    if (third >= order.size()) return;
    begin(order[0], order[second], order[third]);
    for (std::size_t k = 1; k < order.size(); ++k)
      if (k != second && k != third) insert(order[k]);
  }

  std::vector<Triangle> triangles() const {
    std::vector<Triangle> finite;
    for (const Cell& c : cells_) {
      if (c.dead || infinite_corner(c) >= 0) continue;
      Triangle t = c.corner;  // the least first, so that the list has one form
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      finite.push_back(t);
    }
    std::sort(finite.begin(), finite.end());
    return finite;
  }

 private:
  static constexpr std::int32_t kInfinity = -1;
  struct Cell {
    Triangle corner;                       // anticlockwise
    std::array<std::int32_t, 3> beyond{};  // the cell opposite to each corner
    bool dead = false;
  };

  const Point2& at(std::int32_t i) const { return points_[static_cast<std::size_t>(i)]; }
  Cell& cell(std::int32_t i) { return cells_[static_cast<std::size_t>(i)]; }
  static int infinite_corner(const Cell& c) {
    for (int k = 0; k < 3; ++k)
      if (c.corner[static_cast<std::size_t>(k)] == kInfinity) return k;
    return -1;
  }

  /// Rounds that double, in shuffled order between rounds, along a curve within each (Amenta, Choi
  /// and Rote 2003).
  std::vector<std::int32_t> insertion_order() const {
    const std::size_t n = points_.size();
    std::vector<std::int32_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    if (n == 0) return order;
    Random(0xde1aULL).shuffle(order);
    Point2 low = points_[0], high = points_[0];
    for (const Point2& p : points_) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const double side = std::max((high - low).maxCoeff(), 1e-300);
    std::vector<std::uint32_t> key(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Point2 s = (points_[i] - low) / side * 65535.0;
      key[i] =
          along_hilbert_curve(static_cast<std::uint32_t>(s.x()), static_cast<std::uint32_t>(s.y()));
    }
    for (std::size_t end = n; end > 0;) {
      const std::size_t begin = end > 1000 ? end / 2 : 0;
      std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(begin),
                       order.begin() + static_cast<std::ptrdiff_t>(end),
                       [&](std::int32_t a, std::int32_t b) {
                         return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)];
                       });
      end = begin;
    }
    return order;
  }
  static std::uint32_t along_hilbert_curve(std::uint32_t x, std::uint32_t y) {
    std::uint32_t d = 0;
    for (std::uint32_t s = 1U << 15; s > 0; s /= 2) {
      const std::uint32_t rx = (x & s) != 0 ? 1U : 0U, ry = (y & s) != 0 ? 1U : 0U;
      d += s * s * ((3 * rx) ^ ry);
      if (ry == 0) {
        if (rx == 1) {
          x = (65535U - x) & 65535U;
          y = (65535U - y) & 65535U;
        }
        std::swap(x, y);
      }
    }
    return d;
  }

  void begin(std::int32_t a, std::int32_t b, std::int32_t c) {
    if (orient2d(at(a), at(b), at(c)) < 0.0) std::swap(b, c);
    cells_.push_back({{a, b, c}, {1, 2, 3}, false});
    cells_.push_back({{kInfinity, c, b}, {0, 3, 2}, false});
    cells_.push_back({{kInfinity, a, c}, {0, 1, 3}, false});
    cells_.push_back({{kInfinity, b, a}, {0, 2, 1}, false});
  }

  bool holds(const Cell& c, const Point2& p) const {
    const int inf = infinite_corner(c);
    if (inf < 0) return in_circle(at(c.corner[0]), at(c.corner[1]), at(c.corner[2]), p) > 0.0;
    const auto k = static_cast<std::size_t>(inf);
    const Point2 &u = at(c.corner[(k + 1) % 3]), &v = at(c.corner[(k + 2) % 3]);
    const double side = orient2d(u, v, p);
    return side > 0.0 || (side == 0.0 && p != u && p != v && on_segment(u, v, p));
  }

  /// A cell whose circle holds `p`; −1 where a point stands already. Walks from the last one.
  std::int32_t locate(const Point2& p) const {
    std::int32_t here = last_;
    for (;;) {
      const Cell& c = cells_[static_cast<std::size_t>(here)];
      const int inf = infinite_corner(c);
      if (inf >= 0) {
        if (holds(c, p)) return here;
        here = c.beyond[static_cast<std::size_t>(inf)];
        continue;
      }
      std::int32_t next = -1;
      for (std::size_t k = 0; k < 3 && next < 0; ++k)
        if (orient2d(at(c.corner[(k + 1) % 3]), at(c.corner[(k + 2) % 3]), p) < 0.0)
          next = c.beyond[k];
      if (next < 0) {
        for (const std::int32_t v : c.corner)
          if (at(v) == p) return -1;
        return here;
      }
      here = next;
    }
  }

  void insert(std::int32_t index) {
    const Point2& p = at(index);
    const std::int32_t first = locate(p);
    if (first < 0) return;
    hollow_.assign(1, first);
    cell(first).dead = true;
    rim_.clear();
    for (std::size_t i = 0; i < hollow_.size(); ++i) {
      const Cell c = cell(hollow_[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t next = c.beyond[k];
        if (cell(next).dead) continue;
        if (holds(cell(next), p)) {
          cell(next).dead = true;
          hollow_.push_back(next);
        } else {
          rim_.push_back({c.corner[(k + 1) % 3], c.corner[(k + 2) % 3], next, -1});
        }
      }
    }
    for (Rim& r : rim_) {  // the fan
      if (!hollow_.empty()) {
        r.made = hollow_.back();
        hollow_.pop_back();
      } else {
        r.made = static_cast<std::int32_t>(cells_.size());
        cells_.emplace_back();
      }
    }
    for (const Rim& r : rim_) {
      Cell& c = cell(r.made);
      c.corner = {index, r.from, r.to};
      c.beyond = {r.outside, -1, -1};
    }
    // Which side of the outside cell borders here: the one with these two corners, reversed.
    for (const Rim& r : rim_) {
      Cell& o = cell(r.outside);
      for (std::size_t k = 0; k < 3; ++k)
        if (o.corner[(k + 1) % 3] == r.to && o.corner[(k + 2) % 3] == r.from) o.beyond[k] = r.made;
    }
    // The rim is one loop: whoever starts where this one ends comes next.
    for (const Rim& r : rim_)
      for (const Rim& s : rim_)
        if (s.from == r.to) {
          cell(r.made).beyond[1] = s.made;
          cell(s.made).beyond[2] = r.made;
        }
    for (const Rim& r : rim_) cell(r.made).dead = false;
    last_ = rim_.front().made;
  }

  struct Rim {
    std::int32_t from, to, outside, made;
  };
  std::span<const Point2> points_;
  std::vector<Cell> cells_;
  std::vector<std::int32_t> hollow_;
  std::vector<Rim> rim_;
  std::int32_t last_ = 0;
};
}  // namespace detail

/// The triangles of the Delaunay triangulation, anticlockwise, each with its least index first, in
/// ascending order: they cover the convex hull, and no point lies inside the circle of any. Of
/// points at one place one is used. None where all points lie on a line. Among concyclic points
/// one of the triangulations, always the same. Exact predicates; expected O(n log n) for points
/// of any order. Throws `Error` where a coordinate is not finite.
inline std::vector<Triangle> delaunay(std::span<const Point2> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    require(points[i].allFinite(),
            "delaunay: point " + std::to_string(i) + " is not finite; expected finite numbers");
  return detail::DelaunayBuilder(points).triangles();
}
}  // namespace surfleet
