// SPDX-License-Identifier: MIT
/// @file
/// @brief Settings of a drone inspection and the options that set them.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "support/body_shape.hpp"
#include "support/cli.hpp"

#include <surfleet/core/error.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/geometry/lidar_model.hpp>
#include <surfleet/geometry/text_scanner.hpp>
#include <surfleet/mapping/any_integrator.hpp>
#include <surfleet/motion/kinematics.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/mission.hpp>
#include <surfleet/simulation/presets.hpp>
#include <surfleet/simulation/random_scene.hpp>
#include <surfleet/simulation/stereo_noise.hpp>
#include <surfleet/viewpoint/viewpoint_generation.hpp>
#include <surfleet/viewpoint/viewpoint_merging.hpp>

namespace surfleet::examples {
/// Of a published mission, or of a kind of random scenes. Throws `Error` for another name.
inline MissionPreset preset_by_name(std::string_view name) {
  if (const RandomSceneSpec* spec = find_random_scene_spec(name)) return spec->preset;
  return published_preset(name, random_scene_kinds());
}

/// What the command line says. Angles in degrees, as people give them.
struct InspectionSettings : MissionPreset {
  std::string scene = "powerplant";
  std::string preset;  ///< Empty: the one that fits the scene's name, else powerplant.
  std::string planner = "surfleet";
  std::string architecture;  ///< Empty: single for one robot, else centralized.
  int robots = 3;
  std::uint64_t seed = 1;
  std::vector<double> fov{90.0, 60.0};
  int image_width = 160;
  double camera_pitch = 0.0;                        ///< Down [deg].
  std::vector<double> camera_mount{0.0, 0.0, 0.0};  ///< Of the camera in the body's frame [m].
  bool gimbal = false;
  std::optional<double> gimbal_pitch;  ///< [deg]; nothing: `tilt_of_views`.
  std::string sensor = "camera";       ///< Or lidar.
  LidarModel lidar;
  double lidar_noise = 0.02;  ///< [m]
  double rate = 4.0;
  std::vector<double> start, bounds;
  std::string body;                       ///< What `shape` is of; empty: a ball of `radius`.
  std::optional<BodyShape> shape;         ///< Of a drone's body, in the ball of `radius`.
  std::optional<double> start_clearance;  ///< [m]; nothing: `known_around_start`.
  std::optional<double> floor;            ///< [m]; −∞: none; nothing: the scene's own.
  KeepOut keep_out;
  std::optional<double> ground;
  bool noise = true;
  StereoNoise stereo;
  AerialLimits limits;
  std::optional<double> truncation;  ///< [m]; nothing: three voxels.
  int threads = 2;
  double max_time = 7200.0;
  double known_weight = 0.3;
  std::string weight = "inverse-square";  ///< Of an image: that or constant.
  double cluster_max_radius = 5.0;
  std::string cluster_distance = "straight";
  MergeOptions merge;
  int max_views = 1;
  MissionLimits end;                     ///< When a mission is over before nothing is left to do.
  std::string begun;                     ///< Folder of a mission to go on with; empty: none.
  std::string neighbours = "exact";      ///< How drones see one another: exact, markers, none.
  bool announces = true;                 ///< Drones tell each other where they go.
  std::string network = "perfect";       ///< Of a distributed fleet: perfect, wifi, poor or a file.
  std::string events;                    ///< File of what befalls robots of one; empty: nothing.
  int patch_images = 5;                  ///< In a map patch of one.
  std::optional<double> patch_distance;  ///< Flown, that closes one, too [m].
  double wait_for_team = 30.0;           ///< For mates that it no longer hears [s].
  std::string save_images;               ///< Folder for what the cameras see; empty: nowhere.
  std::optional<double> utility_share;   ///< c_thres in place of the planner's own.

  Pose T_body_camera() const {
    return forward_camera_mount(radians(camera_pitch),
                                Point3(camera_mount[0], camera_mount[1], camera_mount[2]));
  }
  /// How far a drone's body reaches below its position [m].
  double depth() const { return shape ? shape->half.z() : radius; }
  /// So that the images of a gimbal's views border on each other [deg].
  double tilt_of_views() const {
    return gimbal_pitch.value_or(std::min(fov[1], kMostTilt - std::abs(camera_pitch)));
  }
  bool has_lidar() const { return sensor == "lidar"; }
  /// Farthest that the sensor measures [m].
  double sensor_range() const { return has_lidar() ? lidar.max_range : farthest; }
  /// Of the camera's views beyond its mount [rad].
  std::vector<double> pitches() const {
    if (!gimbal) return {0.0};
    const double tilt = radians(tilt_of_views());
    return {0.0, tilt, -tilt};
  }
  static constexpr double kMostTilt = 80.0;  ///< Of a camera, up or down [deg].
  /// What the operator knows to be free of the structure around every start [m]: unless it is said,
  /// as far as it takes until what the sensor sees is as high as what the body needs.
  double known_around_start() const {
    const double needed = radius + margin + voxel;
    const double half = has_lidar() ? degrees(std::min(lidar.highest, -lidar.lowest))
                                    : 0.5 * fov[1] - std::abs(camera_pitch);
    const double opens = std::max(kLeastOpening, half);
    return start_clearance.value_or(needed / std::sin(radians(opens)) + 1.5 * voxel);
  }
  static constexpr double kLeastOpening = 5.0;  ///< Above or below the horizon [deg].

  /// Its options are those of the belief that takes it.
  AnyIntegrator integrator() const {
    if (weight == "constant")
      return TsdfIntegrator({}, drop_off_by_voxels(voxel, ConstantWeight{}));
    return TsdfIntegrator({}, drop_off_by_voxels(voxel));
  }

  PlannerSettings planner_settings() const {
    PlannerSettings p;
    p.standoff = standoff;
    p.cluster_radius = cluster_radius;
    p.cluster_max_radius = cluster_max_radius;
    p.cluster_by_path = cluster_distance == "path";
    p.lambda_tc = lambda_tc;
    p.lambda_ic = lambda_ic;
    p.merge = merge;
    p.speed = limits.speed;
    if (!has_lidar())
      p.yaw_rate = limits.yaw_rate;
    else
      p.yaw_rate = 1e3;  // as no robot turns for it
    p.printed_share = printed_share;
    p.utility_share = utility_share;
    p.threads = threads;
    return p;
  }
  /// What it is called in results.
  std::string architecture_name() const {
    if (!architecture.empty()) return architecture;
    return robots == 1 ? "single" : "centralized";
  }
};

/// Throws `Error` if no planner, asked for by `option`, has that name, or it could not use the
/// gimbal.
inline void check_planner(const std::string& name, bool gimbal, const std::string& option) {
  require(planner_by_name(name).chooses_pitch || !gimbal,
          "--gimbal: expected " + option + " surfleet, as the others know level views alone");
}

/// What a program runs with these settings: one inspection, many of several planners and fleets,
/// for which it has options of its own, a tour of what is known, without all that finds out, or one
/// robot of a distributed fleet.
enum class InspectionProgram { mission, trials, tour, agent };

/// Declares the options that inspections share. The preset is applied before what is given by name
/// overrides it: call `settle` after parsing.
class InspectionOptions {
 public:
  InspectionSettings settings;

  explicit InspectionOptions(cli::Options& app,
                             InspectionProgram program = InspectionProgram::mission)
      : app_(app), program_(program) {
    app.settle_before_printing([this] { settings = settle(); });
    // A mission that is cut short says nothing beside others, and one drone alone takes long.
    if (program == InspectionProgram::trials) settings.max_time = 14000.0;
    const bool explores = program != InspectionProgram::tour;
    const bool agent = program == InspectionProgram::agent;
    const bool flies = agent || program == InspectionProgram::mission;
    if (agent) {
      settings.architecture = "distributed";
      settings.threads = 1;
    }
    app.begin_group("Scene and task");
    app.add("--scene", settings.scene,
            "powerplant, statue, house, random:KIND:SEED with KIND " + random_scene_kinds() +
                " or all (seeds 1-99 for development, 1000 and up for reported figures only), or a "
                "mesh file (.ply .obj .stl .off) [m]");
    app.add("--preset", settings.preset,
            "powerplant or statue: the published parameters, or those of a KIND of random scenes; "
            "the defaults below are those of the power plant");
    app.add("--bounds", settings.bounds, "flight space x0 y0 z0 x1 y1 z1 [m]").expected(6);
    app.add("--floor", floor_,
            "height that no drone's body comes below [m], or none; default the mesh's lowest "
            "point, where there is no --ground, no --bounds and the start is in no room");
    app.add("--keep-out", keep_out_,
            "x0 y0 z0 x1 y1 z1 of a box that no drone's body may enter [m]; may be repeated");
    app.add("--ground", settings.ground, "height of a ground plane under the mesh [m]");
    app.add("--start", settings.start, "place of the first drone [m]").expected(3);
    app.add(
        "--start-clearance", settings.start_clearance,
        "known to be free of the structure around every start [m]; default what the sensor "
        "leaves unseen: (radius + margin + voxel) / sin(half the vertical field of view, less the "
        "pitch) + 1.5 voxels");
    app.begin_group("Robots");
    if (flies) {
      app.add("--robots", settings.robots,
              agent ? "of the team, at the most; each has a starting place" : "number of drones");
      app.add("--planner", settings.planner, "one of " + planner_list());
    }
    if (program == InspectionProgram::mission)
      app.add("--architecture", settings.architecture,
              "single, centralized (one map, one planner) or distributed (each robot has its own)");
    app.add("--speed", settings.limits.speed, "nominal speed [m/s]");
    app.add("--yaw-rate", settings.limits.yaw_rate, "at which a drone turns [rad/s]");
    app.add("--radius", settings.radius, "of a drone's body [m]");
    app.add("--margin", settings.margin, "kept beyond the body [m]");
    if (explores) {
      app.add("--body", settings.body,
              "its shape, which may go where a ball does not fit: ellipsoid:A,B,C (semi-axes "
              "forward, left, up [m]) or box:L,W,H (edges); default a ball of the radius, which "
              "else is that of the ball around it");
      app.add("--acceleration", settings.limits.acceleration, "of a drone [m/s^2]");
      app.add("--unknown-margin", settings.unknown_margin,
              "the same from what is unknown [m]; as a rule a voxel");
    }
    if (flies)
      app.add("--neighbours", settings.neighbours,
              "how drones see one another: exactly, by markers that they carry (6-D localisation "
              "by fish-eye cameras), or not at all")
          .one_of({"exact", "markers", "none"});
    if (program == InspectionProgram::mission) {
      app.add("--announcements", announcements_,
              "on, or off: drones do not tell where they go, and keep apart by sight alone");
    }
    if (explores) {
      app.begin_group("LiDAR");
      app.add("--sensor", settings.sensor,
              "what drones see with: the camera, or a LiDAR that sees all around, upright at "
              "--camera-mount; coverage is counted against what it could see")
          .one_of({"camera", "lidar"});
      app.add(
             "--lidar-range", lidar_range_,
             "nearest and farthest distance [m]; default 0.5 and one and a half times the farthest "
             "depth of --range")
          .expected(2);
      app.add("--lidar-fov", lidar_fov_, "elevation of the lowest and the highest beam [deg]")
          .expected(2);
      app.add("--lidar-beams", lidar_beams_, "around, and from the lowest to the highest")
          .expected(2);
      app.add("--lidar-noise", settings.lidar_noise,
              "standard deviation of a distance, where --noise is on [m]");
    }
    app.begin_group("Camera");
    app.add("--range", range_, "nearest and farthest depth [m]").expected(2);
    app.add("--fov", settings.fov, "horizontal and vertical field of view [deg]").expected(2);
    app.add("--image-width", settings.image_width, "columns of the depth image [px]");
    app.add("--camera-pitch", settings.camera_pitch, "tilt of the camera, down [deg]");
    app.add("--camera-mount", settings.camera_mount, "place of the camera in the body [m]")
        .expected(3);
    app.add_flag(
        "--gimbal", settings.gimbal,
        "pitch is chosen with the heading: views face level, down or up; coverage is still "
        "counted against what the level camera could see");
    app.add("--gimbal-pitch", settings.gimbal_pitch,
            "of a gimbal's views down and up, beyond the camera's own [deg]; default the vertical "
            "field of view");
    app.add("--rate", settings.rate, "images or scans a second");
    app.add("--noise", noise_, "of the sensor, on or off; a camera's is stereo noise");
    app.add("--disparity-error", settings.stereo.disparity_error, "|e_d| of that noise [px]");
    app.add("--focal", settings.stereo.focal, "f of that noise [px]");
    app.add("--baseline", settings.stereo.baseline, "B of that noise [m]");
    if (flies) distributed_group(agent);
    app.begin_group("Map");
    app.add("--voxel", settings.voxel, "edge of a voxel [m]");
    app.add("--known-weight", settings.known_weight, "W_th: weight of a known voxel");
    app.add("--weight", settings.weight,
            "of an image of a voxel z metres away: inverse-square, 1/z^2, or constant, 1; how long "
            "drones view surface follows from it; default inverse-square, of a LiDAR's scan "
            "constant")
        .one_of({"inverse-square", "constant"});
    app.add("--truncation", settings.truncation, "mu of the TSDF [m]; default three voxels");
    if (explores) {
      app.begin_group("Planner");
      app.add("--standoff", settings.standoff, "delta_pose, distance of a view [m]");
      app.add("--utility-share", settings.utility_share,
              "c_thres: share of a route's work whose completion asks for a new plan; default 0.2, "
              "tsga and nnb 0.8, with --preset statue 0.5");
      app.add("--max-views", settings.max_views, "views in vain before an element is given up");
      app.add("--merge-distance", settings.merge.distance,
              "epsilon: viewpoints this near are one, if they face alike [m] (all but surfleet and "
              "tours)");
      app.add("--cluster-radius", settings.cluster_radius, "d_nu [m]");
      app.add("--cluster-max-radius", settings.cluster_max_radius,
              "d_nu^max: up to which a lone viewpoint seeks neighbours [m]");
      app.add("--cluster-distance", settings.cluster_distance,
              "what joins viewpoints: straight lines or roadmap paths")
          .one_of({"straight", "path"});
      app.add("--lambda-tc", settings.lambda_tc,
              "penalty of travel between clusters [1/m] (all but surfleet and tours)");
      app.add("--lambda-ic", settings.lambda_ic,
              "penalty of travel inside clusters [1/m] (all but surfleet and tours)");
    }
    app.begin_group("Run");
    app.add("--seed", settings.seed, "of noise and roadmap");
    app.add("--threads", settings.threads, "threads; the result is the same for any number");
    if (explores) {
      app.begin_group("End of the mission");
      app.add("--max-time", settings.max_time, "the mission ends at this time [s]");
      app.add("--least-gain", settings.end.least_gain,
              "drones fly home when no route gains so much for a metre flown, as its planner "
              "counts it [m^2/m]; 0: when there is nothing left to do; default: " +
                  (program == InspectionProgram::mission ? default_least_gain() : "0"));
      app.add("--coverage-goal", settings.end.coverage_goal,
              "drones fly home at this share by their own account, 0 to 1");
      app.add("--endurance-m", settings.end.endurance.distance,
              "a drone is back at its start before it has flown so far [m]");
      app.add("--endurance-s", settings.end.endurance.time,
              "a drone is back at its start before this time [s]");
      if (program == InspectionProgram::mission)
        app.add("--continue", settings.begun,
                "folder of an earlier mission, whose map.sfm is gone on with");
    }
  }

  /// Call once, after parsing: applies the preset under what was given, and checks everything that
  /// can be checked without the scene. Throws `Error`.
  InspectionSettings settle() {
    const InspectionSettings given = settings;
    InspectionSettings s = given;
    s.preset = !given.preset.empty()          ? given.preset
               : is_random_scene(given.scene) ? std::string(parse_random_scene(given.scene).kind)
               : given.scene == "statue"      ? "statue"
                                              : "powerplant";
    static_cast<MissionPreset&>(s) = preset_by_name(s.preset);
    const auto keep = [&](const std::string& option, auto member) {
      if (app_.was_given(option)) s.*member = given.*member;
    };
    keep("--voxel", &InspectionSettings::voxel);
    keep("--radius", &InspectionSettings::radius);
    keep("--margin", &InspectionSettings::margin);
    if (!s.body.empty()) {
      s.shape = parse_body_shape(s.body);
      const double around = s.shape->radius();
      require(!app_.was_given("--radius") || s.radius >= around * (1.0 - 1e-6),
              "--radius: expected that of a ball around --body, " + std::to_string(around) +
                  " m, or more");
      s.radius = app_.was_given("--radius") ? std::max(s.radius, around) : around;
      require(s.radius <= 20.0 * s.voxel,
              "--body " + s.body + ": expected less than 20 voxels to every side");
    }
    keep("--unknown-margin", &InspectionSettings::unknown_margin);
    if (!app_.was_given("--unknown-margin"))
      s.unknown_margin = std::min(s.margin, std::max(s.unknown_margin, s.voxel));
    if (app_.was_given("--range")) {
      s.nearest = range_[0];
      s.farthest = range_[1];
    }
    range_ = {s.nearest, s.farthest};
    if (!app_.was_given("--lidar-range")) lidar_range_ = {0.5, 1.5 * s.farthest};
    s.lidar = {.azimuths = lidar_beams_[0],
               .elevations = lidar_beams_[1],
               .lowest = radians(lidar_fov_[0]),
               .highest = radians(lidar_fov_[1]),
               .min_range = lidar_range_[0],
               .max_range = lidar_range_[1]};
    if (s.has_lidar() && !app_.was_given("--weight")) s.weight = "constant";
    keep("--standoff", &InspectionSettings::standoff);
    keep("--cluster-radius", &InspectionSettings::cluster_radius);
    keep("--lambda-tc", &InspectionSettings::lambda_tc);
    keep("--lambda-ic", &InspectionSettings::lambda_ic);
    s.cluster_max_radius = app_.was_given("--cluster-max-radius")
                               ? given.cluster_max_radius
                               : std::max(given.cluster_max_radius, s.cluster_radius);
    require(noise_ == "on" || noise_ == "off", "--noise " + noise_ + ": expected on or off");
    s.noise = noise_ == "on";
    require(announcements_ == "on" || announcements_ == "off",
            "--announcements " + announcements_ + ": expected on or off");
    s.announces = announcements_ == "on";
    s.floor = parse_floor(floor_);
    require(keep_out_.size() % 6 == 0,
            "--keep-out: expected six numbers x0 y0 z0 x1 y1 z1 for each box");
    for (std::size_t i = 0; i < keep_out_.size(); i += 6)
      s.keep_out.boxes.push_back(
          cli::box_from_numbers({keep_out_.begin() + static_cast<std::ptrdiff_t>(i),
                                 keep_out_.begin() + static_cast<std::ptrdiff_t>(i + 6)},
                                "--keep-out"));
    // Trials compare planners, of which not all say what their routes gain.
    if (program_ == InspectionProgram::mission && !app_.was_given("--least-gain"))
      s.end.least_gain = planner_by_name(s.planner).enough * s.sensor_range();
    check(s);
    return s;
  }

 private:
  void distributed_group(bool agent) {
    app_.begin_group("Distributed fleet");
    app_.add("--network", settings.network,
             "perfect, wifi (2 % loss, 20 ms, 20 Mbit/s), poor (30 %, 500 +- 200 ms, 1 Mbit/s), or "
             "a file with any of loss, duplication, reordering (shares), latency, jitter [s], "
             "bandwidth [bit/s of a robot], range [m], line-of-sight = true, "
             "partition = [\"60 to 200: 1 2 | 3\"], cut = [\"10 to 20: 1 > 3\"]");
    if (!agent)
      app_.add("--events", settings.events,
               "file of what befalls robots: killed = [\"2 at 120\"] (its body hovers), "
               "vanished = [\"3 at 60.5\"] (its body is gone), restarted = [\"2 at 180\"] (with "
               "an empty map); each a list of \"ROBOT at SECONDS\"");
    app_.add("--patch-images", settings.patch_images, "a patch of the map closes after so many");
    app_.add("--patch-distance", settings.patch_distance,
             "or once its robot has come so far [m]; default no such distance");
    app_.add("--wait-for-team", settings.wait_for_team, "for robots that are no longer heard [s]");
  }
  static std::string default_least_gain() {
    std::string shares;
    for (const NamedPlanner& p : kPlanners)
      if (p.enough > 0.0)
        shares += format_number(p.enough, 2) + " times the range by " + std::string(p.name) + ", ";
    return shares + "else 0";
  }
  static std::optional<double> parse_floor(const std::string& text) {
    if (text.empty()) return std::nullopt;
    if (text == "none") return -std::numeric_limits<double>::infinity();
    const auto height = parse_number<double>(text);
    require(height && std::isfinite(*height), "--floor " + text + ": expected a height or none");
    return height;
  }
  static void check_lidar(const InspectionSettings& s) {
    const LidarModel& l = s.lidar;
    require(!s.gimbal && s.camera_pitch == 0.0,
            "--sensor lidar: stands upright; expected no --gimbal and no --camera-pitch with it");
    require(l.min_range >= 0.0 && l.max_range > 2.0 * l.min_range && l.max_range <= 1000.0,
            "--lidar-range: expected 0 <= nearest < half the farthest, and that at most 1000 m");
    const double steepest = radians(InspectionSettings::kMostTilt) + 1e-9;
    require(l.lowest >= -steepest && l.lowest <= 0.0 && l.highest > l.lowest && l.highest >= 0.0 &&
                l.highest <= steepest,
            "--lidar-fov: expected -80 to 0 and 0 to 80 degrees, with an opening between them");
    const auto planned = camera_within(l);
    require(
        planned.max_range > std::max(s.voxel, planned.min_range),
        "--lidar-range: so high an opening leaves no range to plan with; expected a longer one");
    require(s.start_clearance ||
                degrees(std::min(l.highest, -l.lowest)) >= InspectionSettings::kLeastOpening,
            "--lidar-fov: such beams see nothing of the path up or down; expected a "
            "--start-clearance with it");
    require(l.azimuths >= 16 && l.azimuths <= 8192 && l.elevations >= 2 && l.elevations <= 1024,
            "--lidar-beams: expected 16 to 8192 around and 2 to 1024 up");
    require(s.lidar_noise >= 0.0 && std::isfinite(s.lidar_noise),
            "--lidar-noise: expected 0 m or more");
  }
  static void check(const InspectionSettings& s) {
    const auto positive = [](double v, const char* name) {
      require(v > 0.0 && std::isfinite(v), std::string(name) + ": expected a positive number");
    };
    require(s.robots >= 1 && s.robots <= 64,
            "--robots " + std::to_string(s.robots) + ": expected 1 to 64");
    require(s.threads >= 1 && s.threads <= 256, "--threads: expected 1 to 256");
    require(s.voxel >= 0.01 && s.voxel <= 10.0,
            "--voxel " + std::to_string(s.voxel) + ": expected 0.01 to 10 m");
    require(s.nearest >= 0.0 && s.farthest > s.nearest && s.farthest <= 1000.0,
            "--range: expected 0 <= nearest < farthest <= 1000 m");
    for (const double angle : s.fov)
      require(angle > 0.0 && angle <= 170.0,
              "--fov " + std::to_string(angle) + ": expected angles in (0, 170] degrees");
    require(std::abs(s.camera_pitch) <= InspectionSettings::kMostTilt,
            "--camera-pitch: expected -80 to 80 degrees");
    require(s.gimbal || !s.gimbal_pitch, "--gimbal-pitch: expected --gimbal with it");
    require(!s.gimbal || (s.tilt_of_views() > 0.0 && s.tilt_of_views() + std::abs(s.camera_pitch) <=
                                                         InspectionSettings::kMostTilt),
            "--gimbal: expected views at more than 0 and at most 80 degrees up and down");
    require(
        s.has_lidar() || s.start_clearance ||
            std::abs(s.camera_pitch) + InspectionSettings::kLeastOpening <= 0.5 * s.fov[1],
        "--camera-pitch: at such a tilt the camera sees nothing of the path up or down; expected "
        "a --start-clearance with it");
    if (s.has_lidar()) check_lidar(s);
    for (const double x : s.camera_mount)
      require(std::abs(x) <= s.radius, "--camera-mount: expected a place within the body");
    require(s.image_width >= 16 && s.image_width <= 4096, "--image-width: expected 16 to 4096");
    require(s.rate >= 0.2 && s.rate <= 100.0, "--rate: expected 0.2 to 100 images a second");
    positive(s.standoff, "--standoff");
    positive(s.limits.speed, "--speed");
    positive(s.limits.acceleration, "--acceleration");
    positive(s.limits.yaw_rate, "--yaw-rate");
    require(s.stereo.disparity_error >= 0.0 && std::isfinite(s.stereo.disparity_error),
            "--disparity-error: expected 0 or more pixels");
    positive(s.stereo.focal, "--focal");
    positive(s.stereo.baseline, "--baseline");
    if (s.truncation)
      require(*s.truncation >= s.voxel && std::isfinite(*s.truncation),
              "--truncation: expected a voxel or more");
    positive(s.merge.distance, "--merge-distance");
    require(s.cluster_max_radius >= s.cluster_radius && std::isfinite(s.cluster_max_radius),
            "--cluster-max-radius: expected --cluster-radius or more");
    positive(s.radius, "--radius");
    positive(s.margin, "--margin");
    if (s.start_clearance)
      require(*s.start_clearance >= s.radius && std::isfinite(*s.start_clearance),
              "--start-clearance: expected --radius or more");
    positive(s.unknown_margin, "--unknown-margin");
    require(s.unknown_margin <= s.margin, "--unknown-margin: expected at most --margin");
    positive(s.max_time, "--max-time");
    require(s.end.least_gain >= 0.0 && std::isfinite(s.end.least_gain),
            "--least-gain: expected 0 or more");
    const double goal = s.end.coverage_goal.value_or(1.0);
    require(goal > 0.0 && goal <= 1.0, "--coverage-goal: expected more than 0 and at most 1");
    positive(s.end.endurance.distance.value_or(1.0), "--endurance-m");
    positive(s.end.endurance.time.value_or(1.0), "--endurance-s");
    positive(s.known_weight, "--known-weight");
    positive(s.cluster_radius, "--cluster-radius");
    require(s.lambda_tc >= 0.0 && s.lambda_ic >= 0.0,
            "--lambda-tc, --lambda-ic: expected 0 or more");
    require(s.max_views >= 1 && s.max_views <= 100, "--max-views: expected 1 to 100");
    const double share = s.utility_share.value_or(1.0);
    require(share > 0.0 && share <= 1.0, "--utility-share: expected (0, 1]");
    const std::string& a = s.architecture;
    require(a.empty() || a == "single" || a == "centralized" || a == "distributed",
            "--architecture " + a + ": expected single, centralized or distributed");
    const bool distributed = a == "distributed";
    require(distributed || (s.network == "perfect" && s.events.empty()),
            "--network, --events: expected --architecture distributed with them");
    require(distributed || !s.patch_distance,
            "--patch-distance: expected --architecture distributed with it");
    require(!distributed || (s.announces && s.begun.empty()),
            "--architecture distributed: expected no --announcements off or --continue with it");
    require(s.patch_images >= 1 && s.patch_images <= 1000, "--patch-images: expected 1 to 1000");
    positive(s.patch_distance.value_or(1.0), "--patch-distance");
    positive(s.wait_for_team, "--wait-for-team");
    require(s.architecture != "single" || s.robots == 1,
            "--architecture single: expected --robots 1");
    check_planner(s.planner, s.gimbal, "--planner");
  }

  cli::Options& app_;
  InspectionProgram program_;
  std::vector<double> range_{MissionPreset{}.nearest, MissionPreset{}.farthest};
  std::vector<double> lidar_range_{0.5, 1.5 * MissionPreset{}.farthest}, lidar_fov_{-45.0, 45.0};
  std::vector<int> lidar_beams_{512, 64};
  std::string noise_ = "on", announcements_ = "on", floor_;
  std::vector<double> keep_out_;
};
}  // namespace surfleet::examples
