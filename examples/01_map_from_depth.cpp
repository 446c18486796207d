// SPDX-License-Identifier: MIT
// Depth images with poses become a TSDF map, and the map a mesh.
#include <cmath>
#include <cstdio>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>
#include <surfleet/simulation/depth_camera.hpp>

using namespace surfleet;

int main() {
  // Stand-ins for your sensor: a box, and a camera that is carried round it.
  const Bvh world(make_box({Point3(-1, -1, -1), Point3(1, 1, 1)}));
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(70.0), radians(60.0), 160, 120, 0.5, 6.0);
  const DepthCamera<NoNoise> sensor(camera);

  TsdfMap map{{.voxel_size = 0.1}};
  TsdfIntegrator<InverseSquareWeight, ProjectiveUpdate> integrate{{.truncation = 0.3}};
  for (int k = 0; k < 24; ++k) {
    const double angle = k * kPi / 12.0;
    const Configuration place{{3.5 * std::cos(angle), 3.5 * std::sin(angle), k % 2 ? 2.0 : -2.0},
                              angle + kPi};
    const Pose T_world_camera = place.pose() * forward_camera_mount(k % 2 ? 0.5 : -0.5);
    integrate(sensor.capture(world, T_world_camera), camera, T_world_camera, map);
  }
  const TriangleMesh mesh = extract_mesh(map, {.min_weight = 0.1F});
  std::printf("%zu triangles, %.1f m2; the box has 24 m2\n", mesh.triangles.size(), mesh.area());
  return std::abs(mesh.area() - 24.0) < 1.5 ? 0 : 1;
}
