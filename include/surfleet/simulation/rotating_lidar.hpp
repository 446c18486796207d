// SPDX-License-Identifier: MIT
/// @file
/// @brief A line scanner turned about an axis: scans of any mesh, with noise along the beam [004
/// §2.2.1].
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/ray_caster.hpp>

namespace surfleet {
/// Beams at equal steps of elevation in a half-plane through the sensor's z axis, which turns about
/// that axis in equal steps of azimuth.
struct RotatingLidar {
  int azimuths = 360;              ///< Over a full turn.
  int elevations = 181;            ///< From `lowest` to `highest`, both included.
  double lowest = radians(-90.0);  ///< [rad]
  double highest = radians(90.0);  ///< [rad]
  double min_range = 0.02;         ///< [m]
  double max_range = 30.0;         ///< [m]
  double noise = 0.0;              ///< Standard deviation along the beam [m].
  std::uint64_t seed = 1;
  int threads = 1;

  /// The points of one scan in the world, row by row of elevation within an azimuth; beams that
  /// meet nothing in range give none. The same for any number of threads.
  template <RayCaster Caster>
  PointCloud scan(const Caster& world, const Pose& T_world_sensor) const {
    require(azimuths >= 1 && elevations >= 2 && lowest < highest && min_range >= 0.0 &&
                max_range > min_range && noise >= 0.0,
            "rotating lidar: expected beams, an opening, a range and noise of 0 m or more");
    const auto columns = static_cast<std::size_t>(azimuths);
    std::vector<std::vector<Point3>> found(columns);
    const Random random(mix64(seed) ^ 0x11dabULL);
    parallel_for(columns, threads, [&](std::size_t c) {
      Random stream = random.fork(c);
      const double azimuth = 2.0 * kPi * static_cast<double>(c) / azimuths;
      for (int e = 0; e < elevations; ++e) {
        const double elevation = lowest + (highest - lowest) * e / (elevations - 1);
        const Eigen::Vector3d beam(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        const Eigen::Vector3d direction = T_world_sensor.linear() * beam;
        const double error = noise > 0.0 ? noise * stream.normal() : 0.0;
        const std::optional<RayHit> hit =
            world.cast(T_world_sensor.translation(), direction, max_range);
        if (hit && hit->t >= min_range)
          found[c].push_back(T_world_sensor.translation() + (hit->t + error) * direction);
      }
    });
    PointCloud cloud;
    for (const auto& column : found)
      cloud.points.insert(cloud.points.end(), column.begin(), column.end());
    return cloud;
  }
};

/// Adds independent Gaussian noise of standard deviation `sigma` [m] along each axis.
inline void add_noise(std::span<Point3> points, double sigma, std::uint64_t seed) {
  require(sigma >= 0.0 && std::isfinite(sigma), "noise of points: expected 0 m or more");
  Random random(mix64(seed) ^ 0x2e5eULL);
  for (Point3& p : points)
    for (int k = 0; k < 3; ++k) p[k] += sigma * random.normal();
}
}  // namespace surfleet
