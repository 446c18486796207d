// SPDX-License-Identifier: MIT
#include <surfleet/geometry/mesh_adjacency.hpp>

#include <set>

#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
/// The incidences hold against plain counting, and against each other.
void check_adjacency(const TriangleMesh& mesh) {
  const MeshAdjacency adjacency(mesh);
  std::set<std::array<std::int32_t, 2>> expected;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] != t[(k + 1) % 3])
        expected.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  CHECK(adjacency.edge_count() == expected.size());
  std::size_t i = 0;
  for (const auto& vertices : expected) CHECK(adjacency.edges()[i++].vertices == vertices);
  for (std::int32_t e = 0; e < static_cast<std::int32_t>(adjacency.edge_count()); ++e)
    for (const std::int32_t t : adjacency.triangles_of_edge(e)) {
      const auto& own = adjacency.edges_of_triangle(t);
      CHECK(std::find(own.begin(), own.end(), e) != own.end());
    }
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(mesh.vertices.size()); ++v) {
    std::vector<std::int32_t> ring;
    for (const auto& [a, b] : expected) {
      if (a == v) ring.push_back(b);
      if (b == v) ring.push_back(a);
    }
    std::sort(ring.begin(), ring.end());
    CHECK(std::equal(ring.begin(), ring.end(), adjacency.ring(v).begin(), adjacency.ring(v).end()));
    for (const std::int32_t t : adjacency.triangles_of_vertex(v)) {
      const Triangle& own = mesh.triangles[static_cast<std::size_t>(t)];
      CHECK(std::find(own.begin(), own.end(), v) != own.end());
    }
  }
}
}  // namespace

TEST(adjacency_of_good_and_bad_meshes) {
  check_adjacency(make_sphere({0, 0, 0}, 1.0, 2));
  check_adjacency(make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0, 3, 2));
  check_adjacency(TriangleMesh{});
  TriangleMesh bad = make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0, 2, 2);
  bad.triangles.push_back({0, 1, 8});
  bad.triangles.push_back({0, 1, 7});
  bad.triangles.push_back({2, 2, 3});
  bad.triangles.push_back({4, 4, 4});
  bad.vertices.emplace_back(9, 9, 9);  // used by no triangle
  check_adjacency(bad);
  CHECK(MeshAdjacency(bad).non_manifold_edges().size() >= 1);
  CHECK(!is_closed_and_oriented(bad));
}

TEST(borders) {
  const MeshAdjacency plane(make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0, 3, 2));
  CHECK(plane.boundary_edges().size() == 10 && plane.non_manifold_edges().empty());
  for (const std::int32_t e : plane.boundary_edges())
    CHECK(plane.is_boundary(e) && plane.is_manifold(e));
  TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  CHECK(is_closed_and_oriented(box));
  std::swap(box.triangles[0][0], box.triangles[0][1]);
  CHECK(!is_closed_and_oriented(box));
}

TEST(components_are_numbered_in_order) {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  append(mesh, make_sphere({5, 0, 0}, 1.0, 1));
  append(mesh, make_box({8, 0, 0}, {9, 1, 1}));
  const MeshComponents parts = connected_components(mesh);
  CHECK(parts.count == 3 && parts.of_triangle.size() == mesh.triangles.size());
  CHECK(parts.of_triangle.front() == 0 && parts.of_triangle[12] == 1);
  CHECK(parts.of_triangle.back() == 2);
  CHECK(connected_components(TriangleMesh{}).count == 0);
}

TEST(welding_closes_a_soup) {
  const TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  for (const double shift : {0.0, 1e-4}) {
    TriangleMesh soup;
    for (std::size_t t = 0; t < box.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        if (k == 0) {
          const auto n = static_cast<std::int32_t>(soup.vertices.size());
          soup.triangles.push_back({n, n + 1, n + 2});
        }
        soup.vertices.push_back(box.corner(t, k) +
                                Point3::Constant(shift * static_cast<double>(t % 3)));
        soup.colors.push_back({static_cast<std::uint8_t>(t), 0, 0});
      }
    soup.vertices.emplace_back(7, 7, 7);  // used by no triangle
    soup.colors.push_back({0, 0, 0});
    CHECK(!is_closed_and_oriented(soup));
    const TriangleMesh welded = weld_vertices(soup, 10 * shift);
    CHECK(welded.vertices.size() == 8 && welded.triangles.size() == 12);
    CHECK(welded.colors.size() == 8 && is_closed_and_oriented(welded));
  }
  CHECK(weld_vertices(box, 5.0).triangles.empty());
  CHECK(weld_vertices(TriangleMesh{}).empty());
  CHECK_THROWS(Error, weld_vertices(box, -1.0));
  TriangleMesh far = box;
  for (Point3& v : far.vertices) v += Point3(1e9, -1e9, 0);
  CHECK(weld_vertices(far).triangles.size() == 12);
}
