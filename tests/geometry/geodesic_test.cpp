// SPDX-License-Identifier: MIT
#include <surfleet/geometry/geodesic.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// A jittered triangulated square of n × n vertices over [0, 1]², lifted by `height`.
template <typename Height>
TriangleMesh sheet(int n, double jitter, Height height) {
  TriangleMesh mesh;
  Random random(5);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const bool edge = i == 0 || j == 0 || i == n - 1 || j == n - 1;
      const double x = (i + (edge ? 0.0 : jitter * random.uniform(-1, 1))) / (n - 1);
      const double y = (j + (edge ? 0.0 : jitter * random.uniform(-1, 1))) / (n - 1);
      mesh.vertices.push_back({x, y, height(x, y)});
    }
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i, b = a + 1, c = a + n + 1, d = a + n;
      if ((i + j) % 2 == 0)
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      else
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
    }
  return mesh;
}
double flat(double, double) { return 0.0; }

template <typename Policy>
double mean_error(const TriangleMesh& mesh, const Policy& policy, std::int32_t source) {
  const auto paths = shortest_paths(policy(mesh, EuclideanMetric{}), source);
  double sum = 0.0;
  int count = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double exact =
        (mesh.vertices[v] - mesh.vertices[static_cast<std::size_t>(source)]).norm();
    if (exact == 0.0) continue;
    CHECK(paths.distance[v] >= exact * (1.0 - 1e-12));
    sum += paths.distance[v] / exact - 1.0;
    ++count;
  }
  return sum / count;
}

TEST(flat_sheet_errors) {
  const TriangleMesh mesh = sheet(31, 0.25, flat);
  const double edges = mean_error(mesh, EdgeGeodesic{}, 0);
  const double faces = mean_error(mesh, FaceGeodesic{}, 0);
  CHECK(faces < 0.012);
  CHECK(faces < 0.5 * edges);
  CHECK(mean_error(mesh, FaceGeodesic{.faces = 1}, 400) < 0.035);
}

TEST(one_hop_across_an_edge_is_exact) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  CHECK_NEAR(shortest_paths(FaceGeodesic{1}(mesh, EuclideanMetric{}), 0).distance[3], 2.0, 1e-12);
  // Folded about the common edge the surface distance stays.
  mesh.vertices[3] = {1, 0, 1};
  CHECK_NEAR(shortest_paths(FaceGeodesic{1}(mesh, EuclideanMetric{}), 0).distance[3], 2.0, 1e-12);
  // Orientation of a face does not matter.
  mesh.triangles[1] = {1, 2, 3};
  CHECK_NEAR(shortest_paths(FaceGeodesic{1}(mesh, EuclideanMetric{}), 0).distance[3], 2.0, 1e-12);
  CHECK_NEAR(shortest_paths(EdgeGeodesic{}(mesh, EuclideanMetric{}), 0).distance[3],
             2.0 * std::sqrt(2.0), 1e-12);
}

TEST(non_manifold_edge_crosses_to_every_page) {
  // Three pages of a book on one spine.
  TriangleMesh mesh;
  mesh.vertices = {{0, -1, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
  const auto paths = shortest_paths(FaceGeodesic{}(mesh, EuclideanMetric{}), 2);
  CHECK_NEAR(paths.distance[3], 2.0, 1e-12);
  CHECK_NEAR(paths.distance[4], 2.0, 1e-12);
  const HalfEdges half(mesh);
  int around = 1;
  for (std::int32_t h = half.around(0); h != 0; h = half.around(h)) ++around;
  CHECK(around == 3);
}

TEST(many_sources_never_below_the_straight_line) {
  const TriangleMesh mesh =
      sheet(25, 0.3, [](double x, double y) { return 0.2 * std::sin(7 * x) * std::cos(5 * y); });
  std::vector<Source> sources;
  for (std::int32_t s = 3; s < 625; s += 97) sources.push_back({s, 0.0});
  const auto paths =
      shortest_paths(FaceGeodesic{}(mesh, EuclideanMetric{}), std::span<const Source>(sources));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    double straight = 1e9;
    for (const Source& s : sources)
      straight = std::min(
          straight, (mesh.vertices[v] - mesh.vertices[static_cast<std::size_t>(s.first)]).norm());
    CHECK(paths.distance[v] >= straight * (1.0 - 1e-12));
  }
}

TEST(metric_scales_both_policies) {
  const TriangleMesh mesh = sheet(11, 0.2, flat);
  const auto doubled = [](std::int32_t, std::int32_t, const Eigen::Vector3d& d) {
    return 2.0 * d.norm();
  };
  const auto once = shortest_paths(FaceGeodesic{}(mesh, EuclideanMetric{}), 60);
  const auto twice = shortest_paths(FaceGeodesic{}(mesh, doubled), 60);
  for (std::size_t v = 0; v < 121; ++v) CHECK_NEAR(twice.distance[v], 2.0 * once.distance[v], 1e-9);
}

TEST(degenerate_and_empty_meshes) {
  TriangleMesh mesh;
  CHECK(FaceGeodesic{}(mesh, EuclideanMetric{}).size() == 0);
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 0}, {5, 5, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 1, 2}};
  const auto paths = shortest_paths(FaceGeodesic{}(mesh, EuclideanMetric{}), 0);
  CHECK_NEAR(paths.distance[2], 2.0, 1e-12);
  CHECK(!paths.reached(4));
  mesh.triangles.push_back({0, 1, 9});
  CHECK_THROWS(Error, require_valid_surface(mesh));
  CHECK_THROWS(Error, FaceGeodesic{9}(TriangleMesh{}, EuclideanMetric{}));
}

TEST(queue_order_holds_on_arcs_of_every_scale) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const int n = 200;
    std::vector<std::pair<std::int32_t, Arc>> list;
    for (int e = 0; e < 900; ++e) {
      const double length = std::pow(10.0, random.uniform(-6, 4)) * (random.below(9) == 0 ? 0 : 1);
      const auto a = static_cast<std::int32_t>(random.below(n)),
                 b = static_cast<std::int32_t>(random.below(n));
      list.push_back({a, {b, length}});
    }
    const Graph graph(n, list);
    double last = 0.0;
    std::vector<int> seen(n, 0);
    const Source s{0, 0.0};
    const auto paths = shortest_paths(graph, std::span<const Source>(&s, 1), NoHeuristic{},
                                      [&](std::int32_t v, double d) {
                                        CHECK(d >= last);
                                        last = d;
                                        ++seen[static_cast<std::size_t>(v)];
                                        return false;
                                      });
    // Bellman and Ford as the oracle.
    std::vector<double> d(n, ShortestPaths::kUnreached);
    d[0] = 0.0;
    for (int pass = 0; pass < n; ++pass)
      for (const auto& [a, arc] : list)
        d[static_cast<std::size_t>(arc.to)] = std::min(d[static_cast<std::size_t>(arc.to)],
                                                       d[static_cast<std::size_t>(a)] + arc.length);
    for (std::size_t v = 0; v < n; ++v) {
      CHECK(paths.distance[v] == d[v]);
      CHECK(seen[v] == (d[v] < ShortestPaths::kUnreached ? 1 : 0));
    }
  }
}
}  // namespace
