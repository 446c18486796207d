// SPDX-License-Identifier: MIT
/// @file
/// @brief Path shortcutting: cut what line of sight allows, then string pulling.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <surfleet/motion/path.hpp>

namespace surfleet {
struct ShortcutOptions {
  int rounds = 12;           ///< Of string pulling, at most.
  double least_gain = 1e-3;  ///< A round that shortens by a smaller share is the last.
  double finest_cut = 0.05;  ///< Corners are not cut closer than this [m].
};

namespace detail {
/// From every vertex on to the farthest later one in sight.
template <typename Visible>
std::vector<Point3> skip_vertices(const std::vector<Point3>& p, const Visible& visible) {
  std::vector<Point3> out;
  for (std::size_t i = 0; i < p.size();) {
    out.push_back(p[i]);
    std::size_t next = i + 1;
    for (std::size_t j = p.size() - 1; j > i + 1; --j)
      if (visible(p[i], p[j])) {
        next = j;
        break;
      }
    i = next;
  }
  return out;
}

/// Moves every inner vertex towards the chord of its neighbours as far as both legs stay free.
template <typename Visible>
void pull_vertices(std::vector<Point3>& p, const Visible& visible) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Point3 a = p[i - 1], b = p[i + 1];
    const Eigen::Vector3d chord = b - a;
    const double square = chord.squaredNorm();
    const double t = square > 0.0 ? std::clamp((p[i] - a).dot(chord) / square, 0.0, 1.0) : 0.0;
    const Point3 projection = a + t * chord;
    for (double share = 0.5; share > 0.06; share *= 0.5) {
      const Point3 moved = p[i] + share * (projection - p[i]);
      if (visible(a, moved) && visible(moved, b)) {
        p[i] = moved;
        break;
      }
    }
  }
}

/// Replaces every inner vertex by a cut across its corner, as large as is free.
template <typename Visible>
std::vector<Point3> cut_corners(const std::vector<Point3>& p, const Visible& visible,
                                double finest) {
  std::vector<Point3> out{p.front()};
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Eigen::Vector3d back = out.back() - p[i], on = p[i + 1] - p[i];
    // Not past the middle of the next leg, which the next corner needs as well.
    const double reach = std::min(back.norm(), 0.5 * on.norm());
    bool cut = false;
    for (double d = reach; !cut && d > finest; d *= 0.5) {
      const Point3 u = p[i] + back.normalized() * d, w = p[i] + on.normalized() * d;
      if (!visible(u, w)) continue;
      if ((u - out.back()).norm() > 1e-9) out.push_back(u);
      out.push_back(w);
      cut = true;
    }
    if (!cut) out.push_back(p[i]);
  }
  out.push_back(p.back());
  return out;
}
}  // namespace detail

/// A path with the same ends, no longer than `points`, whose legs `visible(a, b)` allows; the legs
/// of `points` are taken as allowed. Deterministic and local: it stays in the homotopy class or
/// nearly so, and ends near a locally shortest path. O(vertices² + rounds · vertices) checks.
template <typename Visible>
Path shortcut(std::vector<Point3> points, const Visible& visible,
              const ShortcutOptions& options = {}) {
  if (points.size() < 3) return Path(std::move(points));
  Path best(detail::skip_vertices(points, visible));
  for (int round = 0; round < options.rounds && best.points.size() > 2; ++round) {
    std::vector<Point3> p = best.points;
    detail::pull_vertices(p, visible);
    p = detail::cut_corners(p, visible, options.finest_cut);
    Path next(detail::skip_vertices(p, visible));
    const double gain = best.length - next.length;
    if (gain > 0.0) best = std::move(next);
    if (gain < options.least_gain * best.length) break;
  }
  return best;
}
}  // namespace surfleet
