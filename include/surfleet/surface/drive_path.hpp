// SPDX-License-Identifier: MIT
/// @file
/// @brief Vehicles driven over a mesh: after a field, or after a path with noise on the pose.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/surface/follow_field.hpp>
#include <surfleet/surface/strip_path.hpp>
#include <surfleet/surface/surface_vehicles.hpp>
#include <surfleet/surface/surface_walk.hpp>
#include <surfleet/surface/tracking_control.hpp>

namespace surfleet {
/// The waypoints of a surface path at most `spacing` [m] apart, with the normals of its triangles,
/// meaned where it goes from one to the next.
inline std::vector<OrientedPoint> oriented_waypoints(const TriangleMesh& mesh,
                                                     const SurfacePath& path, double spacing) {
  std::vector<OrientedPoint> waypoints;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double side = 1.0;
  for (std::size_t i = 0; i < path.triangles.size(); ++i) {
    const auto t = static_cast<std::size_t>(path.triangles[i]);
    Eigen::Vector3d n = mesh.area_vector(t).normalized();
    if (i > 0) {  // triangles may have either orientation
      const auto sides = shared_side(
          mesh.triangles[static_cast<std::size_t>(path.triangles[i - 1])], mesh.triangles[t]);
      const auto k = static_cast<std::size_t>(sides->first),
                 j = static_cast<std::size_t>(sides->second);
      if (mesh.triangles[static_cast<std::size_t>(path.triangles[i - 1])][k] ==
          mesh.triangles[t][j])
        side = -side;
    }
    n *= side;
    waypoints.push_back({path.points[i], i > 0 ? Eigen::Vector3d((last + n).normalized()) : n});
    const Eigen::Vector3d piece = path.points[i + 1] - path.points[i];
    const auto parts = static_cast<int>(std::ceil(piece.norm() / spacing));
    for (int p = 1; p < parts; ++p) waypoints.push_back({path.points[i] + piece * p / parts, n});
    last = n;
  }
  waypoints.push_back({path.points.back(), last});
  return waypoints;
}

struct TrackOptions {
  double speed = 0.05;          ///< Of the reference [m/s].
  double dt = 0.02;             ///< Of the control [s].
  double spacing = 0.04;        ///< Of the spline's control points [m].
  double position_noise = 0.0;  ///< Standard deviation along each axis of what it knows [m].
  double heading_noise = 0.0;   ///< [rad]
  std::uint64_t seed = 1;
  TrackingControl control = {};
};

/// A tracked drive.
struct TrackedDrive {
  std::vector<SurfacePose> poses;  ///< Every control step, the start first.
  std::vector<double> error;       ///< From the path, at each of them [m].
  double rms = 0.0, worst = 0.0;   ///< [m]
  double end_error = 0.0;          ///< From the goal [m].
  std::size_t stops = 0;           ///< Steps in which it did not move: it met a border.
};

/// Drives `vehicle` from `start` after a reference that runs along `path` at constant speed, by eq.
/// 8.6. The error is the distance to the path, truth to truth. O(length / (speed dt)).
template <SurfaceVehicle Vehicle>
TrackedDrive track_path(const SurfaceWalk& walk, const SurfacePath& path, Vehicle vehicle,
                        const SurfacePose& start, const TrackOptions& options = {}) {
  require(options.speed > 0.0 && options.dt > 0.0, "tracking: expected a positive speed and step");
  const UnwrappedPath plane(oriented_waypoints(walk.mesh(), path, 0.5 * options.spacing));
  const SplineReference reference(plane.points(), options.spacing);
  Random random(options.seed);
  TrackedDrive drive;
  SurfacePose pose = start;
  std::size_t hint = 0, true_hint = 0;
  const auto record = [&] {
    drive.poses.push_back(pose);
    drive.error.push_back(plane.distance(pose.at.position(walk.mesh()), true_hint));
  };
  record();
  const double settle = 2.0;  // the reference waits at the end for the robot to come up [s]
  for (double time = 0.0; time < reference.length() / options.speed + settle; time += options.dt) {
    const double s = options.speed * time;
    const bool runs = s < reference.length();
    const auto state = reference(s);
    const Twist feedforward{runs ? options.speed : 0.0,
                            runs ? options.speed * state.curvature : 0.0};
    const SurfacePose known = pose.turned(options.heading_noise * random.normal());
    Point3 position = pose.at.position(walk.mesh());
    const double x = random.normal(), y = random.normal();
    position += options.position_noise * (x * pose.forward + y * pose.left());
    const PlanarPose robot = plane.pose(position, known.forward, hint);
    const Twist twist = options.control(robot, state.pose, feedforward);
    const Point3 before = pose.at.position(walk.mesh());
    const Twist done = vehicle.drive(walk, pose, runs ? twist : Twist{twist.v, 0.0}, options.dt);
    if (std::abs(done.v) > 0.0 && (pose.at.position(walk.mesh()) - before).norm() == 0.0)
      ++drive.stops;
    record();
  }
  double sum = 0.0;
  for (const double e : drive.error) {
    sum += e * e;
    drive.worst = std::max(drive.worst, e);
  }
  drive.rms = std::sqrt(sum / static_cast<double>(drive.error.size()));
  drive.end_error = (pose.at.position(walk.mesh()) - path.points.back()).norm();
  return drive;
}

/// Drives a vehicle by a field through the point `ahead` [m] in front of it, which moves as the
/// point robot does: that point stays in the strip and reaches the goal.
template <StripFieldPolicy Policy, SurfaceVehicle Vehicle>
FieldDrive drive_field(const SurfaceWalk& walk, const StripField<Policy>& field, Vehicle vehicle,
                       SurfacePose pose, double ahead, double speed, double dt, double tolerance,
                       std::size_t max_steps = 200000) {
  require(ahead > 0.0 && speed > 0.0 && dt > 0.0, "drive: expected positive lengths and times");
  FieldDrive drive;
  StripPlace at(field.strip());
  const Point3 goal = field.goal().position(walk.mesh());
  drive.poses.push_back(pose);
  for (std::size_t k = 0; k < max_steps; ++k) {
    const SurfacePose tip = walk(pose, {ahead, 0.0}).pose;
    if (tip.at.triangle != field.strip().triangles[*at]) at.enter(tip.at.triangle);
    if (at.lost()) break;
    if ((tip.at.position(walk.mesh()) - goal).norm() <= tolerance) {
      drive.reached = true;
      break;
    }
    const Eigen::Vector3d u = field(*at, tip.at.weights);
    if (!(u.norm() > 0.0)) break;
    const Eigen::Vector3d velocity =
        std::min(speed, (tip.at.position(walk.mesh()) - goal).norm() / dt) * u.normalized();
    const Point3 before = pose.at.position(walk.mesh());
    vehicle.drive(walk, pose,
                  linearized({velocity.dot(tip.forward), velocity.dot(tip.left())}, ahead), dt);
    drive.length += (pose.at.position(walk.mesh()) - before).norm();
    drive.poses.push_back(pose);
  }
  drive.left_strip = at.left_strip();
  return drive;
}
}  // namespace surfleet
