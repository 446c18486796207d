// SPDX-License-Identifier: MIT
#include <surfleet/geometry/simplify.hpp>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Vertices − edges + triangles; 2 for a sphere, 0 for a torus, less one for every opening.
long euler_number(const TriangleMesh& mesh) {
  return static_cast<long>(mesh.vertices.size()) -
         static_cast<long>(MeshAdjacency(mesh).edge_count()) +
         static_cast<long>(mesh.triangles.size());
}
void check_simplified(const TriangleMesh& mesh, const TriangleMesh& fine, double tolerance) {
  CHECK(MeshAdjacency(mesh).non_manifold_edges().empty());
  CHECK(euler_number(mesh) == euler_number(fine));
  CHECK(connected_components(mesh).count == connected_components(fine).count);
  CHECK(MeshAdjacency(mesh).boundary_edges().empty() ==
        MeshAdjacency(fine).boundary_edges().empty());
  const Bvh bvh(fine), coarse(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto near = bvh.closest_point(mesh.centroid(t));
    CHECK(near->distance < tolerance);
    CHECK(mesh.area_vector(t).dot(fine.area_vector(static_cast<std::size_t>(near->triangle))) >
          0.0);
  }
  for (const Point3& p : fine.vertices) CHECK(coarse.closest_point(p)->distance < tolerance);
}

TEST(simplified_solids_keep_their_shape_and_kind) {
  const TriangleMesh ball = make_sphere({1, 2, 3}, 1.0, 4), ring = make_torus({0, 0, 0}, 1.0, 0.4);
  const TriangleMesh small_ball = simplified(ball, {.triangles = 500});
  CHECK(small_ball.triangles.size() <= 500 && small_ball.triangles.size() > 490);
  check_simplified(small_ball, ball, 0.03);
  CHECK(is_closed_and_oriented(small_ball));
  const TriangleMesh small_ring = simplified(ring, {.triangles = 400});
  CHECK(small_ring.triangles.size() <= 400 && is_closed_and_oriented(small_ring));
  check_simplified(small_ring, ring, 0.08);
  CHECK(simplified(ball, {.triangles = 500}).triangles == small_ball.triangles);
  // Around this thin ring three edges close without a triangle: none of them may go.
  const TriangleMesh wire = simplified(make_torus({0, 0, 0}, 1.0, 0.05, 60, 3), {.triangles = 0});
  CHECK(euler_number(wire) == 0 && is_closed_and_oriented(wire));
  const TriangleMesh least = simplified(ball, {.triangles = 0});
  CHECK(least.triangles.size() >= 4 && is_closed_and_oriented(least));
  CHECK(euler_number(least) == 2);
}

// A flat sheet with two holes: nothing is lost on the plane, borders stay in place, holes open.
TEST(simplified_sheets_keep_their_openings) {
  const TriangleMesh whole = make_plane(Box2(Point2(0, 0), Point2(2, 1)), 0.5, 60, 30);
  const TriangleMesh sheet = selected(whole, [&](std::size_t t) {
    const Point3 c = whole.centroid(t);
    const bool square = std::max(std::abs(c.x() - 0.5), std::abs(c.y() - 0.5)) < 0.2;
    return !square && std::max(std::abs(c.x() - 1.5), std::abs(c.y() - 0.5)) > 0.1;
  });
  const TriangleMesh few = simplified(sheet, {.triangles = 40});
  CHECK(few.triangles.size() <= 40 && euler_number(few) == euler_number(sheet));
  CHECK_NEAR(few.area(), sheet.area(), 1e-6);
  for (const Point3& p : few.vertices) CHECK_NEAR(p.z(), 0.5, 1e-9);
  for (std::size_t t = 0; t < few.triangles.size(); ++t) CHECK(few.area_vector(t).z() > 0.0);
  const TriangleMesh none = simplified(sheet, {.triangles = 0});
  CHECK(euler_number(none) == euler_number(sheet) && !none.triangles.empty());
  CHECK(MeshAdjacency(none).non_manifold_edges().empty());
}

TEST(odd_meshes_are_simplified_or_refused) {
  CHECK(simplified(TriangleMesh{}).empty());
  TriangleMesh fan;  // three triangles on one edge, one without area, one of its own
  fan.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {5, 5, 5}, {6, 6, 6}};
  fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 5, 6}, {2, 2, 3}};
  const TriangleMesh still = simplified(fan, {.triangles = 0});
  CHECK(still.triangles.size() >= 3);
  fan.vertices[0].x() = std::nan("");
  CHECK_THROWS(Error, simplified(fan, {.triangles = 0}));
  CHECK_THROWS(Error, simplified(fan, {.border = -1.0}));
}
}  // namespace
