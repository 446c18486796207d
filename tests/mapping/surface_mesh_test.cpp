// SPDX-License-Identifier: MIT
#include <surfleet/mapping/surface_mesh.hpp>

#include <cmath>
#include <vector>

#include <surfleet/geometry/triangle_queries.hpp>

#include "check.hpp"
#include "seen_sheet.hpp"

using namespace surfleet;
using namespace surfleet::test;

namespace {
/// Distance from `p` to the triangles whose normals have a positive part along `normal`.
double distance_on_side(const TriangleMesh& mesh, const Point3& p, const Eigen::Vector3d& normal) {
  double best = 1e9;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (mesh.area_vector(t).dot(normal) > 0.0)
      best = std::min(
          best,
          (closest_on_triangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)) - p)
              .norm());
  return best;
}
std::optional<double> ball(const Point3& o, const Eigen::Vector3d& d) {
  const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 0.64;
  const double q = b * b - a * c;
  if (q < 0.0 || b > 0.0) return std::nullopt;
  return (-b - std::sqrt(q)) / a;
}
}  // namespace

TEST(a_sheet_seen_from_both_sides_has_two_whole_sides) {
  const double h = 0.2;
  for (const double at : {0.1, 0.0, 0.07}) {
    TsdfMap map({.voxel_size = h});
    TsdfIntegrator<DropOffWeight<>> integrate({.truncation = 3 * h}, {.full = h, .zero = 1.5 * h});
    for (int i = 0; i < 60; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0;
      const Point3 eye(at - 2.0 * side, 0.02 * i - 0.6, 0.1);
      const Pose T = facing(eye, Point3(at, 0, 0) - eye);
      integrate(render(sheet_camera(), T, sheet(at)), sheet_camera(), T, map);
    }
    const TriangleMesh mesh = extract_surface(map, {.min_weight = 0.3});
    const TriangleMesh torn = extract_mesh(map, {.min_weight = 0.3});
    int held = 0, all = 0;
    for (double y = -0.95; y <= 0.95; y += 0.19)
      for (double z = -0.95; z <= 0.95; z += 0.19)
        for (const double side : {1.0, -1.0}) {
          CHECK(distance_on_side(mesh, {at, y, z}, {side, 0, 0}) < 0.4 * h);
          held += distance_on_side(torn, {at, y, z}, {side, 0, 0}) < 0.4 * h ? 1 : 0;
          ++all;
        }
    CHECK(held < all / 2);  // or the test would be of no thin sheet
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Point3 c = mesh.centroid(t);
      CHECK(std::abs(c.x() - at) < 0.5 * h && std::abs(c.y()) < 1.0 + h &&
            std::abs(c.z()) < 1.0 + h);
    }
  }
}

TEST(a_thick_body_keeps_the_mesh_of_its_distances) {
  const TsdfMap map = seen_from_around(ball, 2.5, 24, 0.1);
  const TriangleMesh distances = extract_mesh(map, {.min_weight = 0.3});
  const TriangleMesh mesh = extract_surface(map, {.min_weight = 0.3});
  CHECK_NEAR(mesh.area() / distances.area(), 1.0, 0.06);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    CHECK_NEAR(mesh.centroid(t).norm(), 0.8, 0.05);
}

TEST(a_map_without_hits_gives_the_mesh_of_its_distances) {
  const TsdfMap map = seen_from_around(ball, 2.5, 8, 0.1, {.keep_hits = false});
  const TriangleMesh a = extract_mesh(map, {.min_weight = 0.3});
  const TriangleMesh b = extract_surface(map, {.min_weight = 0.3});
  CHECK(a.triangles.size() > 100);
  CHECK(a.triangles == b.triangles);
}

TEST(a_post_thinner_than_a_voxel_is_meshed_all_along) {
  const TsdfMap map = seen_from_around(post(0.04), 1.5, 60, 0.15);
  const TriangleMesh mesh = extract_surface(map, {.min_weight = 0.3});
  const PointCloud points = extract_points(map, {.min_weight = 0.3});
  for (double z = -0.6; z <= 0.6; z += 0.03) {
    const Point3 p(0.04, 0.0, z);
    double to_mesh = 1e9, to_points = 1e9;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      to_mesh = std::min(
          to_mesh,
          (closest_on_triangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)) - p)
              .norm());
    for (const Point3& q : points.points) to_points = std::min(to_points, (q - p).norm());
    CHECK(to_mesh < 0.06);
    CHECK(to_points < 0.12);
  }
  for (const Point3& q : points.points) CHECK(q.head<2>().norm() < 0.09);
}

TEST(points_lie_on_the_surface_with_outward_normals_on_any_number_of_threads) {
  const TsdfMap map = seen_from_around(ball, 2.5, 24, 0.1);
  const PointCloud points = extract_points(map, {.min_weight = 0.3});
  const PointCloud again = extract_points(map, {.min_weight = 0.3, .threads = 3});
  CHECK(points.points == again.points && points.normals == again.normals);
  CHECK(points.size() > 300);
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK_NEAR(points.points[i].norm(), 0.8, 0.02);
    CHECK(points.points[i].normalized().dot(points.normals[i].cast<double>()) > 0.9);
  }
  const TriangleMesh one = extract_surface(map), three = extract_surface(map, {.threads = 3});
  CHECK(one.vertices == three.vertices && one.triangles == three.triangles);
}
