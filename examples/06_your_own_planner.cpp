// SPDX-License-Identifier: MIT
// A planner of your own beside the library's: each robot goes to the viewpoint nearest to it.
#include <cstdio>
#include <limits>
#include <vector>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/drone_world.hpp>
#include <surfleet/simulation/fly_mission.hpp>
#include <surfleet/viewpoint/viewpoint_generation.hpp>

using namespace surfleet;

Plan nearest_view(const SurfaceSituation& situation) {
  const KindSpace& space = situation.space();
  const SurfaceBelief& belief = situation.belief;
  Plan plan;
  for (const RobotId id : situation.asked) {
    const Point3& here = situation.robot(id).at.position;
    const auto reach = space.roadmap.reach_from(here);
    const auto views = generate_viewpoints(
        situation.goals, belief.observed(), space.kind.camera, {.distance = 2.0},
        [&](const Configuration& q) { return space.free.is_free(q.position); },
        [&](const Configuration& q) { return reach(q.position); },
        [&](const IncompleteElement& e, const Eigen::Vector3d& direction) {
          return belief.ledger().promises(e.voxel, direction);
        });
    Stops& route = plan.routes[id];
    double least = std::numeric_limits<double>::infinity();
    for (const Viewpoint& view : views.views) {
      const double d = (view.configuration.position - here).norm();
      if (d >= least) continue;
      least = d;
      const auto target = static_cast<std::size_t>(view.targets.front());
      route = {{view.configuration, {situation.goals[target].voxel}}};
    }
  }
  return plan;
}

int main() {
  const Bvh truth(make_box({Point3(-1.5, -1, 0), Point3(1.5, 1, 2)}));
  MissionOptions options;
  options.kind.camera = PinholeCamera::from_fov(radians(90.0), radians(60.0), 96, 55, 0.5, 4.0);
  options.kind.body_radius = 0.4;
  options.kind.bounds = Box3(Point3(-5, -5, -3), Point3(5, 5, 5));
  options.belief.voxel_size = 0.2;
  options.belief.region = Box3(Point3(-2, -1.5, -0.3), Point3(2, 1.5, 2.3));
  options.start_clearance = 1.9;
  const std::vector<Configuration> starts{{{-3.5, 0.0, 1.0}, 0.0}};
  DroneWorld<Bvh> world(truth, options.kind.camera, options.kind.T_body_camera);

  const FlownMission mine = fly_mission(options, world, starts, nearest_view);
  const FlownMission theirs =
      fly_mission(options, world, starts, make_planner("surfleet", {.standoff = 2.0}));
  for (const auto& [name, flown] :
       {std::pair("nearest view", &mine), std::pair("surfleet", &theirs)})
    std::printf("%-12s %5.0f m, %.1f %% by its own account\n", name,
                flown->result.total_path_length(), 100.0 * flown->result.coverage.share());
  return mine.result.complete && mine.result.coverage.share() > 0.9 ? 0 : 1;
}
