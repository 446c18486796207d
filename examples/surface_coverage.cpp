// SPDX-License-Identifier: MIT
// A group of robots divides a curved surface among themselves, and each sweeps its part.
//
//   surface_coverage                                       ten robots on the bumpy slope
//   surface_coverage --scene steam_chest --robots 5 --coordinator exchange
//   surface_coverage --scene tank.ply --robots 8 --sweep-range 20 --out out/tank
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/coverage/balance_regions.hpp>
#include <surfleet/coverage/covering_strip.hpp>
#include <surfleet/coverage/hybrid_area_coverage.hpp>
#include <surfleet/coverage/p_median_bound.hpp>
#include <surfleet/coverage/surface_coverage.hpp>
#include <surfleet/evaluation/plot.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/geometry/mesh_io.hpp>

#include "support/cli.hpp"
#include "support/peak_memory.hpp"
#include "support/stopwatch.hpp"
#include "support/surface_scene.hpp"

namespace {
using namespace surfleet;

struct Settings {
  std::string scene = "bumpy_slope", out = "out/surface_coverage", coordinator = "substitution",
              distance = "faces", field = "uniform";
  std::optional<double> edge, sensing, communication, sweep_range, footprint;  ///< [m]
  double ratio = 2.0, speed = 0.1;
  int robots = 10, rounds = 1, max_steps = 20000;
  std::uint64_t seed = 1;
  bool asynchronous = false, sweep = true, balance = true, largest = false, quiet = false;
  std::vector<double> starts;
  std::vector<std::string> events;
};

Settings settings(int argc, char** argv) {
  Settings s;
  cli::Options app(
      "A group of robots divides a curved surface among themselves, and each sweeps its part.\n"
      "Writes metrics.json, regions.ply, sweep_regions.ply, sweep_K.tum, pictures and report.html "
      "to --out.\nExit status: 0 done, 2 input refused, 3 ended early.");
  app.begin_group("Scene");
  app.add("--scene", s.scene, examples::kSurfaceScenes);
  app.add("--edge", s.edge, "edge length of a bundled scene [m]; default its own").positive();
  app.begin_group("Robots");
  app.add("--robots", s.robots, "how many");
  app.add("--starts", s.starts, "where they start: X Y Z for each [m]; else at random");
  app.add("--seed", s.seed, "of the random starts and of the coordinator");
  app.begin_group("Deployment");
  app.add("--coordinator", s.coordinator, "wavefront, exchange or substitution")
      .one_of({"wavefront", "exchange", "substitution"});
  app.add("--distance", s.distance, "along edges, or straight across faces")
      .one_of({"edges", "faces"});
  app.add("--field", s.field,
          "where and how regions stretch: uniform, curvature, principal, x, y or z")
      .one_of({"uniform", "curvature", "principal", "x", "y", "z"});
  app.add("--ratio", s.ratio, "by how much regions stretch in a directional field");
  app.add("--rounds", s.rounds, "k_R of the vertex exchange");
  app.add_flag("--async", s.asynchronous, "one robot at a time, in a random order");
  app.add("--sensing", s.sensing, "sensing range on an unknown surface [m]; default: it is known")
      .positive();
  app.add("--communication", s.communication, "communication range [m]; default unlimited")
      .positive();
  app.begin_group("Sweep");
  app.add_flag("--sweep,!--no-sweep", s.sweep, "one covering path per robot after the deployment");
  app.add_flag("--balance,!--no-balance", s.balance, "even out the work before the sweep");
  app.add("--sweep-range", s.sweep_range,
          "path a robot can sweep before it must deploy anew [m]; default unlimited")
      .positive();
  app.add("--events", s.events,
          "with --sweep-range: fail:ITERATION:ROBOT or join:ITERATION:TRIANGLE");
  app.add("--footprint", s.footprint, "width a robot covers [m]; default that of the mesh")
      .positive();
  app.add("--speed", s.speed, "of the robots [m/s]");
  app.add("--max-steps", s.max_steps, "of the deployment");
  app.add_flag("--largest-component", s.largest, "leave out all but the largest connected part");
  app.begin_group("Results");
  app.add("--out", s.out, "folder for the results");
  app.add_flag("--quiet", s.quiet, "no progress line");
  app.add_examples(
      "  surface_coverage --scene sphere --robots 6 --no-sweep\n"
      "  surface_coverage --scene hull.ply --largest-component --coordinator exchange "
      "--sweep-range 60");
  app.parse(argc, argv);
  require(s.robots >= 1, "--robots: expected 1 or more");
  require(s.rounds >= 1, "--rounds: expected 1 or more");
  require(s.max_steps >= 1, "--max-steps: expected 1 or more");
  require(s.speed > 0.0, "--speed: expected more than 0 m/s");
  require(s.ratio > 0.0 && std::isfinite(s.ratio), "--ratio: expected more than 0");
  require(
      s.starts.empty() || s.starts.size() == 3 * static_cast<std::size_t>(s.robots),
      "--starts: expected three numbers for each of the " + std::to_string(s.robots) + " robots");
  require(s.events.empty() || s.sweep_range, "--events: expected --sweep-range with them");
  return s;
}

std::vector<RobotEvent> robot_events(const Settings& s) {
  std::vector<RobotEvent> events;
  for (const std::string& text : s.events) {
    RobotEvent event;
    unsigned long iteration = 0;
    long which = 0;
    char kind[8] = {};
    int used = 0;
    const bool read =
        std::sscanf(text.c_str(), "%4[a-z]:%lu:%ld%n", kind, &iteration, &which, &used) == 3 &&
        static_cast<std::size_t>(used) == text.size() && which >= 0 && which < (1L << 30);
    const std::string name = kind;
    require(read && (name == "fail" || name == "join"),
            "--events: \"" + text + "\"; expected fail:ITERATION:ROBOT or join:ITERATION:TRIANGLE");
    event.iteration = iteration;
    if (name == "fail")
      event.robot = static_cast<std::int32_t>(which);
    else
      event.triangle = static_cast<std::int32_t>(which);
    events.push_back(event);
  }
  return events;
}

TriangleMesh largest_component(const TriangleMesh& mesh) {
  const auto part = connected_components(DualMeshGraph{}(mesh, EdgeGeodesic{}).links);
  std::vector<double> area(mesh.triangles.size(), 0.0);
  for (std::size_t t = 0; t < part.size(); ++t)
    area[static_cast<std::size_t>(part[t])] += mesh.area(t);
  const auto best =
      static_cast<std::int32_t>(std::max_element(area.begin(), area.end()) - area.begin());
  TriangleMesh kept;
  kept.vertices = mesh.vertices;
  for (std::size_t t = 0; t < part.size(); ++t)
    if (part[t] == best) kept.triangles.push_back(mesh.triangles[t]);
  return clean_surface(kept);
}

MetricField field(const Settings& s, const TriangleMesh& mesh) {
  if (s.field == "curvature") return CurvatureField{}(mesh);
  if (s.field == "principal") return PrincipalDirectionField{s.ratio}(mesh);
  if (s.field == "uniform") return {};
  const int axis = s.field == "x" ? 0 : s.field == "y" ? 1 : 2;
  return DirectionalField{Eigen::Vector3d::Unit(axis), s.ratio}(mesh);
}

/// What a deployment leaves behind, whatever the policies were.
struct Deployment {
  std::vector<double> time, cost;  ///< Steps, eq. 6.4 on the vertices.
  std::vector<std::vector<Point3>> tracks;
  SurfaceRegions regions;
  std::vector<std::int32_t> vertices;  ///< Where the robots stand.
  std::vector<std::pair<std::int32_t, std::int32_t>> neighbours;
  double initial_cost = 0.0, final_cost = 0.0, known = 1.0;
  std::size_t steps = 0;
  bool converged = false, connected = true, covering = true;
};

template <typename Surface, typename Distance, typename Coordinator>
Deployment deploy(const Settings& s, const TriangleMesh& mesh, const SurfaceGraph& yardstick,
                  const SurfaceCoverageOptions& options, Coordinator coordinator,
                  cli::ProgressLine& line) {
  constexpr bool dual = std::same_as<Surface, DualMeshGraph>;
  using Cover = SurfaceCoverage<Surface, Distance, Coordinator>;
  const auto number = static_cast<std::size_t>(s.robots);
  std::vector<Point3> starts;
  for (std::size_t k = 0; k + 2 < s.starts.size(); k += 3)
    starts.push_back({s.starts[k], s.starts[k + 1], s.starts[k + 2]});
  std::optional<Cover> cover;
  if (starts.empty()) {
    const SurfaceGraph sites = Surface{}(mesh, EdgeGeodesic{}, options.field);
    cover.emplace(mesh, random_robot_sites(sites, number, s.seed), options, coordinator);
  } else {
    cover.emplace(mesh, std::span<const Point3>(starts), options, coordinator);
  }
  Deployment d;
  d.tracks.resize(number);
  const auto on_vertices = [&](bool settled) {
    if constexpr (!dual) return cover->partition().generator;
    if (settled) return centroid_vertices(mesh, cover->graph(), cover->partition().region, number);
    std::vector<std::int32_t> own(mesh.triangles.size(), -1);
    for (std::size_t i = 0; i < number; ++i)
      own[static_cast<std::size_t>(cover->partition().generator[i])] = static_cast<int>(i);
    return centroid_vertices(mesh, cover->graph(), own, number);
  };
  const auto record = [&] {
    d.time.push_back(static_cast<double>(cover->steps()));
    d.cost.push_back(surface_cost(yardstick, on_vertices(cover->steps() > 0)));
    const std::vector<Point3> at = cover->positions();
    for (std::size_t i = 0; i < number; ++i)
      if (d.tracks[i].empty() || d.tracks[i].back() != at[i]) d.tracks[i].push_back(at[i]);
  };
  record();
  const std::size_t every = 1 + mesh.vertices.size() / 5000;
  const auto limit = static_cast<std::size_t>(s.max_steps);
  bool whole = false;
  while (!cover->converged() && cover->steps() < limit && !cli::interrupted()) {
    cover->step();
    d.connected = d.connected && cover->connected();
    const auto& region = cover->partition().region;
    const bool all = std::find(region.begin(), region.end(), -1) == region.end();
    d.covering = d.covering && (all || !whole);
    whole = all;
    if (cover->steps() % every == 0) record();
    line("step " + std::to_string(cover->steps()) + ", cost " + std::to_string(d.cost.back()));
  }
  record();
  d.covering = d.covering && whole;
  d.initial_cost = d.cost.front();
  d.final_cost = d.cost.back();
  d.steps = cover->steps();
  d.converged = cover->converged();
  if (s.sensing) d.known = cover->maps().known_fraction(cover->graph());
  d.regions = cover->regions();
  d.vertices = on_vertices(true);
  d.neighbours = dual_delaunay(d.regions.dual->links, d.regions.region);
  return d;
}

template <typename Distance>
Deployment deploy(const Settings& s, const TriangleMesh& mesh, const SurfaceGraph& yardstick,
                  const SurfaceCoverageOptions& options, cli::ProgressLine& line) {
  if (s.coordinator == "wavefront")
    return deploy<MeshGraph, Distance>(s, mesh, yardstick, options, WavefrontPropagation{}, line);
  if (s.coordinator == "substitution")
    return deploy<MeshGraph, Distance>(s, mesh, yardstick, options, VertexSubstitution{}, line);
  VertexExchange exchange;
  exchange.rounds = s.rounds;
  return deploy<DualMeshGraph, EdgeGeodesic>(s, mesh, yardstick, options, exchange, line);
}

/// A colour for every robot: the palette, darker each time it comes round.
Rgb robot_color(std::size_t i) {
  constexpr std::size_t kPalette = 8;
  Rgb color = categorical_color(i % kPalette);
  const double light = std::pow(0.65, static_cast<double>(i / kPalette));
  for (auto& channel : color) channel = static_cast<std::uint8_t>(light * channel);
  return color;
}

/// The mesh with one colour a region; vertices are repeated where regions meet.
TriangleMesh colored(const SurfaceRegions& regions) {
  const TriangleMesh& mesh = *regions.mesh;
  TriangleMesh result;
  const auto normals = vertex_normals(mesh);
  for (std::int32_t robot = -1; robot < static_cast<std::int32_t>(regions.robots()); ++robot) {
    std::vector<std::int32_t> name(mesh.vertices.size(), -1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (regions.region[t] != robot) continue;
      Triangle triangle = mesh.triangles[t];
      for (std::int32_t& v : triangle) {
        const auto i = static_cast<std::size_t>(v);
        if (name[i] < 0) {
          name[i] = static_cast<std::int32_t>(result.vertices.size());
          result.vertices.push_back(mesh.vertices[i]);
          result.normals.push_back(normals[i]);
          result.colors.push_back(robot < 0 ? Rgb{150, 150, 150}
                                            : robot_color(static_cast<std::size_t>(robot)));
        }
        v = name[i];
      }
      result.triangles.push_back(triangle);
    }
  }
  return result;
}

/// The light side of each region's colour, so that paths in full colour stand out on it.
TriangleMesh paled(TriangleMesh mesh) {
  for (auto& color : mesh.colors)
    for (auto& channel : color) channel = static_cast<std::uint8_t>(255 - (255 - channel) / 3);
  return mesh;
}

Trajectory timed(const std::vector<Point3>& path, double speed) {
  Trajectory trajectory;
  double time = 0.0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (k > 0) time += (path[k] - path[k - 1]).norm() / speed;
    StampedPose stamped;
    stamped.time = time;
    stamped.T_world_body.translation() = path[k];
    trajectory.push_back(stamped);
  }
  return trajectory;
}

int run(int argc, char** argv) {
  const auto begin = examples::Clock::now();
  const auto seconds = [&] { return examples::seconds_since(begin); };
  const Settings s = settings(argc, argv);
  SurfaceDefects defects;
  TriangleMesh mesh = clean_surface(examples::surface_scene(s.scene, s.edge), &defects);
  if (s.largest) mesh = largest_component(mesh);
  const auto number = static_cast<std::size_t>(s.robots);
  const std::vector<RobotEvent> events = robot_events(s);
  require(number <= std::min(mesh.vertices.size(), mesh.triangles.size()),
          "--robots: " + std::to_string(number) + " on a surface of " +
              std::to_string(mesh.vertices.size()) + " vertices and " +
              std::to_string(mesh.triangles.size()) + " triangles; at most one on each");
  {
    const auto part = connected_components(DualMeshGraph{}(mesh, EdgeGeodesic{}).links);
    const auto parts = static_cast<std::size_t>(*std::max_element(part.begin(), part.end())) + 1;
    require(parts <= number, "--robots: " + std::to_string(number) + " for a surface in " +
                                 std::to_string(parts) +
                                 " parts that share no edge; expected one a part at least, or "
                                 "--largest-component");
  }
  SurfaceCoverageOptions options;
  options.asynchronous = s.asynchronous;
  options.seed = s.seed;
  options.field = field(s, mesh);
  if (s.sensing) options.sensing_range = *s.sensing;
  if (s.communication) options.communication_range = *s.communication;

  cli::ProgressLine line(!s.quiet);
  line("reading the surface");
  // Costs are told on the vertices with the chosen distance, whatever the coordinator works on.
  const bool faces = s.distance == "faces";
  const SurfaceGraph yardstick = faces ? MeshGraph{}(mesh, FaceGeodesic{}, options.field)
                                       : MeshGraph{}(mesh, EdgeGeodesic{}, options.field);
  cli::watch_interrupts();
  const Deployment d = faces ? deploy<FaceGeodesic>(s, mesh, yardstick, options, line)
                             : deploy<EdgeGeodesic>(s, mesh, yardstick, options, line);
  const double planning = seconds();
  const auto out = cli::prepare_output_folder(s.out);

  std::optional<PMedianBound> bound;
  if (yardstick.size() <= 1600 && number < yardstick.size() && !cli::interrupted()) {
    line("bounding the cost from below");
    const PMedianProblem problem = p_median_problem(yardstick);
    bound.emplace();
    bound->lower = p_median_lower_bound(problem, number, d.final_cost, 250);
  }

  line("sweeping");
  SurfaceRegions sweep_regions = d.regions;
  std::vector<CoveringStrip> strips;
  std::vector<std::vector<Point3>> sweep_paths(number);
  std::vector<double> lengths, transfers(number, 0.0);
  std::vector<double> curve_time{0.0}, curve_covered{0.0};
  double swept = 0.0, balance = 1.0, completion = 0.0;
  std::size_t iterations = 0;
  bool complete = !s.sweep;
  if (s.sweep && !cli::interrupted()) {
    if (s.sweep_range) {
      HybridSurfaceOptions hybrid;
      hybrid.sweep_range = *s.sweep_range;
      hybrid.balance = s.balance;
      hybrid.seed = s.seed;
      hybrid.field = options.field;
      hybrid.events = events;
      const HybridSurfaceCoverage result = hybrid_area_coverage(
          mesh, d.regions.start, hybrid, VertexExchange{},
          [&](double covered) { line("swept " + std::to_string(100.0 * covered) + " %"); });
      lengths = result.swept_length;
      transfers = result.transfer_length;
      swept = result.covered;
      balance = result.balance();
      complete = result.complete;
      iterations = result.iterations.size();
      sweep_paths.resize(lengths.size());
      for (const HybridSurfaceIteration& it : result.iterations) {
        double slowest = 0.0;
        for (std::size_t i = 0; i < it.strips.size(); ++i) {
          slowest = std::max(slowest, it.strips[i].length() + it.transfer_length[i]);
          for (const Point3& p : it.transfers[i]) sweep_paths[i].push_back(p);
          for (const Point3& p : it.strips[i].path) sweep_paths[i].push_back(p);
        }
        completion += slowest / s.speed;
        curve_time.push_back(completion);
        curve_covered.push_back(100.0 * it.covered);
      }
      if (!result.iterations.empty()) sweep_regions = result.iterations.front().regions;
    } else {
      if (s.balance) balance_regions(sweep_regions, sweep_work(sweep_regions));
      strips = covering_strips(sweep_regions);
      swept = swept_fraction(mesh, strips);
      balance = sweep_balance(strips);
      complete = swept > 1.0 - 1e-12;
      iterations = 1;
      double all = 0.0, covered = 0.0;
      std::vector<std::pair<double, double>> visits;
      std::vector<std::uint8_t> seen(mesh.triangles.size(), 0);
      for (std::size_t i = 0; i < number; ++i) {
        lengths.push_back(strips[i].length());
        sweep_paths[i] = strips[i].path;
        completion = std::max(completion, strips[i].length() / s.speed);
        for (std::size_t k = 0; k < strips[i].triangles.size(); ++k) {
          const auto t = static_cast<std::size_t>(strips[i].triangles[k]);
          if (seen[t] == 0) visits.push_back({strips[i].travelled[k] / s.speed, mesh.area(t)});
          seen[t] = 1;
        }
      }
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) all += mesh.area(t);
      std::sort(visits.begin(), visits.end());
      for (std::size_t k = 0; k < visits.size(); ++k) {
        covered += visits[k].second;
        if (k % (1 + visits.size() / 400) != 0 && k + 1 != visits.size()) continue;
        curve_time.push_back(visits[k].first);
        curve_covered.push_back(100.0 * covered / all);
      }
    }
  }

  const double footprint = s.footprint ? *s.footprint : strip_footprint(mesh);
  double total = 0.0, transfer = 0.0;
  for (const double l : lengths) total += l;
  for (const double l : transfers) transfer += l;
  const nlohmann::json none;
  nlohmann::json metrics{
      {"scene", s.scene},
      {"coordinator", s.coordinator},
      {"distance", s.distance},
      {"field", s.field},
      {"asynchronous", s.asynchronous},
      {"robots", s.robots},
      {"seed", s.seed},
      {"vertices", mesh.vertices.size()},
      {"triangles", mesh.triangles.size()},
      {"area_m2", mesh.area()},
      {"removed_vertices", defects.removed_vertices},
      {"removed_triangles", defects.removed_triangles},
      {"nonmanifold_edges", defects.nonmanifold_edges},
      {"steps", d.steps},
      {"converged", d.converged},
      {"initial_cost", d.initial_cost},
      {"final_cost", d.final_cost},
      {"cost_lower_bound", bound ? nlohmann::json(bound->lower) : none},
      {"regions_connected", d.connected},
      {"regions_covering", d.covering},
      {"known_fraction", d.known},
      {"swept_fraction", s.sweep ? nlohmann::json(swept) : none},
      {"sweep_balance", s.sweep ? nlohmann::json(balance) : none},
      {"sweep_iterations", iterations},
      {"footprint_m", footprint},
      {"path_ratio", s.sweep ? nlohmann::json(total * footprint / mesh.area()) : none},
      {"path_length_m", lengths},
      {"transfer_length_m", transfers},
      {"total_path_length_m", total + transfer},
      {"completion_time_s", completion},
      {"planning_time_s", planning},
      {"wall_time_s", seconds()},
      {"peak_memory_bytes", examples::peak_memory()}};
  write_file(out / "metrics.json", metrics.dump(2) + "\n");
  const TriangleMesh regions_mesh = colored(d.regions);
  write_ply(regions_mesh, out / "regions.ply");
  if (s.sweep) write_ply(colored(sweep_regions), out / "sweep_regions.ply");
  for (std::size_t i = 0; i < sweep_paths.size(); ++i)
    if (!sweep_paths[i].empty())
      write_tum(out / ("sweep_" + std::to_string(i) + ".tum"), timed(sweep_paths[i], s.speed));

  line("drawing");
  const bool flat = mesh.bounds().sizes().z() < 0.5 * mesh.bounds().sizes().x();
  const RenderView view =
      frame_box(mesh.bounds(), radians(-60.0), radians(flat ? 50.0 : 25.0), 1280, 860);
  RenderStyle style;
  style.shadows = false;
  Rasterizer picture(view, style);
  picture.draw(regions_mesh);
  const auto centres = [&](std::int32_t robot) {
    return mesh.vertices[static_cast<std::size_t>(d.vertices[static_cast<std::size_t>(robot)])];
  };
  for (const auto& [a, b] : d.neighbours) {
    const std::vector<Point3> edge{centres(a), centres(b)};
    picture.draw_polyline(edge, Rgb{190, 40, 40}, 1.5);
  }
  for (std::size_t i = 0; i < number; ++i) {
    picture.draw_polyline(d.tracks[i], Rgb{40, 40, 40}, 2.0);
    picture.draw_points(std::span<const Point3>(&d.tracks[i].front(), 1), Rgb{255, 255, 255}, 9.0);
    const Point3 at = centres(static_cast<std::int32_t>(i));
    picture.draw_points(std::span<const Point3>(&at, 1), Rgb{20, 20, 20}, 13.0);
  }
  const Bytes regions_png = encode_png(picture.image());
  write_file(out / "regions.png", regions_png);

  Report report("Surface coverage: " + s.scene, std::to_string(s.robots) + " robots, " +
                                                    s.coordinator + ", distances " +
                                                    (faces ? "across faces" : "along edges"));
  const auto text = [](double v, int digits) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%.*f", digits, v);
    return std::string(buffer);
  };
  std::vector<KeyFigure> figures{
      {"Final cost", text(d.final_cost, 4),
       bound ? text(100.0 * (d.final_cost / bound->lower - 1.0), 1) + " % above the lower bound"
             : "no bound on a surface of this size"},
      {"Initial cost", text(d.initial_cost, 4), std::to_string(d.steps) + " steps"},
      {"Regions", d.connected && d.covering ? "whole" : "broken",
       "connected and covering after every step"}};
  if (s.sweep) {
    figures.push_back({"Swept", text(100.0 * swept, 2) + " %",
                       text(total, 1) + " m of path, " + std::to_string(iterations) + " round(s)"});
    figures.push_back({"Balance", text(balance, 3), "longest sweep against the mean"});
    figures.push_back({"Path", text(total * footprint / mesh.area(), 2),
                       "times area / footprint of " + text(1000.0 * footprint, 0) + " mm"});
  }
  report.add_key_figures(figures);
  report.add_picture(
      regions_png,
      "Regions, the robots' starts (white), tracks and final places (black), and the "
      "dual Delaunay graph (red).");
  if (s.sweep) {
    Rasterizer sweeps(view, style);
    sweeps.draw(paled(colored(sweep_regions)));
    for (std::size_t i = 0; i < sweep_paths.size(); ++i)
      sweeps.draw_polyline(sweep_paths[i], robot_color(i), 2.0);
    const Bytes png = encode_png(sweeps.image());
    write_file(out / "sweep.png", png);
    report.add_picture(png, "One covering path per robot.");
  }
  Plot cost;
  cost.title = "Cost over time";
  cost.x_label = "step";
  cost.y_label = "cost (eq. 6.4)";
  cost.add(s.coordinator, d.time, d.cost);
  if (bound)
    cost.add({.label = "lower bound",
              .x = {0.0, d.time.back()},
              .y = {bound->lower, bound->lower},
              .low = {},
              .high = {},
              .dashed = true});
  report.add_plot(cost, true);
  if (s.sweep) {
    Plot coverage;
    coverage.title = "Coverage over time";
    coverage.x_label = "time [s]";
    coverage.y_label = "swept [%]";
    coverage.y_min = 0.0;
    coverage.add("", curve_time, curve_covered);
    report.add_plot(coverage, true);
    Table table{"Sweeps", {"robot", "sweep [m]", "transfer [m]"}, {}};
    for (std::size_t i = 0; i < lengths.size(); ++i)
      table.add_row({std::to_string(i), text(lengths[i], 2), text(transfers[i], 2)});
    report.add_table(table);
  }
  report.write(out / "report.html");
  line.finish();

  const bool done = complete && d.converged && d.covering;
  std::printf("%s: %s, %d robots, %s, %zu steps\n", done ? "complete" : "ended early",
              s.scene.c_str(), s.robots, s.coordinator.c_str(), d.steps);
  std::printf("  cost %.5f -> %.5f", d.initial_cost, d.final_cost);
  if (bound) std::printf(", lower bound %.5f", bound->lower);
  std::printf("; regions %s\n", d.connected && d.covering ? "connected and covering" : "broken");
  if (s.sweep)
    std::printf("  swept %.2f %%, path %.1f m (%.2f x area / footprint), balance %.3f\n",
                100.0 * swept, total, total * footprint / mesh.area(), balance);
  std::printf("  see %s\n", (out / "report.html").c_str());
  return done ? cli::kDone : cli::kIncomplete;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("surface_coverage", [&] { return run(argc, argv); });
}
