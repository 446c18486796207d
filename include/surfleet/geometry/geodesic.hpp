// SPDX-License-Identifier: MIT
/// @file
/// @brief Distances along a triangle mesh as graphs for `shortest_paths`: along its edges, and
/// straight across unfolded faces.
///
/// Every arc is the length of a curve on the surface, so no distance is ever below the straight
/// line, from however many sources. Non-manifold edges, borders, several components and slivers
/// need no special treatment: a curve may cross from a face to any other face of the same edge.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// How a surface measures a short straight piece between (or next to) vertices `a` and `b`.
///
/// `metric(a, b, delta)` is the length of the vector `delta` [m] there: symmetric in a and b,
/// positive, the same for −delta.
template <typename M>
concept SegmentMetric = requires(const M& metric, std::int32_t a, std::int32_t b,
                                 const Eigen::Vector3d& delta) {
  { metric(a, b, delta) } -> std::convertible_to<double>;
};

/// Metres.
struct EuclideanMetric {
  double operator()(std::int32_t, std::int32_t, const Eigen::Vector3d& delta) const {
    return delta.norm();
  }
};
static_assert(SegmentMetric<EuclideanMetric>);

/// A graph distance on a mesh: `policy(mesh, metric)` is a symmetric graph over its vertices.
template <typename P>
concept GeodesicPolicy = requires(const P& policy, const TriangleMesh& mesh,
                                  const EuclideanMetric& metric) {
  { policy(mesh, metric) } -> std::convertible_to<Graph>;
};

/// Throws `Error` where a face names a vertex that is not there or a vertex is not finite.
inline void require_valid_surface(const TriangleMesh& mesh) {
  const auto n = static_cast<std::int32_t>(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t v : mesh.triangles[t])
      if (v < 0 || v >= n)
        throw Error("mesh: triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                    " of " + std::to_string(n));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!mesh.vertices[v].allFinite())
      throw Error("mesh: vertex " + std::to_string(v) + " is not finite");
}

/// The half-edges of a mesh, linked around each undirected edge: what walking from face to face
/// asks for, and no more (`MeshAdjacency` answers the rest).
///
/// Half-edge 3t + k runs from corner k to corner k + 1 of triangle t. O(n + m).
class HalfEdges {
 public:
  explicit HalfEdges(const TriangleMesh& mesh) : mesh_(&mesh), next_(3 * mesh.triangles.size()) {
    const std::size_t n = mesh.vertices.size(), m = next_.size();
    std::vector<std::int32_t> first(n + 1, 0);
    for (std::size_t h = 0; h < m; ++h) ++first[static_cast<std::size_t>(low(h)) + 1];
    for (std::size_t v = 0; v < n; ++v) first[v + 1] += first[v];
    std::vector<std::pair<std::int32_t, std::int32_t>> at(m);  // (higher vertex, half-edge)
    std::vector<std::int32_t> fill(first.begin(), first.end() - 1);
    for (std::size_t h = 0; h < m; ++h)
      at[static_cast<std::size_t>(fill[static_cast<std::size_t>(low(h))]++)] = {
          high(h), static_cast<std::int32_t>(h)};
    for (std::size_t v = 0; v < n; ++v) {
      const auto begin = at.begin() + first[v], end = at.begin() + first[v + 1];
      std::sort(begin, end);
      for (auto run = begin; run != end;) {
        auto stop = run;
        while (stop != end && stop->first == run->first) ++stop;
        for (auto h = run; h != stop; ++h)
          next_[static_cast<std::size_t>(h->second)] =
              h + 1 == stop ? run->second : (h + 1)->second;
        if (run->first != static_cast<std::int32_t>(v)) edges_.push_back(run->second);
        run = stop;
      }
    }
  }
  /// The next half-edge on the same undirected edge; itself at a border.
  std::int32_t around(std::int32_t h) const { return next_[static_cast<std::size_t>(h)]; }
  /// The half-edge of the one other triangle of this edge; −1 at a border and where three or more
  /// triangles meet.
  std::int32_t twin(std::int32_t h) const {
    const std::int32_t other = around(h);
    return other != h && around(other) == h ? other : -1;
  }
  /// One half-edge of every undirected edge with two distinct ends.
  const std::vector<std::int32_t>& edges() const { return edges_; }
  std::int32_t from(std::int32_t h) const { return corner(h, 0); }
  std::int32_t to(std::int32_t h) const { return corner(h, 1); }
  std::int32_t opposite(std::int32_t h) const { return corner(h, 2); }
  static std::int32_t triangle(std::int32_t h) { return h / 3; }

 private:
  std::int32_t corner(std::int32_t h, int k) const {
    return mesh_->triangles[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>((h + k) % 3)];
  }
  std::int32_t low(std::size_t h) const {
    const auto i = static_cast<std::int32_t>(h);
    return std::min(from(i), to(i));
  }
  std::int32_t high(std::size_t h) const {
    const auto i = static_cast<std::int32_t>(h);
    return std::max(from(i), to(i));
  }
  const TriangleMesh* mesh_;
  std::vector<std::int32_t> next_;
  std::vector<std::int32_t> edges_;
};

namespace detail {
/// A symmetric arc between two nodes.
struct Link {
  std::int32_t a, b;
  double length;
};
inline Graph symmetric_graph(std::size_t nodes, std::span<const Link> links) {
  std::vector<std::pair<std::int32_t, Arc>> list;
  list.reserve(2 * links.size());
  for (const Link& l : links) {
    list.push_back({l.a, {l.b, l.length}});
    list.push_back({l.b, {l.a, l.length}});
  }
  return Graph(nodes, list);
}
}  // namespace detail

/// Shortest paths along edges, eq. 6.2 of [004]. A few per cent long on irregular meshes, up to
/// 15 % on regular ones.
struct EdgeGeodesic {
  template <SegmentMetric Metric = EuclideanMetric>
  Graph operator()(const TriangleMesh& mesh, const Metric& metric = {}) const {
    const HalfEdges half(mesh);
    std::vector<detail::Link> links;
    links.reserve(half.edges().size());
    for (const std::int32_t h : half.edges()) links.push_back(link(mesh, half, h, metric));
    return detail::symmetric_graph(mesh.vertices.size(), links);
  }

  template <SegmentMetric Metric>
  static detail::Link link(const TriangleMesh& mesh, const HalfEdges& half, std::int32_t h,
                           const Metric& metric) {
    const std::int32_t a = half.from(h), b = half.to(h);
    return {a, b,
            metric(a, b,
                   mesh.vertices[static_cast<std::size_t>(b)] -
                       mesh.vertices[static_cast<std::size_t>(a)])};
  }
};
static_assert(GeodesicPolicy<EdgeGeodesic>);

/// Shortest paths along edges and along straight lines from vertex to vertex across up to
/// `faces` + 1 unfolded triangles.
///
/// The directions in which a path can leave a vertex grow with `faces`: on a regular mesh 6, 12,
/// 12, 24 for 0, 1, 2, 3. O(n 2^faces) arcs at most, about 22 a vertex at the default.
struct FaceGeodesic {
  int faces = 3;  ///< Edges that a straight piece may cross, 0 to 6.

  template <SegmentMetric Metric = EuclideanMetric>
  Graph operator()(const TriangleMesh& mesh, const Metric& metric = {}) const {
    require(faces >= 0 && faces <= 6, "FaceGeodesic: faces must be 0 to 6");
    const HalfEdges half(mesh);
    std::vector<detail::Link> links;
    links.reserve(half.edges().size() * static_cast<std::size_t>(1 + 2 * std::min(faces, 2)));
    for (const std::int32_t h : half.edges())
      links.push_back(EdgeGeodesic::link(mesh, half, h, metric));
    if (faces > 0) {
      Unfolding<Metric> unfold{mesh, half, metric, links, {}, {}, 0, {}};
      unfold.run(faces);
    }
    return detail::symmetric_graph(mesh.vertices.size(), links);
  }

 private:
  using Vec2 = Eigen::Vector2d;
  static double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

  template <SegmentMetric Metric>
  struct Unfolding {
    const TriangleMesh& mesh;
    const HalfEdges& half;
    const Metric& metric;
    std::vector<detail::Link>& links;
    std::vector<Vec2> apex;  // per half-edge: the third corner in the frame of the edge
    std::vector<double> length;
    std::int32_t source;
    struct Crossing {
      std::int32_t from, to;
      Vec2 a, b;
    };
    std::array<Crossing, 8> crossed;

    const Point3& at(std::int32_t v) const { return mesh.vertices[static_cast<std::size_t>(v)]; }

    void run(int depth) {
      const std::size_t m = 3 * mesh.triangles.size();
      apex.resize(m);
      length.resize(m);
      for (std::size_t h = 0; h < m; ++h) {
        const auto i = static_cast<std::int32_t>(h);
        const Eigen::Vector3d edge = at(half.to(i)) - at(half.from(i));
        const Eigen::Vector3d side = at(half.opposite(i)) - at(half.from(i));
        const double squared = edge.squaredNorm();
        length[h] = std::sqrt(squared);
        apex[h] = squared > 0.0 ? Vec2(edge.dot(side) / squared, edge.cross(side).norm() / squared)
                                : Vec2(0.0, 0.0);
      }
      for (std::size_t h = 0; h < m; ++h) {
        const auto i = static_cast<std::int32_t>(h);
        if (!(length[h] > 0.0) || !(apex[h].y() > 0.0) || half.around(i) == i) continue;
        // The corner opposite the half-edge is the origin and looks through it, towards −y.
        source = half.opposite(i);
        const Vec2 a = -length[h] * apex[h], b = a + Vec2(length[h], 0.0);
        through(i, {half.from(i), half.to(i), a, b}, a, b, 0, depth);
      }
    }

    /// Looks from the origin through half-edge `h`, within the cone from `right` to `left`. The
    /// crossing's ends are in anticlockwise order seen from the origin.
    void through(std::int32_t h, const Crossing& edge, const Vec2& right, const Vec2& left,
                 int level, int depth) {
      crossed[static_cast<std::size_t>(level)] = edge;
      const Vec2 along = edge.b - edge.a, away(along.y(), -along.x());
      for (std::int32_t g = half.around(h); g != h; g = half.around(g)) {
        const auto k = static_cast<std::size_t>(g);
        const std::int32_t corner = half.opposite(g);
        if (!(apex[k].y() > 0.0) || corner == source) continue;
        const bool forward = half.from(g) == edge.from;
        const Vec2 c =
            (forward ? Vec2(edge.a + apex[k].x() * along) : Vec2(edge.b - apex[k].x() * along)) +
            apex[k].y() * away;
        const double eps = 1e-9 * c.squaredNorm();
        const bool past_right = cross(right, c) > eps, past_left = cross(c, left) > eps;
        if (past_right && past_left && source < corner) reach(corner, c, level);
        if (level + 1 >= depth) continue;
        const std::int32_t t = 3 * HalfEdges::triangle(g);
        const std::int32_t after = t + (g - t + 1) % 3, before = t + (g - t + 2) % 3;
        const std::int32_t right_edge = forward ? before : after;
        const std::int32_t left_edge = forward ? after : before;
        if (past_right && half.around(right_edge) != right_edge)
          through(right_edge, {edge.from, corner, edge.a, c}, right, past_left ? c : left,
                  level + 1, depth);
        if (past_left && half.around(left_edge) != left_edge)
          through(left_edge, {corner, edge.to, c, edge.b}, past_right ? c : right, left, level + 1,
                  depth);
      }
    }

    void reach(std::int32_t corner, const Vec2& c, int level) {
      if constexpr (std::same_as<Metric, EuclideanMetric>) {
        // Rounding must not take the path below the straight line.
        links.push_back({source, corner, std::max(c.norm(), (at(corner) - at(source)).norm())});
      } else {
        double sum = 0.0;
        Point3 last = at(source);
        for (int k = 0; k <= level; ++k) {
          const Crossing& x = crossed[static_cast<std::size_t>(k)];
          const double ca = cross(x.a, c), cb = cross(c, x.b);
          const double s = ca / (ca + cb);
          const Point3 point = at(x.from) + s * (at(x.to) - at(x.from));
          sum += metric(source, corner, point - last);
          last = point;
        }
        links.push_back({source, corner, sum + metric(source, corner, at(corner) - last)});
      }
    }
  };
};
static_assert(GeodesicPolicy<FaceGeodesic>);

/// The distance on a surface that serves unless speed comes before exactness.
using GeodesicDistance = FaceGeodesic;
}  // namespace surfleet
