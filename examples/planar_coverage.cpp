// SPDX-License-Identifier: MIT
/// @file
/// @brief Voronoi coverage of polygons: convex, with obstacles, unknown; and the hybrid variants
/// that deploy robots and sweep the ground [004 ch. 3-5].
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/coverage/discoverage.hpp>
#include <surfleet/coverage/geodesic_coverage.hpp>
#include <surfleet/coverage/gradient_projection.hpp>
#include <surfleet/coverage/hybrid_flocking.hpp>
#include <surfleet/coverage/hybrid_voronoi.hpp>
#include <surfleet/coverage/random_coverage.hpp>
#include <surfleet/coverage/robotic_band.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/simulation/planar_environments.hpp>

#include "support/cli.hpp"
#include "support/peak_memory.hpp"
#include "support/planar_picture.hpp"
#include "support/stopwatch.hpp"

namespace {
using namespace surfleet;
using Json = nlohmann::ordered_json;

struct Settings {
  std::string scene = "u_shape", mode = "nonconvex", out = "planar_coverage_out",
              sweep = "back_and_forth", planner = "tangentbug", placement = "group";
  std::size_t robots = 5, defects = 10;
  std::uint64_t seed = 1;
  int threads = 1;
  double speed = 0.05, footprint = 0.03, spacing = 0.12, dt = 0.5, max_time = 40000.0;
  std::optional<double> lane, range, cell;  ///< [m]
  std::vector<double> positions;
};

/// What a mode leaves behind.
struct Outcome {
  std::vector<std::vector<Point2>> tracks;  ///< One per robot.
  double completion_time = 0.0;             ///< [s]
  bool complete = true;
  std::vector<double> cost_time, cost, virtual_cost;
  std::vector<Region> regions;
  std::optional<CoverageGrid> grid;
  std::vector<std::int32_t> owner;
  CoverageHistory coverage;
  std::vector<std::pair<Point2, std::string>> labels;
  std::vector<Point2> crosses;
  Json extra = Json::object();
};

Point2 point_of(const nlohmann::json& j, const std::string& where) {
  require(j.is_array() && j.size() == 2 && j[0].is_number() && j[1].is_number(),
          where + ": expected a point [x, y] in metres");
  return {j[0].get<double>(), j[1].get<double>()};
}
Ring ring_of(const nlohmann::json& j, const std::string& where) {
  require(j.is_array(), where + ": expected a list of points [x, y]");
  Ring ring;
  for (const auto& p : j) ring.push_back(point_of(p, where));
  return ring;
}
/// A scene of one's own: {"outer": [[x, y], ...], "holes": [[[x, y], ...], ...], "start": [x, y]}.
PlanarEnvironment read_scene(const std::string& file) {
  std::ifstream in(file);
  require(in.good(), file + ": cannot be read; expected a JSON scene or the name of a bundled one");
  const nlohmann::json j = nlohmann::json::parse(in, nullptr, false);
  require(j.is_object() && j.contains("outer"),
          file +
              ": not a scene; expected a JSON object with \"outer\" and perhaps \"holes\" and "
              "\"start\"");
  std::vector<Ring> holes;
  if (j.contains("holes")) {
    require(j["holes"].is_array(), file + ": holes: expected a list of rings");
    for (const auto& h : j["holes"]) holes.push_back(ring_of(h, file + ": holes"));
  }
  PlanarEnvironment world{
      file, make_polygon(ring_of(j["outer"], file + ": outer"), std::move(holes)), {}};
  if (j.contains("start")) {
    world.start = point_of(j["start"], file + ": start");
  } else {
    Random random(1);
    world.start = random_places(world.domain, 1, random)[0];
  }
  return world;
}

std::vector<Point2> place_robots(const Settings& s, const PlanarEnvironment& world) {
  std::vector<Point2> start;
  if (!s.positions.empty()) {
    require(s.positions.size() % 2 == 0, "--positions: expected pairs of numbers x y");
    for (std::size_t i = 0; i < s.positions.size(); i += 2)
      start.emplace_back(s.positions[i], s.positions[i + 1]);
  } else if (s.placement == "random") {
    Random random(s.seed);
    start = random_places(world.domain, s.robots, random);
  } else {
    start = group_start(world.domain, world.start, s.robots, s.spacing);
  }
  require_placed(world.domain, start);
  return start;
}

std::string short_number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", v);
  return text;
}

struct Watch {
  const Settings& settings;
  cli::ProgressLine& progress;
  bool stop(double time) const { return cli::interrupted() || time >= settings.max_time; }
};

void keep_track(Outcome& out, std::span<const Point2> robots) {
  for (std::size_t i = 0; i < robots.size(); ++i) out.tracks[i].push_back(robots[i]);
}

template <typename Planner>
void run_nonconvex(const Settings& s, const PlanarEnvironment& world,
                   const std::vector<Point2>& start, Planner planner, const Watch& watch,
                   Outcome& out) {
  NonconvexCoverage<Planner> cover(world.domain, start, {.speed = s.speed, .dt = s.dt},
                                   std::move(planner));
  const auto note = [&] {
    out.cost_time.push_back(cover.time());
    out.cost.push_back(cover.real_cost());
    out.virtual_cost.push_back(cover.virtual_cost());
  };
  note();
  for (int k = 0; !cover.converged() && !watch.stop(cover.time()); ++k) {
    cover.step();
    keep_track(out, cover.real_positions());
    note();
    if (k % 50 == 0)
      watch.progress("t = " + short_number(cover.time()) + " s, cost " +
                     short_number(out.cost.back()));
  }
  out.complete = cover.converged();
  out.completion_time = cover.time();
  int constrained = 0;
  for (const auto& r : cover.robots()) {
    constrained += r.constrained ? 1 : 0;
    out.crosses.push_back(r.virtual_goal);
  }
  out.extra["constrained_regions"] = constrained;
  for (VoronoiCell& c : cover.final_tessellation().cells)
    out.regions.push_back(std::move(c.region));
}

/// The modes that move robots step by step to lower a cost.
void run_descent(const Settings& s, const PlanarEnvironment& world, std::vector<Point2> robots,
                 const Watch& watch, Outcome& out) {
  const double tolerance = 1e-5 * world.domain.bounds().diagonal().norm();
  double time = 0.0, moved = std::numeric_limits<double>::infinity();
  const LloydCoverage<> lloyd(world.domain, {.threads = s.threads});
  if (s.mode == "geodesic") {
    const GeodesicCoverage<> cover(world.domain, {.cell = s.cell});
    GeodesicTessellation t = cover.tessellate(robots);
    out.cost_time.push_back(0.0);
    out.cost.push_back(t.cost);
    while (moved > 0.0 && !watch.stop(time)) {
      moved = cover.step(robots, t, s.speed * 2.0 * s.dt);
      time += 2.0 * s.dt;
      out.cost_time.push_back(time);
      out.cost.push_back(t.cost);
      keep_track(out, robots);
      watch.progress("t = " + short_number(time) + " s, cost " + short_number(t.cost));
    }
    out.grid.emplace(cover.grid());
    out.owner = t.owner;
    out.complete = moved <= 0.0;
    out.completion_time = time;
    return;
  }
  require(s.mode != "lloyd" || is_convex(world.domain),
          "mode lloyd needs a convex scene; choose nonconvex, gradient or geodesic for this one");
  const GradientProjectionCoverage<> projection(world.domain);
  while (moved > tolerance * s.dt && !watch.stop(time)) {
    const LloydStep step = s.mode == "lloyd" ? lloyd.control_step(robots, 1.0 / s.dt, s.dt, s.speed)
                                             : projection.step(robots, 1.0 / s.dt, s.dt, s.speed);
    moved = step.largest_move;
    out.cost_time.push_back(time);
    out.cost.push_back(step.cost);
    time += s.dt;
    keep_track(out, robots);
    watch.progress("t = " + short_number(time) + " s, cost " + short_number(step.cost));
  }
  out.complete = moved <= tolerance * s.dt;
  out.completion_time = time;
  out.cost_time.push_back(time);
  out.cost.push_back(lloyd.cost(robots));
  for (VoronoiCell& c : voronoi_tessellation(world.domain, robots, s.threads).cells)
    out.regions.push_back(std::move(c.region));
}

void run_exploration(const Settings& s, const PlanarEnvironment& world,
                     const std::vector<Point2>& start, const Watch& watch, Outcome& out) {
  DisCoverageOptions options;
  const double size = world.domain.bounds().diagonal().norm();
  options.range = s.range.value_or(size / 6.0);
  options.cell = s.cell.value_or(size / 160.0);
  options.speed = s.speed;
  options.dt = s.dt;
  DisCoverage explore(world.domain, start, options);
  const auto reachable =
      static_cast<double>(reachable_cells(world.domain, explore.explored(), start));
  const auto share = [&] {
    return static_cast<double>(explore.explored().covered_count()) / reachable;
  };
  for (;;) {
    out.coverage.time.push_back(explore.time());
    out.coverage.fraction.push_back(share());
    if (explore.finished() || watch.stop(explore.time())) break;
    explore.step();
    keep_track(out, explore.robots());
    watch.progress("t = " + short_number(explore.time()) + " s, explored " +
                   short_number(100.0 * share()) + " %");
  }
  out.complete = explore.finished();
  out.completion_time = explore.time();
  out.extra["explored_fraction_of_reachable"] = share();
  out.grid.emplace(explore.explored());
  out.owner = explore.owner();
}

void run_hybrid(const Settings& s, const PlanarEnvironment& world, const std::vector<Point2>& start,
                Outcome& out) {
  HybridOptions options;
  options.speed = s.speed;
  options.footprint = s.footprint;
  options.lane = s.lane.value_or(2.0 * s.footprint * 0.99);
  options.cell = s.cell.value_or(s.footprint * 2.0 / 3.0);
  std::vector<TimedPath> paths;
  if (s.mode == "hybrid1") {
    FlockingRun run = flocking_coverage(world.domain, start, options, {.max_time = s.max_time});
    paths = std::move(run.paths);
    out.extra["main_direction_changes"] = run.main_direction.size() - 1;
  } else if (s.mode == "hybrid2") {
    RoboticBandPlan plan = robotic_band(world.domain, start, options);
    paths = std::move(plan.paths);
    for (const ReebCell& c : plan.graph.cells) out.regions.push_back({c.region});
    Json points = Json::object();
    for (const CriticalPoint& p : plan.graph.points) {
      const std::string kind = name_of(p.kind);
      points[kind] = points.value(kind, 0) + 1;
      out.labels.emplace_back(p.position, kind);
    }
    out.extra["critical_points"] = points;
    out.extra["cells"] = plan.graph.cells.size();
  } else if (s.mode == "hybrid3") {
    HybridVoronoiPlan plan = s.sweep == "spiral"
                                 ? hybrid_voronoi(world.domain, start, options, {}, SpiralSweep{})
                                 : hybrid_voronoi(world.domain, start, options);
    paths = std::move(plan.paths);
    out.regions = std::move(plan.regions);
  } else {
    paths = random_coverage(world.domain, start, Random(s.seed), options, {.max_time = s.max_time});
  }
  Random random = Random(s.seed).fork(17);
  const std::vector<Defect> defects = random_defects(world.domain, s.defects, random);
  std::vector<double> found(defects.size(), -1.0);
  out.coverage = replay(world.domain, paths, options, 1.0,
                        [&](std::size_t, const Point2& a, const Point2& b, double t) {
                          for (std::size_t d = 0; d < defects.size(); ++d)
                            if (found[d] < 0.0 && defects[d].found_from(a, b, options.footprint))
                              found[d] = t;
                        });
  double longest = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (const TimedPoint& p : paths[i].points()) out.tracks[i].push_back(p.point);
    out.completion_time = std::max(out.completion_time, paths[i].end_time());
    longest = std::max(longest, paths[i].length());
    mean += paths[i].length() / static_cast<double>(paths.size());
  }
  const auto time95 = out.coverage.time_to(0.95);
  out.extra["swept_fraction"] = out.coverage.fraction.back();
  out.extra["sweep_balance"] = mean > 0.0 ? longest / mean : 1.0;
  out.extra["time_to_95_percent_s"] = time95 ? Json(*time95) : Json(nullptr);
  out.extra["defect_found_s"] = Json::array();
  for (const double t : found)
    out.extra["defect_found_s"].push_back(t >= 0.0 ? Json(t) : Json(nullptr));
  out.complete = out.completion_time <= s.max_time && time95.has_value();
}

int run(int argc, char** argv) {
  Settings s;
  cli::Options app(
      "Covers a polygon with robots and writes metrics.json, picture.svg and report.html.\n"
      "Modes: lloyd (convex scenes), nonconvex (virtual and real robots, path planning), gradient "
      "(along "
      "the walls), geodesic (shortest-path distance), discoverage (unknown ground), hybrid1 "
      "(flocking and "
      "sweeping), hybrid2 (robotic band), hybrid3 (Voronoi regions, then sweeps), random "
      "(baseline).");
  std::string names;
  for (const std::string& n : planar_environment_names()) names += " " + n;
  app.begin_group("Scene and task");
  app.add("--scene", s.scene,
          "Bundled scene or JSON file with outer, holes, start. Bundled:" + names);
  app.add("--mode", s.mode, "What to do")
      .one_of({"lloyd", "nonconvex", "gradient", "geodesic", "discoverage", "hybrid1", "hybrid2",
               "hybrid3", "random"});
  app.begin_group("Robots");
  app.add("--robots", s.robots, "Number of robots").within(1, 10000);
  app.begin_group("Run");
  app.add("--seed", s.seed, "Seed of everything random");
  app.add("--out", s.out, "Output folder");
  app.begin_group("Robots");
  app.add("--placement", s.placement, "Robots start in a group or at random places")
      .one_of({"group", "random"});
  app.add("--spacing", s.spacing, "Between robots of a group [m]").positive();
  app.add("--positions", s.positions, "Start positions x y x y ... [m]; overrides --robots");
  app.add("--planner", s.planner, "Of mode nonconvex").one_of({"tangentbug", "shortest"});
  app.add("--range", s.range,
          "Of the sensors [m]; default unlimited (a sixth of the scene for discoverage)")
      .positive();
  app.add("--speed", s.speed, "Of the robots [m/s]").positive();
  app.add("--dt", s.dt, "Time step [s]").positive();
  app.add("--footprint", s.footprint, "Radius of the footprint [m]").positive();
  app.begin_group("Coverage");
  app.add("--lane", s.lane, "Between passes [m]; default 0.99 of the footprint's width").positive();
  app.add("--sweep", s.sweep, "Of hybrid3").one_of({"back_and_forth", "spiral"});
  app.add("--cell", s.cell, "Of grids [m]; default by the size of the scene or footprint")
      .positive();
  app.add("--defects", s.defects, "Cracks to be found in the hybrid modes").within(0, 10000);
  app.begin_group("Run");
  app.add("--max-time", s.max_time, "Stop after this much simulated time [s]").positive();
  app.add("--threads", s.threads, "Threads").within(1, 256);
  app.add_examples(
      "  planar_coverage --scene u_shape --robots 5                       around obstacles\n"
      "  planar_coverage --scene office --mode discoverage --range 4      unknown ground\n"
      "  planar_coverage --scene rooms.json --mode hybrid3 --footprint 0.2");
  app.parse(argc, argv);

  const auto began = examples::Clock::now();
  const bool from_file = s.scene.size() > 5 && s.scene.ends_with(".json");
  const PlanarEnvironment world = from_file ? read_scene(s.scene) : planar_environment(s.scene);
  const std::vector<Point2> start = place_robots(s, world);
  const bool sweeps = s.mode.starts_with("hybrid") || s.mode == "random";
  if (s.mode == "lloyd")
    require(is_convex(world.domain),
            "mode lloyd needs a convex scene; choose nonconvex, gradient or geodesic");
  if (sweeps && s.lane && *s.lane > 2.0 * s.footprint)
    throw Error(
        "--lane: lanes farther apart than the footprint is wide leave gaps; expected at most " +
        short_number(2.0 * s.footprint) + " m");
  const auto folder = cli::prepare_output_folder(s.out);
  cli::watch_interrupts();
  cli::ProgressLine progress;
  const Watch watch{s, progress};
  Outcome out;
  for (const Point2& p : start) out.tracks.push_back({p});
  if (s.mode == "nonconvex") {
    TangentBugOptions sensor;
    if (s.range) sensor.range = *s.range;
    if (s.planner == "shortest")
      run_nonconvex(s, world, start, ShortestPathPlanner{}, watch, out);
    else
      run_nonconvex(s, world, start, TangentBugPlanner{sensor}, watch, out);
  } else if (s.mode == "discoverage") {
    run_exploration(s, world, start, watch, out);
  } else if (sweeps) {
    run_hybrid(s, world, start, out);
  } else {
    run_descent(s, world, start, watch, out);
  }
  progress.finish();

  // Figures.
  const std::size_t n = start.size();
  double total = 0.0;
  Json lengths = Json::array();
  for (const auto& track : out.tracks) {
    lengths.push_back(path_length(track));
    total += path_length(track);
  }
  Json metrics{{"scene", world.name},
               {"mode", s.mode},
               {"robots", n},
               {"seed", s.seed},
               {"complete", out.complete},
               {"area_m2", area(world.domain)},
               {"completion_time_s", out.completion_time},
               {"total_path_length_m", total},
               {"path_length_m", lengths}};
  if (!out.cost.empty()) {
    // No region of area a can be served for less than a disc of that area: a² / 2π.
    const double ground = area(world.domain);
    metrics["initial_cost"] = out.cost.front();
    metrics["final_cost"] = out.cost.back();
    metrics["cost_lower_bound"] = ground * ground / (2.0 * kPi * static_cast<double>(n));
  }
  if (!out.coverage.fraction.empty()) metrics["coverage_fraction"] = out.coverage.fraction.back();
  for (const auto& [key, value] : out.extra.items()) metrics[key] = value;
  metrics["wall_time_s"] = examples::seconds_since(began);
  metrics["peak_memory_bytes"] = examples::peak_memory();
  write_file(folder / "metrics.json", std::string_view(metrics.dump(2) + "\n"));

  cli::PlanarPicture picture(world.domain);
  if (out.grid) picture.add_cells(*out.grid, out.owner);
  for (std::size_t i = 0; i < out.regions.size(); ++i)
    picture.add_region(out.regions[i], categorical_color(i));
  for (std::size_t i = 0; i < n; ++i) {
    picture.add_path(out.tracks[i], categorical_color(i), sweeps ? 0.8 : 1.8);
    picture.add_start(start[i], categorical_color(i));
    picture.add_robot(out.tracks[i].back(), categorical_color(i));
  }
  for (std::size_t i = 0; i < out.crosses.size(); ++i)
    picture.add_cross(out.crosses[i], categorical_color(i));
  for (const auto& [p, text] : out.labels) picture.add_label(p, text);
  const std::string svg = picture.svg();
  write_file(folder / "picture.svg", std::string_view(svg));

  Report report("Coverage of " + world.name,
                std::to_string(n) + " robots, mode " + s.mode + ", seed " + std::to_string(s.seed));
  std::vector<KeyFigure> key{{"completion time", short_number(out.completion_time) + " s",
                              out.complete ? "complete" : "stopped early"},
                             {"total path", short_number(total) + " m", ""}};
  if (!out.cost.empty())
    key.push_back({"final cost", short_number(out.cost.back()) + " m⁴",
                   "lower bound " + short_number(metrics["cost_lower_bound"].get<double>())});
  if (!out.coverage.fraction.empty())
    key.push_back({"covered", short_number(100.0 * out.coverage.fraction.back()) + " %", ""});
  report.add_key_figures(key);
  report.add_svg(svg, "Regions, paths (rings: where they begin, discs: where they end)" +
                          std::string(out.crosses.empty() ? "" : ", crosses: virtual goals"));
  if (!out.cost.empty()) {
    Plot plot{"Coverage cost over time", "time [s]", "H [m⁴]"};
    plot.add("robots", out.cost_time, out.cost);
    if (!out.virtual_cost.empty()) plot.add("virtual generators", out.cost_time, out.virtual_cost);
    report.add_plot(plot, true);
  }
  if (!out.coverage.fraction.empty()) {
    Plot plot{"Coverage over time", "time [s]", "share of the ground"};
    plot.add("covered", out.coverage.time, out.coverage.fraction);
    report.add_plot(plot, true);
  }
  if (out.extra.contains("defect_found_s") && !out.extra["defect_found_s"].empty()) {
    std::vector<double> times;
    for (const auto& t : out.extra["defect_found_s"])
      if (t.is_number()) times.push_back(t.get<double>());
    std::sort(times.begin(), times.end());
    Plot plot{"Defects found over time", "time [s]", "defects"};
    PlotSeries found;
    found.stepped = true;
    found.x.push_back(0.0);
    found.y.push_back(0.0);
    for (std::size_t k = 0; k < times.size(); ++k) {
      found.x.push_back(times[k]);
      found.y.push_back(static_cast<double>(k + 1));
    }
    plot.add(std::move(found));
    report.add_plot(plot, true);
  }
  Table table{"Figures", {"key", "value"}};
  for (const auto& [k, v] : metrics.items()) table.add_row({k, v.dump()});
  report.add_table(table);
  report.write(folder / "report.html");
  std::printf("%s, mode %s, %zu robots: %s after %s s, total path %s m; results in %s\n",
              world.name.c_str(), s.mode.c_str(), n, out.complete ? "complete" : "stopped",
              short_number(out.completion_time).c_str(), short_number(total).c_str(),
              folder.string().c_str());
  return out.complete ? cli::kDone : cli::kIncomplete;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("planar_coverage", [&] { return run(argc, argv); });
}
