// SPDX-License-Identifier: MIT
/// @file
/// @brief The simulated world of a fleet of drones: what their LiDARs see of a true scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/simulation/rotating_lidar.hpp>

namespace surfleet {
struct LidarWorldOptions {
  Point3 place = Point3::Zero();  ///< Of the LiDAR, upright in the body [m].
  double body_radius = 0.5;       ///< Of a teammate as a LiDAR sees it [m].
  std::uint64_t seed = 1;
};

/// Models `SightWorld` as `DroneWorld` does, for robots that `carry` a LiDAR. A scan is taken from
/// one place, as if the robot stood still for its turn. The caster must outlive this object.
template <RayCaster Caster>
class LidarWorld {
 public:
  /// Throws `Error` for a LiDAR that is none.
  LidarWorld(const Caster& caster, const RotatingLidar& lidar, LidarWorldOptions options = {})
      : caster_(&caster), lidar_(lidar), options_(options) {
    require_lidar(lidar);
  }

  LidarScan capture(std::size_t robot, std::uint64_t shot,
                    std::span<const Configuration> fleet) const {
    const auto mates = balls_of_mates(fleet, robot, options_.body_radius);
    return lidar_.sense(*caster_, fleet[robot].pose() * Eigen::Translation3d(options_.place), mates,
                        Random(options_.seed).fork(robot).fork(shot));
  }
  /// Whether nothing of the scene is between; robots do not occlude.
  bool sees(const Point3& a, const Point3& b) const { return is_clear_segment(*caster_, a, b); }

 private:
  const Caster* caster_;
  RotatingLidar lidar_;
  LidarWorldOptions options_;
};
}  // namespace surfleet
