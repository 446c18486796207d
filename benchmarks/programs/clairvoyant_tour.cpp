// SPDX-License-Identifier: MIT
// requires: inspection
// What knowing nothing costs: the coverage tour of the known scene beside a mission's path.
//
//   clairvoyant_tour --scene powerplant --coverage 0.9 --coverage 0.95
//
// Prints one JSON object a line: the share that was asked for, the share that was seen, the share
// that a mission on the same tour would have reported, the length.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "support/cli.hpp"
#include "support/inspection.hpp"
#include "support/inspection_report.hpp"

#include <surfleet/adapters/embree_ray_caster.hpp>
#include <surfleet/fleet/coverage_tour.hpp>
#include <surfleet/simulation/mesh_map.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;

/// What a drone that flies the tour at its nominal speed, and takes images all the while, has in
/// its map, by the mission's own probe.
double coverage_in_map(const CoverageTour& tour, const InspectionSettings& s,
                       const InspectionSite& site, const MissionOptions& mission) {
  const DroneWorld<EmbreeRayCaster> world = site.world(s);
  TsdfIntegrator<DropOffWeight<>> integrate = mission_integrator(mission);
  TsdfMap map({.voxel_size = mission.voxel_size});
  std::uint64_t shot = 0;
  const auto look = [&](const Configuration& q) {
    integrate(world.capture(0, shot++, std::span(&q, 1)), mission.camera,
              q.pose() * mission.T_body_camera, map);
  };
  const double spacing = mission.limits.speed * mission.image_period;
  Point3 at = tour.path.front();
  for (const Configuration& q : tour.looks) {
    const double images = std::max(1.0, std::round((q.position - at).norm() / spacing));
    for (double k = 1.0; k < images; ++k) look({at + (q.position - at) * (k / images), q.yaw});
    look(q);
    at = q.position;
  }
  return CoverageProbe(site, half_voxel_diagonal(s.voxel))(map);
}

int run(int argc, char** argv) {
  cli::Options app(
      "The coverage tour of a known scene: a yardstick for planners that do not know it.");
  InspectionOptions options(app);
  std::vector<double> coverages{0.9, 0.95};
  CoverageTourOptions tour_options;
  double density = 2.0;
  app.add("--coverage", coverages, "shares to be seen");
  app.add("--spacing", tour_options.spacing, "lattice of candidates [m]");
  app.add("--stop-cost", tour_options.stop_cost, "[m]");
  app.add("--density", density, "samples per square metre");
  app.parse(argc, argv);
  InspectionSettings s = options.settle();
  s.robots = 1;
  InspectionSite site(open_scene(s), s);
  const Configuration start = site.starts(s, 1).front();
  site.find_reference(s, start.position);

  // The same free space and roadmap as a mission's, on the map a perfect survey would give.
  const TsdfMap map = map_from_mesh(site.space.surface(), site.scene.bounds, s.voxel);
  const VoxelStateMap states(map, {.known_weight = s.known_weight});
  const MissionOptions mission = mission_options(s, site);
  const FreeSpace space(
      states,
      {.radius = s.radius, .bounds = mission.bounds, .margin = 0.0, .keep_out = mission.keep_out});
  LazyPrmStar roadmap(space, {.seed = s.seed});

  const SurfaceSamples all = sample_surface(site.scene.structure(), {.density = density});
  std::vector<Point3> points;
  std::vector<Eigen::Vector3d> normals;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (site.scene.region.contains(all.cloud.points[i])) {
      points.push_back(all.cloud.points[i]);
      normals.push_back(all.cloud.normals[i].cast<double>());
    }
  const std::vector<double> areas(points.size(), all.area_per_sample);
  for (const double coverage : coverages) {
    CoverageTourOptions o = tour_options;
    o.coverage = coverage;
    const auto before = std::chrono::steady_clock::now();
    const CoverageTour tour = plan_coverage_tour({points, normals, areas}, site.caster, space,
                                                 roadmap, site.camera, start, o);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    const nlohmann::json line{{"scene", site.scene.name},
                              {"asked", coverage},
                              {"coverage", tour.coverage()},
                              {"coverage_in_map", coverage_in_map(tour, s, site, mission)},
                              {"length_m", tour.length},
                              {"viewpoints", tour.viewpoints.size()},
                              {"reachable_m2", tour.reachable_area},
                              {"seconds", seconds}};
    std::printf("%s\n", line.dump().c_str());
    std::fflush(stdout);
  }
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("clairvoyant_tour", [&] { return run(argc, argv); });
}
