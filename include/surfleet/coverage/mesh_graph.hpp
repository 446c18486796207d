// SPDX-License-Identifier: MIT
/// @file
/// @brief A surface as a graph of sites: the mesh's vertices, or its triangles in the dual [004
/// §6.2, §6.3.1].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/coverage/metric_field.hpp>
#include <surfleet/geometry/clean_surface.hpp>
#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/graph_components.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// What coverage needs to know of a surface. A weighted graph whose arcs measure distance.
struct SurfaceGraph {
  std::vector<Point3> position;         ///< Of every site [m].
  std::vector<double> area;             ///< A(v) [m²].
  std::vector<double> mass;             ///< M_A(v) = A(v) ρ(v).
  std::vector<Eigen::Matrix3d> tensor;  ///< K̃ of every site; empty is the identity.
  Graph links;   ///< Neighbours on the surface: what makes a region connected.
  Graph across;  ///< Arcs of the distance where they are not the links; or empty.

  std::size_t size() const { return position.size(); }
  const Graph& distance_graph() const { return across.size() > 0 ? across : links; }
  std::span<const Arc> arcs(std::int32_t site) const { return distance_graph().arcs(site); }
};
static_assert(WeightedGraph<SurfaceGraph>);

/// A mesh read as sites.
template <typename S>
concept SurfaceModel = requires(const S& model, const TriangleMesh& mesh,
                                const EdgeGeodesic& distance, const MetricField& field) {
  { model(mesh, distance, field) } -> std::same_as<SurfaceGraph>;
};

/// G_mesh: one site a vertex, with a third of the area of every triangle around it.
struct MeshGraph {
  template <typename Distance>
  SurfaceGraph operator()(const TriangleMesh& mesh, const Distance& distance,
                          const MetricField& field = {}) const {
    require_valid_surface(mesh);
    require_valid_field(field, mesh);
    const std::size_t n = mesh.vertices.size();
    SurfaceGraph graph;
    graph.position = mesh.vertices;
    graph.tensor = field.tensor;
    graph.area.assign(n, 0.0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::int32_t v : mesh.triangles[t])
        graph.area[static_cast<std::size_t>(v)] += mesh.area(t) / 3.0;
    graph.mass = graph.area;
    for (std::size_t v = 0; v < field.density.size(); ++v) graph.mass[v] *= field.density[v];
    const auto measure = [&](const auto& metric) {
      graph.links = EdgeGeodesic{}(mesh, metric);
      if constexpr (!std::same_as<Distance, EdgeGeodesic>) graph.across = distance(mesh, metric);
    };
    if (field.tensor.empty() && field.norm == 2.0)
      measure(EuclideanMetric{});
    else
      measure(FieldMetric(field.tensor, field.norm));
    return graph;
  }
};

/// Where the shortest line between the centroids of triangles `s` and `t`, unfolded about the edge
/// from `a` to `b` that they share, crosses it.
inline Point3 crossing_point(const TriangleMesh& mesh, std::size_t s, std::size_t t,
                             const Point3& a, const Point3& b) {
  const Eigen::Vector3d edge = b - a;
  const double squared = edge.squaredNorm();
  if (!(squared > 0.0)) return a;
  const auto flat = [&](std::size_t triangle) {
    const Eigen::Vector3d d = mesh.centroid(triangle) - a;
    return Eigen::Vector2d(d.dot(edge) / squared, d.cross(edge).norm() / squared);
  };
  const Eigen::Vector2d p = flat(s), q = flat(t);
  const double share = p.y() + q.y() > 0.0 ? p.y() / (p.y() + q.y()) : 0.5;
  return a + std::clamp(p.x() + share * (q.x() - p.x()), 0.0, 1.0) * edge;
}
/// The same for two triangles that are known to share an edge.
inline Point3 crossing_point(const TriangleMesh& mesh, std::size_t s, std::size_t t) {
  std::array<std::int32_t, 2> common{-1, -1};
  std::size_t found = 0;
  for (const std::int32_t v : mesh.triangles[s])
    for (const std::int32_t w : mesh.triangles[t])
      if (v == w && found < 2 && (found == 0 || common[0] != v)) common[found++] = v;
  require(found == 2, "crossing point: the triangles share no edge");
  return crossing_point(mesh, s, t, mesh.vertices[static_cast<std::size_t>(common[0])],
                        mesh.vertices[static_cast<std::size_t>(common[1])]);
}

/// G*_mesh: one site a triangle, neighbours over a common edge, distances from centroid to
/// centroid straight over that edge. The distance policy is not asked.
struct DualMeshGraph {
  template <typename Distance>
  SurfaceGraph operator()(const TriangleMesh& mesh, const Distance&,
                          const MetricField& field = {}) const {
    require_valid_surface(mesh);
    require_valid_field(field, mesh);
    const std::size_t m = mesh.triangles.size();
    SurfaceGraph graph;
    for (std::size_t t = 0; t < m; ++t) {
      graph.position.push_back(mesh.centroid(t));
      graph.area.push_back(mesh.area(t));
      graph.mass.push_back(graph.area[t] * mean(field.density, mesh.triangles[t], 1.0));
      if (!field.tensor.empty())
        graph.tensor.push_back(
            mean(field.tensor, mesh.triangles[t], Eigen::Matrix3d(Eigen::Matrix3d::Identity())));
    }
    const HalfEdges half(mesh);
    std::vector<detail::Link> links;
    const auto measure = [&](const auto& metric) {
      for (const std::int32_t first : half.edges())
        for (std::int32_t g = half.around(first); g != first; g = half.around(g))
          for (std::int32_t h = first; h != g; h = half.around(h)) {
            const std::int32_t s = HalfEdges::triangle(h), t = HalfEdges::triangle(g);
            if (s == t) continue;
            const Point3 x =
                crossing_point(mesh, static_cast<std::size_t>(s), static_cast<std::size_t>(t),
                               mesh.vertices[static_cast<std::size_t>(half.from(h))],
                               mesh.vertices[static_cast<std::size_t>(half.to(h))]);
            links.push_back(
                {s, t, metric(s, t, x - at(graph, s)) + metric(s, t, at(graph, t) - x)});
          }
    };
    if (field.tensor.empty() && field.norm == 2.0)
      measure(EuclideanMetric{});
    else
      measure(FieldMetric(graph.tensor, field.norm));
    graph.links = detail::symmetric_graph(m, links);
    return graph;
  }

 private:
  static const Point3& at(const SurfaceGraph& graph, std::int32_t s) {
    return graph.position[static_cast<std::size_t>(s)];
  }
  template <typename T>
  static T mean(const std::vector<T>& values, const Triangle& t, const T& otherwise) {
    if (values.empty()) return otherwise;
    return (values[static_cast<std::size_t>(t[0])] + values[static_cast<std::size_t>(t[1])] +
            values[static_cast<std::size_t>(t[2])]) /
           3.0;
  }
};
static_assert(SurfaceModel<MeshGraph> && SurfaceModel<DualMeshGraph>);
}  // namespace surfleet
