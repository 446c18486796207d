// SPDX-License-Identifier: MIT
/// @file
/// @brief What touches what in a mesh: edges, rings, borders, connected parts; welding.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// An undirected edge; `vertices[0] < vertices[1]`.
struct MeshEdge {
  std::array<std::int32_t, 2> vertices{};
};

/// The incidences of a mesh's vertices, edges and triangles, in index order.
///
/// Any soup is fine: an edge has one triangle at a border, two inside a manifold, any number
/// elsewhere. Sides of a triangle that join a vertex to itself have no edge. Build O(n log n),
/// queries O(1).
class MeshAdjacency {
 public:
  static constexpr std::int32_t kNone = -1;

  explicit MeshAdjacency(const TriangleMesh& mesh) {
    const std::size_t n = mesh.triangles.size();
    struct TriangleSide {
      std::int32_t low, high, triangle, side;
    };
    std::vector<TriangleSide> sides;
    sides.reserve(3 * n);
    for (std::size_t t = 0; t < n; ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
        if (a != b)
          sides.push_back({a, b, static_cast<std::int32_t>(t), static_cast<std::int32_t>(k)});
      }
    std::sort(sides.begin(), sides.end(), [](const TriangleSide& x, const TriangleSide& y) {
      return std::array{x.low, x.high, x.triangle, x.side} <
             std::array{y.low, y.high, y.triangle, y.side};
    });
    triangle_edges_.assign(n, {kNone, kNone, kNone});
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const TriangleSide& s = sides[i];
      if (i == 0 || s.low != sides[i - 1].low || s.high != sides[i - 1].high) {
        edge_first_.push_back(edge_triangles_.size());
        edges_.push_back({{s.low, s.high}});
      }
      triangle_edges_[static_cast<std::size_t>(s.triangle)][static_cast<std::size_t>(s.side)] =
          static_cast<std::int32_t>(edges_.size() - 1);
      edge_triangles_.push_back(s.triangle);
    }
    edge_first_.push_back(edge_triangles_.size());

    vertex_first_.assign(mesh.vertices.size() + 1, 0);
    for (const Triangle& t : mesh.triangles)
      for (const std::int32_t v : t) ++vertex_first_[static_cast<std::size_t>(v) + 1];
    std::partial_sum(vertex_first_.begin(), vertex_first_.end(), vertex_first_.begin());
    vertex_triangles_.resize(3 * n);
    std::vector<std::size_t> at(vertex_first_.begin(), vertex_first_.end() - 1);
    for (std::size_t t = 0; t < n; ++t)
      for (const std::int32_t v : mesh.triangles[t])
        vertex_triangles_[at[static_cast<std::size_t>(v)]++] = static_cast<std::int32_t>(t);

    ring_first_.assign(mesh.vertices.size() + 1, 0);
    for (const MeshEdge& e : edges_)
      for (const std::int32_t v : e.vertices) ++ring_first_[static_cast<std::size_t>(v) + 1];
    std::partial_sum(ring_first_.begin(), ring_first_.end(), ring_first_.begin());
    ring_.resize(2 * edges_.size());
    at.assign(ring_first_.begin(), ring_first_.end() - 1);
    for (const MeshEdge& e : edges_)  // edges ascend, so each ring ascends
      for (std::size_t k = 0; k < 2; ++k)
        ring_[at[static_cast<std::size_t>(e.vertices[k])]++] = e.vertices[1 - k];
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      std::sort(ring_.begin() + static_cast<std::ptrdiff_t>(ring_first_[v]),
                ring_.begin() + static_cast<std::ptrdiff_t>(ring_first_[v + 1]));
  }

  std::size_t edge_count() const { return edges_.size(); }
  /// Ascending by their vertices.
  const std::vector<MeshEdge>& edges() const { return edges_; }
  /// The triangles of an edge, ascending.
  std::span<const std::int32_t> triangles_of_edge(std::int32_t edge) const {
    return slice(edge_triangles_, edge_first_, edge);
  }
  /// Edge k joins corners k and k + 1 of the triangle; `kNone` if they are the same vertex.
  const std::array<std::int32_t, 3>& edges_of_triangle(std::int32_t triangle) const {
    return triangle_edges_[static_cast<std::size_t>(triangle)];
  }
  /// The triangles of a vertex, ascending; a triangle that uses it twice comes twice.
  std::span<const std::int32_t> triangles_of_vertex(std::int32_t vertex) const {
    return slice(vertex_triangles_, vertex_first_, vertex);
  }
  /// The vertices joined to a vertex by an edge, ascending.
  std::span<const std::int32_t> ring(std::int32_t vertex) const {
    return slice(ring_, ring_first_, vertex);
  }
  bool is_boundary(std::int32_t edge) const { return triangles_of_edge(edge).size() == 1; }
  bool is_manifold(std::int32_t edge) const { return triangles_of_edge(edge).size() <= 2; }

  /// Edges with one triangle.
  std::vector<std::int32_t> boundary_edges() const {
    return edges_where([](std::size_t triangles) { return triangles == 1; });
  }
  /// Edges with three or more triangles.
  std::vector<std::int32_t> non_manifold_edges() const {
    return edges_where([](std::size_t triangles) { return triangles > 2; });
  }

 private:
  template <typename T>
  static std::span<const T> slice(const std::vector<T>& values,
                                  const std::vector<std::size_t>& first, std::int32_t i) {
    const auto at = static_cast<std::size_t>(i);
    return std::span<const T>(values).subspan(first[at], first[at + 1] - first[at]);
  }
  template <typename Test>
  std::vector<std::int32_t> edges_where(const Test& test) const {
    std::vector<std::int32_t> found;
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (test(edge_first_[e + 1] - edge_first_[e])) found.push_back(static_cast<std::int32_t>(e));
    return found;
  }

  std::vector<MeshEdge> edges_;
  std::vector<std::size_t> edge_first_, vertex_first_, ring_first_;
  std::vector<std::int32_t> edge_triangles_, vertex_triangles_, ring_;
  std::vector<std::array<std::int32_t, 3>> triangle_edges_;
};

/// True if every edge has two triangles that run along it in opposite senses. An empty mesh is
/// closed.
inline bool is_closed_and_oriented(const TriangleMesh& mesh) {
  const MeshAdjacency adjacency(mesh);
  std::vector<int> balance(adjacency.edge_count(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t e = adjacency.edges_of_triangle(static_cast<std::int32_t>(t))[k];
      if (e == MeshAdjacency::kNone) return false;
      if (adjacency.triangles_of_edge(e).size() != 2) return false;
      const bool forward = mesh.triangles[t][k] < mesh.triangles[t][(k + 1) % 3];
      balance[static_cast<std::size_t>(e)] += forward ? 1 : -1;
    }
  return std::all_of(balance.begin(), balance.end(), [](int b) { return b == 0; });
}

/// The parts of a mesh that hang together by shared vertices.
struct MeshComponents {
  std::size_t count = 0;
  std::vector<std::int32_t> of_triangle;  ///< Numbered by their first triangle.
};
/// O(n α(n)).
inline MeshComponents connected_components(const TriangleMesh& mesh) {
  DisjointSets parts(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 1; k < 3; ++k) parts.unite(t[0], t[k]);
  MeshComponents result;
  std::vector<std::int32_t> number(mesh.vertices.size(), -1);
  for (const Triangle& t : mesh.triangles) {
    auto& n = number[static_cast<std::size_t>(parts.find(t[0]))];
    if (n < 0) n = static_cast<std::int32_t>(result.count++);
    result.of_triangle.push_back(n);
  }
  return result;
}

/// The connected parts of a mesh that are closed and consistently oriented on their own; the other
/// parts, open or tangled, are left out. Vertices stay as they are.
inline TriangleMesh closed_parts(const TriangleMesh& mesh) {
  const MeshAdjacency adjacency(mesh);
  const MeshComponents parts = connected_components(mesh);
  std::vector<bool> closed(parts.count, true);
  std::vector<int> balance(adjacency.edge_count(), 0);
  const auto part_of = [&](std::int32_t triangle) {
    return static_cast<std::size_t>(parts.of_triangle[static_cast<std::size_t>(triangle)]);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t e = adjacency.edges_of_triangle(static_cast<std::int32_t>(t))[k];
      if (e == MeshAdjacency::kNone) continue;  // a needle bounds nothing
      const bool forward = mesh.triangles[t][k] < mesh.triangles[t][(k + 1) % 3];
      balance[static_cast<std::size_t>(e)] += forward ? 1 : -1;
    }
  for (std::size_t e = 0; e < balance.size(); ++e)
    if (balance[e] != 0)
      closed[part_of(adjacency.triangles_of_edge(static_cast<std::int32_t>(e))[0])] = false;
  TriangleMesh result = mesh;
  result.triangles.clear();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (closed[part_of(static_cast<std::int32_t>(t))])
      result.triangles.push_back(mesh.triangles[t]);
  return result;
}

/// Joins vertices that lie within `tolerance` [m] of one met before, drops the triangles that
/// collapse and the vertices that are not used. A tolerance of 0 joins equal positions. Vertices
/// keep their order; the first of a group gives position and attributes. O(n) expected.
inline TriangleMesh weld_vertices(const TriangleMesh& mesh, double tolerance = 0.0) {
  require(tolerance >= 0.0 && std::isfinite(tolerance),
          "weld: expected a tolerance of 0 or more metres");
  const double cell = tolerance > 0.0 ? tolerance : 1e-9;
  using Key = Eigen::Matrix<std::int64_t, 3, 1>;
  const auto hash = [](const Key& k) {
    return mix64(
        static_cast<std::uint64_t>(k.x()) ^
        mix64(static_cast<std::uint64_t>(k.y()) ^ mix64(static_cast<std::uint64_t>(k.z()))));
  };
  const auto key_of = [cell](const Point3& p) {
    // Far beyond what can be told apart the key saturates, which costs time but no vertex.
    return (p / cell).array().floor().max(-4e18).min(4e18).matrix().cast<std::int64_t>().eval();
  };
  std::unordered_map<std::uint64_t, std::vector<std::int32_t>>
      cells;  // by hash: may hold strangers
  std::vector<std::int32_t> joined(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Point3& p = mesh.vertices[i];
    const Key key = key_of(p);
    std::int32_t target = static_cast<std::int32_t>(i);
    const int reach = tolerance > 0.0 ? 1 : 0;
    for (int dz = -reach; dz <= reach; ++dz)
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const auto found = cells.find(hash(key + Key(dx, dy, dz)));
          if (found == cells.end()) continue;
          for (const std::int32_t j : found->second)
            if ((mesh.vertices[static_cast<std::size_t>(j)] - p).norm() <= tolerance)
              target = std::min(target, j);
        }
    joined[i] = target;
    if (target == static_cast<std::int32_t>(i)) cells[hash(key)].push_back(target);
  }
  TriangleMesh result;
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    Triangle w{};
    for (std::size_t k = 0; k < 3; ++k) w[k] = joined[static_cast<std::size_t>(t[k])];
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) continue;
    for (const std::int32_t v : w) used[static_cast<std::size_t>(v)] = true;
    result.triangles.push_back(w);
  }
  const bool normals = mesh.normals.size() == mesh.vertices.size();
  const bool colors = mesh.colors.size() == mesh.vertices.size();
  std::vector<std::int32_t> renumbered(mesh.vertices.size(), -1);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!used[i]) continue;
    renumbered[i] = static_cast<std::int32_t>(result.vertices.size());
    result.vertices.push_back(mesh.vertices[i]);
    if (normals) result.normals.push_back(mesh.normals[i]);
    if (colors) result.colors.push_back(mesh.colors[i]);
  }
  for (Triangle& t : result.triangles)
    for (std::int32_t& v : t) v = renumbered[static_cast<std::size_t>(v)];
  return result;
}
}  // namespace surfleet
