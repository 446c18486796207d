// SPDX-License-Identifier: MIT
#include <surfleet/adapters/embree_ray_caster.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/depth_camera.hpp>
#include <surfleet/simulation/house.hpp>

#include "check.hpp"

using namespace surfleet;

TEST(embree_agrees_with_the_bvh) {
  const Point3 far(4000, -7000, 100);  // beyond what single precision could hold at 1 mm
  TriangleMesh mesh = make_torus({0, 0, 0}, 3.0, 1.0, 64, 32);
  append(mesh, make_box({-1, -1, -2}, {1, 1, 2}));
  for (Point3& v : mesh.vertices) v += far;
  const Bvh bvh(mesh);
  const EmbreeRayCaster embree(mesh);
  Random random(1);
  int hits = 0, misses = 0, disagree = 0;
  for (int i = 0; i < 4000; ++i) {
    const Point3 origin =
        far + Point3(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-6, 6));
    const Eigen::Vector3d d(random.normal(), random.normal(), random.normal());
    const double t_max = i % 2 == 0 ? std::numeric_limits<double>::infinity() : 2.0;
    const auto a = bvh.cast(origin, d, t_max), b = embree.cast(origin, d, t_max);
    if (a.has_value() != b.has_value()) {
      ++disagree;  // a grazing ray
    } else if (a && b) {
      ++hits;
      disagree += std::abs(a->t - b->t) * d.norm() > 1e-4 ? 1 : 0;
    } else {
      ++misses;
    }
  }
  CHECK(hits > 300 && misses > 300 && disagree <= 2);
}

TEST(embree_bundles_of_any_length) {
  const TriangleMesh mesh = make_sphere({0, 0, 0}, 2.0);
  const EmbreeRayCaster embree(mesh);
  Random random(2);
  for (const std::size_t n : {0UL, 1UL, 15UL, 16UL, 17UL, 100UL}) {
    std::vector<Eigen::Vector3d> directions;
    for (std::size_t i = 0; i < n; ++i)
      directions.emplace_back(-1.0, random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6));
    std::vector<double> t(n);
    embree.cast_bundle({5, 0, 0}, directions, 100.0, t);
    for (std::size_t i = 0; i < n; ++i) {
      const auto one = embree.cast({5, 0, 0}, directions[i], 100.0);
      CHECK(one ? std::abs(one->t - t[i]) < 1e-5 : std::isinf(t[i]));
    }
  }
}

TEST(embree_gives_the_camera_the_same_image) {
  const Scene scene = house_scene();
  const PinholeCamera model = PinholeCamera::from_fov(radians(90), radians(60), 160, 107, 1.6, 8.0);
  const Pose T = scene.station.pose() * forward_camera_mount(radians(10));
  const DepthImage a = DepthCamera<>(model).capture(Bvh(scene.mesh), T);
  const DepthImage b = DepthCamera<>(model).capture(EmbreeRayCaster(scene.mesh), T);
  int differ = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i)
    differ += std::abs(a.depth[i] - b.depth[i]) > 1e-4F ? 1 : 0;
  CHECK(differ <= 8);  // pixels on an edge may fall to either side
}

TEST(embree_of_nothing_finds_nothing) {
  const EmbreeRayCaster embree{TriangleMesh{}};
  CHECK(!embree.cast({0, 0, 0}, {0, 0, 1}));
  std::vector<double> t(3);
  embree.cast_bundle({0, 0, 0}, std::vector<Eigen::Vector3d>(3, {0, 0, 1}), 10.0, t);
  for (const double x : t) CHECK(std::isinf(x));
}
