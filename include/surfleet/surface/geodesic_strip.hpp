// SPDX-License-Identifier: MIT
/// @file
/// @brief Short strips from a mesh's vertex-to-vertex distances across unfolded faces.
///
///     const GeodesicStrips strips(walk);
///     if (const auto path = strips(start, goal)) drive(*path);
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/predicates.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/strip_path.hpp>
#include <surfleet/surface/surface_point.hpp>
#include <surfleet/surface/surface_walk.hpp>
#include <surfleet/surface/triangle_strip.hpp>

namespace surfleet {
/// Finds the triangles under a `FaceGeodesic` path and shortens it by string pulling: locally
/// shortest, and within a small share of the shortest of all.
class GeodesicStrips {
 public:
  /// The walk must outlive it. O(n log n).
  explicit GeodesicStrips(const SurfaceWalk& walk, const FaceGeodesic& distance = {})
      : walk_(&walk),
        faces_(distance.faces),
        graph_(distance(walk.mesh())),
        adjacency_(walk.mesh()),
        shortener_(walk) {}

  const StripShortener& shortener() const { return shortener_; }

  /// Nothing where no such path leads from one to the other over edges of two triangles.
  std::optional<SurfacePath> operator()(const SurfacePoint& start, const SurfacePoint& goal) const {
    const auto strip = triangles(start, goal);
    if (!strip) return std::nullopt;
    return shortener_.shortened(*strip, start, goal);
  }

  /// The triangles under the shortest path of the graph, start and goal joined to the corners of
  /// their triangles.
  std::optional<std::vector<std::int32_t>> triangles(const SurfacePoint& start,
                                                     const SurfacePoint& goal) const {
    if (start.triangle == goal.triangle) return std::vector<std::int32_t>{start.triangle};
    const TriangleMesh& mesh = walk_->mesh();
    const Point3 from = start.position(mesh), to = goal.position(mesh);
    const Triangle& first = mesh.triangles[static_cast<std::size_t>(start.triangle)];
    const Triangle& last = mesh.triangles[static_cast<std::size_t>(goal.triangle)];
    std::vector<Source> sources;
    for (const std::int32_t v : first) sources.push_back({v, (at(v) - from).norm()});
    double best = ShortestPaths::kUnreached;
    std::int32_t end = -1;
    const auto heuristic = [&](std::int32_t v) { return (at(v) - to).norm(); };
    const auto found = shortest_paths(graph_, std::span<const Source>(sources), heuristic,
                                      [&](std::int32_t v, double d) {
                                        if (d + heuristic(v) >= best) return true;
                                        for (const std::int32_t w : last)
                                          if (w == v) {
                                            best = d + heuristic(v);
                                            end = v;
                                          }
                                        return false;
                                      });
    if (end < 0) return std::nullopt;
    const auto vertices = found.path(end);
    std::vector<std::int32_t> strip{start.triangle};
    for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
      const auto piece = straight_piece(vertices[k], vertices[k + 1]);
      if (piece.empty() || !join(strip, vertices[k], piece.front())) return std::nullopt;
      strip.insert(strip.end(), piece.begin() + 1, piece.end());
    }
    if (!join(strip, vertices.back(), goal.triangle)) return std::nullopt;
    detail::cut_loops(strip);
    return strip;
  }

 private:
  const Point3& at(std::int32_t v) const {
    return walk_->mesh().vertices[static_cast<std::size_t>(v)];
  }
  int corner_of(std::int32_t triangle, std::int32_t vertex) const {
    const Triangle& t = walk_->mesh().triangles[static_cast<std::size_t>(triangle)];
    return t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
  }

  /// Appends the triangles about `vertex` that lead from the strip's last to `to`, on the side
  /// where the angle is less. False where no fan leads there.
  bool join(std::vector<std::int32_t>& strip, std::int32_t vertex, std::int32_t to) const {
    if (strip.back() == to) return true;
    const TriangleMesh& mesh = walk_->mesh();
    const std::int32_t from = strip.back();
    std::vector<std::int32_t> best;
    double least = ShortestPaths::kUnreached;
    for (const int side : {0, 2}) {  // leave over the side after the corner, or before it
      std::vector<std::int32_t> fan;
      double angle = 0.0;
      std::int32_t over = 3 * from + (corner_of(from, vertex) + side) % 3;
      while (true) {
        const std::int32_t in = walk_->twin(over);
        if (in < 0 || in / 3 == from) break;
        fan.push_back(in / 3);
        if (in / 3 == to) {
          if (angle < least) best = fan;
          least = std::min(least, angle);
          break;
        }
        const int corner = corner_of(in / 3, vertex);
        angle += StripShortener::corner_angle(mesh, static_cast<std::size_t>(in / 3),
                                              static_cast<std::size_t>(corner));
        over = in % 3 == corner ? 3 * (in / 3) + (corner + 2) % 3 : 3 * (in / 3) + corner;
      }
    }
    strip.insert(strip.end(), best.begin(), best.end());
    return !best.empty();
  }

  /// The triangles of the shortest straight piece from u to w.
  std::vector<std::int32_t> straight_piece(std::int32_t u, std::int32_t w) const {
    const TriangleMesh& mesh = walk_->mesh();
    Found found{ShortestPaths::kUnreached, {}};
    for (const std::int32_t t : adjacency_.triangles_of_vertex(u)) {
      const int k = corner_of(t, u);
      const auto i = static_cast<std::size_t>(t), c = static_cast<std::size_t>(k);
      const std::int32_t v1 = mesh.triangles[i][(c + 1) % 3], v2 = mesh.triangles[i][(c + 2) % 3];
      if (v1 == w || v2 == w) {
        const double length = (at(w) - at(u)).norm();
        if (length < found.length) found = {length, {t}};
        continue;
      }
      const Eigen::Vector3d a = at(v1) - at(u), b = at(v2) - at(u);
      const double la = a.norm(), x = a.dot(b) / la, y = a.cross(b).norm() / la;
      std::vector<std::int32_t> strip{t};
      const Point2 right(la, 0.0), left(x, y);
      through(3 * t + (k + 1) % 3, {v1, right}, {v2, left}, right, left, w, strip, found);
    }
    return found.strip;
  }
  struct Found {
    double length;
    std::vector<std::int32_t> strip;
  };
  /// An end of an edge that is crossed.
  struct End {
    std::int32_t vertex;
    Point2 at;
  };
  /// Unfolds from the origin over half-edge `h`, whose ends `a` and `b` lie anticlockwise, within
  /// the cone from `right` to `left`.
  void through(std::int32_t h, const End& a, const End& b, const Point2& right, const Point2& left,
               std::int32_t w, std::vector<std::int32_t>& strip, Found& found) const {
    const std::int32_t in = walk_->twin(h);
    if (in < 0 || static_cast<int>(strip.size()) > faces_) return;
    const HalfEdges& half = walk_->half_edges();
    const bool same = half.from(in) == a.vertex;
    const auto t = static_cast<std::size_t>(in / 3), k = static_cast<std::size_t>(in % 3);
    // Beyond the edge, the origin being on the left of ab.
    const End c{half.opposite(in), same ? unfolded_apex(walk_->mesh(), t, k, a.at, b.at, false)
                                        : unfolded_apex(walk_->mesh(), t, k, b.at, a.at, true)};
    strip.push_back(in / 3);
    const bool past_right = cross2(right, c.at) > 0.0, past_left = cross2(c.at, left) > 0.0;
    if (c.vertex == w && past_right && past_left && c.at.norm() < found.length)
      found = {c.at.norm(), strip};
    const std::int32_t first = 3 * (in / 3);
    const std::int32_t after = first + (in % 3 + 1) % 3, before = first + (in % 3 + 2) % 3;
    if (past_right)
      through(same ? before : after, a, c, right, past_left ? c.at : left, w, strip, found);
    if (past_left)
      through(same ? after : before, c, b, past_right ? c.at : right, left, w, strip, found);
    strip.pop_back();
  }

  const SurfaceWalk* walk_;
  int faces_;
  Graph graph_;
  MeshAdjacency adjacency_;
  StripShortener shortener_;
};
}  // namespace surfleet
