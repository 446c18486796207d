// SPDX-License-Identifier: MIT
#include <surfleet/planning/surface_belief.hpp>

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Images that an integrator really takes until the surface of a wall is known, `away` from it.
struct Images {
  std::size_t taken = 0, asked_for = 0;
};
Images images_of_a_wall(std::optional<AnyIntegrator> integrator, double away) {
  RobotKind kind;
  kind.camera = PinholeCamera::from_fov(radians(90), radians(60), 160, 92, 0.2, 12.0);
  kind.bounds = Box3(Point3::Constant(-20.0), Point3::Constant(20.0));
  SurfaceBelief belief({.voxel_size = 0.25, .integrator = std::move(integrator), .region = {}},
                       std::span<const RobotKind>(&kind, 1));
  const DepthImage wall(kind.camera.width, kind.camera.height, static_cast<float>(away));
  const VoxelIndex v = belief.known().grid().index_of({away - 0.02, 0.1, 0.1});
  Images images{.taken = 0, .asked_for = belief.images_needed(Point3::Zero(), v)};
  while (images.taken < 1000 && belief.known()(v) == VoxelState::unknown) {
    belief.integrate(wall, kind.camera, kind.T_body_camera);
    belief.update();
    ++images.taken;
  }
  return images;
}
/// A rule that the library does not have.
struct Cubic {
  double operator()(double, double range) const { return 4.0 / (range * range * range); }
};
TEST(images_needed_are_those_that_the_integrators_weight_takes) {
  const AnyIntegrator cubic = TsdfIntegrator({}, drop_off_by_voxels(0.25, Cubic{}));
  const AnyIntegrator constant =
      TsdfIntegrator({}, drop_off_by_voxels(0.25, ConstantWeight{.value = 1.0 / 32.0}));
  for (const double away : {1.5, 4.0, 9.0}) {
    for (const auto& integrator : {std::optional<AnyIntegrator>(), std::optional(cubic)}) {
      const Images images = images_of_a_wall(integrator, away);
      CHECK(images.asked_for >= images.taken && images.asked_for <= images.taken + 3);
    }
  }
  for (const double away : {1.5, 4.0}) {
    const Images images = images_of_a_wall(constant, away);
    CHECK(images.taken == 10 && images.asked_for == 12);
  }
  // Where one image would do for distances, hits still take a quarter of W_th z².
  const Images quick = images_of_a_wall(TsdfIntegrator({}, ConstantWeight{}), 9.0);
  CHECK(quick.taken == 1 && quick.asked_for == 2 + 6);
}
TEST(a_belief_integrates_by_its_own_settings) {
  const SurfaceBeliefOptions o =
      SurfaceBelief::checked({.voxel_size = 0.25,
                              .truncation = 0.5,
                              .tsdf = {.truncation = 8.0, .threads = 3},
                              .integrator = TsdfIntegrator({.truncation = 9.0}, ConstantWeight{}),
                              .region = {}});
  CHECK(o.integrator->options.truncation == 0.5 && o.integrator->options.threads == 3);
  const SurfaceBeliefOptions plain = SurfaceBelief::checked({.voxel_size = 0.25, .region = {}});
  CHECK(plain.integrator->options.truncation == 0.75);
  CHECK_THROWS(Error, SurfaceBelief::checked({.truncation = 0.0, .region = {}}));
  CHECK(plain.integrator->weight(-0.1, 4.0) == 1.0 / 16.0);
  CHECK(plain.integrator->weight(-0.375, 4.0) == 0.0);
  // A rule without weight never makes anything known; that is no reason to take images for ever.
  SurfaceBelief blind(
      {.voxel_size = 0.2, .integrator = TsdfIntegrator({}, ConstantWeight{0.0}), .region = {}},
      std::span<const RobotKind>(std::vector<RobotKind>(1)));
  CHECK(blind.images_needed(Point3::Zero(), {3, 0, 0}) == 1000000002);
}
}  // namespace
