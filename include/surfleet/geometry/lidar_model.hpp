// SPDX-License-Identifier: MIT
/// @file
/// @brief A rotating LiDAR and the scan it gives.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>

namespace surfleet {
/// Beams at equal steps of elevation in a half-plane through the sensor's z axis, which turns about
/// that axis in equal steps of azimuth. Ranges are distances from the sensor's origin.
struct LidarModel {
  int azimuths = 512;              ///< Over a full turn.
  int elevations = 64;             ///< From `lowest` to `highest`, both included.
  double lowest = radians(-45.0);  ///< [rad]
  double highest = radians(45.0);  ///< [rad]
  double min_range = 0.5;          ///< [m]
  double max_range = 30.0;         ///< [m]

  /// Unit, in the sensor's frame.
  Eigen::Vector3d beam(int azimuth, int elevation) const {
    const double a = 2.0 * kPi * static_cast<double>(azimuth) / azimuths;
    const double e = lowest + (highest - lowest) * elevation / (elevations - 1);
    return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  }
  std::size_t beams() const {
    return static_cast<std::size_t>(azimuths) * static_cast<std::size_t>(elevations);
  }
};
/// Throws `Error` unless there are beams, an opening and a range.
inline void require_lidar(const LidarModel& l) {
  require(l.azimuths >= 1 && l.elevations >= 2 && l.lowest < l.highest &&
              l.lowest >= radians(-90.0) && l.highest <= radians(90.0),
          "lidar: expected beams and an opening within -90 to 90 degrees");
  require_range(l.min_range, l.max_range, "lidar");
}

/// What a LiDAR measured of one turn: points in its frame [m]. One beyond its range says that
/// nothing was met up to there; non-finite points, and beams without a point, say nothing.
struct LidarScan {
  std::vector<Point3> points;
};

/// The camera that views are planned for in place of an upright LiDAR: 60° wide, as high as the
/// LiDAR's opening up to 80° above and below, and as deep as all of its image is in the LiDAR's
/// range. With its optical axis along the body's x axis at the LiDAR's place, it sees a part of
/// what that sees.
inline PinholeCamera camera_within(const LidarModel& lidar) {
  constexpr double kSteepest = radians(80.0), kPixel = radians(1.0);
  require_lidar(lidar);
  const double up = std::tan(std::clamp(lidar.highest, -kSteepest, kSteepest));
  const double down = -std::tan(std::clamp(lidar.lowest, -kSteepest, kSteepest));
  const double side = std::tan(radians(30.0));
  PinholeCamera c;
  c.width = 60;
  c.height = std::max(12, static_cast<int>(std::lround((up + down) / kPixel)));
  c.fx = 0.5 * c.width / side;
  c.fy = c.height / (up + down);
  c.cx = 0.5 * (c.width - 1);
  c.cy = up * c.fy - 0.5;
  const double corner = Eigen::Vector3d(side, std::max(std::abs(up), std::abs(down)), 1.0).norm();
  c.min_range = lidar.min_range;
  c.max_range = lidar.max_range / corner;
  require(c.max_range > c.min_range, "lidar: expected a longer range or a lower opening");
  return c;
}
}  // namespace surfleet
