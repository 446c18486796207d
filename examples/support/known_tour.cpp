// SPDX-License-Identifier: MIT
#include "support/known_tour.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <surfleet/simulation/mesh_map.hpp>

namespace surfleet::examples {
KnownSitePlanner::KnownSitePlanner(const InspectionSettings& s, const InspectionSite& site,
                                   const Configuration& start, double density, double margin)
    : site_(&site),
      start_(start),
      mount_(s.T_body_camera()),
      pitches_(s.pitches()),
      map_(map_from_mesh(site.space.surface(), site.scene.bounds, s.voxel)),
      states_(map_, {.known_weight = s.known_weight}),
      space_(states_, {.radius = s.radius,
                       .bounds = mission_options(s, site).kind.bounds,
                       .margin = margin,
                       .keep_out = mission_options(s, site).kind.keep_out}),
      roadmap_(space_, {.seed = s.seed}) {
  roadmap_.densify();
  const double each = site.samples.area_per_sample;
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(1.0 / (density * each))));
  for (std::size_t i = 0; i < site.reference.size(); i += step) {
    points_.push_back(site.reference.points[i]);
    normals_.push_back(site.reference.normals[i].cast<double>());
  }
  areas_.assign(points_.size(), each * static_cast<double>(step));
}

CoverageTour KnownSitePlanner::plan(const CoverageTourOptions& options) {
  return plan_coverage_tour({points_, normals_, areas_}, site_->caster, space_, roadmap_,
                            site_->camera, start_, options, mount_, pitches_);
}

FlownTour fly_known_tour(const CoverageTour& tour, const InspectionSettings& s,
                         const InspectionSite& site, const Configuration& start, double hold) {
  const MissionOptions mission = mission_options(s, site);
  const DroneWorld<EmbreeRayCaster> world = site.world(s);
  const RobotKind& kind = mission.kind;
  SurfaceBelief belief(mission.belief, std::span(&kind, 1));
  FlownTour flown;
  flown.images = fly_tour(tour, start,
                          {.speed = kind.limits.speed,
                           .yaw_rate = kind.limits.yaw_rate,
                           .pitch_rate = kind.limits.pitch_rate,
                           .image_period = mission.agent.image_period,
                           .hold = hold});
  std::uint64_t shot = 0;
  for (const auto& [time, q] : flown.images)
    belief.integrate(world.capture(0, shot++, std::span(&q, 1)), kind.camera,
                     camera_pose(q, kind.T_body_camera));
  flown.reconstruction = reconstruction_of(belief.map(), s, site.scene.region);
  flown.evaluation = evaluate_mesh(s, site, flown.reconstruction);
  return flown;
}
}  // namespace surfleet::examples
