// SPDX-License-Identifier: MIT
#include <surfleet/simulation/depth_camera.hpp>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
PinholeCamera test_camera() {
  return PinholeCamera::from_fov(radians(90), radians(60), 64, 43, 1.6, 8.0);
}
/// A wall x = `x`, seen by a camera at the origin with its optical axis along +x.
TriangleMesh wall(double x) {
  TriangleMesh mesh;
  mesh.vertices = {{x, -50, -50}, {x, 50, -50}, {x, 50, 50}, {x, -50, 50}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return mesh;
}
/// A model of the bare concept.
struct ArchetypeCaster {
  const Bvh& bvh;
  std::optional<RayHit> cast(const Point3& o, const Eigen::Vector3d& d, double t) const {
    return bvh.cast(o, d, t);
  }
};
static_assert(RayCaster<ArchetypeCaster> && !BundleRayCaster<ArchetypeCaster>);
static_assert(!RayCaster<int> && !DepthNoise<int>);
}  // namespace

TEST(depth_is_measured_along_the_axis) {
  const Bvh bvh(wall(4.0));
  const DepthCamera<> camera(test_camera());
  const DepthImage image = camera.capture(ArchetypeCaster{bvh}, forward_camera_mount());
  for (const float d : image.depth) CHECK_NEAR(d, 4.0, 1e-5);
}

TEST(depth_out_of_range) {
  const DepthCamera<> camera(test_camera());
  const DepthImage far = camera.capture(Bvh(wall(8.1)), forward_camera_mount());
  for (const float d : far.depth) {
    CHECK_NEAR(d, 8.1, 1e-5);
    CHECK(d > 8.0F && DepthImage::is_measurement(d));
  }
  const DepthImage farther = camera.capture(Bvh(wall(10.1)), forward_camera_mount());
  for (const float d : farther.depth)
    CHECK(d == camera.beyond_range() && d > 8.0F && DepthImage::is_measurement(d));
  const DepthImage near = camera.capture(Bvh(wall(1.5)), forward_camera_mount());
  for (const float d : near.depth) CHECK(d == 0.0F);
  const DepthImage nothing = camera.capture(Bvh(), forward_camera_mount());
  for (const float d : nothing.depth) CHECK(d == camera.beyond_range());
}

TEST(no_surface_at_the_end_of_the_range) {
  // Open space, viewed from one place: nothing in it is near a surface.
  const DepthCamera<> camera(test_camera());
  TsdfMap map({.voxel_size = 0.25});
  TsdfIntegrator<> integrate({.truncation = 0.75});
  for (int i = 0; i < 3; ++i)
    integrate(camera.capture(Bvh(), forward_camera_mount()), camera.model, forward_camera_mount(),
              map);
  std::size_t seen = 0;
  map.for_each_block([&](const TsdfMap::Block& block) {
    for (const TsdfVoxel& voxel : block.voxels) {
      if (voxel.weight <= 0.0F) continue;
      ++seen;
      CHECK(voxel.distance > 0.7F);
    }
  });
  CHECK(seen > 1000);
}

TEST(teammates_are_seen_as_bodies) {
  const Bvh bvh(wall(6.0));
  const DepthCamera<> camera(test_camera());
  const Sphere mate{{4, 0, 0}, 1.0}, behind{{-4, 0, 0}, 1.0}, around{{0, 0, 0}, 1.0},
      far{{400, 0, 0}, 1.0}, hidden{{9, 0, 0}, 1.0};
  const std::vector<Sphere> mates{behind, mate, around, far, hidden};
  const DepthImage image = camera.capture(bvh, forward_camera_mount(), mates);
  int on_body = 0;
  for (int v = 0; v < image.height; ++v)
    for (int u = 0; u < image.width; ++u) {
      const Eigen::Vector3d ray = camera.model.ray(u, v);
      const Point3 p = forward_camera_mount() * Point3(ray * static_cast<double>(image(u, v)));
      const double to_body = std::abs((p - mate.center).norm() - 1.0);
      const bool hits = to_body < 1e-5;
      on_body += hits ? 1 : 0;
      CHECK(hits || std::abs(p.x() - 6.0) < 1e-5);
    }
  CHECK(on_body > 100);
  CHECK_NEAR(image(32, 21), 3.0, 0.01);
}

TEST(threads_and_seeds) {
  const Bvh bvh(make_sphere({5, 0, 0}, 2.0));
  DepthCamera<StereoNoise> camera(test_camera());
  const Pose T = forward_camera_mount();
  const DepthImage one = camera.capture(bvh, T, {}, Random(5));
  camera.threads = 3;
  CHECK(camera.capture(bvh, T, {}, Random(5)).depth == one.depth);
  CHECK(camera.capture(bvh, T, {}, Random(6)).depth != one.depth);
}

TEST(stereo_noise_has_its_deviation) {
  StereoNoise noise;
  CHECK_NEAR(noise.deviation(8.0), 0.1 / (376 * 0.11) * 64, 1e-12);
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(60), radians(60), 200, 200, 0.5, 8.0);
  for (const double z : {2.0, 5.0})
    for (const bool smooth : {false, true}) {
      noise.smooth = smooth;
      DepthImage image(200, 200, static_cast<float>(z));
      noise(camera, image, Random(9), 1);
      double sum = 0.0, sum2 = 0.0;
      for (const float d : image.depth) {
        sum += static_cast<double>(d) - z;
        sum2 += std::pow(static_cast<double>(d) - z, 2);
      }
      const auto n = static_cast<double>(image.depth.size());
      // Binomial weights leave (6/16)² of the variance.
      const double expected = noise.deviation(z) * (smooth ? 6.0 / 16.0 : 1.0);
      CHECK_NEAR(sum / n, 0.0, 0.05 * expected);
      CHECK_NEAR(std::sqrt(sum2 / n), expected, 0.03 * expected);
    }
}

TEST(stereo_noise_keeps_edges_and_invalid_pixels) {
  const StereoNoise noise;
  const PinholeCamera camera = PinholeCamera::from_fov(radians(60), radians(60), 60, 60, 0.5, 8.0);
  DepthImage image(60, 60);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 60; ++u)
      image(u, v) = v < 10 ? 0.0F : (v < 20 ? 8.08F : (u < 30 ? 2.0F : 5.0F));
  const DepthImage before = image;
  noise(camera, image, Random(4), 1);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 60; ++u) {
      if (v < 20) CHECK(image(u, v) == before(u, v));
      if (v >= 20) CHECK_NEAR(image(u, v), before(u, v), 6.0 * noise.deviation(5.0));
      CHECK(image(u, v) <= 8.0F || image(u, v) == before(u, v));
    }
  DepthImage at_limit(60, 60, 8.0F);
  noise(camera, at_limit, Random(4), 1);
  for (const float d : at_limit.depth) CHECK(d <= 8.0F && d > 7.0F);
}
