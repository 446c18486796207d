// SPDX-License-Identifier: MIT
// A robot drives over a curved surface from a start to one goal after the other.
//
//   surface_navigation                                        over the bumpy slope
//   surface_navigation --scene steam_chest --goal 4.9 0.2 0 2.6 0.95 0.1 --robot magnebike
//   surface_navigation --scene tank.ply --start 0 0 1 --goal 2 0 1 --field perpendicular
//   surface_navigation --scene steam_chest --reconstruct mls --cloud-noise 0.018 --faces 3000
//   surface_navigation --method dense --scene l_shape         over samples of it, by tensor voting
//   surface_navigation --method dense --scene scan.ply --start 0 0 1 --goal 2 0 1
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/coverage/covering_strip.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/clean_surface.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/surface/drive_path.hpp>
#include <surfleet/surface/geodesic_strip.hpp>
#include <surfleet/surface/single_strip.hpp>
#include <surfleet/surface/strip_replanning.hpp>
#include <surfleet/surface/strip_search.hpp>

#include "support/cli.hpp"
#include "support/cloud_navigation.hpp"
#include "support/navigation_parts.hpp"
#include "support/peak_memory.hpp"
#include "support/scanned_surface.hpp"
#include "support/sparse_navigation.hpp"
#include "support/stopwatch.hpp"
#include "support/surface_scene.hpp"

namespace {
using namespace surfleet;

struct Settings {
  std::string scene = "bumpy_slope", out = "out/surface_navigation", search = "geodesic",
              field = "continuous", robot = "point", blocked, cover_by = "tour";
  std::optional<double> edge, sense;  ///< [m]
  double curvature = 0.0, turn = 0.0, slope = 0.0, speed = 0.05, ahead = 0.02;
  std::vector<double> start, goal, noise{0.0, 0.0};
  double off_surface = 0.1;
  long samples = 5000;
  std::uint64_t seed = 1;
  bool cover = false, quiet = false;
  std::string method = "strip";
  examples::CloudNavigation cloud;
  examples::ScannedSurface scanned;
};

Settings settings(int argc, char** argv) {
  Settings s;
  cli::Options app(
      "A robot drives over a curved surface from a start to one goal after the other: a strip of "
      "triangles, a shortest path in it, a vector field or a tracked reference.\nWrites "
      "metrics.json, "
      "surface.ply, strip.ply, path.tum, driven.tum, a picture and report.html to --out.\n"
      "Exit status: 0 done, 2 input refused, 3 a goal was not reached.");
  app.begin_group("Scene and task");
  app.add("--scene", s.scene, examples::kSurfaceScenes);
  app.add("--method", s.method,
          "strip: over a mesh; dense: over a point cloud (.ply without triangles, .xyz) or samples "
          "of a scene, by tensor voting and A* over cells and headings; sparse: by RRT* over the "
          "points of such a cloud, and a bicycle's motions on quadrics")
      .one_of({"strip", "dense", "sparse"});
  app.begin_group("Clouds and scans");
  app.add("--samples", s.samples, "of the tree (sparse)").positive();
  examples::CloudNavigation& c = s.cloud;
  app.add("--density", c.density, "of the samples of a scene [1/m^2] (dense)").positive();
  app.add("--scan-from", c.scan_from,
          "X Y Z [m] of each rotating lidar that takes the scene in place of even samples (dense), "
          "or for --reconstruct; the steam chest has places of its own");
  app.add("--cloud-noise", c.cloud_noise, "on samples, or along beams [m] (dense, --reconstruct)")
      .zero_or_more();
  app.add("--spacing", c.spacing,
          "least between points kept [m]; default all (dense); 0.02, and for ftm 3 times the noise "
          "(--reconstruct)")
      .positive();
  app.add("--outliers", c.outliers,
          "points so many deviations lonelier than the mean go; 0: none (dense, --reconstruct)")
      .zero_or_more();
  examples::ScannedSurface& r = s.scanned;
  app.add("--reconstruct", r.reconstruct,
          "the mesh to drive on comes from scans of the scene, or from a cloud (.ply without "
          "triangles, .xyz): itm joins one scan's points as the sensor sees them, mls averages "
          "many, ftm grows over them; none: the scene's own mesh (strip)")
      .one_of({"none", "itm", "mls", "ftm"});
  app.add("--support", r.support, "of the averaging [m]; default 4 voxels (mls)").positive();
  app.add("--faces", r.faces, "simplify the mesh to so many triangles; default as it is (strip)")
      .positive();
  app.add("--voting", c.voting,
          "sheets: moved points, edges where planes meet; balls: as printed (dense)")
      .one_of({"sheets", "balls"});
  app.add("--vote-scale", c.vote_scale,
          "of voting [m]; default the larger of 0.06 and 3 times the points' spacing (dense)")
      .positive();
  app.add("--mask", c.mask, "tokens keep so many scales apart (dense)").zero_or_more();
  app.add("--voxel", c.voxel, "side of a cell [m]; default 0.58 scales (dense), 1.5 spacings (mls)")
      .positive();
  app.add("--edge-threshold", c.edge_threshold, "least plate share of an edge, 0 to 1 (dense)")
      .zero_or_more();
  app.add("--inflate", c.inflate, "edges by this [m] (dense)").zero_or_more();
  app.add("--cost", c.cost,
          "K1 K2 K3 K4 of distance, low saliency [1/m], turns [m/rad^2], bends taken askew "
          "[1/rad^2] (dense); else 1 2 0.02 0.1");
  app.add("--threads", c.threads, "for voting (dense) and --reconstruct").positive();
  app.begin_group("Scene and task");
  app.add("--edge", s.edge, "edge length of a bundled scene [m]; default its own").positive();
  app.add("--start", s.start, "X Y Z [m], on the nearest triangle; else one end of the scene");
  app.add("--goal", s.goal, "X Y Z [m] of each goal, in order; else the other end");
  app.add("--off-surface", s.off_surface, "how far start and goals may lie off the surface [m]");
  app.begin_group("Path");
  app.add("--search", s.search,
          "geodesic: the triangles under a shortest path; dual: A* from centroid to centroid; "
          "midpoints: from edge to edge")
      .one_of({"geodesic", "dual", "midpoints"});
  app.add("--curvature", s.curvature, "weight of bends over edges [m] (dual, midpoints)")
      .zero_or_more();
  app.add("--turn", s.turn, "weight of turns [m] (dual, midpoints)").zero_or_more();
  app.add("--slope", s.slope, "weight of steepness (dual, midpoints)").zero_or_more();
  app.add("--blocked", s.blocked, "file of triangle numbers that may not be entered");
  app.add("--sense", s.sense,
          "blocked triangles are seen from so far, and the strip is planned again under way; "
          "default: all are known from the start [m]")
      .positive();
  app.begin_group("Driving");
  app.add("--field", s.field, "continuous (eq. 7.1) or perpendicular to every edge crossed")
      .one_of({"continuous", "perpendicular"});
  app.add("--robot", s.robot,
          "point or epuck follow the field, magnebike tracks the path by eq. 8.6")
      .one_of({"point", "epuck", "magnebike"});
  app.add("--speed", s.speed, "of the robot [m/s]").positive();
  app.add("--ahead", s.ahead, "of the epuck's reference point before its axle [m]").positive();
  app.add("--noise", s.noise, "on the magnebike's pose: position [m] and heading [deg]")
      .expected(2);
  app.add("--seed", s.seed, "of the noise");
  app.add_flag("--cover", s.cover, "drive a strip that covers the surface, from the start");
  app.add(
         "--cover-by", s.cover_by,
         "tour: over whole triangles, some of them again; single: every piece once, some triangles "
         "halved, and again only on detours past borders")
      .one_of({"tour", "single"});
  app.begin_group("Results");
  app.add("--out", s.out, "folder for the results");
  app.add_flag("--quiet", s.quiet, "no progress line");
  app.add_examples(
      "  surface_navigation --scene mock_up --robot magnebike\n"
      "  surface_navigation --edge 0.2 --cover --cover-by single\n"
      "  surface_navigation --scene tube --scan-from -0.4 0 0 0.4 0 0 --reconstruct mls\n"
      "  surface_navigation --scene hall.xyz --method sparse --start 0 0 0 --goal 4 1 0");
  app.parse(argc, argv);
  require(s.start.empty() || s.start.size() == 3, "--start: expected three numbers");
  require(s.goal.size() % 3 == 0, "--goal: expected three numbers for each goal");
  require(s.method == "strip" || (!s.cover && s.blocked.empty() && s.robot == "point"),
          "--cover, --blocked, --robot: expected --method strip with them");
  require(s.method == "strip" || (r.reconstruct == "none" && !r.faces),
          "--reconstruct, --faces: expected --method strip with them");
  require(!s.cover || s.goal.empty(), "--cover: expected no --goal with it");
  require(!s.cover || s.robot != "magnebike", "--cover: expected --robot point or epuck");
  require(s.noise[0] >= 0.0 && s.noise[1] >= 0.0, "--noise: expected 0 or more");
  const bool weighted = s.curvature > 0.0 || s.turn > 0.0 || s.slope > 0.0;
  require(!weighted || s.search != "geodesic",
          "--curvature, --turn, --slope: expected --search dual or midpoints with them");
  return s;
}

/// 0 or infinite for every triangle; empty where no file is given.
std::vector<double> blocked_triangles(const Settings& s, const TriangleMesh& mesh) {
  if (s.blocked.empty()) return {};
  std::ifstream file(s.blocked);
  require(file.good(), "--blocked: " + s.blocked + " cannot be read");
  std::vector<double> cost(mesh.triangles.size(), 0.0);
  std::string word;
  while (file >> word) {
    const auto t = parse_number<long>(word);
    require(t && *t >= 0 && static_cast<std::size_t>(*t) < cost.size(),
            "--blocked: \"" + word + "\"; expected numbers of triangles, 0 to " +
                std::to_string(cost.size() - 1));
    cost[static_cast<std::size_t>(*t)] = std::numeric_limits<double>::infinity();
  }
  return cost;
}

/// One goal: how it was planned for and driven to.
struct Leg {
  std::optional<SurfacePath> path;
  std::string reason;                  ///< Why it was not reached; empty if it was.
  double planned = 0.0, driven = 0.0;  ///< [m]
  std::size_t breaks = 0, shared = 0, left = 0, replans = 0;
};

struct Journey {
  std::vector<Leg> legs;
  std::vector<StampedPose> path, driven;
  std::vector<std::int32_t> strip;
  std::vector<double> errors;  ///< Of tracking [m].
  double planning = 0.0;       ///< [s]
};

class Navigation {
 public:
  Navigation(const Settings& s, const TriangleMesh& mesh)
      : s_(s), walk_(mesh), geodesic_(walk_), search_(mesh, costs(mesh), nodes()) {}

  const SurfaceWalk& walk() const { return walk_; }

  /// A strip and its shortened path.
  Leg plan(const SurfacePoint& start, const SurfacePoint& goal) const {
    Leg leg;
    if (search_.blocked(start.triangle) || search_.blocked(goal.triangle)) {
      leg.reason = search_.blocked(goal.triangle) ? "the goal lies in a blocked triangle"
                                                  : "the robot stands in a blocked triangle";
      return leg;
    }
    if (s_.sense && !s_.blocked.empty()) return plan_under_way(start, goal);
    const bool free = search_.costs().user.empty();
    std::optional<std::vector<std::int32_t>> strip;
    if (s_.search == "geodesic") strip = geodesic_.triangles(start, goal);
    const auto crosses = [&](const std::vector<std::int32_t>& triangles) {
      return std::any_of(triangles.begin(), triangles.end(),
                         [&](std::int32_t t) { return search_.blocked(t); });
    };
    if (!strip || (!free && crosses(*strip))) {
      const auto found = search_(start, goal);
      if (!found) {
        leg.reason = "no strip of free triangles leads to it";
        return leg;
      }
      strip = found->triangles;
    }
    // A strip that was chosen for its cost is kept.
    const bool weighted = s_.curvature > 0.0 || s_.turn > 0.0 || s_.slope > 0.0;
    leg.path = weighted ? geodesic_.shortener().within(*strip, start, goal)
                        : geodesic_.shortener().shortened(*strip, start, goal, [&](std::int32_t t) {
                            return !search_.blocked(t);
                          });
    leg.planned = leg.path->length();
    return leg;
  }

  /// From triangle to triangle, knowing of the blocked ones only what was within sight.
  Leg plan_under_way(const SurfacePoint& start, const SurfacePoint& goal) const {
    Leg leg;
    const TriangleMesh& mesh = walk_.mesh();
    StripReplanner plan(mesh, goal, {s_.curvature, s_.turn, s_.slope, {}}, nodes());
    std::vector<std::int32_t> unsensed, driven{start.triangle};
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t)
      if (search_.blocked(t)) unsensed.push_back(t);
    const auto sense = [&](const Point3& from) {
      const std::size_t before = unsensed.size();
      std::erase_if(unsensed, [&](std::int32_t t) {
        if ((mesh.centroid(static_cast<std::size_t>(t)) - from).norm() > *s_.sense) return false;
        plan.set_user_cost(t, std::numeric_limits<double>::infinity());
        return true;
      });
      return unsensed.size() < before;
    };
    SurfacePoint at = start;
    sense(at.position(mesh));
    auto strip = plan(at);
    for (std::size_t k = 1; strip && at.triangle != goal.triangle; ++k) {
      const std::int32_t next = strip->triangles[k];
      if (search_.blocked(next)) {  // bumped into before it was in sight
        plan.set_user_cost(next, std::numeric_limits<double>::infinity());
        std::erase(unsensed, next);
      } else {
        at = SurfacePoint{next};
        driven.push_back(next);
        if (!sense(at.position(mesh))) continue;
      }
      strip = plan(at);
      ++leg.replans;
      k = 0;
    }
    if (!strip) {
      leg.reason = "no strip of free triangles leads to it, as was found out on the way";
      return leg;
    }
    leg.path = geodesic_.shortener().within(driven, start, goal);
    leg.planned = leg.path->length();
    return leg;
  }

  /// Drives from `pose`, which it takes along, and adds to the records.
  void drive(Leg& leg, SurfacePose& pose, Journey& journey) const {
    if (s_.robot == "magnebike")
      track(leg, pose, journey);
    else if (s_.field == "continuous")
      follow<ContinuousField>(leg, pose, journey);
    else
      follow<PerpendicularField>(leg, pose, journey);
  }

  void stamp(std::vector<StampedPose>& record, const SurfacePose& pose) const {
    examples::append_pose(record, pose.T_world_body(walk_.mesh()), s_.speed);
  }

 private:
  StripCosts costs(const TriangleMesh& mesh) const {
    return {s_.curvature, s_.turn, s_.slope, blocked_triangles(s_, mesh)};
  }
  StripNodes nodes() const {
    return s_.search == "midpoints" ? StripNodes::edge_midpoints : StripNodes::centroids;
  }

  template <typename Policy>
  void follow(Leg& leg, SurfacePose& pose, Journey& journey) const {
    const StripField<Policy> field(walk_.mesh(), leg.path->triangles, leg.path->goal);
    leg.breaks += field.field.breaks();
    if constexpr (std::same_as<Policy, ContinuousField>) leg.shared += field.field.shared();
    FieldDrive drive;
    if (s_.robot == "point") {
      drive = follow_field(walk_, field, leg.path->start);
    } else {  // the point ahead is to start where the strip does
      pose = surface_pose(walk_.mesh(), leg.path->start, pose.forward);
      pose = walk_(pose, {-s_.ahead, 0.0}).pose;
      drive = drive_field(walk_, field, Unicycle{}, pose, s_.ahead, s_.speed, 0.02, 2e-3);
    }
    leg.left += drive.left_strip;
    leg.driven += drive.length;
    if (!drive.reached) leg.reason = "the drive ended before it";
    pose = drive.poses.back();
    for (const SurfacePose& p : drive.poses) stamp(journey.driven, p);
    for (const std::int32_t t : drive.entered) journey.strip.push_back(t);
  }
  void track(Leg& leg, SurfacePose& pose, Journey& journey) const {
    if (leg.planned < 1e-9) return;
    TrackOptions options;
    options.speed = s_.speed;
    options.position_noise = s_.noise[0];
    options.heading_noise = radians(s_.noise[1]);
    options.seed = s_.seed + journey.legs.size();
    pose = surface_pose(walk_.mesh(), leg.path->start, leg.path->points[1] - leg.path->points[0]);
    const TrackedDrive drive = track_path(walk_, *leg.path, FrontDriveBicycle{}, pose, options);
    for (std::size_t k = 0; k < drive.poses.size(); ++k) {
      if (k > 0)
        leg.driven += (drive.poses[k].at.position(walk_.mesh()) -
                       drive.poses[k - 1].at.position(walk_.mesh()))
                          .norm();
      stamp(journey.driven, drive.poses[k]);
    }
    journey.errors.insert(journey.errors.end(), drive.error.begin(), drive.error.end());
    pose = drive.poses.back();
    if (drive.end_error > 0.05) leg.reason = "the robot ended more than 5 cm from it";
  }

  const Settings& s_;
  SurfaceWalk walk_;
  GeodesicStrips geodesic_;
  StripSearch search_;
};

int run(int argc, char** argv) {
  const auto begin = examples::Clock::now();
  Settings s = settings(argc, argv);
  if (s.method != "strip") {
    examples::CloudNavigation& c = s.cloud;
    c.scene = s.scene;
    c.out = s.out;
    c.edge = s.edge;
    c.start = s.start;
    c.goal = s.goal;
    c.off_surface = s.off_surface;
    c.speed = s.speed;
    c.seed = s.seed;
    c.quiet = s.quiet;
    if (s.method == "sparse")
      return examples::navigate_sparse_cloud(c, static_cast<std::size_t>(s.samples));
    return examples::navigate_cloud(c);
  }
  SurfaceDefects defects;
  examples::ScannedSurface& scanned = s.scanned;
  scanned.scene = s.scene;
  scanned.edge = s.edge;
  scanned.noise = s.cloud.cloud_noise;
  scanned.spacing = s.cloud.spacing;
  scanned.outliers = s.cloud.outliers;
  scanned.voxel = s.cloud.voxel;
  scanned.scan_from = s.cloud.scan_from;
  scanned.threads = s.cloud.threads;
  scanned.seed = s.seed;
  nlohmann::json scan_metrics = nlohmann::json::object();
  TriangleMesh surface =
      clean_surface(examples::scanned_surface_mesh(scanned, scan_metrics), &defects);
  require(s.blocked.empty() || defects.removed_triangles == 0,
          "--blocked: the mesh has triangles without area or said twice, so numbers would not "
          "match; expected a clean mesh");
  std::optional<SingleStrip> single;
  double single_time = 0.0;
  if (s.cover && s.cover_by == "single") {
    require(s.blocked.empty(), "--blocked: expected --cover-by tour with it");
    require(s.start.empty() || Point3(s.start[0], s.start[1], s.start[2]).allFinite(),
            "--start: expected finite numbers");
    const Box3 all = surface.bounds();
    const Point3 from = s.start.empty() ? Point3(all.center() - 0.4 * all.sizes())
                                        : Point3(s.start[0], s.start[1], s.start[2]);
    const auto at = nearest_surface_point(surface, Bvh(surface), from);
    const auto planning = examples::Clock::now();
    single = single_strip(surface, at->triangle);
    single_time = examples::seconds_since(planning);
    scan_metrics["split_triangles"] = single->split;
    scan_metrics["detour_places"] = single->detours;
    surface = single->mesh;
  }
  const TriangleMesh& mesh = surface;
  const Bvh bvh(mesh);
  const auto place = [&](const Point3& p, const char* what) {
    const auto at = nearest_surface_point(mesh, bvh, p);
    const double off = (at->position(mesh) - p).norm();
    char text[160];
    std::snprintf(text, sizeof text,
                  "%s: %.3f m off the surface; expected %.3f m at most (--off-surface)", what, off,
                  s.off_surface);
    require(off <= s.off_surface, text);
    return *at;
  };
  // The ends of the longest side.
  const Box3 box = mesh.bounds();
  const auto end = [&](double share) {
    return *nearest_surface_point(mesh, bvh, box.center() + (share - 0.5) * box.sizes());
  };
  auto [start, goals] = examples::route_ends(s.start, s.goal, place, end);
  if (single) start = SurfacePoint{single->triangles.front()};
  if (s.cover) goals.clear();  // none was given: it goes everywhere

  const Navigation navigation(s, mesh);
  const auto out = cli::prepare_output_folder(s.out);
  cli::watch_interrupts();
  cli::ProgressLine line(!s.quiet);

  Journey journey;
  const double prepared = examples::seconds_since(begin);
  SurfacePose pose = surface_pose(mesh, start, Eigen::Vector3d::UnitX());
  std::vector<std::int32_t> planned_strip;
  const auto add_leg = [&](Leg leg) {
    if (leg.path) {
      planned_strip.insert(planned_strip.end(), leg.path->triangles.begin(),
                           leg.path->triangles.end());
      for (std::size_t i = 0; i < leg.path->points.size(); ++i) {
        const auto t = leg.path->triangles[std::min(i, leg.path->triangles.size() - 1)];
        const Point3 ahead = leg.path->points[std::min(i + 1, leg.path->points.size() - 1)];
        SurfacePose p = surface_pose(mesh, surface_point(mesh, t, leg.path->points[i]),
                                     ahead - leg.path->points[i]);
        navigation.stamp(journey.path, p);
      }
      navigation.drive(leg, pose, journey);
    }
    journey.legs.push_back(std::move(leg));
  };
  if (s.cover) {
    const auto planning = examples::Clock::now();
    std::vector<std::int32_t> strip;
    if (single) {
      strip = single->triangles;
    } else {
      const SurfaceGraph dual = DualMeshGraph{}(mesh, EdgeGeodesic{});
      const auto part = connected_components(dual.links);
      std::vector<std::int32_t> piece;
      for (std::size_t t = 0; t < part.size(); ++t)
        if (part[t] == part[static_cast<std::size_t>(start.triangle)])
          piece.push_back(static_cast<std::int32_t>(t));
      strip = covering_strip(mesh, dual.links, piece, start.triangle).triangles;
    }
    journey.planning = examples::seconds_since(planning) + single_time;
    SurfacePoint at = start;
    for (const auto& triangles : split_at_turns(strip)) {
      if (cli::interrupted()) break;
      Leg leg;
      leg.path.emplace();
      leg.path->triangles = triangles;
      leg.path->start = at;
      leg.path->goal = SurfacePoint{triangles.back()};
      leg.path->points.push_back(at.position(mesh));
      for (std::size_t k = 1; k < triangles.size(); ++k)
        leg.path->points.push_back(crossing_point(mesh, static_cast<std::size_t>(triangles[k - 1]),
                                                  static_cast<std::size_t>(triangles[k])));
      leg.path->points.push_back(leg.path->goal.position(mesh));
      leg.planned = leg.path->length();
      add_leg(std::move(leg));
      at = pose.at.triangle == triangles.back() ? pose.at : SurfacePoint{triangles.back()};
      line("covering, " + std::to_string(journey.strip.size()) + " triangles");
    }
  } else {
    for (std::size_t g = 0; g < goals.size() && !cli::interrupted(); ++g) {
      line("goal " + std::to_string(g + 1) + " of " + std::to_string(goals.size()));
      const auto planning = examples::Clock::now();
      Leg leg = navigation.plan(pose.at, goals[g]);
      journey.planning += examples::seconds_since(planning);
      add_leg(std::move(leg));
    }
  }

  double planned = 0.0, driven = 0.0;
  std::size_t breaks = 0, shared = 0, left = 0, replans = 0;
  nlohmann::json unreached = nlohmann::json::array();
  for (std::size_t g = 0; g < journey.legs.size(); ++g) {
    const Leg& leg = journey.legs[g];
    planned += leg.planned;
    driven += leg.driven;
    breaks += leg.breaks;
    shared += leg.shared;
    left += leg.left;
    replans += leg.replans;
    if (!leg.reason.empty()) unreached.push_back({{"goal", g}, {"reason", leg.reason}});
  }
  const bool all = unreached.empty() && !cli::interrupted();
  const nlohmann::json none;
  const bool tracked = !journey.errors.empty();
  const double rms = moments(journey.errors).root_mean_square();
  const double worst = summarize(journey.errors).maximum;
  std::vector<std::uint8_t> entered(mesh.triangles.size(), 0), on_strip(mesh.triangles.size(), 0);
  for (const std::int32_t t : journey.strip) entered[static_cast<std::size_t>(t)] = 1;
  for (const std::int32_t t : planned_strip) on_strip[static_cast<std::size_t>(t)] = 1;
  const auto covered = static_cast<double>(std::count(entered.begin(), entered.end(), 1)) /
                       static_cast<double>(entered.size());
  nlohmann::json metrics{{"scene", s.scene},
                         {"method", "strip"},
                         {"reconstruct", scanned.reconstruct},
                         {"search", s.search},
                         {"field", s.robot == "magnebike" ? none : nlohmann::json(s.field)},
                         {"robot", s.robot},
                         {"seed", s.seed},
                         {"vertices", mesh.vertices.size()},
                         {"triangles", mesh.triangles.size()},
                         {"nonmanifold_edges", defects.nonmanifold_edges},
                         {"path_length_m", planned},
                         {"driven_length_m", driven},
                         {"driven_ratio", planned > 0.0 ? nlohmann::json(driven / planned) : none},
                         {"tracking_rms_m", tracked ? nlohmann::json(rms) : none},
                         {"tracking_worst_m", tracked ? nlohmann::json(worst) : none},
                         {"left_strip", left},
                         {"replans", replans},
                         {"field_breaks", breaks},
                         {"field_shared_vertices", shared},
                         {"covered_triangles", s.cover ? nlohmann::json(covered) : none},
                         {"reached_goal", all},
                         {"unreached_goals", unreached},
                         {"preparation_time_s", prepared},
                         {"planning_time_s", journey.planning},
                         {"wall_time_s", examples::seconds_since(begin)},
                         {"peak_memory_bytes", examples::peak_memory()}};
  metrics.update(scan_metrics);
  write_file(out / "metrics.json", metrics.dump(2) + "\n");
  write_ply(mesh, out / "surface.ply");
  const TriangleMesh strip_mesh = selected(mesh, [&](std::size_t t) { return on_strip[t] != 0; });
  write_ply(strip_mesh, out / "strip.ply");
  write_tum(out / "path.tum", journey.path);
  write_tum(out / "driven.tum", journey.driven);

  line("drawing");
  Rasterizer picture = examples::navigation_picture(box);
  TriangleMesh colored = mesh;
  colored.normals = vertex_normals(mesh);
  colored.colors.assign(mesh.vertices.size(), {190, 195, 200});
  picture.draw(colored);
  const auto lifted = [&](const std::vector<StampedPose>& record) {
    std::vector<Point3> points;
    for (const StampedPose& p : record)
      points.push_back(p.T_world_body * Point3(0.0, 0.0, 0.002 * box.diagonal().norm()));
    return points;
  };
  const auto path = lifted(journey.path), drive = lifted(journey.driven);
  picture.draw_polyline(path, Rgb{30, 90, 190}, 3.0);
  picture.draw_polyline(drive, Rgb{200, 40, 40}, 2.0);
  const Point3 from = start.position(mesh);
  picture.draw_points(std::span<const Point3>(&from, 1), Rgb{20, 20, 20}, 11.0);
  for (const SurfacePoint& g : goals) {
    const Point3 at = g.position(mesh);
    picture.draw_points(std::span<const Point3>(&at, 1), Rgb{30, 140, 60}, 13.0);
  }
  const Bytes png = encode_png(picture.image());
  write_file(out / "path.png", png);
  Report report("Surface navigation: " + s.scene,
                s.robot + " over " + std::to_string(mesh.triangles.size()) + " triangles");
  std::vector<KeyFigure> figures{
      {"Path", format_number(planned, 3) + " m", std::to_string(journey.legs.size()) + " leg(s)"},
      {"Driven", format_number(driven, 3) + " m",
       planned > 0.0 ? format_number(driven / planned, 3) + " times the path" : "nothing to drive"},
      {"Goals", all ? "reached" : "not all reached",
       std::to_string(left) + " times off the strip, " + std::to_string(breaks) + " field breaks"},
      {"Planning", format_number(1000.0 * journey.planning, 1) + " ms",
       "without preparing the surface"}};
  if (tracked)
    figures.push_back({"Tracking", format_number(100.0 * rms, 2) + " cm rms",
                       format_number(100.0 * worst, 2) + " cm at worst"});
  if (s.cover)
    figures.push_back({"Covered", format_number(100.0 * covered, 1) + " %", "of the triangles"});
  report.add_key_figures(figures);
  report.add_picture(png, "The planned path (blue) and what was driven (red), from black to green");
  if (!unreached.empty()) {
    Table table{"", {"goal", "reason"}, {}};
    for (const auto& u : unreached)
      table.rows.push_back({std::to_string(u["goal"].get<int>()), u["reason"].get<std::string>()});
    report.add_heading("Goals not reached").add_table(table);
  }
  report.write(out / "report.html");
  line.finish();
  std::printf("%.3f m planned, %.3f m driven, %s; results in %s\n", planned, driven,
              all ? "every goal reached" : "not every goal reached", out.string().c_str());
  return all ? cli::kDone : cli::kIncomplete;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("surface_navigation", [&] { return run(argc, argv); });
}
