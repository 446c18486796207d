// SPDX-License-Identifier: MIT
/// @file
/// @brief Cutting polygons with holes by half-planes and convex polygons.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/geometry/polygon.hpp>

namespace surfleet {
/// The points q with `normal · q ≤ offset`.
struct HalfPlane {
  Point2 normal = Point2::UnitX();
  double offset = 0.0;

  double signed_distance(const Point2& q) const { return normal.dot(q) - offset; }
  /// The points at least as near to `p` as to `other` [004 eq. 3.4].
  static HalfPlane nearer(const Point2& p, const Point2& other) {
    const Point2 n = other - p;
    return {n, 0.5 * n.dot(p + other)};
  }
};

/// Cuts a polygon by one half-plane after another, in buffers that are kept between polygons.
///
/// Every edge carries a tag, `kBoundary` for those of the polygon; edges that a cut makes carry the
/// tag of the cut, so that it is known afterwards which cuts bound what is left. Points on a line
/// count as inside: no tie can break the pairing of crossings, and the integrals over the result
/// are right in every degenerate case. O(n + k log k) a cut with k crossings.
class PolygonClipper {
 public:
  static constexpr std::int32_t kBoundary = -1;
  struct Vertex {
    Point2 point;
    std::int32_t tag;  ///< Of the edge that leaves this vertex.
  };

  void load(const Polygon& polygon) {
    vertices_.clear();
    first_.assign(1, 0);
    for (std::size_t r = 0; r < polygon.rings(); ++r) {
      for (const Point2& p : polygon.ring(r)) vertices_.push_back({p, kBoundary});
      first_.push_back(vertices_.size());
    }
  }
  void load(const PolygonClipper& other) {
    vertices_ = other.vertices_;
    first_ = other.first_;
  }

  void cut(const HalfPlane& half, std::int32_t tag = kBoundary) {
    side_.resize(vertices_.size());
    bool any_in = false, any_out = false;
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      side_[i] = half.signed_distance(vertices_[i].point);
      (side_[i] > 0.0 ? any_out : any_in) = true;
    }
    if (!any_out) return;
    if (!any_in) {
      vertices_.clear();
      first_.assign(1, 0);
      return;
    }
    next_vertices_.clear();
    next_first_.assign(1, 0);
    chains_.clear();
    chain_vertices_.clear();
    const Point2 along(-half.normal.y(), half.normal.x());
    for (std::size_t r = 0; r + 1 < first_.size(); ++r)
      cut_ring(first_[r], first_[r + 1], along, tag);
    join_chains();
    vertices_.swap(next_vertices_);
    first_.swap(next_first_);
  }

  bool empty() const { return vertices_.empty(); }
  std::size_t rings() const { return first_.size() - 1; }
  std::span<const Vertex> ring(std::size_t r) const {
    return std::span<const Vertex>(vertices_).subspan(first_[r], first_[r + 1] - first_[r]);
  }
  /// Calls `f(a, b, tag)` for every edge.
  template <typename F>
  void for_each_tagged_edge(F&& f) const {
    for (std::size_t r = 0; r + 1 < first_.size(); ++r)
      for (std::size_t i = first_[r], end = first_[r + 1]; i < end; ++i)
        f(vertices_[i].point, vertices_[i + 1 < end ? i + 1 : first_[r]].point, vertices_[i].tag);
  }
  /// The parts that are left, as polygons; slivers without area are dropped. O(n · rings).
  Region region() const {
    Region parts;
    std::vector<Ring> holes;
    for (std::size_t r = 0; r < rings(); ++r) {
      Ring clean;
      for (const Vertex& v : ring(r))
        if (clean.empty() || clean.back() != v.point) clean.push_back(v.point);
      while (clean.size() > 1 && clean.front() == clean.back()) clean.pop_back();
      const double a = signed_area(clean);
      if (a > 0.0)
        parts.push_back({std::move(clean), {}});
      else if (a < 0.0)
        holes.push_back(std::move(clean));
    }
    for (Ring& hole : holes) {
      // The smallest part around the hole; on a touching boundary another vertex decides.
      Polygon* owner = nullptr;
      for (Polygon& part : parts) {
        Side s = Side::Boundary;
        for (std::size_t i = 0; i < hole.size() && s == Side::Boundary; ++i)
          s = locate(part.outer, hole[i]);
        if (s == Side::Inside &&
            (owner == nullptr || signed_area(part.outer) < signed_area(owner->outer)))
          owner = &part;
      }
      if (owner != nullptr) owner->holes.push_back(std::move(hole));
    }
    return parts;
  }

 private:
  struct Chain {
    std::size_t first, last;  // of chain_vertices_
    double enters, leaves;    // places along the line of the cut
    bool used;
  };

  Vertex crossing(std::size_t i, std::size_t j, std::int32_t tag) const {
    const double t = side_[i] / (side_[i] - side_[j]);
    return {vertices_[i].point + t * (vertices_[j].point - vertices_[i].point), tag};
  }
  void cut_ring(std::size_t begin, std::size_t end, const Point2& along, std::int32_t tag) {
    std::size_t start = begin;  // a vertex outside whose successor is inside
    bool any_out = false, mixed = false;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t j = i + 1 < end ? i + 1 : begin;
      any_out = any_out || side_[i] > 0.0;
      if (!mixed && side_[i] > 0.0 && side_[j] <= 0.0) {
        start = i;
        mixed = true;
      }
    }
    if (!mixed) {
      if (any_out) return;
      next_vertices_.insert(next_vertices_.end(),
                            vertices_.begin() + static_cast<std::ptrdiff_t>(begin),
                            vertices_.begin() + static_cast<std::ptrdiff_t>(end));
      next_first_.push_back(next_vertices_.size());
      return;
    }
    const std::size_t n = end - begin;
    std::size_t i = start;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t j = i + 1 < end ? i + 1 : begin;
      if (side_[i] > 0.0 && side_[j] <= 0.0) {
        chains_.push_back({chain_vertices_.size(), 0, 0.0, 0.0, false});
        chain_vertices_.push_back(crossing(i, j, vertices_[i].tag));
        chains_.back().enters = along.dot(chain_vertices_.back().point);
      } else if (side_[i] <= 0.0) {
        chain_vertices_.push_back(vertices_[i]);
        if (side_[j] > 0.0) {
          chain_vertices_.push_back(crossing(i, j, tag));
          chains_.back().leaves = along.dot(chain_vertices_.back().point);
          chains_.back().last = chain_vertices_.size();
        }
      }
      i = j;
    }
  }
  /// Along the line, with what is kept on its left, leaving and entering crossings alternate: the
  /// k-th place where a chain leaves is joined to the k-th place where one enters.
  void join_chains() {
    const std::size_t n = chains_.size();
    leave_order_.resize(n);
    enter_order_.resize(n);
    for (std::size_t c = 0; c < n; ++c) leave_order_[c] = enter_order_[c] = c;
    const auto by = [this](double Chain::*at) {
      return [this, at](std::size_t a, std::size_t b) {
        return std::make_pair(chains_[a].*at, a) < std::make_pair(chains_[b].*at, b);
      };
    };
    std::sort(leave_order_.begin(), leave_order_.end(), by(&Chain::leaves));
    std::sort(enter_order_.begin(), enter_order_.end(), by(&Chain::enters));
    successor_.resize(n);
    for (std::size_t k = 0; k < n; ++k) successor_[leave_order_[k]] = enter_order_[k];
    for (std::size_t c = 0; c < n; ++c) {
      if (chains_[c].used) continue;
      for (std::size_t d = c; !chains_[d].used; d = successor_[d]) {
        chains_[d].used = true;
        next_vertices_.insert(
            next_vertices_.end(),
            chain_vertices_.begin() + static_cast<std::ptrdiff_t>(chains_[d].first),
            chain_vertices_.begin() + static_cast<std::ptrdiff_t>(chains_[d].last));
      }
      next_first_.push_back(next_vertices_.size());
    }
  }

  std::vector<Vertex> vertices_, next_vertices_, chain_vertices_;
  std::vector<std::size_t> first_{0}, next_first_, leave_order_, enter_order_, successor_;
  std::vector<double> side_;
  std::vector<Chain> chains_;
};

/// The half-planes whose intersection is the convex, counter-clockwise ring.
inline std::vector<HalfPlane> half_planes(const Ring& convex) {
  std::vector<HalfPlane> halves;
  for_each_edge(convex, [&](const Point2& a, const Point2& b) {
    const Point2 n(b.y() - a.y(), a.x() - b.x());
    halves.push_back({n, n.dot(a)});
  });
  return halves;
}
/// What all half-planes leave of the polygon.
inline Region clip(const Polygon& polygon, std::span<const HalfPlane> halves) {
  PolygonClipper clipper;
  clipper.load(polygon);
  for (const HalfPlane& h : halves) clipper.cut(h);
  return clipper.region();
}
inline Region clip(const Polygon& polygon, const Ring& convex) {
  return clip(polygon, half_planes(convex));
}
}  // namespace surfleet
