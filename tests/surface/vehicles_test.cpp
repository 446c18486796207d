// SPDX-License-Identifier: MIT
#include <surfleet/surface/drive_path.hpp>
#include <surfleet/surface/surface_vehicles.hpp>
#include <surfleet/surface/tracking_control.hpp>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>
#include <surfleet/surface/geodesic_strip.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(twists_drive_circles) {
  const TriangleMesh mesh = make_plane(Box2(Point2(-2, -2), Point2(2, 2)), 0.0, 9, 9);
  const SurfaceWalk walk(mesh);
  const Bvh bvh(mesh);
  const auto circle = [&](auto vehicle, const Twist& twist, double radius) {
    SurfacePose pose =
        surface_pose(mesh, *nearest_surface_point(mesh, bvh, {0.03, 0.02, 0}), {1, 0, 0});
    for (int k = 0; k < 100; ++k)
      vehicle.drive(walk, pose, twist, 0.05);  // the steering comes round
    const Point3 centre = pose.at.position(mesh) + radius * pose.left();
    for (int k = 0; k < 300; ++k) {
      vehicle.drive(walk, pose, twist, 0.05);
      CHECK_NEAR((pose.at.position(mesh) - centre).norm(), std::abs(radius),
                 1e-3 * std::abs(radius));
    }
  };
  circle(Unicycle{}, {0.1, 0.5}, 0.2);
  circle(RearDriveBicycle{}, {0.1, 0.5}, 0.2);
  circle(RearDriveBicycle{}, {0.1, -0.5}, -0.2);
  circle(RearDriveBicycle{}, {-0.1, 0.5}, -0.2);
  circle(FrontDriveBicycle{}, {0.05, 0.25}, 0.2);
  FrontDriveBicycle bicycle;
  SurfacePose pose = surface_pose(mesh, SurfacePoint{80}, {1, 0, 0});
  const Twist fast = bicycle.drive(walk, pose, {9.0, 0.0}, 0.1);
  CHECK_NEAR(fast.v, bicycle.options.max_speed, 1e-12);
}

TEST(unwrapping_keeps_lengths_and_turns) {
  // A helix on a cylinder is a straight line.
  std::vector<OrientedPoint> helix;
  for (int i = 0; i <= 400; ++i) {
    const double a = 0.02 * i;
    helix.push_back({{std::cos(a), std::sin(a), 0.3 * a}, {std::cos(a), std::sin(a), 0.0}});
  }
  const UnwrappedPath path(helix);
  double length = 0.0;
  for (std::size_t i = 1; i < helix.size(); ++i)
    length += (helix[i].position - helix[i - 1].position).norm();
  CHECK_NEAR(path.points().back().x(), length, 1e-9);
  CHECK_NEAR(path.points().back().y(), 0.0, 1e-6);
  // A circle in the plane stays one, left is left; a pose on it is found again.
  std::vector<OrientedPoint> circle;
  for (int i = 0; i <= 100; ++i)
    circle.push_back(
        {{std::sin(0.02 * i), 1.0 - std::cos(0.02 * i), 0.0}, Eigen::Vector3d::UnitZ()});
  const UnwrappedPath flat(circle);
  std::size_t hint = 0;
  const PlanarPose start = flat.pose({0.0, 0.1, 0.0}, Eigen::Vector3d::UnitX(), hint);
  CHECK_NEAR(start.position.y(), 0.1, 2e-3);
  CHECK(flat.points().back().y() > 0.9);
  CHECK_THROWS(Error, UnwrappedPath(std::span(circle).first(1)));
}

TEST(splines_run_at_constant_speed_from_end_to_end) {
  const std::vector<Point2> corner{{0, 0}, {1, 0}, {1, 1}};
  const SplineReference spline(corner, 0.1);
  CHECK_NEAR((spline(0.0).pose.position - corner[0]).norm(), 0.0, 1e-12);
  CHECK_NEAR((spline(9.0).pose.position - corner[2]).norm(), 0.0, 1e-12);
  CHECK(spline.length() < 2.0 && spline.length() > 1.9);
  double turned = 0.0;
  for (double s = 0.0; s + 0.01 < spline.length(); s += 0.01) {
    const auto a = spline(s), b = spline(s + 0.01);
    CHECK_NEAR((a.pose.position - b.pose.position).norm(), 0.01, 2e-4);
    turned += 0.5 * (a.curvature + b.curvature) * 0.01;
  }
  CHECK_NEAR(turned, kPi / 2, 0.02);
}

// Eq. 8.6 in the plane, from errors of all kinds.
TEST(tracking_converges) {
  for (const double offset : {-0.05, 0.0, 0.05})
    for (const double omega : {-0.3, 0.0, 0.3})
      for (const double y : {-0.05, 0.05}) {
        TrackingControl control;
        control.offset = offset;
        PlanarPose robot{{0.03, y}, 0.4}, reference;
        const double dt = 1e-3, v = 0.1;
        for (int k = 0; k < 15000; ++k) {
          const Twist twist = control(robot, reference, {v, omega});
          robot.position += dt * twist.v * Point2(std::cos(robot.heading), std::sin(robot.heading));
          robot.heading += dt * twist.w;
          reference.position +=
              dt * v * Point2(std::cos(reference.heading), std::sin(reference.heading));
          reference.heading += dt * omega;
        }
        CHECK_NEAR((robot.position - reference.position).norm(), 0.0, 1e-3);
        CHECK_NEAR(wrap_angle(robot.heading - reference.heading), 0.0, 1e-2);
      }
}

TEST(vehicles_track_paths_over_bumps) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.03});
  const SurfaceWalk walk(mesh);
  const Bvh bvh(mesh);
  const GeodesicStrips strips(walk);
  const SurfacePoint a = *nearest_surface_point(mesh, bvh, {0.15, 0.15, 0.1});
  const SurfacePoint b = *nearest_surface_point(mesh, bvh, {1.05, 0.95, 0.3});
  const auto path = strips(a, b);
  CHECK(path.has_value());
  const SurfacePose start = surface_pose(mesh, path->start, path->points[1] - path->points[0]);
  const TrackedDrive exact = track_path(walk, *path, FrontDriveBicycle{}, start);
  CHECK(exact.worst < 0.01 && exact.rms < 0.004 && exact.end_error < 0.01 && exact.stops == 0);
  TrackOptions noisy;
  noisy.position_noise = 0.01;
  noisy.heading_noise = radians(1.0);
  const TrackedDrive rough = track_path(walk, *path, FrontDriveBicycle{}, start, noisy);
  CHECK(rough.rms < 0.03 && rough.worst < 0.1 && rough.rms > exact.rms);
  const TrackedDrive again = track_path(walk, *path, FrontDriveBicycle{}, start, noisy);
  CHECK(again.rms == rough.rms);
}

TEST(a_point_ahead_is_led_by_the_field) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.05});
  const SurfaceWalk walk(mesh);
  const Bvh bvh(mesh);
  const auto path = GeodesicStrips(walk)(*nearest_surface_point(mesh, bvh, {0.2, 0.2, 0.1}),
                                         *nearest_surface_point(mesh, bvh, {1.0, 0.8, 0.3}));
  CHECK(path.has_value());
  const StripField<> field(mesh, path->triangles, path->goal);
  const SurfacePose start = surface_pose(mesh, path->start, path->points[1] - path->points[0]);
  const SurfacePose behind = walk(start, {-0.02, 0.0}).pose;  // its tip stands at the start
  const FieldDrive drive = drive_field(walk, field, Unicycle{}, behind, 0.02, 0.1, 0.02, 2e-3);
  CHECK(drive.reached && drive.left_strip == 0);
  CHECK(drive.length < 1.1 * path->length());
}
}  // namespace
