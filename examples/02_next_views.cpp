// SPDX-License-Identifier: MIT
// From what one place shows: where the surface is incomplete, and the viewpoints for it.
#include <cstdio>
#include <vector>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>
#include <surfleet/simulation/depth_camera.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/viewpoint_clustering.hpp>
#include <surfleet/viewpoint/viewpoint_generation.hpp>

using namespace surfleet;

int main() {
  // Stands for your sensor.
  const Bvh world(make_box({Point3(-3, -2, 0), Point3(3, 2, 4)}));
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(90.0), radians(60.0), 160, 92, 0.5, 8.0);
  const Pose T_world_camera = Configuration{{-7.0, 0.5, 2.0}, 0.0}.pose() * forward_camera_mount();
  const DepthImage depth_image = DepthCamera<NoNoise>(camera).capture(world, T_world_camera);

  TsdfMap map{{.voxel_size = 0.2}};  // VoxelGrid<TsdfVoxel>
  TsdfIntegrator<InverseSquareWeight, ProjectiveUpdate> integrate{{.truncation = 0.6}};
  for (int shot = 0; shot < 8; ++shot) integrate(depth_image, camera, T_world_camera, map);

  VoxelStateMap states{map, {.known_weight = 0.3}};
  IncompleteSurface incomplete{{.known_weight = 0.3}};
  incomplete.update(states);  // only the blocks that changed

  const auto views = generate_viewpoints(incomplete, states, camera, {.distance = 3.0});
  const auto clusters =
      cluster_viewpoints(views.views, {.radius = 0.5, .max_radius = 1.0, .max_extent = 2.0});

  std::printf("%zu elements of incomplete surface, %zu viewpoints, %zu clusters\n",
              incomplete.size(), views.views.size(), clusters.size());
  return clusters.size() > 1 && clusters.size() < views.views.size() ? 0 : 1;
}
