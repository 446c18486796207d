// SPDX-License-Identifier: MIT
/// @file
/// @brief The simulated world of a fleet of drones: what their cameras see of a true scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/simulation/depth_camera.hpp>
#include <surfleet/simulation/stereo_noise.hpp>

namespace surfleet {
struct DroneWorldOptions {
  bool noise = true;  ///< Stereo noise, or exact depth.
  StereoNoise stereo{};
  double body_radius = 0.5;  ///< Of a teammate as a camera sees it [m].
  std::uint64_t seed = 1;
};

/// Models `SightWorld`: depth images cast against the true mesh, teammates as balls. Every image
/// has a random stream of its own, named by robot and shot, so images do not depend on the order
/// or the number of threads in which they are taken. The caster must outlive this object.
template <RayCaster Caster>
class DroneWorld {
 public:
  DroneWorld(const Caster& caster, const PinholeCamera& camera, Pose T_body_camera,
             DroneWorldOptions options = {})
      : caster_(&caster),
        T_body_camera_(std::move(T_body_camera)),
        options_(options),
        exact_(camera),
        noisy_(camera, options.stereo) {}

  DepthImage capture(std::size_t robot, std::uint64_t shot,
                     std::span<const Configuration> fleet) const {
    const auto mates = balls_of_mates(fleet, robot, options_.body_radius);
    const Pose T_world_camera = camera_pose(fleet[robot], T_body_camera_);
    const Random random = Random(options_.seed).fork(robot).fork(shot);
    return options_.noise ? noisy_.capture(*caster_, T_world_camera, mates, random)
                          : exact_.capture(*caster_, T_world_camera, mates, random);
  }
  /// Whether nothing of the scene is between; robots do not occlude.
  bool sees(const Point3& a, const Point3& b) const { return is_clear_segment(*caster_, a, b); }

 private:
  const Caster* caster_;
  Pose T_body_camera_;
  DroneWorldOptions options_;
  DepthCamera<NoNoise> exact_;
  DepthCamera<StereoNoise> noisy_;
};
}  // namespace surfleet
