// SPDX-License-Identifier: MIT
/// @file
/// @brief `surface_navigation --method sparse`: RRT* over a cloud's points, then motions of a
/// bicycle on quadric patches, weighted by saliency, from one to the next.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <surfleet/surface/patch_drive.hpp>
#include <surfleet/surface/sheet_tokens.hpp>
#include <surfleet/surface/sparse_planner.hpp>

#include "cloud_navigation.hpp"

namespace surfleet::examples {
/// Runs the pipeline; the program's exit status.
inline int navigate_sparse_cloud(const CloudNavigation& s, std::size_t samples) {
  using namespace cloud_navigation;
  const auto begin = Clock::now();
  Input in = usable_input(s);
  PointCloud& cloud = in.cloud;
  cloud.normals = plane_normals(cloud.points, {.threads = s.threads});
  if (s.scan_from.size() == 3)
    turn_to_sensor(cloud.points, Point3(s.scan_from[0], s.scan_from[1], s.scan_from[2]),
                   cloud.normals);
  else
    turn_consistently(cloud.points, 12, cloud.normals);
  std::vector<double> saliency;  // how much of a sheet there is about each point
  for (const Token& t :
       SheetTokens{.scale = voting_scale(s, cloud.points), .threads = s.threads}(cloud.points))
    saliency.push_back(t.stick);
  SparsePlannerOptions options;
  options.samples = samples;
  options.seed = s.seed;
  const SparsePlanner planner(cloud, options);
  Box3 box;
  for (const Point3& p : cloud.points) box.extend(p);
  const auto end = [&](double share) {
    return planner.tree().nearest(box.center() + (share - 0.5) * box.sizes())->index;
  };
  const auto place = [&](const Point3& p, const std::string& what) {
    require(p.allFinite(), what + ": expected finite numbers");
    const auto near = planner.tree().nearest(p, s.off_surface);
    require(near.has_value(),
            what + ": no point of the cloud within --off-surface; expected a place on it");
    return near->index;
  };
  const auto [start, goals] = route_ends(s.start, s.goal, place, end);
  std::int32_t at = start;
  const auto out = cli::prepare_output_folder(s.out);
  cli::watch_interrupts();

  PatchDriveOptions motions;
  motions.quadric.noise = std::max(s.cloud_noise, 0.002);
  std::vector<StampedPose> record;
  std::vector<Point3> planned, driven;
  nlohmann::json unreached = nlohmann::json::array();
  double length = 0.0, exact = 0.0, drive_length = 0.0, planning_time = 0.0, off_path = 0.0;
  std::size_t patches = 0;
  for (std::size_t g = 0; g < goals.size() && !cli::interrupted(); ++g) {
    const auto planning = Clock::now();
    const auto path = planner(at, goals[g]);
    planning_time += seconds_since(planning);
    if (!path) {
      unreached.push_back({{"goal", g}, {"reason", "the tree over the cloud did not reach it"}});
      continue;
    }
    length += path->length;
    std::vector<Point3> waypoints;
    for (const std::int32_t i : path->points)
      waypoints.push_back(cloud.points[static_cast<std::size_t>(i)]);
    planned.insert(planned.end(), waypoints.begin(), waypoints.end());
    if (in.truth) exact += in.truth->distance(waypoints.front(), waypoints.back()).value_or(0.0);
    at = goals[g];
    if (waypoints.size() < 2) continue;
    const PatchDrive drive =
        drive_over_patches(cloud, planner.tree(), waypoints, motions, saliency);
    patches += drive.patches;
    drive_length += drive.length;
    off_path = std::max(off_path, drive.off_path);
    for (const PatchPose& p : drive.poses) {
      append_pose(record, body_pose({p.position, p.normal}, p.forward), s.speed);
      driven.push_back(p.position + 0.004 * p.normal);
    }
    if (!drive.reached)
      unreached.push_back({{"goal", g}, {"reason", "no quadric patch or motion leads on to it"}});
  }
  const bool all = unreached.empty() && !cli::interrupted();
  const nlohmann::json none;
  const nlohmann::json metrics{
      {"scene", s.scene},
      {"method", "sparse"},
      {"seed", s.seed},
      {"points", in.raw},
      {"points_used", cloud.size()},
      {"samples", samples},
      {"path_length_m", length},
      {"geodesic_ratio", exact > 0.0 ? nlohmann::json(length / exact) : none},
      {"driven_length_m", drive_length},
      {"patches", patches},
      {"off_path_max_m", off_path},
      {"reached_goal", all},
      {"unreached_goals", unreached},
      {"planning_time_s", planning_time},
      {"wall_time_s", seconds_since(begin)},
      {"peak_memory_bytes", peak_memory()}};
  write_file(out / "metrics.json", metrics.dump(2) + "\n");
  write_ply(cloud, out / "cloud.ply");
  write_tum(out / "driven.tum", record);

  Rasterizer picture = navigation_picture(box);
  picture.draw_points(cloud.points, Rgb{190, 195, 200}, 4.0);
  picture.draw_polyline(planned, Rgb{30, 90, 190}, 3.0);
  picture.draw_polyline(driven, Rgb{200, 40, 40}, 3.0);
  const Bytes png = encode_png(picture.image());
  write_file(out / "path.png", png);
  Report report("Surface navigation: " + s.scene,
                std::to_string(cloud.size()) + " points, sparse planner");
  report.add_key_figures(std::vector<KeyFigure>{
      {"Path", format_number(length, 3) + " m", std::to_string(goals.size()) + " goal(s)"},
      {"Driven", format_number(drive_length, 3) + " m", std::to_string(patches) + " patches"},
      {"Planning", format_number(planning_time, 2) + " s", std::to_string(samples) + " samples"}});
  report.add_picture(png, "The tree's path (blue) and the motions on patches (red)");
  report.write(out / "report.html");
  std::printf("%zu points, %.3f m planned, %.3f m driven, %s; results in %s\n", cloud.size(),
              length, drive_length, all ? "every goal reached" : "not every goal reached",
              out.string().c_str());
  return all ? cli::kDone : cli::kIncomplete;
}
}  // namespace surfleet::examples
