// SPDX-License-Identifier: MIT
/// @file
/// @brief What an agent needs of the robot it drives.
#pragma once

#include <concepts>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/sensor_reading.hpp>

namespace surfleet {
/// A teammate as a robot sees it.
struct SeenRobot {
  Point3 position = Point3::Zero();  ///< Of its body's centre, in the world [m].
  double error = 0.0;                ///< The centre is no farther off than this [m].
};

/// A robot, real or simulated. What it says of itself is its own estimate; the truth stays with it.
///
/// - `sense()`: a depth image or a LiDAR's scan from where it is now.
/// - `estimate()`: where it believes to be; `neighbours()`: where it saw teammates when it last
///   took an image, all that are near and in doubt too many.
/// - `follow(path, yaw, watch)`: sets out along `path`, whose first point is where it is, to end
///   with heading `yaw`; until then it turns to the heading `watch` if that is given, which
///   `watch(yaw)` changes.
/// - `path_onto(path)`: the path that `follow` would take from the course it is on.
/// - `stop()`, `resume()`: brakes, and goes on along the same path.
/// - `remaining()`: the path ahead; `stopping_distance()` [m]; `velocity()` [m/s].
/// - `standing()`, `braking()`, `finished()`: at the end of the path with the heading asked for.
/// - `advance(dt)`: lets time pass [s]; a real robot has nothing to do here.
///
/// Stops at other pitches than 0 need a `GimballedBody`.
template <typename B>
concept RobotBody = requires(B& body, const B& now, std::span<const Point3> path, double x,
                             std::optional<double> watch) {
  { body.sense() } -> std::convertible_to<SensorReading>;
  { now.estimate() } -> std::convertible_to<Configuration>;
  { now.neighbours() } -> std::convertible_to<std::vector<SeenRobot>>;
  body.follow(path, x, watch);
  body.watch(x);
  { now.path_onto(path) } -> std::convertible_to<std::vector<Point3>>;
  body.stop();
  body.resume();
  { now.remaining() } -> std::convertible_to<std::vector<Point3>>;
  { now.stopping_distance() } -> std::convertible_to<double>;
  { now.velocity() } -> std::convertible_to<Eigen::Vector3d>;
  { now.standing() } -> std::convertible_to<bool>;
  { now.braking() } -> std::convertible_to<bool>;
  { now.finished() } -> std::convertible_to<bool>;
  body.advance(x);
};

/// A body whose camera hangs in a gimbal: `tilt(pitch)` turns it, in its own time, to that pitch of
/// `Configuration` [rad]; `estimate()` tells how far it is.
template <typename B>
concept GimballedBody = RobotBody<B> && requires(B& body, double pitch) {
  body.tilt(pitch);
};

/// A body that knows how far it has flown on its charge, `travelled()` [m], whatever drove it: an
/// agent that takes it over goes on from there.
template <typename B>
concept MeasuredBody = RobotBody<B> && requires(const B& now) {
  { now.travelled() } -> std::convertible_to<double>;
};
/// What a body says that it has flown; 0 for one that does not know [m].
template <RobotBody B>
double travelled_by(const B& body) {
  if constexpr (MeasuredBody<B>) return body.travelled();
  return 0.0;
}
}  // namespace surfleet
