// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/view_frustum.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Through the pose and the camera's own projection.
bool projected(const PinholeCamera& camera, const Pose& T_body_camera, const Configuration& q,
               const Point3& p) {
  const Point3 in_camera = (q.pose() * T_body_camera).inverse() * p;
  return in_camera.z() >= camera.min_range && in_camera.z() <= camera.max_range &&
         camera.project(in_camera).has_value();
}

Point3 random_point(Random& random, double r) {
  return {random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r)};
}

TEST(contains_what_projects_into_the_image) {
  Random random(3);
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(90), radians(60), 320, 240, 1.6, 8.0);
  for (const double pitch : {-1.2, 0.0, 0.4, kPi / 2}) {
    const Point3 offset(0.2, -0.1, 0.3);
    const Pose mount = forward_camera_mount(pitch, offset);
    const ViewFrustum frustum(camera, mount);
    int inside = 0;
    for (int n = 0; n < 4000; ++n) {
      const Configuration q{random_point(random, 3.0), random.uniform(-4.0, 4.0),
                            n % 2 == 0 ? 0.0 : random.uniform(-1.5, 1.5)};
      const Point3 p = q.position + random_point(random, 9.0);
      // A gimbal tilts as a mount does.
      const bool expected = projected(camera, forward_camera_mount(pitch + q.pitch, offset), q, p);
      CHECK(frustum.contains(q, p) == expected);
      const ViewFrustum::Placed placed = frustum.at(q);
      CHECK(!expected || placed.bounds().contains(p));
      CHECK(!expected || placed.may_contain(p + Point3(0.3, 0, 0), 0.31));
      inside += expected ? 1 : 0;
    }
    CHECK(inside > 100);
  }
}

TEST(balls_far_outside_are_refused) {
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(90), radians(60), 320, 240, 1.6, 8.0);
  const ViewFrustum frustum(camera);
  const ViewFrustum::Placed placed = frustum.at({Point3(1, 2, 3), 0.0});
  CHECK(placed.may_contain({5, 2, 3}, 0.1));
  CHECK(!placed.may_contain({-5, 2, 3}, 1.0));
  CHECK(!placed.may_contain({5, 2, 9}, 1.0));
}

TEST(eye_and_axis_follow_the_heading) {
  const PinholeCamera camera;
  const ViewFrustum frustum(camera, forward_camera_mount(0.0, Point3(0.5, 0, 0.1)));
  const ViewFrustum::Placed placed = frustum.at({Point3(1, 2, 3), kPi / 2});
  CHECK_NEAR((placed.eye() - Point3(1, 2.5, 3.1)).norm(), 0.0, 1e-12);
  CHECK_NEAR((placed.axis() - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-12);
}
TEST(a_gimbal_tilts_the_camera_where_it_is) {
  const Pose mount = forward_camera_mount(0.2, Point3(0.5, 0, 0.1));
  const Configuration q{Point3(1, 2, 3), kPi / 2, 0.3};
  const ViewFrustum frustum(PinholeCamera(), mount);
  const ViewFrustum::Placed placed = frustum.at(q);
  const Pose T = camera_pose(q, mount);
  CHECK_NEAR((placed.eye() - Point3(1, 2.5, 3.1)).norm(), 0.0, 1e-12);
  CHECK_NEAR((T.translation() - placed.eye()).norm(), 0.0, 1e-12);
  const Eigen::Vector3d down(0.0, std::cos(0.5), -std::sin(0.5));
  CHECK_NEAR((placed.axis() - down).norm(), 0.0, 1e-12);
  CHECK_NEAR((T.linear().col(2) - down).norm(), 0.0, 1e-12);
  const Point3 p(0.3, -1.0, 2.0);
  CHECK_NEAR((placed.to_body(placed.to_world(p)) - p).norm(), 0.0, 1e-12);
}
}  // namespace
