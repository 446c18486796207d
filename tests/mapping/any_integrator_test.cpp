// SPDX-License-Identifier: MIT
#include <surfleet/mapping/any_integrator.hpp>

#include <cmath>
#include <utility>
#include <vector>

#include "check.hpp"

#include <surfleet/mapping/tsdf_map.hpp>

using namespace surfleet;

namespace {
/// A rule and an update that offer the bare minimum.
struct Halves {
  double operator()(double, double range) const { return 0.5 / range; }
};
struct CountsCalls {
  int calls = 0;
  std::size_t operator()(const auto&, const auto&, const TsdfOptions&, TsdfMap&) {
    return static_cast<std::size_t>(++calls);
  }
};
static_assert(UpdatePolicy<CountsCalls>);

/// The typed integrator and the same one behind `AnyIntegrator` make equal maps.
template <WeightPolicy Weight, UpdatePolicy Update>
void equals_the_typed_one(const Weight& weight) {
  const PinholeCamera camera = PinholeCamera::from_fov(radians(80), radians(60), 40, 28, 0.2, 4.0);
  DepthImage image(camera.width, camera.height, 2.0F);
  std::vector<Point3> points;
  for (int i = 0; i < 60; ++i)
    for (int k = 0; k < 40; ++k)
      points.push_back({2.0, std::sin(0.05 * (i - 30)), 0.05 * (k - 20)});
  TsdfMap one({.voxel_size = 0.1}), other({.voxel_size = 0.1});
  TsdfIntegrator<Weight, Update> typed({.truncation = 0.3}, weight);
  AnyIntegrator any = TsdfIntegrator<Weight, Update>({.truncation = 0.7}, weight);
  any.options.truncation = 0.3;
  const Pose T_camera = forward_camera_mount(), T = Pose::Identity();
  CHECK(typed(image, camera, T_camera, one) == any(image, camera, T_camera, other));
  CHECK(equal_maps(one, other) && one.block_count() > 0);
  CHECK(typed(points, 0.1, 4.0, T, one) == any(points, 0.1, 4.0, T, other));
  CHECK(equal_maps(one, other));
  for (const double z : {0.5, 3.0}) CHECK(any.weight(-0.05, z) == typed.weight(-0.05, z));
}
TEST(any_integrator_does_as_the_typed_one) {
  equals_the_typed_one<DropOffWeight<>, ProjectiveUpdate>({});
  equals_the_typed_one<ConstantWeight, RayTraversalUpdate>({.value = 0.7});
  equals_the_typed_one<Halves, ProjectiveUpdate>({});
}
TEST(copies_of_an_integrator_are_its_own) {
  const PinholeCamera camera = PinholeCamera::from_fov(radians(80), radians(60), 40, 28, 0.2, 4.0);
  const DepthImage image(camera.width, camera.height, 2.0F);
  TsdfMap map({.voxel_size = 0.1});
  AnyIntegrator a = TsdfIntegrator<Halves, CountsCalls>();
  const auto call = [&](AnyIntegrator& i) { return i(image, camera, Pose::Identity(), map); };
  CHECK(call(a) == 1 && call(a) == 2);
  AnyIntegrator b = a;
  CHECK(call(a) == 3 && call(b) == 3 && call(b) == 4 && call(a) == 4);
  b = TsdfIntegrator({.truncation = 0.2}, ConstantWeight{});
  CHECK(b.weight(0.0, 7.0) == 1.0 && b.options.truncation == 0.2);
  CHECK_THROWS(Error, b(DepthImage(3, 3), camera, Pose::Identity(), map));
}
TEST(drop_offs_by_voxels_end_within_a_voxel_and_a_half) {
  const auto w = drop_off_by_voxels(0.25, ConstantWeight{.value = 3.0});
  CHECK(w(0.1, 5.0) == 3.0 && w(-0.25, 5.0) == 3.0 && w(-0.375, 5.0) == 0.0);
  CHECK_NEAR(w(-0.3125, 5.0), 1.5, 1e-12);
  CHECK_NEAR(drop_off_by_voxels(0.2)(0.0, 4.0), 1.0 / 16.0, 1e-12);
}
}  // namespace
