// SPDX-License-Identifier: MIT
#include "support/fusion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "support/json_values.hpp"
#include "support/peak_memory.hpp"
#include "support/stopwatch.hpp"

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/evaluation/color_map.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/mapping/map_file.hpp>
#include <surfleet/mapping/surface_mesh.hpp>
#include <surfleet/mapping/surface_points.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/viewpoint/coverage_estimate.hpp>
#include <surfleet/viewpoint/gain.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/viewpoint_cover.hpp>
#include <surfleet/viewpoint/viewpoint_generation.hpp>

namespace surfleet::examples {
namespace {
std::optional<Box3> bounds_of(const FusionSettings& s) {
  if (s.bounds.empty()) return std::nullopt;
  return cli::box_from_numbers(s.bounds, "--bounds");
}
/// Behind a surface an observation soon knows nothing, as in missions.
DropOffWeight<> fusion_weight(const FusionSettings& s) {
  return {.full = s.voxel, .zero = 1.5 * s.voxel};
}
TsdfOptions fusion_options(const FusionSettings& s) {
  TsdfOptions o;
  o.truncation = s.mu();
  o.threads = s.threads;
  return o;
}

struct NextViews {
  std::vector<NextView> views;  ///< The one that adds most first.
  std::size_t incomplete = 0;   ///< Elements of the map, …
  std::size_t asked = 0;        ///< … those that a view was sought for, evenly picked …
  std::size_t unseen = 0;       ///< … and of these, those that none was found for.
  double covered = 0.0;         ///< Share of those asked that the views show.
};

/// Elements that are asked about, at the most: their shares are within a few hundredths.
constexpr std::size_t kMostAsked = 4000;

/// Views of what is incomplete, from space that was seen to be free: for one element after the
/// other that no view shows yet, then greedily by what each adds.
NextViews plan_next_views(const IncompleteSurface& incomplete, const VoxelStateMap& states,
                          const PinholeCamera& camera, const FusionSettings& s) {
  NextViews next;
  std::vector<IncompleteElement> elements = incomplete.elements();
  next.incomplete = elements.size();
  const std::size_t count = std::min(elements.size(), kMostAsked);
  std::vector<IncompleteElement> asked;
  for (std::size_t i = 0; i < count; ++i) asked.push_back(elements[i * elements.size() / count]);
  next.asked = count;
  if (count == 0 || s.views == 0) return next;

  const Pose mount = forward_camera_mount(radians(s.pitch));
  ViewpointOptions options;
  options.distance = s.standoff.value_or(0.5 * (s.range[0] + s.range[1]));
  options.max_distance = s.range[1];
  options.distance_step = std::max(0.02, 0.1 * (s.range[1] - s.range[0]));
  options.T_body_camera = mount;
  ViewpointGenerator generate(states, camera, options);
  const ViewFrustum frustum(camera, mount);
  const IncompleteSurfaceGain gain(asked, states, frustum);
  const EmptyBall is_free{&states, s.radius};
  std::vector<std::uint8_t> shown(count, 0);
  std::vector<Viewpoint> views;
  std::vector<std::vector<std::int32_t>> seen;
  // Not in the order of the voxels, lest neighbours' views come one after the other.
  std::size_t stride = std::max<std::size_t>(1, count * 618 / 1000);
  while (std::gcd(stride, count) != 1) ++stride;
  for (std::size_t k = 0, i = 0; k < count; ++k, i = (i + stride) % count) {
    if (shown[i] != 0) continue;
    const ViewpointChoice choice = generate(asked[i], is_free);
    if (!choice.view) {
      ++next.unseen;
      continue;
    }
    views.push_back(*choice.view);
    seen.push_back(gain.seen(choice.view->configuration));
    shown[i] = 1;
    for (const std::int32_t e : seen.back()) shown[static_cast<std::size_t>(e)] = 1;
  }
  std::size_t covered = 0;
  for (const CoverChoice& choice : cover_greedily(seen, static_cast<std::size_t>(s.views))) {
    const Configuration& q = views[choice.set].configuration;
    next.views.push_back(
        {q, q.pose() * mount, gain.value(seen[choice.set].size()), gain.value(choice.adds)});
    covered += choice.adds;
  }
  next.covered = gain.value(covered);
  return next;
}

nlohmann::json matrix_of(const Pose& pose) {
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < 4; ++i)
    rows.push_back(
        {pose.matrix()(i, 0), pose.matrix()(i, 1), pose.matrix()(i, 2), pose.matrix()(i, 3)});
  return rows;
}
nlohmann::json json_of(const NextViews& next, const PinholeCamera& c) {
  nlohmann::json list = nlohmann::json::array();
  for (const NextView& v : next.views) {
    const Eigen::Quaterniond q(v.T_world_camera.linear());
    list.push_back({{"position", triple(v.T_world_camera.translation())},
                    {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}},
                    {"yaw_rad", v.body.yaw},
                    {"gain", v.gain},
                    {"added_gain", v.added}});
  }
  return {{"pose", "of the camera in the map: x right, y down, z forward"},
          {"camera",
           {{"width", c.width},
            {"height", c.height},
            {"fx", c.fx},
            {"fy", c.fy},
            {"cx", c.cx},
            {"cy", c.cy},
            {"range_m", {c.min_range, c.max_range}}}},
          {"incomplete_elements", next.incomplete},
          {"viewpoints", list}};
}

/// The mesh without what `eye` would see from behind: rooms are seen from outside.
TriangleMesh facing(const TriangleMesh& mesh, const Point3& eye) {
  return selected(
      mesh, [&](std::size_t t) { return mesh.area_vector(t).dot(eye - mesh.centroid(t)) > 0.0; });
}
std::vector<std::byte> picture_of(const TriangleMesh& mesh, RenderView view,
                                  const Trajectory& sensors, const NextViews& next) {
  const Eigen::Vector3d back = (view.eye - view.target).normalized();
  Rasterizer picture(view,
                     {.to_light = back + 0.6 * view.up + 0.3 * view.up.cross(back).normalized()});
  picture.draw(facing(mesh, view.eye), MeshStyle{});
  std::vector<Point3> path, eyes;
  for (const StampedPose& p : sensors) path.push_back(p.T_world_body.translation());
  picture.draw_polyline(path, categorical_color(0), 2.0);
  picture.draw_points(path, categorical_color(0), 4.0);
  for (const NextView& v : next.views) {
    const Point3 eye = v.T_world_camera.translation();
    const double length = 0.06 * (view.eye - view.target).norm() * 0.5;
    picture.draw_polyline(std::vector<Point3>{eye, v.T_world_camera * Point3(0, 0, length)},
                          categorical_color(1), 2.0);
    eyes.push_back(eye);
  }
  picture.draw_points(eyes, categorical_color(1), 6.0);
  return encode_png(picture.image());
}
/// All but the hundredth of the vertices that is farthest out on every side, which are few and far.
Box3 bulk(const TriangleMesh& mesh) {
  Box3 box;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> c;
    for (const Point3& p : mesh.vertices) c.push_back(p[k]);
    const auto at = [&](double share) {
      const auto i = static_cast<std::ptrdiff_t>(share * static_cast<double>(c.size() - 1));
      std::nth_element(c.begin(), c.begin() + i, c.end());
      return c[static_cast<std::size_t>(i)];
    };
    box.min()[k] = at(0.01);
    box.max()[k] = at(0.99);
  }
  return box;
}
/// The two directions from which most is to be seen: to either side of the one that the surface
/// faces as a whole, or opposite ones if it faces none [rad].
std::array<double, 2> azimuths(const TriangleMesh& mesh) {
  constexpr double kOneSided = 0.1;  // of the area, as a sum of vectors
  Eigen::Vector3d faced = Eigen::Vector3d::Zero();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) faced += mesh.area_vector(t);
  if (faced.head<2>().norm() < kOneSided * mesh.area()) return {radians(-55.0), radians(125.0)};
  const double middle = std::atan2(faced.y(), faced.x());
  return {middle - radians(35.0), middle + radians(35.0)};
}
/// Over the shoulder of the sensor in the middle of the recording.
RenderView behind_sensor(const Pose& T_world_camera, const PinholeCamera& camera) {
  RenderView view;
  const Eigen::Matrix3d R = T_world_camera.linear();
  view.eye = T_world_camera.translation() - 0.1 * camera.max_range * R.col(2);
  view.target = T_world_camera.translation() + 0.5 * camera.max_range * R.col(2);
  view.up = -R.col(1);
  view.vertical_fov = camera.vertical_fov();
  view.width = 1000;
  view.height = std::clamp(1000 * camera.height / camera.width, 200, 2000);
  return view;
}
}  // namespace

Pose FusionSettings::upright() const {
  Pose turned = Pose::Identity();
  turned.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(up[0], up[1], up[2]),
                                                       Eigen::Vector3d::UnitZ())
                        .toRotationMatrix();
  return turned;
}

void declare_fusion_options(cli::Options& app, FusionSettings& s) {
  app.begin_group("Map");
  app.add("--voxel", s.voxel, "edge of a voxel [m]");
  app.add("--range", s.range, "nearest and farthest that is trusted [m]; what is farther carves")
      .expected(2);
  app.add("--truncation", s.truncation, "mu of the TSDF [m]; default three voxels");
  app.add("--known-weight", s.known_weight,
          "W_th: weight of a known voxel; an observation from range r counts 1 / r^2; default that "
          "of " +
              std::to_string(static_cast<int>(s.observations)) +
              (s.observations > 1.0 ? " observations" : " observation") +
              " from the far end of --range");
  app.add("--bounds", s.bounds, "what is meshed and viewed: x0 y0 z0 x1 y1 z1 [m]").expected(6);
  app.add("--up", s.up,
          "direction that is up in the frame of the poses; results are turned so that it is z")
      .expected(3);
  app.begin_group("Recording");
  app.add("--max-time-off", s.max_time_off, "most between an observation and its pose [s]");
  app.add_flag("--strict", s.strict, "refuse what cannot be used, rather than skip and count it");
  app.begin_group("Next viewpoints");
  app.add("--views", s.views, "next viewpoints, at most").within(0, 1000);
  app.add("--standoff", s.standoff,
          "delta_pose, distance of a view [m]; default the middle of --range");
  app.add("--pitch", s.pitch, "of the camera of the next views, downwards [deg]");
  app.add("--radius", s.radius, "of the body that needs seen free space at a view [m]");
  app.begin_group("Run");
  app.add("--threads", s.threads, "threads; the result is the same for any number").within(1, 256);
  app.add("--out", s.out, "folder for the results");
  app.add_flag("--quiet", s.quiet, "no progress line");
}

void check_fusion_settings(const FusionSettings& s) {
  require(s.voxel >= 1e-3 && s.voxel <= 10.0,
          "--voxel " + std::to_string(s.voxel) + ": expected 0.001 to 10 m");
  require(s.range[0] >= 0.0 && s.range[1] > s.range[0] && s.range[1] <= 1000.0,
          "--range: expected 0 <= nearest < farthest <= 1000 m");
  require(s.range[1] <= 1e5 * s.voxel, "--range: expected less than 100000 voxels");
  if (s.truncation)
    require(*s.truncation >= s.voxel && std::isfinite(*s.truncation),
            "--truncation: expected a voxel or more");
  if (s.known_weight)
    require(*s.known_weight > 0.0 && std::isfinite(*s.known_weight),
            "--known-weight: expected a positive number");
  if (s.standoff)
    require(*s.standoff >= s.range[0] && *s.standoff <= s.range[1],
            "--standoff: expected a distance in --range");
  const Eigen::Vector3d up(s.up[0], s.up[1], s.up[2]);
  require(up.allFinite() && up.norm() > 1e-9 && up.norm() < 1e9,
          "--up: expected a direction, as in 0 0 1");
  require(std::abs(s.pitch) <= 90.0, "--pitch: expected -90 to 90 degrees");
  require(s.radius >= 0.0 && s.radius <= 1000.0 * s.voxel, "--radius: expected 0 to 1000 voxels");
  require(s.max_time_off >= 0.0 && std::isfinite(s.max_time_off),
          "--max-time-off: expected 0 or more seconds");
  static_cast<void>(bounds_of(s));
}

Fusion::Fusion(const FusionSettings& settings)
    : settings_(settings),
      upright_(settings.upright()),
      integrate_(fusion_options(settings), fusion_weight(settings)),
      map_({.voxel_size = settings.voxel}) {}

void Fusion::add(const DepthImage& image, const PinholeCamera& camera, const Pose& T_world_camera,
                 double time) {
  const auto start = Clock::now();
  const Pose pose = upright_ * T_world_camera;
  integrate_(image, camera, pose, map_);
  depth_images_ = true;
  sensors_.push_back({time, pose});
  fuse_ += seconds_since(start);
}
void Fusion::add(const PointCloud& scan, const Pose& T_world_sensor, double time) {
  const auto start = Clock::now();
  const Pose pose = upright_ * T_world_sensor;
  integrate_(scan, settings_.range[0], settings_.range[1], pose, map_);
  sensors_.push_back({time, pose});
  fuse_ += seconds_since(start);
}

int Fusion::finish(const char* program, const PinholeCamera& camera, const SkippedFrames& skipped,
                   FusionTimes times) {
  const FusionSettings& s = settings_;
  const std::optional<Box3> box = bounds_of(s);
  require(!sensors_.empty(), s.input + ": nothing can be used; " + skipped.summary());
  times.fuse = fuse_;
  const auto extracting = Clock::now();
  const double known = s.known();
  PointCloud points = extract_points(map_, {.min_weight = known, .threads = s.threads});
  TriangleMesh mesh = extract_surface(map_, points, {.min_weight = known, .threads = s.threads});
  if (box) {
    mesh = cropped(mesh, *box);
    points = cropped(points, *box);
  }
  times.extract = seconds_since(extracting);
  require(!mesh.empty(), s.input +
                             ": no surface is known; expected a wider --range, a lower "
                             "--known-weight or --depth-scale, or poses that fit");
  const auto viewing = Clock::now();
  const VoxelStateMap states(map_, {.known_weight = known});
  IncompleteSurface incomplete({.known_weight = known, .region = box.value_or(Box3())});
  incomplete.update(states);
  const NextViews next = plan_next_views(incomplete, states, camera, s);
  const CoverageEstimate coverage =
      estimate_coverage(map_, mesh, incomplete, known, box.value_or(Box3()));
  times.views = seconds_since(viewing);

  const auto out = cli::prepare_output_folder(s.out);
  write_ply(mesh, out / "reconstruction.ply");
  write_ply(points, out / "points.ply");
  save_map(map_, out / "map.sfm");
  write_tum(out / "sensors.tum", sensors_);
  Trajectory poses;
  for (const NextView& v : next.views)
    poses.push_back({static_cast<double>(poses.size()), v.T_world_camera});
  write_tum(out / "next_viewpoints.tum", poses);
  write_file(out / "next_viewpoints.json", json_of(next, camera).dump(2) + "\n");

  const double frames = static_cast<double>(sensors_.size());
  nlohmann::json metrics{{"frames", sensors_.size()},
                         {"frames_skipped", skipped.total()},
                         {"frames_skipped_reasons", skipped.counts()},
                         {"interrupted", cli::interrupted()},
                         {"voxel_m", s.voxel},
                         {"truncation_m", s.mu()},
                         {"known_weight", known},
                         {"range_m", s.range},
                         {"read_time_s", times.read},
                         {"fuse_time_s", times.fuse},
                         {"extract_time_s", times.extract},
                         {"viewpoint_time_s", times.views},
                         {"wall_time_s", times.wall + times.extract + times.views},
                         {"png_to_mesh_s_per_frame", (times.wall + times.extract) / frames},
                         {"peak_memory_bytes", peak_memory()},
                         {"map_blocks", map_.block_count()},
                         {"mesh_triangles", mesh.triangles.size()},
                         {"mesh_area_m2", mesh.area()},
                         {"points", points.size()},
                         {"estimated_coverage", coverage.share()},
                         {"remaining_ise", next.incomplete},
                         {"next_viewpoints", next.views.size()},
                         {"next_viewpoints_show", next.covered},
                         {"T_map_input", matrix_of(upright_)}};
  write_file(out / "metrics.json", metrics.dump(2) + "\n");

  Report report("Fusion of recorded observations",
                std::to_string(sensors_.size()) + " of " +
                    std::to_string(sensors_.size() + static_cast<std::size_t>(skipped.total())) +
                    " frames, voxels of " + format_number(100.0 * s.voxel, 1) + " cm");
  const std::vector<KeyFigure> key{
      {"surface", format_number(mesh.area(), 1) + " m²",
       std::to_string(mesh.triangles.size()) + " triangles"},
      {"by its own account", format_number(100.0 * coverage.share(), 1) + " %",
       "of the surface that was met or must go on"},
      {"incomplete elements", std::to_string(next.incomplete), "where known surface ends"},
      {"next viewpoints", std::to_string(next.views.size()),
       "would show " + format_number(100.0 * next.covered, 0) + " % of these"},
      {"a frame", format_number(1000.0 * (times.wall + times.extract) / frames, 1) + " ms",
       "from file to mesh"}};
  report.add_key_figures(key);
  const Box3 frame = bulk(mesh);
  for (const double azimuth : azimuths(mesh))
    report.add_picture(
        picture_of(mesh, frame_box(frame, azimuth, radians(35.0), 1000, 700), sensors_, next),
        "The surface, the sensor's path (blue) and the next viewpoints (orange); what faces away "
        "is left out",
        true);
  report.add_picture(
      picture_of(mesh, frame_box(frame, radians(-90.0), radians(89.0), 1000, 700), sensors_, next),
      "From above", true);
  if (depth_images_)
    report.add_picture(
        picture_of(mesh, behind_sensor(sensors_[sensors_.size() / 2].T_world_body, camera), {}, {}),
        "Over the camera's shoulder, half way", true);
  Table best{.caption = "Next viewpoints (next_viewpoints.json, next_viewpoints.tum)",
             .columns = {"", "x [m]", "y [m]", "z [m]", "heading [deg]", "shows [%]", "adds [%]"}};
  for (const NextView& v : next.views) {
    const Point3 eye = v.T_world_camera.translation();
    best.add_row({std::to_string(best.rows.size() + 1), format_number(eye.x(), 2),
                  format_number(eye.y(), 2), format_number(eye.z(), 2),
                  format_number(degrees(v.body.yaw), 1), format_number(100.0 * v.gain, 1),
                  format_number(100.0 * v.added, 1)});
  }
  Table all{.caption = "Metrics (metrics.json)", .columns = {"key", "value"}};
  for (const auto& [name, value] : metrics.items()) all.add_row({name, value.dump()});
  report.add_table(best).add_table(all);
  report.write(out / "report.html");

  std::printf("%zu frames", sensors_.size());
  if (skipped.total() > 0) std::printf(", %s", cli::one_line(skipped.summary()).c_str());
  std::printf("\n  surface %.2f m2 in %zu triangles, %zu points, %zu incomplete elements\n",
              mesh.area(), mesh.triangles.size(), points.size(), next.incomplete);
  std::printf(
      "  read %.2f s, fuse %.2f s, extract %.2f s, viewpoints %.2f s; %.1f ms a frame to "
      "the mesh\n",
      times.read, times.fuse, times.extract, times.views,
      1000.0 * (times.wall + times.extract) / frames);
  std::printf("  see %s\n", (out / "report.html").c_str());
  if (depth_images_) {
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    for (const StampedPose& p : sensors_) up -= p.T_world_body.linear().col(1);
    up /= frames;
    constexpr double kLeastUp = 0.5;  // cosine beside z, of cameras that are held as people do
    if (up.norm() > kLeastUp && up.z() < kLeastUp * up.norm()) {
      const Eigen::Vector3d given = upright_.linear().transpose() * up;
      std::fprintf(stderr,
                   "%s: the images' own up is mostly %.1f %.1f %.1f in the frame of the poses; "
                   "viewpoints are level with z: --up may be wrong\n",
                   program, given.x(), given.y(), given.z());
    }
  }
  return cli::interrupted() ? cli::kIncomplete : cli::kDone;
}
}  // namespace surfleet::examples
