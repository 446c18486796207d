// SPDX-License-Identifier: MIT
#include <surfleet/adapters/fcl_body.hpp>
#include <surfleet/adapters/fcl_body_judge.hpp>
#include <surfleet/adapters/fcl_mesh_judge.hpp>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/ellipsoid.h>

#include <limits>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/motion/body_check.hpp>
#include <surfleet/motion/free_space.hpp>

#include "body_scenes.hpp"
#include "check.hpp"
#include "motion_scenes.hpp"

namespace {
using namespace surfleet;
using namespace motion_scenes;
}  // namespace

TEST(fcl_shapes_agree_with_our_own) {
  const FclBody sphere(std::make_shared<fcl::Sphered>(0.6), 0.6);
  const FclBody ellipsoid(std::make_shared<fcl::Ellipsoidd>(0.55, 0.25, 0.25), 0.25);
  const SphereBody our_sphere{0.6};
  const EllipsoidBody our_ellipsoid{{0.55, 0.25, 0.25}};
  CHECK(sphere.bounding_radius() >= 0.6 && ellipsoid.bounding_radius() >= 0.55);
  Random random(1);
  int wrong = 0, hits = 0;
  for (int i = 0; i < 400; ++i) {
    const Configuration q{Point3(random.uniform(-5, 5), 1, 2), random.uniform(-3, 3)};
    const Sphere ball{
        q.position + Point3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)),
        random.uniform(0.05, 0.3)};
    // Beside the border both may say either.
    const Sphere less{ball.center, ball.radius - 0.01}, more{ball.center, ball.radius + 0.01};
    if (our_sphere.touches(q, less) == our_sphere.touches(q, more))
      wrong += sphere.touches(q, ball) != our_sphere.touches(q, ball);
    if (our_ellipsoid.touches(q, less) == our_ellipsoid.touches(q, more))
      wrong += ellipsoid.touches(q, ball) != our_ellipsoid.touches(q, ball);
    hits += ellipsoid.touches(q, ball);
  }
  CHECK(wrong == 0);
  CHECK(hits > 20);
  CHECK_THROWS(Error, FclBody(nullptr));
}

TEST(fcl_body_in_the_map) {
  TsdfMap tsdf({.voxel_size = 0.1});
  observe(tsdf, box(-3, -3, -2, 3, 3, 2), Boxes{{box(0.5, -3, -2, 0.7, 3, 2)}});
  const VoxelStateMap states(tsdf);
  const FreeSpace space(states, {.radius = 0.55});
  const FclBody robot(std::make_shared<fcl::Boxd>(1.0, 0.4, 0.4), 0.2);
  CHECK(is_body_free(space, robot, {{0.05, 0, 0}, kPi / 2}));
  CHECK(!is_body_free(space, robot, {{0.05, 0, 0}, 0.0}));
}

TEST(judge_measures_exact_distances) {
  const Point3 lo(-1, -2, -3), hi(2, 1, 4);
  const MeshJudge judge(make_box(lo, hi));
  CHECK(judge.triangle_count() == 12);
  const Box3 solid(lo, hi);
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const Point3 p(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-6, 7));
    const double expected = solid.contains(p) ? std::min((p - lo).minCoeff(), (hi - p).minCoeff())
                                              : solid.exteriorDistance(p);
    CHECK_NEAR(judge.distance(p), expected, 1e-5);
    if (std::abs(expected - 1.0) > 1e-4) CHECK(judge.collides(p, 1.0) == (expected < 1.0));
  }
  Pose at = Pose::Identity();
  at.translate(Point3(3, 0, 0));
  CHECK(!judge.collides(fcl::Boxd(1, 1, 1), at));
  CHECK(judge.collides(fcl::Boxd(2.5, 1, 1), at));
}

TEST(judge_on_the_nasty_shelf) {
  CHECK(std::isinf(MeshJudge(TriangleMesh{}).distance({0, 0, 0})));
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0},
                   {1, 0, 0},
                   {1, 0, 0},
                   {0, 2, 0},
                   {0, 2, 1},
                   {0, 2, 2},
                   {std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {0, 1, 6}};
  const MeshJudge judge(mesh);
  CHECK(judge.triangle_count() == 2);
  CHECK(std::isfinite(judge.distance({0, 0, 0})));
}

TEST(fcl_bodies_are_swept_as_our_own) {
  const SweptBody ours = SweptBody::of(EllipsoidBody{{0.6, 0.3, 0.2}});
  const SweptBody theirs =
      SweptBody::of(FclBody(std::make_shared<fcl::Ellipsoidd>(0.6, 0.3, 0.2), 0.2));
  CHECK(theirs.radius() < 0.63);
  for (double r = 0.01; r < 0.55; r += 0.01) {
    const SweptBody::Ring a = ours.between(r, r), b = theirs.between(r, r);
    CHECK_NEAR(a.high, b.high, 0.04);
    CHECK_NEAR(a.low, b.low, 0.04);
    CHECK(b.high >= 0.2 * std::sqrt(1.0 - r * r / 0.36));
  }
}

TEST(a_flat_fcl_box_goes_through_a_slot_that_its_ball_does_not_fit_into) {
  check_slot(FclBody(std::make_shared<fcl::Boxd>(1.0, 0.6, 0.24)), 16, 0.3);
}

TEST(a_body_s_distance_to_a_mesh) {
  TriangleMesh mesh = make_box(Box3(Point3(-9, -4, -4), Point3(1, 4, 4)));
  for (const bool sliver : {false, true}) {
    if (sliver) {  // a bar without area before the wall, far to the side
      const auto n = static_cast<std::int32_t>(mesh.vertices.size());
      for (const double z : {-4.0, 4.0, 0.0}) mesh.vertices.push_back(Point3(1.5, 3.0, z));
      mesh.triangles.push_back({n, n + 1, n + 2});
    }
    const MeshJudge judge(mesh);
    const FclBodyJudge ellipsoid(judge,
                                 FclBody(std::make_shared<fcl::Ellipsoidd>(0.6, 0.3, 0.2), 0.2));
    const FclBodyJudge flat(judge, FclBody(std::make_shared<fcl::Boxd>(1.0, 0.4, 0.2), 0.1));
    Random random(8);
    for (int i = 0; i < 200; ++i) {
      const double x = random.uniform(1.0, 4.0), y = random.uniform(-2.0, 1.5);
      const Configuration q{Point3(x, y, random.uniform(-2.0, 2.0)), random.uniform(-kPi, kPi)};
      const double c = std::abs(std::cos(q.yaw)), s = std::abs(std::sin(q.yaw));
      const double reach = std::hypot(0.6 * c, 0.3 * s), half = 0.5 * c + 0.2 * s;
      if (sliver && x > 1.7) continue;
      CHECK_NEAR(ellipsoid.distance(q), std::max(0.0, x - 1.0 - reach), 1e-4);
      CHECK_NEAR(flat.distance(q), std::max(0.0, x - 1.0 - half), 1e-4);
    }
    if (sliver) {
      CHECK_NEAR(flat.distance({Point3(2.0, 3.0, 0.0), kPi / 2}), 0.3, 1e-4);
      CHECK(flat.distance({Point3(2.0, 3.0, 0.0), 0.0}) == 0.0);
    }
  }
  const MeshJudge none(TriangleMesh{});
  CHECK(std::isinf(FclBodyJudge(none, FclBody(std::make_shared<fcl::Boxd>(1, 1, 1))).distance({})));
}
