// SPDX-License-Identifier: MIT
/// @file
/// @brief Keeps teammates out of the map.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <surfleet/geometry/sensor_reading.hpp>

namespace surfleet {
/// Takes the measurements that fell on a teammate out of `image`: a pixel whose point lies within
/// `radius` of a teammate's centre becomes no measurement. What a teammate hides stays unknown.
/// O(pixels of the teammates' bounding boxes).
inline void mask_teammates(DepthImage& image, const PinholeCamera& camera,
                           const Pose& T_world_camera, std::span<const Point3> teammates,
                           double radius) {
  const Pose T_camera_world = T_world_camera.inverse();
  for (const Point3& mate : teammates) {
    const Point3 c = T_camera_world * mate;
    if (c.z() + radius <= 0.0 || c.z() - radius > camera.max_range) continue;
    int u0 = 0, u1 = image.width - 1, v0 = 0, v1 = image.height - 1;
    const double near = c.z() - radius;
    if (near > 0.1) {
      const auto clip = [](double x, int n) {
        return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(n - 1)));
      };
      // The body lies in a cube of side 2 radius, whose projection its nearest face bounds.
      const double far = c.z() + radius;
      const auto low = [&](double x, double f, double o) {
        return o + f * std::min((x - radius) / near, (x - radius) / far);
      };
      const auto high = [&](double x, double f, double o) {
        return o + f * std::max((x + radius) / near, (x + radius) / far);
      };
      u0 = clip(std::floor(low(c.x(), camera.fx, camera.cx)), image.width);
      u1 = clip(std::ceil(high(c.x(), camera.fx, camera.cx)), image.width);
      v0 = clip(std::floor(low(c.y(), camera.fy, camera.cy)), image.height);
      v1 = clip(std::ceil(high(c.y(), camera.fy, camera.cy)), image.height);
    }
    for (int v = v0; v <= v1; ++v)
      for (int u = u0; u <= u1; ++u) {
        const float d = image(u, v);
        if (!DepthImage::is_measurement(d) || d > static_cast<float>(camera.max_range)) continue;
        if ((camera.ray(u, v) * static_cast<double>(d) - c).norm() <= radius) image(u, v) = 0.0F;
      }
  }
}
/// The same for a scan, whose points on teammates are left out. O(points · teammates).
inline void mask_teammates(LidarScan& scan, const LidarModel& /*lidar*/, const Pose& T_world_lidar,
                           std::span<const Point3> teammates, double radius) {
  const Pose T_lidar_world = T_world_lidar.inverse(Eigen::Isometry);
  for (const Point3& mate : teammates) {
    const Point3 c = T_lidar_world * mate;
    std::erase_if(scan.points, [&](const Point3& p) { return (p - c).norm() <= radius; });
  }
}
/// The same for whatever the sensor gives.
inline void mask_teammates(SensorReading& seen, const SensorModel& sensor,
                           const Pose& T_world_sensor, std::span<const Point3> teammates,
                           double radius) {
  visit_reading(seen, sensor, [&](auto& s, const auto& model) {
    mask_teammates(s, model, T_world_sensor, teammates, radius);
  });
}
}  // namespace surfleet
