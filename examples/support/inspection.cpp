// SPDX-License-Identifier: MIT
#include "support/inspection.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "support/cli.hpp"
#include "support/fleet_files.hpp"
#include "support/peak_memory.hpp"
#include "support/recorded_world.hpp"

#include <surfleet/adapters/fcl_body_judge.hpp>
#include <surfleet/adapters/zstd_codec.hpp>
#include <surfleet/evaluation/observable_surface.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/mapping/map_file.hpp>
#include <surfleet/mapping/surface_mesh.hpp>
#include <surfleet/mapping/surface_points.hpp>
#include <surfleet/simulation/body_judge.hpp>
#include <surfleet/simulation/fly_mission.hpp>
#include <surfleet/simulation/marker_sight.hpp>
#include <surfleet/simulation/scenes.hpp>

namespace surfleet::examples {
namespace {
/// Points that both surfaces are sampled with at the most; larger scenes are sampled less densely.
constexpr double kMostSamples = 1e7;

EvaluationOptions evaluation_options(const InspectionSettings& s, double area) {
  EvaluationOptions e;
  e.e_max = half_voxel_diagonal(s.voxel);
  e.density = std::min(e.sampling_density(), kMostSamples / area);
  e.threads = s.threads;
  return e;
}
/// What lies in the region, some samples a voxel's face. Throws `Error` if that is nothing.
SurfaceSamples sample_region(const Scene& scene, double voxel) {
  const TriangleMesh structure = scene.structure();
  const double density = std::min(3.0 / (voxel * voxel), kMostSamples / structure.area());
  const SurfaceSamples all = sample_surface(structure, {.density = density});
  std::vector<std::uint8_t> inside(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    inside[i] = scene.region.contains(all.cloud.points[i]) ? 1 : 0;
  SurfaceSamples kept = select(all, inside);
  require(kept.size() > 0, scene.name + ": no surface in the region; expected --bounds around it");
  return kept;
}
}  // namespace

Scene open_scene(const InspectionSettings& s) {
  const bool bundled = is_scene_name(s.scene);
  std::optional<Box3> bounds;
  if (!s.bounds.empty()) bounds = cli::box_from_numbers(s.bounds, "--bounds");
  std::optional<Point3> start;
  if (!s.start.empty()) start = Point3(s.start[0], s.start[1], s.start[2]);
  if (!bundled) {
    SceneOptions o;
    o.name = std::filesystem::path(s.scene).filename().string();
    o.bounds = bounds;
    o.start = start;
    o.ground = s.ground;
    o.standoff = std::max(s.sensor_range(), 3.0 * s.radius);
    o.radius = s.radius;
    o.depth = s.depth();
    o.margin = s.margin;
    o.start_clearance = s.known_around_start();
    o.floor = s.floor;
    o.keep_out = s.keep_out;
    return scene_from_mesh(read_mesh(s.scene), o);
  }
  require(!s.ground, "--ground: a bundled scene has its own; expected a mesh file as --scene");
  Scene scene = scene_by_name(s.scene);
  if (bounds) scene.bounds = *bounds;
  scene.keep_out = s.keep_out;
  if (start) {
    const SceneSpace space(scene.mesh);
    require(scene.bounds.contains(*start) && space.is_free(*start, s.radius),
            "--start: inside an obstacle or outside the flight space; expected a place with " +
                std::to_string(s.radius) + " m around it");
    scene.station.position = *start;
  }
  require(s.keep_out.distance(scene.station.position) >= s.radius,
          "--keep-out: the start is in a box or beside it; expected a --start with " +
              std::to_string(s.radius) + " m around it");
  if (s.floor) set_floor(scene, *s.floor, s.depth());
  return scene;
}

InspectionSite::InspectionSite(Scene s, const InspectionSettings& settings)
    : scene(std::move(s)),
      space(scene.mesh),
      structure(scene.structure()),
      caster(scene.mesh),
      judge(scene.mesh),
      samples(sample_region(scene, settings.voxel)) {
  const double ratio =
      std::tan(0.5 * radians(settings.fov[1])) / std::tan(0.5 * radians(settings.fov[0]));
  const int height = std::max(12, static_cast<int>(std::lround(settings.image_width * ratio)));
  camera =
      PinholeCamera::from_fov(radians(settings.fov[0]), radians(settings.fov[1]),
                              settings.image_width, height, settings.nearest, settings.farthest);
}

std::vector<Configuration> InspectionSite::starts(const InspectionSettings& settings,
                                                  int robots) const {
  return starting_places(scene, space, structure, robots,
                         {.radius = settings.radius,
                          .margin = settings.margin,
                          .spacing = starting_distance(settings.radius, settings.margin),
                          .clearance = settings.known_around_start()});
}

DroneWorld<EmbreeRayCaster> InspectionSite::world(const InspectionSettings& s) const {
  return {caster,
          camera,
          s.T_body_camera(),
          {.noise = s.noise, .stereo = s.stereo, .body_radius = 0.5 * s.radius, .seed = s.seed}};
}

LidarWorld<EmbreeRayCaster> InspectionSite::lidar_world(const InspectionSettings& s) const {
  return {
      caster,
      RotatingLidar(s.lidar, s.noise ? s.lidar_noise : 0.0),
      {.place = s.T_body_camera().translation(), .body_radius = 0.5 * s.radius, .seed = s.seed}};
}

void InspectionSite::find_reference(const InspectionSettings& settings, const Point3& start) {
  const ReachableLattice lattice(space.surface(), {.bounds = scene.bounds,
                                                   .start = start,
                                                   .radius = settings.radius,
                                                   .spacing = 0.1 * settings.sensor_range(),
                                                   .keep_out = scene.keep_out});
  ObservabilityOptions o;
  o.camera = camera;
  o.T_body_camera = settings.T_body_camera();
  if (settings.has_lidar()) o.lidar = settings.lidar;
  o.threads = settings.threads;
  const ObservableSurface seen = observable_surface(samples.cloud, caster, lattice, o);
  reference = oriented_samples(samples.cloud, seen);
  reference_share = seen.fraction();
  require(!reference.points.empty(),
          scene.name +
              ": nothing can be seen from where the drones can get; expected another --start, "
              "--bounds, --range or --lidar-range");
}

namespace {
NeighbourSense neighbour_sense(const InspectionSettings& s, const InspectionSite& site) {
  if (s.neighbours == "exact") return {};
  if (s.neighbours == "none")
    return [](std::size_t, std::uint64_t, std::span<const Configuration>) {
      return std::vector<SeenRobot>{};
    };
  MarkerSightOptions o;
  o.target = printed_target(4.0 * s.radius);  // about as large as the body
  o.period = 1.0 / s.rate;
  o.seed = s.seed;
  return MarkerSight(site.caster, static_cast<std::size_t>(s.robots), o);
}
}  // namespace

MissionOptions mission_options(const InspectionSettings& s, const InspectionSite& site) {
  MissionOptions o;
  RobotKind& kind = o.kind;
  kind.camera = site.camera;
  kind.T_body_camera = s.T_body_camera();
  kind.pitches = s.pitches();
  if (s.shape) s.shape->give_to(kind);
  if (s.has_lidar()) carry(kind, s.lidar, kind.T_body_camera.translation());
  kind.body_radius = s.radius;
  kind.margin = s.margin;
  kind.unknown_margin = s.unknown_margin;
  kind.limits = s.limits;
  kind.bounds = site.scene.bounds;
  kind.keep_out = site.scene.keep_out;
  if (site.scene.has_ground)
    kind.bounds.min().z() =
        std::max(kind.bounds.min().z(), site.scene.ground_z + s.depth() + s.margin);
  o.belief.voxel_size = s.voxel;
  o.belief.known_weight = s.known_weight;
  o.belief.truncation = s.truncation;
  o.belief.integrator = s.integrator();
  o.belief.ledger.max_views = s.max_views;
  o.belief.region = site.scene.region;
  o.belief.seed = s.seed;
  o.agent.image_period = 1.0 / s.rate;
  if (s.utility_share) o.agent.utility_share = *s.utility_share;
  // Said by the operator, who knows the starting place, and held against the truth before the
  // mission begins: see `InspectionSite::starts`.
  o.start_clearance = s.known_around_start();
  o.neighbours = neighbour_sense(s, site);
  o.announces = s.announces;
  o.limits = s.end;
  o.max_time = s.max_time;
  o.threads = s.threads;
  return o;
}

TriangleMesh reconstruction_of(const TsdfMap& map, const InspectionSettings& s,
                               const Box3& region) {
  return cropped(extract_surface(map, {.min_weight = s.known_weight, .threads = s.threads}),
                 region);
}

MappedSurface mapped_surface(const TsdfMap& map, const InspectionSettings& s, const Box3& region) {
  const PointCloud points =
      extract_points(map, {.min_weight = s.known_weight, .threads = s.threads});
  return {
      cropped(extract_surface(map, points, {.min_weight = s.known_weight, .threads = s.threads}),
              region),
      cropped(points, region)};
}

InspectionInputs read_inputs(const InspectionSettings& s) {
  InspectionInputs in;
  if (!s.begun.empty()) {
    in.begun = load_map(std::filesystem::path(s.begun) / "map.sfm");
    require(in.begun->voxel_size() == s.voxel, "--continue " + s.begun + ": its voxels are of " +
                                                   std::to_string(in.begun->voxel_size()) +
                                                   " m; expected --voxel to say so");
  }
  DistributedOptions& o = in.distributed;
  o.network = network_conditions(s.network, s.robots, s.seed);
  o.events = fleet_events(s.events, s.robots);
  o.packer = ZstdPacker{};
  o.agent.patch_images = static_cast<std::uint32_t>(s.patch_images);
  o.agent.patch_distance = s.patch_distance;
  o.agent.memory_of_lost = s.wait_for_team;
  o.agent.redundancy.radius = 0.5 * s.cluster_radius;
  return in;
}

InspectionRun run_inspection(const InspectionSettings& s, const InspectionSite& site,
                             const MissionWatch& progress, const InspectionInputs& inputs) {
  const std::vector<Configuration> starts = site.starts(s, s.robots);
  InspectionRun run;
  {  // What the mission holds is given back before it is judged.
    std::optional<RecordedWorld<DroneWorld<EmbreeRayCaster>>> seen;
    std::optional<LidarWorld<EmbreeRayCaster>> scanned;
    if (s.has_lidar())
      scanned.emplace(site.lidar_world(s));
    else
      seen.emplace(site.world(s), s, site.camera, s.T_body_camera());
    const AnyWorld world = scanned ? AnyWorld(*scanned) : AnyWorld(*seen);
    using Clock = std::chrono::steady_clock;
    const auto before = Clock::now();
    Clock::duration watched{};
    MissionOptions options = mission_options(s, site);
    options.begun = inputs.begun ? &*inputs.begun : nullptr;
    const MissionWatch watch = [&](const MissionProgress& p, const TsdfMap& map) {
      const auto asked = Clock::now();
      const bool go_on = progress(p, map);
      watched += Clock::now() - asked;
      return go_on;
    };
    if (s.architecture == "distributed") {
      const auto planner = [&](RobotId) { return make_planner(s.planner, s.planner_settings()); };
      FlownDistributed flown =
          fly_distributed(options, inputs.distributed, world, starts, planner, watch);
      run.result = std::move(flown.result.mission);
      run.distributed = std::move(flown.result);
      run.map = std::move(flown.map);
    } else {
      FlownMission flown =
          fly_mission(options, world, starts, make_planner(s.planner, s.planner_settings()), watch);
      run.result = std::move(flown.result);
      run.map = std::move(flown.map);
    }
    run.wall_time = std::chrono::duration<double>(Clock::now() - before - watched).count();
    run.mission_memory = peak_memory();
  }
  MappedSurface surface = mapped_surface(run.map, s, site.scene.region);
  run.reconstruction = std::move(surface.mesh);
  run.points = std::move(surface.points);
  return run;
}

std::vector<std::vector<Point3>> InspectionRun::paths() const {
  std::vector<std::vector<Point3>> all;
  for (const auto& trajectory : result.trajectories) {
    all.emplace_back();
    for (const TimedConfiguration& t : trajectory) all.back().push_back(t.configuration.position);
  }
  return all;
}

ReconstructionEvaluation evaluate_mesh(const InspectionSettings& s, const InspectionSite& site,
                                       const TriangleMesh& mesh) {
  const TriangleMesh structure = site.scene.structure();
  const EvaluationOptions e = evaluation_options(s, std::max(structure.area(), mesh.area()));
  return evaluate(site.reference, MeasuredSurface::from(structure, e),
                  MeasuredSurface::from(mesh, e), e);
}

namespace {
/// The share of the reference that some ray ended at which the mesh covers.
double coverage_of_met(const InspectionSettings& s, const InspectionSite& site, const TsdfMap& map,
                       const ReconstructionEvaluation& mesh) {
  PointCloud met;
  map.for_each_block([&](const TsdfMap::Block& block) {
    for (const SurfaceHit& hit : block.layer.hits()) {
      if (hit.weight == 0) continue;
      met.points.push_back(map.center(TsdfMap::index_in(block, hit.voxel())) +
                           hit.mean_offset(map.voxel_size()));
      met.normals.push_back(hit.mean_normal().cast<float>());
    }
  });
  if (met.points.empty()) return 0.0;
  const double e_max = half_voxel_diagonal(s.voxel);
  const OrientedCoverage near = oriented_coverage(site.reference, OrientedSurface(met),
                                                  {.e_max = e_max, .threads = s.threads});
  std::size_t all = 0, covered = 0;
  for (std::size_t i = 0; i < near.distance.size(); ++i) {
    if (near.distance[i] > e_max) continue;
    ++all;
    covered += mesh.facing_distance[i] <= e_max ? 1 : 0;
  }
  return all == 0 ? 0.0 : static_cast<double>(covered) / static_cast<double>(all);
}

/// A robot that has left the mission has no place for the rest of it.
void end_of_lost(std::vector<std::vector<Point3>>& paths, std::span<const RobotId> lost) {
  std::size_t instants = 0;
  for (const auto& path : paths) instants = std::max(instants, path.size());
  for (const RobotId r : lost) paths[r].resize(instants, Point3::Constant(JudgeReport::kNone));
}

/// Puts what befell the true shape in the place of what would have befallen the ball around it.
void judge_shape(const InspectionSettings& s, const InspectionSite& site, const InspectionRun& run,
                 InspectionJudgement& judged) {
  std::vector<std::vector<Configuration>> flown;
  for (const auto& trajectory : run.result.trajectories) {
    flown.emplace_back();
    for (const TimedConfiguration& t : trajectory) flown.back().push_back(t.configuration);
  }
  const FclBody body = s.shape->judged();
  judge_bodies(FclBodyJudge(site.judge, body), flown, s.shape->radius(), judged.paths);
  judged.keep_out_violations = 0;
  for (const Box3& box : site.scene.keep_out.boxes) {
    const MeshJudge closed(make_box(box));
    JudgeReport report;
    judge_bodies(FclBodyJudge(closed, body), flown, s.shape->radius(), report);
    judged.keep_out_violations += report.collisions_with_scene;
  }
}
}  // namespace

InspectionJudgement judge_inspection(const InspectionSettings& s, const InspectionSite& site,
                                     const InspectionRun& run) {
  const AgreeingJudges both(site.judge, site.space.surface());
  std::vector<std::vector<Point3>> present = run.paths();
  if (run.distributed) end_of_lost(present, run.distributed->lost);
  InspectionJudgement judged{.evaluation = evaluate_mesh(s, site, run.reconstruction),
                             .points = {},
                             .paths = judge_paths(both, present, s.radius)};
  judged.disagreement = both.largest_disagreement();
  judged.disagreements = both.disagreements();
  judged.keep_out_violations =
      judge_paths(site.scene.keep_out, present, s.radius).collisions_with_scene;
  if (s.shape) judge_shape(s, site, run, judged);
  judged.coverage_of_met = coverage_of_met(s, site, run.map, judged.evaluation);
  if (!run.points.points.empty()) {
    const TriangleMesh structure = site.scene.structure();
    const EvaluationOptions e = evaluation_options(s, structure.area());
    judged.points = evaluate(site.reference, MeasuredSurface::from(structure, e),
                             MeasuredSurface::from(run.points), e)
                        .metrics;
  }
  return judged;
}
}  // namespace surfleet::examples
