// SPDX-License-Identifier: MIT
#include <surfleet/surface/surface_walk.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

SurfacePose random_pose(const TriangleMesh& mesh, Random& random) {
  const auto t = static_cast<std::int32_t>(random.below(mesh.triangles.size()));
  Eigen::Vector3d w(random.uniform(), random.uniform(), random.uniform());
  w /= w.sum();
  const SurfacePose pose = surface_pose(mesh, {t, w}, {1.0, 0.3, 0.2});
  return pose.turned(random.uniform(-kPi, kPi));
}

void check_pose(const TriangleMesh& mesh, const SurfacePose& pose) {
  const auto t = static_cast<std::size_t>(pose.at.triangle);
  const Eigen::Vector3d n = mesh.area_vector(t).normalized();
  CHECK(pose.at.weights.minCoeff() >= 0.0);
  CHECK_NEAR(pose.at.weights.sum(), 1.0, 1e-12);
  CHECK_NEAR(std::abs(n.dot(pose.up)), 1.0, 1e-9);
  CHECK_NEAR(pose.forward.dot(pose.up), 0.0, 1e-9);
  CHECK_NEAR(pose.forward.norm(), 1.0, 1e-9);
}

TEST(a_step_on_a_plane_is_a_step_in_the_plane) {
  const TriangleMesh mesh = make_plane(Box2(Point2(-5, -5), Point2(5, 5)), 0.5, 13, 17);
  const SurfaceWalk walk(mesh);
  const Bvh bvh(mesh);
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Point3 p(random.uniform(-2, 2), random.uniform(-2, 2), 0.5);
    const double yaw = random.uniform(-kPi, kPi);
    const SurfacePose pose = surface_pose(mesh, *nearest_surface_point(mesh, bvh, p),
                                          {std::cos(yaw), std::sin(yaw), 0.0});
    const Eigen::Vector2d ahead(random.uniform(-2, 2), random.uniform(-2, 2));
    const SurfaceStep step = walk(pose, ahead);
    const Point3 expected = p + ahead.x() * pose.forward + ahead.y() * pose.left();
    CHECK_NEAR((step.pose.at.position(mesh) - expected).norm(), 0.0, 1e-9);
    CHECK_NEAR((step.pose.forward - pose.forward).norm(), 0.0, 1e-9);
    CHECK_NEAR(step.length, ahead.norm(), 1e-12);
    CHECK(!step.stopped && step.entered.size() == step.crossings.size());
  }
}

// A cone of angle Θ unrolls to a sector; a straight line that passes the apex at distance p and
// runs very far leaves at an angle of π about the apex.
TEST(a_line_about_a_cone_is_straight_in_the_sector) {
  constexpr int kSides = 40;
  TriangleMesh mesh;
  mesh.vertices.push_back({0, 0, 1.0});
  for (int i = 0; i < kSides; ++i)
    mesh.vertices.push_back(
        {2.0 * std::cos(2 * kPi * i / kSides), 2.0 * std::sin(2 * kPi * i / kSides), 0});
  for (int i = 0; i < kSides; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % kSides});
  const SurfaceWalk walk(mesh);
  const auto sector_angle = [&](const SurfacePoint& at) {  // of the unrolled cone
    const auto t = static_cast<std::size_t>(at.triangle);
    const Eigen::Vector3d a = mesh.corner(t, 1) - mesh.corner(t, 0);
    const Eigen::Vector3d b = mesh.corner(t, 2) - mesh.corner(t, 0);
    const Eigen::Vector3d p = at.position(mesh) - mesh.corner(t, 0);
    const double corner = std::atan2(a.cross(b).norm(), a.dot(b));
    return corner * at.triangle + std::atan2(a.cross(p).norm(), a.dot(p));
  };
  SurfacePose pose = surface_pose(mesh, {3, {0.5, 0.3, 0.2}}, Eigen::Vector3d::UnitX());
  const Eigen::Vector3d outward = (pose.at.position(mesh) - mesh.vertices[0]);
  const double r0 = outward.norm(), a0 = sector_angle(pose.at);
  pose.forward = outward.normalized();
  pose = pose.turned(radians(120.0));
  const double s = 1.1;
  const SurfaceStep step = walk(pose, {s, 0.0});
  const Eigen::Vector2d end(r0 + s * std::cos(radians(120.0)), s * std::sin(radians(120.0)));
  CHECK(!step.stopped);
  CHECK_NEAR((step.pose.at.position(mesh) - mesh.vertices[0]).norm(), end.norm(), 1e-9);
  CHECK_NEAR(sector_angle(step.pose.at) - a0, std::atan2(end.y(), end.x()), 1e-9);
}

TEST(there_and_back_again) {
  for (const TriangleMesh& mesh : {make_sphere(Point3::Zero(), 1.0, 3), bumpy_slope(),
                                   make_torus(Point3::Zero(), 1.0, 0.4, 40, 20)}) {
    const SurfaceWalk walk(mesh);
    Random random(7);
    for (int i = 0; i < 100; ++i) {
      const SurfacePose pose = random_pose(mesh, random);
      const Eigen::Vector2d ahead(random.uniform(-1, 1), random.uniform(-1, 1));
      const SurfaceStep there = walk(pose, ahead);
      check_pose(mesh, there.pose);
      const SurfaceStep back = walk(there.pose, -ahead.normalized() * there.length);
      CHECK_NEAR((back.pose.at.position(mesh) - pose.at.position(mesh)).norm(), 0.0, 1e-7);
      CHECK_NEAR((back.pose.forward - pose.forward).norm(), 0.0, 1e-6);
      CHECK(there.stopped || std::abs(there.length - ahead.norm()) < 1e-12);
    }
  }
}

TEST(a_great_circle_comes_back) {
  const TriangleMesh mesh = make_sphere(Point3::Zero(), 1.0, 5);
  const SurfaceWalk walk(mesh);
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const SurfacePose pose = random_pose(mesh, random);
    const SurfaceStep step = walk(pose, {2.0 * kPi, 0.0});
    CHECK_NEAR((step.pose.at.position(mesh) - pose.at.position(mesh)).norm(), 0.0, 0.05);
    CHECK(step.pose.forward.dot(pose.forward) > 0.99);
  }
}

// From corner to corner: every line of a step goes through vertices, and along edges.
TEST(vertices_and_edges_stop_nobody) {
  const TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(8, 8)), 0.0, 8, 8);
  const SurfaceWalk walk(mesh);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) {
      const SurfacePoint corner{t, Eigen::Vector3d::Unit(k)};
      const Point3 p = corner.position(mesh);
      for (const auto& d : {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, 1),
                            Eigen::Vector2d(1, 1), Eigen::Vector2d(-1, 1), Eigen::Vector2d(2, 1)}) {
        const Point3 end = p + 2.0 * Point3(d.x(), d.y(), 0.0);
        if (end.x() <= 0.5 || end.y() <= 0.5 || end.x() >= 7.5 || end.y() >= 7.5) continue;
        if (p.x() < 0.5 || p.y() < 0.5 || p.x() > 7.5 || p.y() > 7.5) continue;
        const SurfacePose pose = surface_pose(mesh, corner, Eigen::Vector3d(d.x(), d.y(), 0.0));
        const SurfaceStep step = walk(pose, {2.0 * d.norm(), 0.0});
        CHECK_NEAR((step.pose.at.position(mesh) - end).norm(), 0.0, 1e-9);
      }
    }
}

TEST(borders_and_crowded_edges_are_ends) {
  TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0);
  const SurfaceWalk walk(mesh);
  const SurfacePose pose = surface_pose(mesh, {0, {0.4, 0.3, 0.3}}, Eigen::Vector3d::UnitX());
  const SurfaceStep step = walk(pose, {10.0, 0.0});
  CHECK(step.stopped);
  CHECK_NEAR(step.pose.at.position(mesh).x(), 1.0, 1e-12);

  mesh.vertices.push_back({0.5, 0.5, 1.0});  // a fin on the diagonal
  mesh.triangles.push_back({1, 2, 4});
  const SurfaceWalk finned(mesh);
  const SurfaceStep end = finned(pose, {10.0, 0.0});
  CHECK(end.stopped && end.pose.at.triangle == 0);
}

// A triangle that runs the other way round does not turn the robot over.
TEST(up_does_not_depend_on_how_triangles_are_said) {
  TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(4, 4)), 0.0, 4, 4);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const SurfaceWalk walk(mesh);
  const SurfacePose pose = surface_pose(mesh, {1, {0.4, 0.3, 0.3}}, Eigen::Vector3d(1, 0.7, 0));
  const SurfaceStep step = walk(pose, {2.0, 1.0});
  CHECK_NEAR(
      (step.pose.at.position(mesh) - (pose.at.position(mesh) + 2.0 * pose.forward + pose.left()))
          .norm(),
      0.0, 1e-9);
  CHECK_NEAR((step.pose.up - pose.up).norm(), 0.0, 1e-12);
  CHECK_NEAR((step.pose.forward - pose.forward).norm(), 0.0, 1e-12);
}

TEST(a_spike_ends_the_step_in_time) {
  TriangleMesh mesh;  // three thin triangles about a tip
  mesh.vertices = {{0, 0, 100}, {1e-3, 0, 0}, {-1e-3, 1e-3, 0}, {-1e-3, -1e-3, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
  const SurfaceWalk walk(mesh);
  SurfacePose pose = surface_pose(mesh, {0, {0.5, 0.25, 0.25}}, Eigen::Vector3d::UnitZ());
  pose.forward = (mesh.vertices[0] - pose.at.position(mesh)).normalized();
  const SurfaceStep step = walk(pose, {300.0, 0.0});
  check_pose(mesh, step.pose);
  CHECK(step.length > 49.0);
}

TEST(meshes_without_area_are_refused) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  CHECK_THROWS(Error, SurfaceWalk(mesh));
}
}  // namespace
