// SPDX-License-Identifier: MIT
/// @file
/// @brief What robots of one kind have in common: sensor, body, limits, where they may be.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/core/transport.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/geometry/sensor_reading.hpp>
#include <surfleet/motion/collision_body.hpp>
#include <surfleet/motion/kinematics.hpp>
#include <surfleet/motion/swept_body.hpp>

namespace surfleet {
using RobotKindId = std::uint32_t;  ///< Of a kind among those of a belief, from 0 on.

struct RobotKind {
  PinholeCamera camera;
  Pose T_body_camera = forward_camera_mount();
  double body_radius = 1.0;              ///< Of the body, or of the ball that holds its shape [m].
  std::optional<double> margin;          ///< Kept beyond the body [m]; nothing: one voxel.
  std::optional<double> unknown_margin;  ///< The same from what is unknown [m]; nothing: `margin`.
  AerialLimits limits;
  Box3 bounds;       ///< Where the robots' centres may be [m].
  KeepOut keep_out;  ///< Where in there their bodies may not be.
  /// By which the camera is tilted down beyond its mount in views [rad]: others than 0 take a
  /// gimbal. See `HeadingTable`.
  std::vector<double> pitches{0.0};
  /// What of the ball of `body_radius` the body takes up, whatever its heading; nothing: all of it.
  /// See `take_shape`. Teammates keep clear of the ball.
  std::optional<SweptBody> shape;
  /// What it sees with in place of the camera, if anything: see `carry`.
  std::optional<LidarModel> lidar{};

  /// Gives the robots a body of any shape; a ball again if that is one.
  template <CollisionBody Body>
  void take_shape(const Body& body) {
    body_radius = body.bounding_radius();
    shape.reset();
    if (body.inscribed_radius() >= body_radius) return;
    shape = SweptBody::of(body);
    body_radius = shape->radius();
  }
  /// Of the ball that is within the body [m].
  double inscribed_radius() const { return shape ? shape->inscribed_radius() : body_radius; }
  /// How far the body reaches below its position [m].
  double depth() const { return shape ? shape->depth() : body_radius; }
  bool has_gimbal() const { return pitches != std::vector<double>{0.0}; }
  SensorModel sensor() const { return lidar ? SensorModel(*lidar) : SensorModel(camera); }
  /// `T_world_sensor` of a body at `q`.
  Pose sensor_pose(const Configuration& q) const {
    if (!lidar) return camera_pose(q, T_body_camera);
    return q.pose() * Eigen::Translation3d(T_body_camera.translation());
  }
  /// Whether it sees the same whatever its heading.
  bool sees_all_around() const { return lidar.has_value(); }
};

/// Has robots of the kind see with a LiDAR that stands upright in the body, at `place` [m].
/// Planners know cameras alone: they plan for one that faces ahead and sees a part of what the
/// LiDAR does (`camera_within`), so that a view never promises too much; what the LiDAR sees on all
/// other sides comes without being planned for, and agents do not turn to a view's heading. Throws
/// `Error` for a LiDAR that is none.
inline void carry(RobotKind& kind, const LidarModel& lidar, const Point3& place = Point3::Zero()) {
  kind.camera = camera_within(lidar);
  kind.T_body_camera = forward_camera_mount(0.0, place);
  kind.pitches = {0.0};
  kind.lidar = lidar;
}

/// The same for kinds that see and reach the same, on whatever host, and almost certainly another
/// for others: what one robot viewed in vain, another of its kind need not try.
inline std::uint32_t kind_number(const RobotKind& kind) {
  std::uint64_t h = 0;
  // Whole micrometres, as hosts' sines differ in their last bits.
  const auto add = [&](double v) {
    h = mix64(h ^ std::bit_cast<std::uint64_t>(std::round(v * 1e6) + 0.0));
  };
  const auto add_point = [&](const Eigen::Vector3d& p) {
    for (int k = 0; k < 3; ++k) add(p[k]);
  };
  const PinholeCamera& c = kind.camera;
  for (const double v : {static_cast<double>(c.width), static_cast<double>(c.height), c.fx, c.fy,
                         c.cx, c.cy, c.min_range, c.max_range, kind.body_radius,
                         kind.margin.value_or(-1.0), kind.unknown_margin.value_or(-1.0)})
    add(v);
  add_point(kind.T_body_camera.translation());
  for (int k = 0; k < 3; ++k) add_point(kind.T_body_camera.linear().col(k));
  add_point(kind.bounds.min());
  add_point(kind.bounds.max());
  for (const Box3& box : kind.keep_out.boxes) {
    add_point(box.min());
    add_point(box.max());
  }
  if (kind.has_gimbal())
    for (const double p : kind.pitches) add(p);
  if (kind.shape)
    for (const SweptBody::Ring& ring : kind.shape->rings())
      if (!ring.empty()) {
        add(ring.low);
        add(ring.high);
      }
  if (const auto& l = kind.lidar)
    for (const double v : {static_cast<double>(l->azimuths), static_cast<double>(l->elevations),
                           l->lowest, l->highest, l->min_range, l->max_range})
      add(v);
  return static_cast<std::uint32_t>(h);
}
}  // namespace surfleet
