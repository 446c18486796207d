// SPDX-License-Identifier: MIT
// Two simulated drones reconstruct a box they know nothing of.
#include <cstdio>
#include <vector>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/mapping/surface_mesh.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/drone_world.hpp>
#include <surfleet/simulation/fly_mission.hpp>

using namespace surfleet;

int main() {
  const Bvh truth(make_box({Point3(-1.5, -1, 0), Point3(1.5, 1, 2)}));
  MissionOptions options;
  options.kind.camera = PinholeCamera::from_fov(radians(90.0), radians(60.0), 96, 55, 0.5, 4.0);
  options.kind.body_radius = 0.4;
  options.kind.bounds = Box3(Point3(-5, -5, -3), Point3(5, 5, 5));
  options.belief.voxel_size = 0.2;
  options.belief.region = Box3(Point3(-2, -1.5, -0.3), Point3(2, 1.5, 2.3));
  options.start_clearance = 1.9;
  const std::vector<Configuration> starts{{{-3.5, -1.0, 1.0}, 0.0}, {{-3.5, 1.0, 1.0}, 0.0}};

  DroneWorld<Bvh> world(truth, options.kind.camera, options.kind.T_body_camera);
  const FlownMission flown =
      fly_mission(options, world, starts, make_planner("surfleet", {.standoff = 2.0}));
  const TriangleMesh mesh = extract_surface(flown.map, {.min_weight = 0.3F});
  std::printf("%s after %.0f s and %.0f m, %.1f %% by its own account, %zu triangles\n",
              flown.result.complete ? "complete" : "ended early", flown.result.completion_time,
              flown.result.total_path_length(), 100.0 * flown.result.coverage.share(),
              mesh.triangles.size());
  return flown.result.complete && flown.result.coverage.share() > 0.95 ? 0 : 1;
}
