// SPDX-License-Identifier: MIT
/// @file
/// @brief A small world for the fleet's tests: a box in empty space, seen without noise.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/simulation/mission.hpp>

namespace box_world {
inline surfleet::Box3 box() {
  return {surfleet::Point3(-1.5, -1.0, 0.0), surfleet::Point3(1.5, 1.0, 2.0)};
}

struct World {
  surfleet::TriangleMesh mesh = surfleet::make_box(box());
  surfleet::Bvh bvh{mesh};
  surfleet::PinholeCamera camera = surfleet::PinholeCamera::from_fov(
      surfleet::radians(90.0), surfleet::radians(60.0), 48, 28, 0.5, 4.0);

  surfleet::DepthImage capture(std::size_t robot, std::uint64_t /*shot*/,
                               std::span<const surfleet::Configuration> fleet) const {
    const surfleet::Pose T = surfleet::camera_pose(fleet[robot], surfleet::forward_camera_mount());
    surfleet::DepthImage image(camera.width, camera.height,
                               static_cast<float>(camera.max_range * 2.0));
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u)
        if (const auto hit = bvh.cast(T.translation(), T.linear() * camera.ray(u, v), 4.0))
          image(u, v) = static_cast<float>(hit->t);
    return image;
  }
  bool sees(const surfleet::Point3& a, const surfleet::Point3& b) const {
    return surfleet::is_clear_segment(bvh, a, b);
  }
};

/// A patch of one wall that no image shows.
struct Glass : World {
  surfleet::DepthImage capture(std::size_t robot, std::uint64_t shot,
                               std::span<const surfleet::Configuration> fleet) const {
    surfleet::DepthImage image = World::capture(robot, shot, fleet);
    const surfleet::Pose T = surfleet::camera_pose(fleet[robot], surfleet::forward_camera_mount());
    for (int v = 0; v < image.height; ++v)
      for (int u = 0; u < image.width; ++u) {
        const double depth = image(u, v);
        if (!(depth > 0.0) || depth > camera.max_range) continue;
        const surfleet::Point3 p = T * (camera.ray(u, v) * depth);
        if (std::abs(p.y()) < 0.5 && std::abs(p.z() - 1.0) < 0.4 && p.x() < 0.0) image(u, v) = 0.0F;
      }
    return image;
  }
};

inline surfleet::MissionOptions options(const World& world) {
  surfleet::MissionOptions o;
  o.kind.camera = world.camera;
  o.belief.voxel_size = 0.2;
  o.belief.truncation = 0.6;
  o.kind.body_radius = 0.4;
  o.start_clearance = 1.9;  // as far as it takes until the image is as high as the body
  o.kind.limits.speed = 1.0;
  o.belief.region =
      surfleet::Box3(surfleet::Point3(-2.0, -1.5, -0.3), surfleet::Point3(2.0, 1.5, 2.3));
  o.kind.bounds =
      surfleet::Box3(surfleet::Point3(-5.0, -5.0, -3.0), surfleet::Point3(5.0, 5.0, 5.0));
  o.max_time = 600.0;
  return o;
}

/// The share of the box's surface that a voxel of known weight lies within 0.2 m of.
inline double mapped_share(const World& world, const surfleet::TsdfMap& map, double min_weight) {
  const surfleet::Bvh mapped(surfleet::extract_mesh(map, {.min_weight = min_weight}));
  double near = 0.0, all = 0.0;
  for (std::size_t t = 0; t < world.mesh.triangles.size(); ++t)
    for (double u = 0.05; u < 1.0; u += 0.1)
      for (double v = 0.05; u + v < 1.0; v += 0.1) {
        const surfleet::Point3 p = world.mesh.corner(t, 0) * (1.0 - u - v) +
                                   world.mesh.corner(t, 1) * u + world.mesh.corner(t, 2) * v;
        all += 1.0;
        near += mapped.distance(p) < 0.2 ? 1.0 : 0.0;
      }
  return near / all;
}

/// For robots that see with that in place of a camera.
inline surfleet::LidarModel lidar() {
  return {.azimuths = 120,
          .elevations = 31,
          .lowest = surfleet::radians(-40.0),
          .highest = surfleet::radians(40.0),
          .min_range = 0.3,
          .max_range = 6.0};
}

inline std::vector<surfleet::Configuration> starts(int n) {
  std::vector<surfleet::Configuration> list;
  for (int i = 0; i < n; ++i) list.push_back({surfleet::Point3(-3.5, -1.0 + 1.5 * i, 1.0), 0.0});
  return list;
}
}  // namespace box_world
