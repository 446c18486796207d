// SPDX-License-Identifier: MIT
/// @file
/// @brief How a drone inspection is run and judged, for `drone_inspection`, its trials and the
/// clairvoyant benchmark.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "support/inspection_settings.hpp"

#include <surfleet/adapters/embree_ray_caster.hpp>
#include <surfleet/adapters/fcl_mesh_judge.hpp>
#include <surfleet/evaluation/reconstruction_metrics.hpp>
#include <surfleet/evaluation/surface_sampling.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/simulation/agreeing_judges.hpp>
#include <surfleet/simulation/drone_world.hpp>
#include <surfleet/simulation/fly_distributed.hpp>
#include <surfleet/simulation/fly_mission.hpp>
#include <surfleet/simulation/judge.hpp>
#include <surfleet/simulation/lidar_world.hpp>
#include <surfleet/simulation/mission.hpp>
#include <surfleet/simulation/scene.hpp>

namespace surfleet::examples {
/// Opens a bundled scene or a mesh file. Throws `Error`.
Scene open_scene(const InspectionSettings& s);

/// A scene made ready: its geometry for rays and clearances, and the part a drone could see.
struct InspectionSite {
  Scene scene;
  SceneSpace space;
  Bvh structure;  ///< Without the ground.
  EmbreeRayCaster caster;
  MeshJudge judge;
  PinholeCamera camera;          ///< That drones see with, if they do.
  SurfaceSamples samples;        ///< Of the structure in the region.
  PointCloud reference;          ///< What could be seen; normals to the sides it is seen from.
  double reference_share = 1.0;  ///< Of the samples.

  /// Throws `Error` where the region has nothing to be seen.
  InspectionSite(Scene s, const InspectionSettings& settings);

  /// Where so many drones start. Throws `Error` if there is no room for them, or less of it free of
  /// the structure than the settings say.
  std::vector<Configuration> starts(const InspectionSettings& settings, int robots) const;

  /// What the drones' cameras or LiDARs see. The site must outlive it.
  DroneWorld<EmbreeRayCaster> world(const InspectionSettings& settings) const;
  LidarWorld<EmbreeRayCaster> lidar_world(const InspectionSettings& settings) const;

  /// Finds what could have been seen from `start`: slow, and needed for the judgement alone. Throws
  /// `Error` if that is nothing.
  void find_reference(const InspectionSettings& settings, const Point3& start);
};

MissionOptions mission_options(const InspectionSettings& s, const InspectionSite& site);

/// What is handed over of a map, and judged, while a mission is under way and at its end: the
/// surface of what it knows at W_th, cut to the region.
TriangleMesh reconstruction_of(const TsdfMap& map, const InspectionSettings& s, const Box3& region);
/// The same with the points that it is made beside, cut alike.
struct MappedSurface {
  TriangleMesh mesh;
  PointCloud points;
};
MappedSurface mapped_surface(const TsdfMap& map, const InspectionSettings& s, const Box3& region);

/// A finished mission and what it brought back.
struct InspectionRun {
  MissionResult result;
  std::optional<DistributedResult> distributed;  ///< All of it but the mission, if it was.
  TsdfMap map;
  TriangleMesh reconstruction;     ///< Cut to the region, without the ground.
  PointCloud points;               ///< Of the surface, beside the mesh, cut as it is.
  double wall_time = 0.0;          ///< Of the mission alone [s].
  std::size_t mission_memory = 0;  ///< The process's largest until the mission's end [bytes].

  std::vector<std::vector<Point3>> paths() const;  ///< One a robot.
};
/// How good that is, against the true scene.
struct InspectionJudgement {
  ReconstructionEvaluation evaluation;          ///< Of the mesh.
  std::optional<ReconstructionMetrics> points;  ///< Of the points, if there are any.
  /// Share of what the images met that the mesh covers: what the mission's own account guesses.
  double coverage_of_met = 0.0;
  JudgeReport paths;              ///< By the lesser distance of two judges.
  double disagreement = 0.0;      ///< Of the two, the largest [m].
  std::size_t disagreements = 0;  ///< Where they are not to be trusted.
  int keep_out_violations = 0;    ///< Times that a body came into a closed box.
};

/// What a mission takes from files beside its scene.
struct InspectionInputs {
  std::optional<TsdfMap> begun;  ///< The map that is gone on from, if any.
  DistributedOptions distributed;
};
/// Throws `Error` for files that cannot be used.
InspectionInputs read_inputs(const InspectionSettings& s);

/// `wall_time` leaves out what `progress` takes.
InspectionRun run_inspection(const InspectionSettings& s, const InspectionSite& site,
                             const MissionWatch& progress, const InspectionInputs& inputs = {});
/// The errors of `mesh` against the site's reference, which must have been found.
ReconstructionEvaluation evaluate_mesh(const InspectionSettings& s, const InspectionSite& site,
                                       const TriangleMesh& mesh);
/// The site's reference must have been found.
InspectionJudgement judge_inspection(const InspectionSettings& s, const InspectionSite& site,
                                     const InspectionRun& run);
}  // namespace surfleet::examples
