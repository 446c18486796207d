// SPDX-License-Identifier: MIT
/// @file
/// @brief A line scanner turned about an axis: scans of any mesh, with noise along the beam [004
/// §2.2.1].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/lidar_model.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/simulation/depth_camera.hpp>

namespace surfleet {
/// A LiDAR in a true scene; by default one that stands, with a degree between its beams.
struct RotatingLidar : LidarModel {
  double noise = 0.0;  ///< Standard deviation along the beam [m].
  std::uint64_t seed = 1;
  int threads = 1;

  RotatingLidar()
      : LidarModel{.azimuths = 360,
                   .elevations = 181,
                   .lowest = radians(-90.0),
                   .highest = radians(90.0),
                   .min_range = 0.02,
                   .max_range = 30.0} {}
  explicit RotatingLidar(const LidarModel& model, double sigma = 0.0)
      : LidarModel(model), noise(sigma) {}

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
      for (int e = 0; e < elevations; ++e) {
        const Eigen::Vector3d direction = T_world_sensor.linear() * beam(static_cast<int>(c), e);
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

  /// What the sensor itself gives of one turn, with teammates as balls. Within the range points
  /// err along their beams and stay in it; a little beyond it they are exact, and twice the range
  /// away where there is nothing; beams that meet something nearer than the range give none.
  /// `random` names the noise: the same on any number of threads.
  template <RayCaster Caster>
  LidarScan sense(const Caster& world, const Pose& T_world_sensor,
                  std::span<const Sphere> teammates = {}, const Random& random = Random(1)) const {
    require_lidar(*this);
    require(noise >= 0.0, "lidar: expected noise of 0 m or more");
    const double reach = 1.25 * max_range;
    const Point3 origin = T_world_sensor.translation();
    const auto rows = static_cast<std::size_t>(elevations);
    std::vector<double> range(beams());
    parallel_for(static_cast<std::size_t>(azimuths), threads, [&](std::size_t c) {
      std::vector<Eigen::Vector3d> directions;
      for (int e = 0; e < elevations; ++e)
        directions.push_back(T_world_sensor.linear() * beam(static_cast<int>(c), e));
      const std::span<double> column = std::span(range).subspan(c * rows, rows);
      cast_bundle(world, origin, directions, reach, column);
      Random stream = random.fork(c);
      for (std::size_t e = 0; e < rows; ++e) {
        double& r = column[e];
        for (const Sphere& mate : teammates)
          if (const auto t = intersect_sphere(origin, directions[e], mate)) r = std::min(r, *t);
        const double error = noise > 0.0 ? noise * stream.normal() : 0.0;
        if (r > reach)
          r = 2.0 * max_range;
        else if (r < min_range)
          r = 0.0;
        else if (r <= max_range)
          r = std::clamp(r + error, (1.0 + kEdge) * min_range, (1.0 - kEdge) * max_range);
      }
    });
    LidarScan scan;
    for (std::size_t i = 0; i < range.size(); ++i)
      if (range[i] > 0.0)
        scan.points.push_back(range[i] *
                              beam(static_cast<int>(i / rows), static_cast<int>(i % rows)));
    return scan;
  }

 private:
  static constexpr double kEdge = 1e-12;  ///< So that rounding passes no limit of the range.
};

/// Adds independent Gaussian noise of standard deviation `sigma` [m] along each axis.
inline void add_noise(std::span<Point3> points, double sigma, std::uint64_t seed) {
  require(sigma >= 0.0 && std::isfinite(sigma), "noise of points: expected 0 m or more");
  Random random(mix64(seed) ^ 0x2e5eULL);
  for (Point3& p : points)
    for (int k = 0; k < 3; ++k) p[k] += sigma * random.normal();
}
}  // namespace surfleet
