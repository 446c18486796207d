// SPDX-License-Identifier: MIT
#include <surfleet/geometry/mesh_clipping.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
std::vector<double> heights(const TriangleMesh& mesh, double above) {
  std::vector<double> all;
  for (const Point3& v : mesh.vertices) all.push_back(v.z() - above);
  return all;
}
std::vector<double> negative(std::vector<double> values) {
  for (double& v : values) v = -v;
  return values;
}
}  // namespace

TEST(a_clipped_sphere_is_its_cap) {
  const TriangleMesh sphere = make_sphere(Point3::Zero(), 1.0, 6);
  for (const double z : {-0.7, 0.0, 0.31, 0.9}) {
    const TriangleMesh cap = clipped(sphere, heights(sphere, z));
    CHECK_NEAR(cap.area(), 2.0 * kPi * (1.0 - z), 0.01);
    for (const Point3& v : cap.vertices) CHECK(v.z() > z - 1e-12);
    for (std::size_t t = 0; t < cap.triangles.size(); ++t)
      CHECK(cap.area_vector(t).dot(cap.centroid(t)) >= 0.0);
  }
}
TEST(both_parts_of_a_clipped_mesh_are_the_whole) {
  Random random(5);
  const TriangleMesh sphere = make_sphere(Point3::Zero(), 1.0, 4);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> values;
    for (std::size_t i = 0; i < sphere.vertices.size(); ++i)
      values.push_back(random.uniform() < 0.1 ? 0.0 : random.normal());
    const TriangleMesh a = clipped(sphere, values), b = clipped(sphere, negative(values));
    const TriangleMesh neither = selected(sphere, [&](std::size_t t) {
      return std::all_of(sphere.triangles[t].begin(), sphere.triangles[t].end(),
                         [&](int v) { return values[static_cast<std::size_t>(v)] == 0.0; });
    });
    CHECK_NEAR(a.area() + b.area() + neither.area(), sphere.area(), 1e-9);
  }
}
TEST(a_clipped_mesh_has_no_cracks) {
  const TriangleMesh sphere = make_sphere(Point3::Zero(), 1.0, 5);
  const TriangleMesh cap = clipped(sphere, heights(sphere, 0.123));
  const MeshAdjacency adjacency(cap);
  const std::vector<std::int32_t> open = adjacency.boundary_edges();
  for (const std::int32_t e : open)
    for (const std::int32_t v : adjacency.edges()[static_cast<std::size_t>(e)].vertices)
      CHECK_NEAR(cap.vertices[static_cast<std::size_t>(v)].z(), 0.123, 1e-9);
  CHECK(open.size() > 20 && adjacency.non_manifold_edges().empty());
}
TEST(meshes_are_clipped_at_the_limits) {
  const TriangleMesh sphere = make_sphere(Point3::Zero(), 1.0, 3);
  const std::size_t n = sphere.vertices.size();
  const TriangleMesh whole = clipped(sphere, std::vector<double>(n, 1.0));
  CHECK(whole.vertices.size() == n && whole.area() == sphere.area());
  CHECK(clipped(sphere, std::vector<double>(n, 0.0)).empty());
  CHECK(clipped(sphere, std::vector<double>(n, -1.0)).vertices.empty());
  CHECK(clipped(TriangleMesh{}, {}).empty());
  CHECK_THROWS(Error, clipped(sphere, std::vector<double>(n - 1, 1.0)));
}
