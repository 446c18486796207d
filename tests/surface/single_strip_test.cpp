// SPDX-License-Identifier: MIT
#include <surfleet/surface/single_strip.hpp>

#include <set>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>
#include <surfleet/surface/strip_field.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

SingleStrip check_single_strip(const TriangleMesh& mesh, std::int32_t start, bool closed) {
  const SingleStrip strip = single_strip(mesh, start);
  CHECK(strip.mesh.triangles.size() == mesh.triangles.size() + strip.split);
  CHECK_NEAR(strip.mesh.area(), mesh.area(), 1e-9 * mesh.area());
  CHECK(strip.source.size() == strip.mesh.triangles.size());
  CHECK(strip.source[static_cast<std::size_t>(strip.triangles.front())] == start);
  CHECK(strip.triangles.size() == strip.mesh.triangles.size() + strip.detours);
  CHECK(std::set<std::int32_t>(strip.triangles.begin(), strip.triangles.end()).size() ==
        strip.mesh.triangles.size());
  if (closed) CHECK(strip.detours == 0);
  bool turned = false, joined = true;
  for (std::size_t t = 0; t < strip.mesh.triangles.size(); ++t)
    turned = turned || !(strip.mesh.area_vector(t).dot(
                             mesh.area_vector(static_cast<std::size_t>(strip.source[t]))) > 0.0);
  for (std::size_t i = 1; i < strip.triangles.size(); ++i)
    joined = joined &&
             shared_side(strip.mesh.triangles[static_cast<std::size_t>(strip.triangles[i - 1])],
                         strip.mesh.triangles[static_cast<std::size_t>(strip.triangles[i])])
                 .has_value();
  CHECK(!turned);
  CHECK(joined);
  CHECK(MeshAdjacency(strip.mesh).non_manifold_edges().size() ==
        MeshAdjacency(mesh).non_manifold_edges().size());
  return strip;
}
}  // namespace

TEST(single_strips_visit_each_piece_of_closed_surfaces_once) {
  for (const std::int32_t start : {0, 17, 200}) {
    check_single_strip(make_sphere(Point3::Zero(), 1.0, 3), start, true);
    check_single_strip(make_torus(Point3::Zero(), 1.0, 0.4, 30, 16), start, true);
  }
  const SingleStrip box =
      check_single_strip(make_box(Box3(Point3(0, 0, 0), Point3(1, 1, 1))), 3, true);
  CHECK(box.split % 2 == 0);
  // A closed strip ends beside its start.
  const SingleStrip ball = check_single_strip(make_sphere(Point3::Zero(), 1.0, 4), 5, true);
  CHECK(shared_side(ball.mesh.triangles[static_cast<std::size_t>(ball.triangles.front())],
                    ball.mesh.triangles[static_cast<std::size_t>(ball.triangles.back())])
            .has_value());
  CHECK(ball.split < ball.source.size() / 4);
}

TEST(single_strips_pass_borders_by_detours) {
  check_single_strip(make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0, 14, 9), 4, false);
  check_single_strip(bumpy_slope({.edge = 0.2, .hole = true}), 40, false);
  TriangleMesh one;
  one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  one.triangles = {{0, 1, 2}};
  CHECK(single_strip(one, 0).triangles.size() >= 1);
  one.triangles.push_back({1, 3, 2});
  check_single_strip(one, 1, false);
  // Two parts: the start's alone. A fin of three triangles at an edge: its edge is a wall.
  TriangleMesh two = make_sphere(Point3::Zero(), 1.0, 1);
  append(two, make_sphere(Point3(3, 0, 0), 1.0, 1));
  const SingleStrip half = single_strip(two, 100);
  CHECK(half.mesh.triangles.size() == two.triangles.size() / 2 + half.split);
  CHECK_THROWS(Error, single_strip(two, -1));
}
