// SPDX-License-Identifier: MIT
/// @file
/// @brief The room of the mapping benchmarks, with exact distances: 10 × 8 × 3 m, a sphere and
/// a square pillar.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <surfleet/geometry/pinhole_camera.hpp>

namespace room_scene {
using surfleet::Box3;
using surfleet::Point3;
using surfleet::Pose;

inline const Box3 kRoom{Point3(-5, -4, 0), Point3(5, 4, 3)};
inline const Box3 kPillar{Point3(-2.5, -2.0, 0), Point3(-1.7, -1.2, 3)};
inline const Point3 kSphere{1.5, 1.0, 1.2};
constexpr double kRadius = 0.8;

/// Range along a unit direction from a point in the free space of the room.
inline double cast(const Point3& from, const Eigen::Vector3d& direction) {
  double range = std::numeric_limits<double>::infinity();
  double enter = 0.0, leave = range;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0.0) {
      if (from[i] < kPillar.min()[i] || from[i] > kPillar.max()[i]) leave = -1.0;
      continue;
    }
    const double wall = direction[i] > 0 ? kRoom.max()[i] : kRoom.min()[i];
    range = std::min(range, (wall - from[i]) / direction[i]);
    const double a = (kPillar.min()[i] - from[i]) / direction[i];
    const double b = (kPillar.max()[i] - from[i]) / direction[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter < leave) range = std::min(range, enter);
  const Eigen::Vector3d to = kSphere - from;
  const double along = to.dot(direction);
  const double d2 = kRadius * kRadius - to.squaredNorm() + along * along;
  if (along > 0.0 && d2 > 0.0) range = std::min(range, along - std::sqrt(d2));
  return range;
}

/// Unsigned distance to the nearest surface of the scene.
inline double distance(const Point3& p) {
  const double inside =
      std::min((p - kRoom.min()).cwiseAbs().minCoeff(), (p - kRoom.max()).cwiseAbs().minCoeff());
  double pillar = kPillar.exteriorDistance(p);
  if (pillar == 0.0) {
    const Point3 low = p - kPillar.min(), high = kPillar.max() - p;
    pillar = std::min({low.x(), low.y(), high.x(), high.y()});
  }
  return std::min({inside, pillar, std::abs((p - kSphere).norm() - kRadius)});
}

/// What a point of a reconstruction is a sample of.
enum class Part {
  plane,   ///< A wall, the floor, the ceiling or a face of the pillar.
  sphere,  ///< The sphere.
  edge,    ///< One of the pillar's convex edges is within `reach`.
  corner,  ///< Two planes that meet at a concave angle are.
};
inline Part part_at(const Point3& p, double reach) {
  const double sphere = std::abs((p - kSphere).norm() - kRadius);
  if (sphere <= distance(p)) return Part::sphere;
  const auto to_sides = [&](const Box3& box, int axis) {
    return std::min(std::abs(p[axis] - box.min()[axis]), std::abs(p[axis] - box.max()[axis]));
  };
  const bool at_pillar = kPillar.exteriorDistance(p) <= reach;
  if (at_pillar && std::hypot(to_sides(kPillar, 0), to_sides(kPillar, 1)) <= reach)
    return Part::edge;
  int planes = at_pillar ? 1 : 0;
  for (int axis = 0; axis < 3; ++axis) planes += to_sides(kRoom, axis) <= reach ? 1 : 0;
  return planes > 1 ? Part::corner : Part::plane;
}

/// Ten poses of a body on a circle, facing outward and around.
inline std::vector<Pose> body_poses(int count = 10) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double a = 2.0 * surfleet::kPi * i / count;
    const surfleet::Configuration c{Point3(1.0 * std::cos(a) - 0.3, 1.0 * std::sin(a) - 0.6, 1.5),
                                    a + 0.5};
    poses.push_back(c.pose());
  }
  return poses;
}

inline surfleet::DepthImage depth_image(const surfleet::PinholeCamera& camera,
                                        const Pose& T_world_camera) {
  surfleet::DepthImage image(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.ray(u, v);
      const double length = ray.norm();
      image(u, v) = static_cast<float>(
          cast(T_world_camera.translation(), T_world_camera.linear() * ray / length) / length);
    }
  return image;
}

/// 100 rings of 1000 points, ±45°, in the sensor frame.
inline std::vector<Point3> lidar_scan(const Pose& T_world_sensor, int rings = 100,
                                      int columns = 1000) {
  std::vector<Point3> points;
  for (int r = 0; r < rings; ++r)
    for (int c = 0; c < columns; ++c) {
      const double e = surfleet::radians(-45.0 + 90.0 * (r + 0.5) / rings);
      const double a = 2.0 * surfleet::kPi * c / columns;
      const Eigen::Vector3d d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      points.push_back(d * cast(T_world_sensor.translation(), T_world_sensor.linear() * d));
    }
  return points;
}
}  // namespace room_scene
