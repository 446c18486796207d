// SPDX-License-Identifier: MIT
#include <surfleet/geometry/mesh_primitives.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/core/rotation.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
double volume(const TriangleMesh& mesh) {
  double six = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    six += mesh.corner(t, 0).dot(mesh.corner(t, 1).cross(mesh.corner(t, 2)));
  return six / 6.0;
}
/// Closed, oriented outward (positive volume), with the given volume and area up to `tolerance`.
void check_solid(const TriangleMesh& mesh, double expected_volume, double expected_area,
                 double tolerance) {
  CHECK(is_closed_and_oriented(mesh));
  CHECK_NEAR(volume(mesh), expected_volume, tolerance * expected_volume + 1e-9);
  CHECK_NEAR(mesh.area(), expected_area, tolerance * expected_area + 1e-9);
}
}  // namespace

TEST(primitives_are_closed_and_have_their_volumes) {
  check_solid(make_box({1, 2, 3}, {2, 4, 6}), 6.0, 22.0, 1e-12);
  for (const Point3& b : {Point3(4, 0, 0), Point3(0, 0, -4), Point3(0, 4, 0), Point3(0, 0, 4)}) {
    check_solid(make_beam({0, 0, 0}, b, 0.5, 0.25), 0.5, 6.25, 1e-9);
    check_solid(make_cylinder({0, 0, 0}, b, 1.5, 256), kPi * 2.25 * 4, 2 * kPi * 1.5 * 5.5, 1e-3);
  }
  check_solid(make_cone({0, 0, 0}, {0, 0, 3}, 1.0, 1e-6, 256), kPi, kPi * (1 + std::sqrt(10.0)),
              1e-3);
  check_solid(make_sphere({5, 5, 5}, 2.0, 5), 4.0 / 3.0 * kPi * 8.0, 4.0 * kPi * 4.0, 2e-3);
  check_solid(make_torus({0, 0, 1}, 3.0, 1.0, 200, 100), 2 * kPi * kPi * 3.0, 4 * kPi * kPi * 3.0,
              2e-3);
  const std::array<Point2, 4> cup{Point2(2, 0), Point2(2, 3), Point2(1.5, 3), Point2(1.5, 1)};
  check_solid(make_lathe({0, 0, 0}, cup, 256), kPi * (4 * 3 - 2.25 * 2),
              kPi * (4 + 12 + (4 - 2.25) + 6 + 2.25), 1e-3);
  const std::array<Point2, 5> house{Point2(0, 0), Point2(4, 0), Point2(4, 3), Point2(2, 5),
                                    Point2(0, 3)};
  check_solid(make_prism(house, 1.0, 2.0), 16.0, 32.0 + 10.0 + 4.0 * std::sqrt(2.0), 1e-9);
  const std::array<Point3, 4> bend{Point3(0, 0, 0), Point3(0, 0, 3), Point3(4, 0, 3),
                                   Point3(4, 5, 3)};
  check_solid(make_tube(bend, 0.2, 64), kPi * 0.04 * 12, 2 * kPi * 0.2 * 12.2, 5e-3);
}

TEST(sheets_face_up) {
  const TriangleMesh plane = make_plane(Box2(Point2(-1, -2), Point2(3, 2)), 0.5, 4, 3);
  CHECK_NEAR(plane.area(), 16.0, 1e-12);
  for (std::size_t t = 0; t < plane.triangles.size(); ++t) CHECK(plane.area_vector(t).z() > 0);
  CHECK(plane.triangles.size() == 24);
}

TEST(box_solid_has_rooms_and_no_inner_walls) {
  BoxSolid joined;
  joined.add({0, 0, 0}, {1, 1, 1}).add({1, 0, 0}, {2, 1, 1}).add({0.5, 0, 0}, {1.5, 1, 1});
  check_solid(joined.mesh(), 2.0, 10.0, 1e-12);
  BoxSolid room;  // walls of 1, a chamber of 2 × 2 × 2, a door of 1 × 1
  room.add({0, 0, 0}, {4, 4, 4}).cut({1, 1, 1}, {3, 3, 3});
  check_solid(room.mesh(), 56.0, 96.0 + 24.0, 1e-12);
  room.cut({0, 1.5, 1}, {1, 2.5, 2});
  check_solid(room.mesh(), 55.0, 96.0 + 24.0 - 2.0 + 4.0, 1e-12);
  CHECK(BoxSolid().mesh().empty());
}

TEST(the_shortest_rotation_turns_about_what_is_normal_to_both) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const Point3 a = Point3::NullaryExpr([&] { return random.uniform(-1, 1); });
    Point3 b = Point3::NullaryExpr([&] { return random.uniform(-1, 1); });
    if (i % 3 == 1) b = -random.uniform(0.5, 2.0) * a;
    if (i % 3 == 2) b = random.uniform(0.5, 2.0) * a + 1e-9 * b;
    const Eigen::Quaterniond q = rotation_between(a, b);
    CHECK_NEAR(q.norm(), 1.0, 1e-12);
    CHECK_NEAR((q * a.normalized() - b.normalized()).norm(), 0.0, 1e-7);
    CHECK_NEAR(q.vec().dot(a), 0.0, 1e-12);
    CHECK_NEAR(2.0 * std::acos(std::min(1.0, std::abs(q.w()))),
               std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)), 1e-7);
  }
}

TEST(bad_settings_are_refused) {
  CHECK_THROWS(Error, make_beam({0, 0, 0}, {0, 0, 0}, 1, 1));
  CHECK_THROWS(Error, make_tube(std::vector<Point3>{{0, 0, 0}}, 1.0));
  CHECK_THROWS(Error, make_lathe({0, 0, 0}, std::vector<Point2>{{0, 0}, {1, 1}}));
  CHECK_THROWS(Error, make_torus({0, 0, 0}, 2, 1, 2, 2));
  CHECK_THROWS(Error, make_prism(std::vector<Point2>{{0, 0}, {0, 1}, {1, 0}}, 0, 1));
}
