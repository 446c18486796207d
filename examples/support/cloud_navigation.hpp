// SPDX-License-Identifier: MIT
/// @file
/// @brief `surface_navigation --method dense`: from a raw cloud, or samples of a scene, to a path.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/evaluation/surface_sampling.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/clean_surface.hpp>
#include <surfleet/geometry/cloud_filters.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/simulation/rotating_lidar.hpp>
#include <surfleet/surface/dense_planner.hpp>
#include <surfleet/surface/geodesic_strip.hpp>
#include <surfleet/surface/smooth_path.hpp>

#include "cli.hpp"
#include "navigation_parts.hpp"
#include "peak_memory.hpp"
#include "stopwatch.hpp"
#include "surface_scene.hpp"

namespace surfleet::examples {
struct CloudNavigation {
  std::string scene, out, voting = "sheets";
  std::optional<double> edge, spacing, vote_scale, voxel;  ///< [m]
  double density = 3600.0, cloud_noise = 0.0, outliers = 3.0;
  double mask = 0.5, edge_threshold = 0.06, inflate = 0.0;
  std::vector<double> scan_from, cost, start, goal;
  double off_surface = 0.1, speed = 0.05;
  std::uint64_t seed = 1;
  int threads = 1;
  bool quiet = false;
};

namespace cloud_navigation {
/// The surface that a cloud was taken from, with what answers questions about it.
struct Truth {
  TriangleMesh mesh;
  Bvh bvh{mesh};
  SurfaceWalk walk{mesh};
  GeodesicStrips strips{walk};

  explicit Truth(TriangleMesh surface) : mesh(std::move(surface)) {}
  Truth(const Truth&) = delete;

  /// Length of a shortest path; nothing if none is found.
  std::optional<double> distance(const Point3& a, const Point3& b) const {
    const auto from = nearest_surface_point(mesh, bvh, a), to = nearest_surface_point(mesh, bvh, b);
    if (!from || !to) return std::nullopt;
    const auto strip = strips.triangles(*from, *to);
    if (!strip) return std::nullopt;
    return strips.shortener()
        .shortened(*strip, *from, *to, [](std::int32_t) { return true; })
        .length();
  }
};

/// A cloud, and the surface that it was taken from where that is known.
struct Input {
  PointCloud cloud;
  std::unique_ptr<Truth> truth;
  std::size_t raw = 0;  ///< Points before any was left out.
};

inline Input input(const CloudNavigation& s) {
  Input in;
  const std::filesystem::path file = s.scene;
  const auto take = [&](const TriangleMesh& mesh) {
    in.truth = std::make_unique<Truth>(clean_surface(mesh));
  };
  if (file.has_extension()) {
    try {
      take(read_mesh(file));
    } catch (const Error&) {  // no mesh: then what it says as a cloud
      in.cloud = read_point_cloud(file);
    }
  } else {
    take(surface_scene(s.scene, s.edge));
  }
  if (!in.truth) return in;
  if (s.scan_from.empty()) {
    in.cloud = sample_surface(in.truth->mesh, {.density = s.density, .seed = s.seed}).cloud;
    add_noise(in.cloud.points, s.cloud_noise, s.seed);
  } else {
    for (std::size_t k = 0; k + 2 < s.scan_from.size(); k += 3) {
      Pose T = Pose::Identity();
      T.translation() = Point3(s.scan_from[k], s.scan_from[k + 1], s.scan_from[k + 2]);
      RotatingLidar lidar;
      lidar.noise = s.cloud_noise;
      lidar.seed = s.seed + k;
      lidar.threads = s.threads;
      const PointCloud scan = lidar.scan(in.truth->bvh, T);
      in.cloud.points.insert(in.cloud.points.end(), scan.points.begin(), scan.points.end());
    }
  }
  in.cloud.normals.clear();
  return in;
}

/// The same less what is not finite, crowded, or lonely. Throws `Error` if hardly any is left.
inline Input usable_input(const CloudNavigation& s) {
  require(s.scan_from.size() % 3 == 0, "--scan-from: expected three numbers for each scan");
  Input in = input(s);
  in.raw = in.cloud.size();
  in.cloud = selected(in.cloud, finite_points(in.cloud.points));
  if (s.spacing) in.cloud = selected(in.cloud, evenly_spaced(in.cloud.points, *s.spacing, s.seed));
  if (s.outliers > 0.0)
    in.cloud = selected(in.cloud,
                        inliers(in.cloud.points, {.deviations = s.outliers, .threads = s.threads}));
  require(in.cloud.size() >= 4, "the cloud has " + std::to_string(in.cloud.size()) +
                                    " usable points; expected four or more");
  return in;
}

/// σ [m]: as asked for, else the larger of the MagneBike's wheel and three spacings.
inline double voting_scale(const CloudNavigation& s, std::span<const Point3> points) {
  constexpr double kWheel = 0.06;  // [m]
  return s.vote_scale ? *s.vote_scale : std::max(kWheel, 3.0 * median_spacing(points));
}

/// Places every 5 mm along the edges of a mesh that fold by more than 30°.
inline std::vector<Point3> true_edges(const TriangleMesh& mesh) {
  std::vector<Point3> places;
  const MeshAdjacency adjacency(mesh);
  for (std::size_t e = 0; e < adjacency.edge_count(); ++e) {
    const auto sides = adjacency.triangles_of_edge(static_cast<std::int32_t>(e));
    if (sides.size() != 2) continue;
    const Eigen::Vector3d a = mesh.area_vector(static_cast<std::size_t>(sides[0])),
                          b = mesh.area_vector(static_cast<std::size_t>(sides[1]));
    if (std::atan2(a.cross(b).norm(), a.dot(b)) < radians(30.0)) continue;
    const auto& v = adjacency.edges()[e].vertices;
    const Point3 &p = mesh.vertices[static_cast<std::size_t>(v[0])],
                 &q = mesh.vertices[static_cast<std::size_t>(v[1])];
    const int parts = std::max(1, static_cast<int>((q - p).norm() / 0.005));
    for (int k = 0; k <= parts; ++k) places.push_back(p + (q - p) * k / parts);
  }
  return places;
}

/// How well tokens agree with the true surface; null where there is nothing to compare.
inline nlohmann::json token_quality(const CloudTokens& cloud, const Truth& surface, double scale) {
  const KdTree edges(true_edges(surface.mesh));
  std::vector<double> error;
  double hits = 0.0, false_alarms = 0.0, missed = 0.0;
  for (std::size_t i = 0; i < cloud.tokens.size(); ++i) {
    const Token& t = cloud.tokens[i];
    const auto near = surface.bvh.closest_point(t.position, 10.0 * scale);
    if (!near) continue;
    const auto fold = edges.nearest(t.position);
    const bool truth = fold && fold->distance() < 0.5 * scale, edge = cloud.edge[i] != 0;
    hits += truth && edge ? 1.0 : 0.0;
    false_alarms += !truth && edge ? 1.0 : 0.0;
    missed += truth && !edge ? 1.0 : 0.0;
    if (fold && fold->distance() < 3.0 * scale) continue;
    const Eigen::Vector3d n = surface.mesh.area_vector(static_cast<std::size_t>(near->triangle));
    error.push_back(degrees(std::atan2(n.cross(t.normal).norm(), std::abs(n.dot(t.normal)))));
  }
  nlohmann::json q;
  const nlohmann::json none;
  q["orientation_error_deg"] = error.empty() ? none : nlohmann::json(summarize(error).median);
  q["edge_precision"] =
      hits + false_alarms > 0.0 ? nlohmann::json(hits / (hits + false_alarms)) : none;
  q["edge_recall"] = hits + missed > 0.0 ? nlohmann::json(hits / (hits + missed)) : none;
  return q;
}

/// The centres of the most surface cells that steps of a planner join, whatever its turns; a scan
/// of the open has many small parts beside it.
struct LargestPart {
  std::vector<std::int32_t> cells;
  KdTree tree;

  explicit LargestPart(const DensePlanner& planner) {
    const FeatureMaps& maps = planner.maps();
    DisjointSets parts(maps.cells().size());
    std::vector<std::int32_t> surface;
    for (std::int32_t c = 0; c < static_cast<std::int32_t>(maps.cells().size()); ++c) {
      if (!planner.is_surface(c)) continue;
      surface.push_back(c);
      for (int h = 0; h < DensePlanner::kHeadings; ++h)
        if (const std::int32_t to = planner.neighbor(c, h); to >= 0) parts.unite(c, to);
    }
    std::vector<std::size_t> size(maps.cells().size(), 0);
    for (const std::int32_t c : surface) ++size[static_cast<std::size_t>(parts.find(c))];
    const auto most =
        static_cast<std::int32_t>(std::max_element(size.begin(), size.end()) - size.begin());
    std::vector<Point3> at;
    for (const std::int32_t c : surface) {
      if (parts.find(c) != most) continue;
      cells.push_back(c);
      at.push_back(maps[c].position);
    }
    tree = KdTree(at);
  }
};

inline Pose body_pose(const OrientedPoint& at, const Eigen::Vector3d& ahead) {
  Pose T = Pose::Identity();
  Eigen::Vector3d x = ahead - ahead.dot(at.normal) * at.normal;
  x = x.norm() > 1e-12 ? Eigen::Vector3d(x.normalized())
                       : Eigen::Vector3d(at.normal.unitOrthogonal());
  T.linear().col(0) = x;
  T.linear().col(1) = at.normal.cross(x);
  T.linear().col(2) = at.normal;
  T.translation() = at.position;
  return T;
}
}  // namespace cloud_navigation

/// Runs the pipeline; the program's exit status.
inline int navigate_cloud(const CloudNavigation& s) {
  using namespace cloud_navigation;
  const auto begin = Clock::now();
  require(s.cost.empty() || s.cost.size() == 4, "--cost: expected four weights");
  const Input in = usable_input(s);
  const double scale = voting_scale(s, in.cloud.points);
  const double voxel = s.voxel.value_or(scale * 0.035 / 0.06);
  cli::ProgressLine line(!s.quiet);

  line("voting");
  const auto voting = Clock::now();
  CloudTokenOptions token_options;
  token_options.scale = scale;
  token_options.mask = s.mask;
  token_options.edge_threshold = s.edge_threshold;
  token_options.first = s.voting == "balls" ? FirstRound::balls : FirstRound::sheets;
  token_options.threads = s.threads;
  const CloudTokens tokens = cloud_tokens(in.cloud.points, token_options);
  FeatureMapOptions map_options;
  map_options.voxel = voxel;
  map_options.inflation = s.inflate;
  map_options.threads = s.threads;
  const FeatureMaps maps(tokens, scale, map_options);
  const double vote_time = seconds_since(voting);
  require(!maps.cells().empty(),
          "no surface: no two points lie within three voting scales (--vote-scale)");

  const auto planning = Clock::now();
  DensePlannerOptions options;
  options.threads = s.threads;
  if (!s.cost.empty()) options.costs = {s.cost[0], s.cost[1], s.cost[2], s.cost[3]};
  const DensePlanner planner(maps, options);
  double planning_time = seconds_since(planning);
  Box3 box;
  for (const Token& t : tokens.tokens) box.extend(t.position);
  const auto place = [&](const Point3& p, const char* what) {
    const auto cell = planner.cell_at(p, s.off_surface);
    char text[160];
    std::snprintf(text, sizeof text,
                  "%s: no surface within %.3f m; expected a place on the cloud (--off-surface)",
                  what, s.off_surface);
    require(cell.has_value(), text);
    return *cell;
  };
  const LargestPart part(planner);
  require(!part.cells.empty(), "no cell of the cloud is surface; expected a denser cloud");
  Box3 around;
  for (const std::int32_t c : part.cells) around.extend(maps[c].position);
  const auto end = [&](double share) {  // of its box's diagonal
    const auto near = part.tree.nearest(around.center() + (share - 0.5) * around.sizes());
    return part.cells[static_cast<std::size_t>(near->index)];
  };
  const auto [start, goals] = route_ends(s.start, s.goal, place, end);
  const auto out = cli::prepare_output_folder(s.out);
  cli::watch_interrupts();

  std::vector<StampedPose> record;
  std::vector<std::vector<Point3>> drawn;
  nlohmann::json unreached = nlohmann::json::array(), legs = nlohmann::json::array();
  double length = 0.0, cell_length = 0.0, exact = 0.0, worst_attack = 0.0;
  std::size_t crossings = 0;
  std::int32_t at = start;
  const nlohmann::json none;
  for (std::size_t g = 0; g < goals.size() && !cli::interrupted(); ++g) {
    line("goal " + std::to_string(g + 1) + " of " + std::to_string(goals.size()));
    const auto searching = Clock::now();
    const auto path = planner(at, goals[g]);
    const double searched = seconds_since(searching);
    if (!path) {
      planning_time += searched;
      unreached.push_back({{"goal", g}, {"reason", "no path over salient surface leads to it"}});
      continue;
    }
    SmoothPathOptions smoothing;
    smoothing.reach = scale;
    smoothing.spacing = voxel;
    const SmoothPath smooth = smoothed(planner, tokens, *path, smoothing);
    planning_time += seconds_since(searching);
    nlohmann::json leg{{"path_length_m", smooth.length()},
                       {"cell_path_length_m", path->length},
                       {"cost", path->cost},
                       {"expanded_nodes", path->expanded},
                       {"edge_crossings", smooth.crossings.size()},
                       {"search_time_s", searched}};
    length += smooth.length();
    cell_length += path->length;
    crossings += smooth.crossings.size();
    worst_attack = std::max(worst_attack, smooth.worst_attack());
    if (in.truth)
      if (const auto shortest =
              in.truth->distance(smooth.points.front().position, smooth.points.back().position)) {
        exact += *shortest;
        leg["geodesic_ratio"] =
            *shortest > 0.0 ? nlohmann::json(smooth.length() / *shortest) : none;
      }
    legs.push_back(leg);
    std::vector<Point3> points;
    for (std::size_t i = 0; i < smooth.points.size(); ++i) {
      const std::size_t next = std::min(i + 1, smooth.points.size() - 1);
      const std::size_t last = next == i && i > 0 ? i - 1 : i;
      append_pose(
          record,
          body_pose(smooth.points[i], smooth.points[next].position - smooth.points[last].position),
          s.speed);
      points.push_back(smooth.points[i].position + 0.5 * voxel * smooth.points[i].normal);
    }
    drawn.push_back(points);
    at = goals[g];
  }

  const bool all = unreached.empty() && !cli::interrupted();
  std::size_t edge_tokens = 0;
  for (const std::uint8_t e : tokens.edge) edge_tokens += e;
  nlohmann::json metrics{
      {"scene", s.scene},
      {"method", "dense"},
      {"voting", s.voting},
      {"seed", s.seed},
      {"points", in.raw},
      {"points_used", in.cloud.size()},
      {"tokens", tokens.tokens.size()},
      {"edge_tokens", edge_tokens},
      {"cells", maps.cells().size()},
      {"vote_scale_m", scale},
      {"voxel_m", voxel},
      {"path_length_m", length},
      {"cell_path_length_m", cell_length},
      {"geodesic_ratio", exact > 0.0 ? nlohmann::json(length / exact) : none},
      {"edge_crossings", crossings},
      {"edge_crossing_max_deg", crossings > 0 ? nlohmann::json(degrees(worst_attack)) : none},
      {"orientation_error_deg", none},
      {"edge_precision", none},
      {"edge_recall", none},
      {"legs", legs},
      {"reached_goal", all},
      {"unreached_goals", unreached},
      {"vote_time_s", vote_time},
      {"planning_time_s", planning_time}};
  if (in.truth) metrics.update(token_quality(tokens, *in.truth, scale));

  PointCloud colored, edges;
  const double best = std::max(maps.greatest_saliency(), 1e-300);
  std::vector<double> sticks;
  for (const Token& t : tokens.tokens) sticks.push_back(t.stick);
  const double top = std::max(summarize(sticks).maximum, 1e-300);
  for (std::size_t i = 0; i < tokens.tokens.size(); ++i) {
    const Token& t = tokens.tokens[i];
    colored.points.push_back(t.position);
    colored.normals.push_back(t.normal.cast<float>());
    const auto grey = static_cast<std::uint8_t>(40.0 + 200.0 * std::clamp(t.stick / top, 0.0, 1.0));
    colored.colors.push_back(tokens.edge[i] != 0 ? std::array<std::uint8_t, 3>{200, 40, 40}
                                                 : std::array<std::uint8_t, 3>{grey, grey, grey});
  }
  for (const EdgePoint& e : tokens.edge_points) edges.points.push_back(e.position);
  write_ply(colored, out / "tokens.ply");
  write_ply(edges, out / "edges.ply");
  if (in.truth) write_ply(in.truth->mesh, out / "surface.ply");
  write_tum(out / "path.tum", record);

  line("drawing");
  Rasterizer picture = navigation_picture(box);
  std::vector<Point3> faint, salient, red;
  for (std::size_t i = 0; i < tokens.tokens.size(); ++i)
    (tokens.edge[i] != 0                  ? red
     : tokens.tokens[i].stick < 0.5 * top ? faint
                                          : salient)
        .push_back(tokens.tokens[i].position);
  picture.draw_points(faint, Rgb{215, 218, 222}, 4.0);
  picture.draw_points(salient, Rgb{160, 166, 174}, 4.0);
  picture.draw_points(red, Rgb{200, 40, 40}, 5.0);
  for (const auto& points : drawn) picture.draw_polyline(points, Rgb{30, 90, 190}, 4.0);
  const Bytes png = encode_png(picture.image());
  write_file(out / "path.png", png);
  metrics["wall_time_s"] = seconds_since(begin);
  metrics["peak_memory_bytes"] = peak_memory();
  write_file(out / "metrics.json", metrics.dump(2) + "\n");
  Report report("Surface navigation: " + s.scene,
                std::to_string(in.cloud.size()) + " points, dense planner");
  report.add_key_figures(std::vector<KeyFigure>{
      {"Path", format_number(length, 3) + " m", std::to_string(goals.size()) + " goal(s)"},
      {"Edges", std::to_string(crossings) + " crossed",
       "at most " + format_number(degrees(worst_attack), 1) + "° off the square"},
      {"Voting", format_number(vote_time, 2) + " s",
       std::to_string(tokens.tokens.size()) + " tokens, " + std::to_string(maps.cells().size()) +
           " cells"},
      {"Planning", format_number(planning_time, 2) + " s",
       "greatest saliency " + format_number(best, 1)}});
  report.add_picture(png, "Tokens (salient ones darker), edges (red), the path (blue)");
  if (!unreached.empty()) {
    Table table{"", {"goal", "reason"}, {}};
    for (const auto& u : unreached)
      table.rows.push_back({std::to_string(u["goal"].get<int>()), u["reason"].get<std::string>()});
    report.add_heading("Goals not reached").add_table(table);
  }
  report.write(out / "report.html");
  line.finish();
  std::printf("%zu points, %zu tokens, %.3f m planned, %s; results in %s\n", in.cloud.size(),
              tokens.tokens.size(), length, all ? "every goal reached" : "not every goal reached",
              out.string().c_str());
  return all ? cli::kDone : cli::kIncomplete;
}
}  // namespace surfleet::examples
