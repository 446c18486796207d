// SPDX-License-Identifier: MIT
/// @file
/// @brief Strips of triangles and how they unfold into the plane [004 §7.2.3].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/surface_point.hpp>

namespace surfleet {
/// The side that two triangles share: k in `a`, and the side of `b` that joins the same vertices.
/// Nothing if there is none.
inline std::optional<std::pair<int, int>> shared_side(const Triangle& a, const Triangle& b) {
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) {
      const auto p = a[static_cast<std::size_t>(k)], q = a[static_cast<std::size_t>((k + 1) % 3)];
      const auto r = b[static_cast<std::size_t>(j)], s = b[static_cast<std::size_t>((j + 1) % 3)];
      if (p != q && ((p == r && q == s) || (p == s && q == r))) return std::pair{k, j};
    }
  return std::nullopt;
}

/// A strip laid flat: every triangle at its place, congruent with itself on the surface, the shared
/// edges in common. Places overlap where a strip winds about a vertex; nothing here minds.
struct UnfoldedStrip {
  std::vector<std::int32_t> triangles;         ///< Each shares an edge with the one before.
  std::vector<std::array<Point2, 3>> corners;  ///< Of every place, in the mesh's order [m].
  std::vector<int> exit;               ///< The side by which a place is left, −1 in the last.
  std::vector<int> entry;              ///< The side by which it is entered, −1 in the first.
  std::vector<std::uint8_t> mirrored;  ///< Places whose corners run clockwise here.

  std::size_t size() const { return triangles.size(); }
  Point2 flat(std::size_t place, const Eigen::Vector3d& weights) const {
    const auto& c = corners[place];
    return weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
  }
  /// The gate to the next place: its ends as the strip is driven, left and right.
  struct Gate {
    Point2 left, right;
    std::int32_t left_vertex, right_vertex;
  };
  Gate gate(const TriangleMesh& mesh, std::size_t place) const {
    const auto k = static_cast<std::size_t>(exit[place]), j = (k + 1) % 3;
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(triangles[place])];
    const auto& c = corners[place];
    // Left of the exit is the far end of a side that runs anticlockwise about its triangle.
    if (mirrored[place] != 0) return {c[k], c[j], t[k], t[j]};
    return {c[j], c[k], t[j], t[k]};
  }
};

/// The third corner of triangle `t` where corners k and k + 1 lie at `a` and `b`: to the left of
/// ab, or to the right.
inline Point2 unfolded_apex(const TriangleMesh& mesh, std::size_t t, std::size_t k, const Point2& a,
                            const Point2& b, bool to_the_left) {
  const Eigen::Vector3d edge = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k);
  const Eigen::Vector3d side = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
  const double squared = edge.squaredNorm();
  const double x = edge.dot(side) / squared, y = edge.cross(side).norm() / squared;
  const Point2 along = b - a, left(-along.y(), along.x());
  return a + x * along + (to_the_left ? y : -y) * left;
}

/// Lays a strip flat, its first triangle with corner 0 at the origin and corner 1 on the x axis.
/// Throws `Error` where two consecutive triangles share no edge or one has no area. O(n).
inline UnfoldedStrip unfold(const TriangleMesh& mesh, std::span<const std::int32_t> triangles) {
  UnfoldedStrip strip;
  strip.triangles.assign(triangles.begin(), triangles.end());
  strip.corners.resize(triangles.size());
  strip.exit.assign(triangles.size(), -1);
  strip.entry.assign(triangles.size(), -1);
  strip.mirrored.assign(triangles.size(), 0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    require(triangles[i] >= 0 && static_cast<std::size_t>(triangles[i]) < mesh.triangles.size(),
            "strip: triangle " + std::to_string(triangles[i]) + " of " +
                std::to_string(mesh.triangles.size()));
    const auto t = static_cast<std::size_t>(triangles[i]);
    require(mesh.area_vector(t).squaredNorm() > 0.0, "strip: a triangle without area");
    auto& c = strip.corners[i];
    if (i == 0) {
      c[0] = Point2::Zero();
      c[1] = Point2((mesh.corner(t, 1) - mesh.corner(t, 0)).norm(), 0.0);
      c[2] = unfolded_apex(mesh, t, 0, c[0], c[1], true);
      continue;
    }
    const auto last = static_cast<std::size_t>(triangles[i - 1]);
    const auto sides = shared_side(mesh.triangles[last], mesh.triangles[t]);
    require(sides.has_value() && last != t, "strip: triangles " + std::to_string(triangles[i - 1]) +
                                                " and " + std::to_string(triangles[i]) +
                                                " share no edge");
    strip.exit[i - 1] = sides->first;
    strip.entry[i] = sides->second;
    const auto k = static_cast<std::size_t>(sides->first),
               j = static_cast<std::size_t>(sides->second);
    const auto& from = strip.corners[i - 1];
    const bool same = mesh.triangles[last][k] == mesh.triangles[t][j];
    c[j] = same ? from[k] : from[(k + 1) % 3];
    c[(j + 1) % 3] = same ? from[(k + 1) % 3] : from[k];
    // Beyond the edge, seen from the place before.
    const bool before_left = strip.mirrored[i - 1] == 0;  // of its own side k
    const bool left = same ? !before_left : before_left;
    c[(j + 2) % 3] = unfolded_apex(mesh, t, j, c[j], c[(j + 1) % 3], left);
    strip.mirrored[i] = left ? 0 : 1;
  }
  return strip;
}
}  // namespace surfleet
