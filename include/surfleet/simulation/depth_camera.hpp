// SPDX-License-Identifier: MIT
/// @file
/// @brief A depth camera in a true scene.
///
///     DepthCamera<StereoNoise> camera{PinholeCamera::from_fov(…)};
///     const DepthImage image = camera.capture(Bvh(scene.mesh), T_world_camera, {}, Random(seed));
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/motion/collision_body.hpp>
#include <surfleet/simulation/stereo_noise.hpp>

namespace surfleet {
/// The parameter t >= 0 at which `origin + t * direction` enters a sphere; nothing if it misses it
/// or starts inside.
inline std::optional<double> intersect_sphere(const Point3& origin,
                                              const Eigen::Vector3d& direction,
                                              const Sphere& sphere) {
  const Eigen::Vector3d to = sphere.center - origin;
  const double a = direction.squaredNorm(), b = to.dot(direction);
  const double c = to.squaredNorm() - sphere.radius * sphere.radius;
  const double discriminant = b * b - a * c;
  if (!(c > 0.0 && b > 0.0 && discriminant >= 0.0)) return std::nullopt;
  return (b - std::sqrt(discriminant)) / a;
}

/// A robot's mates as a sensor sees them.
inline std::vector<Sphere> balls_of_mates(std::span<const Configuration> fleet, std::size_t robot,
                                          double radius) {
  std::vector<Sphere> mates;
  for (std::size_t k = 0; k < fleet.size(); ++k)
    if (k != robot) mates.push_back({fleet[k].position, radius});
  return mates;
}

/// Casts one ray a pixel centre against a scene and teammates' bodies; noise is a policy.
///
/// Pixel values [m along z]: 0 where the first surface is nearer than the minimum range; within the
/// range the depth, spoiled by the noise and kept within the range; a little beyond it the depth,
/// and twice the maximum range where there is nothing. Both say that all of the range is free, and
/// neither that there is a surface at its end. O(pixels · ray).
template <DepthNoise Noise = NoNoise>
class DepthCamera {
 public:
  PinholeCamera model;
  [[no_unique_address]] Noise noise{};
  int threads = 1;

  explicit DepthCamera(const PinholeCamera& camera = {}, Noise n = {}, int thread_count = 1)
      : model(camera), noise(n), threads(thread_count) {}

  /// The value of a pixel whose ray meets nothing up to `reach`.
  float beyond_range() const { return static_cast<float>(2.0 * model.max_range); }
  /// How far surface is told of at all [m].
  double reach() const { return 1.25 * model.max_range; }

  /// The image from `T_world_camera`. `random` names the image's noise: the same stream gives the
  /// same image on any number of threads.
  template <RayCaster Scene>
  DepthImage capture(const Scene& scene, const Pose& T_world_camera,
                     std::span<const Sphere> teammates = {},
                     const Random& random = Random(1)) const {
    DepthImage image(model.width, model.height);
    const Eigen::Matrix3d R = T_world_camera.linear();
    const Point3 origin = T_world_camera.translation();
    std::vector<Sphere> near;  // teammates that can be within range of any pixel
    const double corner =
        Eigen::Vector3d(std::max(model.cx, model.width - 1 - model.cx) / model.fx,
                        std::max(model.cy, model.height - 1 - model.cy) / model.fy, 1.0)
            .norm();
    for (const Sphere& s : teammates)
      if ((s.center - origin).norm() < reach() * corner + s.radius) near.push_back(s);
    constexpr std::size_t kRows = 4;  // a bundle is a band of rows: near rays, few calls
    const auto height = static_cast<std::size_t>(model.height);
    const auto width = static_cast<std::size_t>(model.width);
    parallel_for((height + kRows - 1) / kRows, threads, [&](std::size_t band) {
      const std::size_t first = band * kRows, last = std::min(height, first + kRows);
      std::vector<Eigen::Vector3d> directions;
      directions.reserve(kRows * width);
      for (std::size_t v = first; v < last; ++v)
        for (std::size_t u = 0; u < width; ++u)
          directions.push_back(R * model.ray(static_cast<double>(u), static_cast<double>(v)));
      std::vector<double> depth(directions.size());
      // Directions have z = 1 in the camera frame, so the ray's parameter is the depth.
      cast_bundle(scene, origin, directions, reach(), depth);
      for (std::size_t i = 0; i < depth.size(); ++i) {
        double d = depth[i];
        for (const Sphere& s : near)
          if (const auto t = intersect_sphere(origin, directions[i], s); t && *t < d) d = *t;
        float& pixel = image.depth[first * width + i];
        if (d > reach())
          pixel = beyond_range();
        else
          pixel = d < model.min_range ? 0.0F : static_cast<float>(d);
      }
    });
    noise(model, image, random, threads);
    return image;
  }
};
}  // namespace surfleet
