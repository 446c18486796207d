// SPDX-License-Identifier: MIT
#include "support/inspection_report.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "support/cli.hpp"
#include "support/json_values.hpp"
#include "support/peak_memory.hpp"
#include "support/published_figures.hpp"

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/evaluation/color_map.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/mapping/map_file.hpp>

namespace surfleet::examples {
std::string doubts(const InspectionJudgement& judged) {
  if (judged.disagreements == 0) return {};
  return "warning: the two judges of clearance disagree " + std::to_string(judged.disagreements) +
         " times, by up to " + format_number(judged.disagreement, 4) +
         " m; collisions are counted by the nearer, expected a mesh that both can measure";
}

namespace {
/// What a distributed fleet has besides.
nlohmann::json network_metrics(const InspectionSettings& s, const DistributedResult& d) {
  nlohmann::json lost = nlohmann::json::array(), catch_ups = lost;
  for (const CatchUp& c : d.catch_ups)
    catch_ups.push_back(
        {{"from_s", c.from}, {"took_s", c.took ? nlohmann::json(*c.took) : nullptr}});
  for (const RobotId r : d.lost) lost.push_back(r + 1);
  nlohmann::json drops = by_name<NetworkDrop>(
      kNetworkDrops, [&](auto k) { return d.dropped[static_cast<std::size_t>(k)]; });
  drops.update(by_name<MessageDrop>(kMessageDrops, [&](auto k) { return d.refused[k]; }));
  return {
      {"network", s.network},
      {"bytes_sent", d.bytes_sent},
      {"bytes_sent_by_kind",
       by_name<MessageKind>(kMessageKinds,
                            [&](auto k) { return d.bytes_by_kind[static_cast<std::size_t>(k)]; })},
      {"messages_dropped", drops},
      {"redundant_stops", d.redundant_stops},
      {"maps_equal", d.maps_equal},
      {"caught_up", catch_ups},
      {"lost_robots", lost}};
}
/// What a centralised fleet says to its centre: all send as many images.
nlohmann::json central_metrics(const InspectionSettings& s, const CentralTraffic& t) {
  const auto robots = static_cast<std::size_t>(s.robots);
  return {{"bytes_sent", std::vector<std::uint64_t>(robots, (t.images + t.poses) / robots)},
          {"bytes_sent_by_kind", {{"image", t.images}, {"pose", t.poses}, {"route", t.routes}}}};
}
}  // namespace

nlohmann::json inspection_metrics(const InspectionSettings& s, const InspectionSite& site,
                                  const InspectionRun& run, const InspectionJudgement& judged,
                                  const CoverageCurve& curve) {
  const ReconstructionMetrics& m = judged.evaluation.metrics;
  nlohmann::json milestones = nlohmann::json::object();
  for (const double share : kMilestones) {
    const auto at = curve.reached(share);
    milestones[format_number(share, 2)] = at ? nlohmann::json(at->path) : nlohmann::json();
  }
  const auto number = [](double v) {
    return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json();
  };
  const nlohmann::json none;
  nlohmann::json stop_reasons = nlohmann::json::array();
  for (const StopReason r : run.result.stop_reasons)
    stop_reasons.push_back(std::string(name_of(r)));
  const std::optional<Yield>& left_out = run.result.left_out;
  nlohmann::json metrics{
      {"scene", site.scene.name},
      {"planner", s.planner},
      {"preset", s.preset},
      {"architecture", s.architecture_name()},
      {"robots", s.robots},
      {"seed", s.seed},
      {"voxel_m", s.voxel},
      {"complete", run.result.complete},
      {"stop_reason", stop_reasons},
      {"left_area_m2", run.result.left_area},
      {"left_out_gain_m2", left_out ? nlohmann::json(left_out->gain) : none},
      {"left_out_way_m", left_out ? nlohmann::json(left_out->distance) : none},
      {"completion_time_s", run.result.completion_time},
      {"planning_time_s", run.result.planning_time},
      {"wall_time_s", run.wall_time},
      {"mission_peak_memory_bytes", run.mission_memory},
      {"peak_memory_bytes", peak_memory()},
      {"total_path_length_m", run.result.total_path_length()},
      {"path_length_m", run.result.path_length},
      {"total_path_at_work_m", run.result.total_path_at_work()},
      {"path_to_coverage_m", milestones},
      {"surface_coverage", m.surface_coverage},
      {"estimated_coverage", run.result.coverage.share()},
      {"coverage_of_met", judged.coverage_of_met},
      {"point_coverage", judged.points ? number(judged.points->surface_coverage) : none},
      {"point_rmse_m", judged.points ? number(judged.points->rmse_m) : none},
      {"m3c2_coverage", m.m3c2_coverage()},
      {"observable_share", site.reference_share},
      {"m3c2_mean_m", number(m.m3c2_mean_m)},
      {"m3c2_std_m", number(m.m3c2_std_m)},
      {"rmse_m", number(m.rmse_m)},
      {"completeness_mean_m", number(m.completeness_mean_m)},
      {"completeness_p95_m", number(m.completeness_p95_m)},
      {"accuracy_mean_m", number(m.accuracy_mean_m)},
      {"accuracy_p95_m", number(m.accuracy_p95_m)},
      {"collisions", judged.paths.collisions},
      {"min_clearance_m", number(judged.paths.min_clearance_m)},
      {"min_separation_m", number(judged.paths.min_separation_m)},
      {"judge_disagreement_m", number(judged.disagreement)},
      {"keep_out_violations", judged.keep_out_violations},
      {"start_clearance_m", s.known_around_start()},
      {"sensor", s.sensor},
      {"gimbal", s.gimbal},
      {"remaining_ise", run.result.remaining},
      {"remaining_ise_reasons", by_name(run.result.reasons)},
      {"images", run.result.images},
      {"plans", run.result.plans},
      {"emergency_stops", run.result.emergency_stops}};
  if (s.shape) metrics["body"] = s.body;
  if (run.distributed)
    metrics.update(network_metrics(s, *run.distributed));
  else if (s.robots > 1)
    metrics.update(central_metrics(s, run.result.traffic));
  return metrics;
}

namespace {
std::vector<std::byte> view_of(const TriangleMesh& mesh, const Box3& box, double azimuth,
                               const std::vector<std::vector<Point3>>& paths, bool colored) {
  // The sun stands behind the viewer's shoulder.
  const double sun = azimuth + radians(2.0);
  Rasterizer picture(
      frame_box(box, azimuth, radians(28.0), 1280, 760),
      {.to_light = Eigen::Vector3d(0.75 * std::cos(sun), 0.75 * std::sin(sun), 1.0)});
  picture.draw(mesh, colored ? MeshStyle{.light = 0.55} : MeshStyle{});
  for (std::size_t r = 0; r < paths.size(); ++r) {
    picture.draw_polyline(paths[r], categorical_color(r), 2.0);
    if (!paths[r].empty())
      picture.draw_points(std::span<const Point3>(&paths[r].front(), 1), categorical_color(r), 9.0);
  }
  return encode_png(picture.image());
}
}  // namespace

void write_inspection(const std::filesystem::path& out, const InspectionRun& run) {
  write_ply(run.reconstruction, out / "reconstruction.ply");
  write_ply(run.points, out / "points.ply");
  save_map(run.map, out / "map.sfm");
  for (std::size_t r = 0; r < run.result.trajectories.size(); ++r) {
    std::vector<StampedPose> poses;
    for (const TimedConfiguration& t : run.result.trajectories[r])
      poses.push_back({t.time, t.configuration.pose()});
    write_tum(out / ("trajectory_" + std::to_string(r + 1) + ".tum"), poses);
  }
}

void write_judgement(const std::filesystem::path& out, const InspectionSettings& s,
                     const InspectionSite& site, const InspectionRun& run,
                     const InspectionJudgement& judged, const CoverageCurve& curve,
                     const nlohmann::json& more) {
  nlohmann::json metrics = inspection_metrics(s, site, run, judged, curve);
  metrics.update(more);
  write_file(out / "metrics.json", metrics.dump(2) + "\n");

  // The reconstruction, coloured by its signed distance to the truth.
  const double e_max = half_voxel_diagonal(s.voxel);
  TriangleMesh colored = run.reconstruction;
  const std::vector<double> error = signed_distances(
      colored.vertices, site.scene.mesh, site.space.surface(), 2.0 * s.voxel, s.threads);
  colored.colors.clear();
  for (const double e : error) colored.colors.push_back(signed_error_color(e, e_max));
  write_ply(colored, out / "error.ply");

  const ReconstructionMetrics& m = judged.evaluation.metrics;
  Report report("Inspection of " + site.scene.name,
                std::to_string(s.robots) + (s.robots == 1 ? " drone" : " drones") + ", planner " +
                    s.planner + ", seed " + std::to_string(s.seed));
  const std::vector<KeyFigure> key{
      {"surface coverage", format_number(100.0 * m.surface_coverage, 1) + " %",
       "of what could be seen, side by side"},
      {"total path", format_number(run.result.total_path_length(), 1) + " m",
       format_number(run.result.total_path_at_work(), 1) + " m without flights home"},
      {"completion time", format_minutes(run.result.completion_time), "min:s"},
      {"RMSE", format_number(100.0 * m.rmse_m, 2) + " cm", "M3C2 over what is covered"},
      {"collisions", std::to_string(judged.paths.collisions),
       "least clearance " + format_number(judged.paths.min_clearance_m, 2) + " m"},
      {"elements left", std::to_string(run.result.remaining),
       run.result.remaining > 0 ? "reasons below" : ""}};
  report.add_key_figures(key);
  const Box3 box = site.scene.structure().bounds();
  report.add_picture(view_of(run.reconstruction, box, radians(-55.0), run.paths(), false),
                     "The reconstruction and the drones' paths");
  report.add_picture(view_of(run.reconstruction, box, radians(125.0), {}, false),
                     "The reconstruction from the other side", true);
  report.add_picture(view_of(colored, box, radians(-55.0), {}, true),
                     "Signed distance to the truth, saturated at e_max = " +
                         format_number(100.0 * e_max, 1) + " cm (red outside, blue inside)",
                     true);
  std::vector<double> minutes, percent;
  for (const double t : curve.time) minutes.push_back(t / 60.0);
  for (const double c : curve.coverage) percent.push_back(100.0 * c);
  Plot coverage{.title = "Coverage under way", .x_label = "time [min]", .y_label = "coverage [%]"};
  coverage.add("", minutes, percent);
  Plot work{.title = "Incomplete surface elements", .x_label = "time [min]", .y_label = "elements"};
  work.add("", minutes, curve.incomplete);
  Plot distance{.title = "Distance flown", .x_label = "time [min]", .y_label = "path [m]"};
  distance.add("", minutes, curve.path);
  report.add_plot(coverage, true);
  report.add_plot(work, true);
  report.add_plot(distance, true);
  if (has_published_figures(s)) {
    std::vector<OwnRun> own{{"this run", s.robots, s.planner, run.result.total_path_length(),
                             run.result.completion_time, m.surface_coverage, m.m3c2_mean_m,
                             m.m3c2_std_m, m.rmse_m}};
    constexpr double kPublishedCoverage = 0.90;  // where most of the published runs end
    if (const auto at = curve.reached(kPublishedCoverage)) {
      constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
      own.push_back({"this run, under way", s.robots, s.planner, at->path, at->time,
                     kPublishedCoverage, kUnknown, kUnknown, kUnknown});
    }
    report.add_table(comparison_table(s.preset, own));
  }
  if (run.result.left_out || run.result.remaining > 0) {
    Table left{.caption = "What is left", .columns = {"what", "how much"}};
    if (const auto& out_of = run.result.left_out)
      left.add_row(
          {"going on would have gained, by the planner's estimate",
           format_number(out_of->gain, 1) + " m² in " + format_number(out_of->distance, 1) + " m"});
    for (const auto& [reason, count] : run.result.reasons)
      left.add_row({"incomplete elements: " + std::string(name_of(reason)), std::to_string(count)});
    report.add_table(left);
  }
  Table all{.caption = "Metrics (metrics.json)", .columns = {"key", "value"}};
  for (const auto& [key_name, value] : metrics.items()) all.add_row({key_name, value.dump()});
  report.add_table(all);
  report.write(out / "report.html");
}
}  // namespace surfleet::examples
