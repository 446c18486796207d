// SPDX-License-Identifier: MIT
/// @file
/// @brief The shortest path in an unfolded strip, and strips moved around vertices until their path
/// is locally shortest on the surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/predicates.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/surface_point.hpp>
#include <surfleet/surface/surface_walk.hpp>
#include <surfleet/surface/triangle_strip.hpp>

namespace surfleet {
/// A path on a surface: straight within every triangle.
struct SurfacePath {
  std::vector<std::int32_t> triangles;  ///< The strip it lies in, in order.
  SurfacePoint start, goal;             ///< In its first and last triangle.
  std::vector<Point3> points;  ///< Start, a point on every gate, goal: one more than triangles.

  double length() const {
    double sum = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
    return sum;
  }
};

/// A vertex about which the shortest path in a strip bends.
struct StripCorner {
  std::int32_t vertex = -1;
  std::size_t gate = 0;  ///< One that has the vertex at an end.
  bool on_left = false;  ///< The vertex lies on the strip's left border.
  Point2 at;             ///< In the unfolded strip [m].
};

/// The corners of the shortest path from `start` to `goal` inside a strip, by pulling a funnel
/// through its gates. O(n) for most strips, O(n²) at worst.
inline std::vector<StripCorner> strip_corners(const TriangleMesh& mesh, const UnfoldedStrip& strip,
                                              const Point2& start, const Point2& goal) {
  std::vector<StripCorner> corners;
  Point2 apex = start, left = start, right = start;
  std::size_t left_gate = 0, right_gate = 0;
  std::int32_t left_vertex = -1, right_vertex = -1;
  const std::size_t gates = strip.size() - 1;
  const auto restart = [&](const Point2& at, std::int32_t vertex, std::size_t gate, bool on_left) {
    corners.push_back({vertex, gate, on_left, at});
    apex = left = right = at;
    left_gate = right_gate = gate;
    left_vertex = right_vertex = vertex;
    return gate + 1;
  };
  for (std::size_t i = 0; i <= gates;) {
    UnfoldedStrip::Gate gate{goal, goal, -1, -1};
    if (i < gates) gate = strip.gate(mesh, i);
    if (cross2(right - apex, gate.right - apex) >= 0.0) {
      if (apex == right || cross2(left - apex, gate.right - apex) < 0.0 || left == apex) {
        right = gate.right;
        right_vertex = gate.right_vertex;
        right_gate = i;
      } else {
        i = restart(left, left_vertex, left_gate, true);
        continue;
      }
    }
    if (cross2(left - apex, gate.left - apex) <= 0.0) {
      if (apex == left || cross2(right - apex, gate.left - apex) > 0.0 || right == apex) {
        left = gate.left;
        left_vertex = gate.left_vertex;
        left_gate = i;
      } else {
        i = restart(right, right_vertex, right_gate, false);
        continue;
      }
    }
    ++i;
  }
  // The goal ends the path and is no corner; a corner at the start or the goal bends nothing.
  std::erase_if(corners, [](const StripCorner& c) { return c.vertex < 0; });
  return corners;
}

/// The shortest path from `start`, in the first triangle, to `goal`, in the last, that stays in the
/// strip. Also gives its corners if asked. O(n) for most strips.
inline SurfacePath shortest_path_in_strip(const TriangleMesh& mesh, const UnfoldedStrip& strip,
                                          const SurfacePoint& start, const SurfacePoint& goal,
                                          std::vector<StripCorner>* corners_out = nullptr) {
  SurfacePath path;
  path.triangles = strip.triangles;
  path.start = start;
  path.goal = goal;
  path.points.push_back(start.position(mesh));
  const Point2 from = strip.flat(0, start.weights);
  const Point2 to = strip.flat(strip.size() - 1, goal.weights);
  const auto corners = strip_corners(mesh, strip, from, to);
  std::size_t next = 0;  // the corner ahead
  Point2 a = from;
  for (std::size_t i = 0; i + 1 < strip.size(); ++i) {
    while (next < corners.size() && corners[next].gate < i) a = corners[next++].at;
    const Point2 b = next < corners.size() ? corners[next].at : to;
    const auto gate = strip.gate(mesh, i);
    const Point3& left = mesh.vertices[static_cast<std::size_t>(gate.left_vertex)];
    const Point3& right = mesh.vertices[static_cast<std::size_t>(gate.right_vertex)];
    double share;  // of the gate from left to right
    if (gate.left == b || gate.left == a) {
      share = 0.0;
    } else if (gate.right == b || gate.right == a) {
      share = 1.0;
    } else {
      const double l = cross2(b - a, gate.left - a), r = cross2(b - a, gate.right - a);
      share = l - r > 0.0 ? std::clamp(l / (l - r), 0.0, 1.0) : 0.5;
    }
    path.points.push_back(left + share * (right - left));
  }
  path.points.push_back(goal.position(mesh));
  if (corners_out != nullptr) *corners_out = corners;
  return path;
}

namespace detail {
/// Drops places at either end that the start or the goal, lying on a gate, does not need.
inline void trim_strip(const TriangleMesh& mesh, std::vector<std::int32_t>& strip,
                       SurfacePoint& start, SurfacePoint& goal) {
  const auto moved = [&](SurfacePoint& at, std::int32_t from, std::int32_t to) {
    const Triangle& a = mesh.triangles[static_cast<std::size_t>(from)];
    const Triangle& b = mesh.triangles[static_cast<std::size_t>(to)];
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (at.weights[k] <= 0.0) continue;
      bool found = false;
      for (Eigen::Index j = 0; j < 3; ++j)
        if (b[static_cast<std::size_t>(j)] == a[static_cast<std::size_t>(k)]) {
          weights[j] = at.weights[k];
          found = true;
        }
      if (!found) return false;
    }
    at = {to, weights};
    return true;
  };
  std::size_t first = 0, last = strip.size() - 1;
  while (first < last && moved(start, strip[first], strip[first + 1])) ++first;
  while (last > first && moved(goal, strip[last], strip[last - 1])) --last;
  strip.erase(strip.begin() + static_cast<std::ptrdiff_t>(last) + 1, strip.end());
  strip.erase(strip.begin(), strip.begin() + static_cast<std::ptrdiff_t>(first));
}

/// Cuts out what lies between two visits of one triangle.
inline void cut_loops(std::vector<std::int32_t>& strip) {
  std::map<std::int32_t, std::size_t> at;
  std::vector<std::int32_t> kept;
  for (const std::int32_t t : strip) {
    const auto met = at.find(t);
    if (met != at.end()) {
      while (kept.size() > met->second + 1) {
        at.erase(kept.back());
        kept.pop_back();
      }
      continue;
    }
    at[t] = kept.size();
    kept.push_back(t);
  }
  strip = std::move(kept);
}
}  // namespace detail

/// Shortens strips by string pulling.
class StripShortener {
 public:
  /// The walk must outlive it. O(n).
  explicit StripShortener(const SurfaceWalk& walk)
      : walk_(&walk), angle_(walk.mesh().vertices.size(), 0.0) {
    const TriangleMesh& mesh = walk.mesh();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        angle_[static_cast<std::size_t>(mesh.triangles[t][k])] += corner_angle(mesh, t, k);
  }

  /// The shortest path in a strip as it is.
  SurfacePath within(std::span<const std::int32_t> triangles, const SurfacePoint& start,
                     const SurfacePoint& goal) const {
    return pulled({triangles.begin(), triangles.end()}, start, goal, nullptr, nullptr);
  }

  /// The shortest path in a strip that is moved to the other side of every inner vertex about which
  /// less than π is left there, until no more can be gained: locally shortest on the surface, and
  /// never longer than the strip's own. Triangles for which `allowed(triangle)` is false are not
  /// entered. O(n) a move; every move shortens the path.
  template <typename Allowed>
  SurfacePath shortened(std::span<const std::int32_t> triangles, const SurfacePoint& start,
                        const SurfacePoint& goal, const Allowed& allowed) const {
    std::vector<StripCorner> corners;
    UnfoldedStrip strip;
    SurfacePath best = pulled({triangles.begin(), triangles.end()}, start, goal, &strip, &corners);
    double length = best.length();
    for (bool one_by_one = false;;) {
      std::vector<std::int32_t> moved = best.triangles;
      // From the end, so that the places before a move keep their numbers.
      std::size_t untouched = moved.size();
      bool any = false;
      for (std::size_t c = corners.size(); c-- > 0;) {
        const Point2 before = c > 0 ? corners[c - 1].at : strip.flat(0, best.start.weights);
        const Point2 after = c + 1 < corners.size()
                                 ? corners[c + 1].at
                                 : strip.flat(strip.size() - 1, best.goal.weights);
        const auto [i, j] = run_of(strip, corners[c]);
        if (j >= untouched) continue;
        const auto fan = other_side(strip, corners[c], i, j, before, after, allowed);
        if (fan.empty()) continue;
        moved.erase(moved.begin() + static_cast<std::ptrdiff_t>(i),
                    moved.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        moved.insert(moved.begin() + static_cast<std::ptrdiff_t>(i), fan.begin(), fan.end());
        untouched = i;
        any = true;
        if (one_by_one) break;
      }
      if (!any) return best;
      detail::cut_loops(moved);
      std::vector<StripCorner> new_corners;
      UnfoldedStrip new_strip;
      SurfacePath next = pulled(moved, best.start, best.goal, &new_strip, &new_corners);
      const double shorter = next.length();
      if (shorter < length * (1.0 - 1e-13)) {
        best = std::move(next);
        strip = std::move(new_strip);
        corners = std::move(new_corners);
        length = shorter;
        one_by_one = false;
      } else if (!one_by_one) {
        one_by_one = true;
      } else {
        return best;
      }
    }
  }
  SurfacePath shortened(std::span<const std::int32_t> triangles, const SurfacePoint& start,
                        const SurfacePoint& goal) const {
    return shortened(triangles, start, goal, [](std::int32_t) { return true; });
  }

  /// The angle of all triangles about a vertex [rad].
  double angle(std::int32_t vertex) const { return angle_[static_cast<std::size_t>(vertex)]; }

  static double corner_angle(const TriangleMesh& mesh, std::size_t t, std::size_t k) {
    const Eigen::Vector3d u = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k);
    const Eigen::Vector3d v = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
    return std::atan2(u.cross(v).norm(), u.dot(v));
  }

 private:
  SurfacePath pulled(std::vector<std::int32_t> triangles, SurfacePoint start, SurfacePoint goal,
                     UnfoldedStrip* strip_out, std::vector<StripCorner>* corners) const {
    require(!triangles.empty() && triangles.front() == start.triangle &&
                triangles.back() == goal.triangle,
            "strip: expected to begin in the start's triangle and to end in the goal's");
    detail::trim_strip(walk_->mesh(), triangles, start, goal);
    UnfoldedStrip strip = unfold(walk_->mesh(), triangles);
    SurfacePath path = shortest_path_in_strip(walk_->mesh(), strip, start, goal, corners);
    if (strip_out != nullptr) *strip_out = std::move(strip);
    return path;
  }

  /// The places about a corner's vertex, the first and the last.
  std::pair<std::size_t, std::size_t> run_of(const UnfoldedStrip& strip,
                                             const StripCorner& corner) const {
    std::size_t i = corner.gate, j = corner.gate + 1;
    const auto has = [&](std::size_t gate) {
      const auto g = strip.gate(walk_->mesh(), gate);
      return g.left_vertex == corner.vertex || g.right_vertex == corner.vertex;
    };
    while (i > 0 && has(i - 1)) --i;
    while (j + 1 < strip.size() && has(j)) ++j;
    return {i, j};
  }
  /// The triangles that lead around the other side of a corner, from place i's to place j's; empty
  /// where that is no gain.
  template <typename Allowed>
  std::vector<std::int32_t> other_side(const UnfoldedStrip& strip, const StripCorner& corner,
                                       std::size_t i, std::size_t j, const Point2& before,
                                       const Point2& after, const Allowed& allowed) const {
    const TriangleMesh& mesh = walk_->mesh();
    const auto far_end = [&](std::size_t gate) {
      const auto g = strip.gate(mesh, gate);
      return Point2(g.left_vertex == corner.vertex ? g.right : g.left);
    };
    const auto between = [&](const Point2& p, const Point2& q) {
      const Point2 u = p - corner.at, v = q - corner.at;
      return std::atan2(std::abs(cross2(u, v)), u.dot(v));
    };
    if (before == corner.at || after == corner.at) return {};
    double inside = between(before, far_end(i)) + between(far_end(j - 1), after);
    for (std::size_t k = i + 1; k < j; ++k) inside += between(far_end(k - 1), far_end(k));
    // Little is to be gained where nearly π is left, and rounding could turn it into a loss.
    if (!(angle(corner.vertex) - inside < kPi - 1e-9)) return {};
    std::vector<std::int32_t> fan{strip.triangles[i]};
    std::int32_t over = side_beside(strip.triangles[i], corner.vertex, strip.exit[i]);
    while (fan.back() != strip.triangles[j] || fan.size() == 1) {
      const std::int32_t in = walk_->twin(over);
      if (in < 0 || in / 3 == fan.front()) return {};  // a border, or once around
      if (in / 3 != strip.triangles[j] && !allowed(in / 3)) return {};
      fan.push_back(in / 3);
      over = side_beside(in / 3, corner.vertex, in % 3);
    }
    return fan;
  }
  /// The half-edge of a triangle's side at `vertex` that is not side `other`.
  std::int32_t side_beside(std::int32_t triangle, std::int32_t vertex, int other) const {
    const Triangle& t = walk_->mesh().triangles[static_cast<std::size_t>(triangle)];
    for (int k = 0; k < 3; ++k)
      if (k != other && (t[static_cast<std::size_t>(k)] == vertex ||
                         t[static_cast<std::size_t>((k + 1) % 3)] == vertex))
        return 3 * triangle + k;
    return 3 * triangle;
  }

  const SurfaceWalk* walk_;
  std::vector<double> angle_;
};
}  // namespace surfleet
