// SPDX-License-Identifier: MIT
#include "support/tour_report.hpp"

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "support/cli.hpp"
#include "support/json_values.hpp"
#include "support/peak_memory.hpp"

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/core/binary_io.hpp>
#include <surfleet/evaluation/color_map.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/geometry/mesh_io.hpp>

namespace surfleet::examples {
namespace {
nlohmann::json pose(const Configuration& q) {
  return {{"position", triple(q.position)}, {"yaw", q.yaw}, {"pitch", q.pitch}};
}

std::vector<std::byte> view_of(const TriangleMesh& mesh, const Box3& box, double azimuth,
                               const CoverageTour& tour) {
  Rasterizer picture(frame_box(box, azimuth, radians(28.0), 1280, 760), {});
  picture.draw(mesh, MeshStyle{});
  picture.draw_polyline(tour.path, categorical_color(0), 2.0);
  std::vector<Point3> stops;
  for (const Configuration& q : tour.viewpoints) stops.push_back(q.position);
  picture.draw_points(stops, categorical_color(1), 6.0);
  return encode_png(picture.image());
}
}  // namespace

void write_tour(const std::filesystem::path& out, const InspectionSettings& s,
                const InspectionSite& site, const CoverageTourOptions& plan,
                const CoverageTour& tour, const FlownTour& flown, const JudgeReport& path) {
  nlohmann::json stops = nlohmann::json::array(), points = nlohmann::json::array();
  // Numbers as JSON writes them: the shortest that read back as the same value.
  const auto text = [](double v) { return nlohmann::json(v).dump(); };
  std::string csv = "index,x_m,y_m,z_m,yaw_rad";
  csv += s.gimbal ? ",pitch_rad\n" : "\n";
  for (std::size_t k = 0; k < tour.viewpoints.size(); ++k) {
    const Configuration& q = tour.viewpoints[k];
    stops.push_back(pose(q));
    csv += std::to_string(k + 1) + "," + text(q.position.x()) + "," + text(q.position.y()) + "," +
           text(q.position.z()) + "," + text(q.yaw);
    csv += s.gimbal ? "," + text(q.pitch) + "\n" : "\n";
  }
  for (const Point3& p : tour.path) points.push_back(triple(p));
  write_file(out / "viewpoints.csv", csv);
  const nlohmann::json whole{{"start", pose(flown.images.front().second)},
                             {"viewpoints", stops},
                             {"path", points},
                             {"length_m", tour.length}};
  write_file(out / "tour.json", whole.dump(2) + "\n");
  std::vector<StampedPose> poses;
  for (const auto& [time, q] : flown.images) poses.push_back({time, q.pose()});
  write_tum(out / "tour.tum", poses);
  write_ply(flown.reconstruction, out / "reconstruction.ply");

  const ReconstructionMetrics& m = flown.evaluation.metrics;
  const auto number = [](double v) {
    return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json();
  };
  const nlohmann::json metrics{{"scene", site.scene.name},
                               {"preset", s.preset},
                               {"seed", s.seed},
                               {"voxel_m", s.voxel},
                               {"asked_coverage", plan.coverage},
                               {"surface_coverage", m.surface_coverage},
                               {"observable_share", site.reference_share},
                               {"viewpoints", tour.viewpoints.size()},
                               {"images", flown.images.size()},
                               {"total_path_length_m", tour.length},
                               {"completion_time_s", flown.images.back().first},
                               {"m3c2_mean_m", number(m.m3c2_mean_m)},
                               {"m3c2_std_m", number(m.m3c2_std_m)},
                               {"rmse_m", number(m.rmse_m)},
                               {"collisions", path.collisions},
                               {"min_clearance_m", number(path.min_clearance_m)},
                               {"peak_memory_bytes", peak_memory()}};
  // A scene is named by its file, which may hold bytes that are not UTF-8.
  const auto dumped = [](const nlohmann::json& value, int indent) {
    return value.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  write_file(out / "metrics.json", dumped(metrics, 2) + "\n");

  Report report("Coverage tour of " + site.scene.name, std::to_string(tour.viewpoints.size()) +
                                                           " viewpoints, " +
                                                           format_number(tour.length, 1) + " m");
  const std::vector<KeyFigure> key{
      {"surface coverage", format_number(100.0 * m.surface_coverage, 1) + " %",
       "of what could be seen, by the images of the flight"},
      {"tour", format_number(tour.length, 1) + " m", ""},
      {"time", format_minutes(flown.images.back().first),
       "min:s, at " + format_number(s.limits.speed, 1) + " m/s"},
      {"viewpoints", std::to_string(tour.viewpoints.size()), ""},
      {"least clearance", format_number(path.min_clearance_m, 2) + " m",
       "of the body to the true surface"}};
  report.add_key_figures(key);
  const Box3 box = site.scene.structure().bounds();
  for (const double azimuth : {-55.0, 125.0})
    report.add_picture(view_of(site.scene.structure(), box, radians(azimuth), tour),
                       azimuth < 0.0 ? "The structure, the tour and its viewpoints"
                                     : "The same from the other side",
                       true);
  report.add_picture(view_of(flown.reconstruction, box, radians(-55.0), {}),
                     "What the images of the flight show", true);
  Table list{.caption = "Viewpoints (viewpoints.csv)",
             .columns = {"", "x [m]", "y [m]", "z [m]", "heading [deg]"}};
  if (s.gimbal) list.columns.push_back("pitch, down [deg]");
  for (std::size_t k = 0; k < tour.viewpoints.size(); ++k) {
    const Configuration& q = tour.viewpoints[k];
    std::vector<std::string> row{std::to_string(k + 1), format_number(q.position.x(), 2),
                                 format_number(q.position.y(), 2), format_number(q.position.z(), 2),
                                 format_number(q.yaw * 180.0 / kPi, 1)};
    if (s.gimbal) row.push_back(format_number(q.pitch * 180.0 / kPi, 1));
    list.add_row(std::move(row));
  }
  Table all{.caption = "Metrics (metrics.json)", .columns = {"key", "value"}};
  for (const auto& [name, value] : metrics.items()) all.add_row({name, dumped(value, -1)});
  report.add_table(all).add_table(list);
  report.write(out / "report.html");
}
}  // namespace surfleet::examples
