// SPDX-License-Identifier: MIT
#include <surfleet/geometry/camera_models.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Every pixel's ray falls on that pixel at any depth, and is a unit vector.
template <CameraModel Camera>
void lens_laws(const Camera& camera) {
  Random random(3);
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d px(random.uniform(0, camera.width - 1.0),
                             random.uniform(0, camera.height - 1.0));
    const Eigen::Vector3d ray = bearing(camera, px);
    CHECK_NEAR(ray.norm(), 1.0, 1e-12);
    const auto back = camera.project(random.uniform(0.1, 50.0) * ray);
    if (!back) continue;
    ++seen;
    CHECK_NEAR((*back - px).norm(), 0.0, 1e-8);
  }
  CHECK(seen > 1000);
}
struct ArchetypeCamera {
  int width = 10, height = 10;
  std::optional<Eigen::Vector2d> project(const Point3& p) const { return p.head<2>(); }
};
static_assert(CameraModel<ArchetypeCamera> && !CameraModel<int>);

TEST(lenses_undo_their_projection) {
  const auto pinhole = PinholeCamera::from_fov(radians(90), radians(65), 752, 480, 0.1, 10);
  lens_laws(pinhole);
  lens_laws(AnyCamera(pinhole));
  RadialTangentialCamera brown;
  lens_laws(brown);
  brown.radial = {-0.28, 0.07, -0.01};
  brown.tangential = {1e-3, -5e-4};
  lens_laws(brown);
  lens_laws(EquidistantCamera::from_fov(radians(190), 752, 480));
  auto fish = EquidistantCamera::from_fov(radians(150), 752, 480);
  fish.distortion = {-0.02, 0.003, -0.001, 0.0002};
  lens_laws(fish);
  lens_laws(AnyCamera(fish));
}
TEST(without_distortion_a_lens_is_a_pinhole) {
  const PinholeCamera pinhole;
  const RadialTangentialCamera brown;
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const Point3 p(random.normal(), random.normal(), random.normal());
    const auto a = pinhole.project(p), b = brown.project(p);
    CHECK(a.has_value() == b.has_value());
    if (a && b) CHECK_NEAR((*a - *b).norm(), 0.0, 1e-10);
  }
}
TEST(a_fish_eye_sees_beside_and_behind_itself) {
  const auto fish = EquidistantCamera::from_fov(radians(190), 752, 480);
  const auto behind = fish.project({std::sin(radians(94)), 0.0, std::cos(radians(94))});
  CHECK(behind.has_value());
  // The radius is proportional to the angle.
  CHECK_NEAR(behind->x() - 375.5, 94.0 / 190.0 * 752.0, 1e-9);
  CHECK(!fish.project({std::sin(radians(96)), 0.0, std::cos(radians(96))}));
  CHECK(!fish.project({0.0, 0.0, -1.0}));
  CHECK(!PinholeCamera().project({0.0, 0.0, -1.0}) &&
        !RadialTangentialCamera().project({0, 0, -1}));
}
TEST(a_folding_lens_shows_nothing_beyond_its_fold) {
  RadialTangentialCamera brown;
  brown.radial = {-0.3, 0.0, 0.0};  // grows up to r = 1.054
  brown.width = 4000;
  brown.cx = 2000;
  CHECK(brown.project({1.0, 0.0, 1.0}).has_value());
  CHECK(!brown.project({1.2, 0.0, 1.0}));
}
}  // namespace
