// SPDX-License-Identifier: MIT
// requires: fusion
// Recorded range scans with poses become a map, a mesh, points, a report and the next viewpoints.
//
//   fuse_scans DIR --voxel 0.2 --range 1 40 --out out/street
#include <string>
#include <vector>

#include "support/cli.hpp"
#include "support/frame_folder.hpp"
#include "support/fusion.hpp"
#include "support/reading.hpp"
#include "support/stopwatch.hpp"

#include <surfleet/geometry/mesh_io.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;
int run(int argc, char** argv) {
  cli::Options app(
      "Recorded range scans with poses become a map, a mesh, points, a report and the next "
      "viewpoints.\n"
      "DIR holds clouds (.ply, .xyz) of points in the frame of the sensor, which is their origin,\n"
      "and NAME.pose.txt (4 x 4, sensor to world) beside each, unless --trajectory is given.\n"
      "Writes reconstruction.ply, points.ply, map.sfm, next_viewpoints.json and .tum, "
      "sensors.tum,\n"
      "metrics.json and report.html to --out.\n"
      "Exit status: 0 done, 2 input refused, 3 ended early.");
  FusionSettings s;
  s.voxel = 0.2;
  s.range = {0.5, 50.0};
  s.observations = 1.0;
  s.out = "out/fuse_scans";
  std::string trajectory;
  std::vector<double> fov{90.0, 60.0};
  app.add("DIR", s.input, "folder of the recording").required();
  app.add("--trajectory", trajectory,
          "poses in TUM format: of scans named by their times, 12.5.ply, the nearest within "
          "--max-time-off; else as many as scans, in the order of their names");
  app.add("--fov", fov, "horizontal and vertical, of the camera of the next views [deg]")
      .expected(2);
  declare_fusion_options(app, s);
  app.add_examples(
      "  fuse_scans recordings/street --trajectory street.tum --voxel 0.2 --range 1 40\n"
      "  fuse_scans recordings/hall --fov 80 50 --views 10    with NAME.pose.txt beside each "
      "cloud");
  app.parse(argc, argv);
  check_fusion_settings(s);
  constexpr int kWidth = 640, kHeight = 480;
  const PinholeCamera camera = PinholeCamera::from_fov(radians(fov[0]), radians(fov[1]), kWidth,
                                                       kHeight, s.range[0], s.range[1]);

  const auto start = Clock::now();
  SkippedFrames skipped(s.strict);
  const std::vector<RecordedFrame> frames =
      open_scan_folder(s.input, trajectory, s.max_time_off, skipped);
  Fusion fusion(s);
  FusionTimes times;
  for_each_read(
      frames, s, "scan", skipped, times,
      [](const RecordedFrame& frame) { return read_point_cloud(frame.file); },
      [&](const PointCloud& cloud, const RecordedFrame& frame) {
        fusion.add(cloud, frame.T_world_sensor, frame.time);
      });
  times.wall = seconds_since(start);
  return fusion.finish("fuse_scans", camera, skipped, times);
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("fuse_scans", [&] { return run(argc, argv); });
}
