// SPDX-License-Identifier: MIT
// requires: fusion
// Recorded depth images with poses become a map, a mesh, points, a report and the next viewpoints.
//
//   fuse_depth DIR --intrinsics 585 585 320 240 --up 0 -1 0 --out out/room
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "support/cli.hpp"
#include "support/frame_folder.hpp"
#include "support/fusion.hpp"
#include "support/reading.hpp"
#include "support/stopwatch.hpp"

#include <surfleet/adapters/png_depth.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;
int run(int argc, char** argv) {
  cli::Options app(
      "Recorded depth images with poses become a map, a mesh, points, a report and the next "
      "viewpoints.\n"
      "DIR holds 16-bit PNG images, 0 and 65535 being no measurement, laid out as 7-Scenes\n"
      "(NAME.depth.png, NAME.pose.txt: camera to world, millimetres) or TUM RGB-D (depth.txt,\n"
      "groundtruth.txt, 5000 units a metre), and camera-intrinsics.txt (3 x 3) unless "
      "--intrinsics\n"
      "is given.\n"
      "Writes reconstruction.ply, points.ply, map.sfm, next_viewpoints.json and .tum, "
      "sensors.tum,\n"
      "metrics.json and report.html to --out.\n"
      "Exit status: 0 done, 2 input refused, 3 ended early.");
  FusionSettings s;
  s.out = "out/fuse_depth";
  std::vector<double> intrinsics;
  std::optional<double> depth_scale;
  app.add("DIR", s.input, "folder of the recording").required();
  app.add("--intrinsics", intrinsics, "FX FY CX CY [px]").expected(4);
  app.add("--depth-scale", depth_scale, "units of a pixel's value a metre; default the layout's")
      .positive();
  declare_fusion_options(app, s);
  app.add_examples(
      "  fuse_depth recordings/office --intrinsics 585 585 320 240 --up 0 -1 0\n"
      "  fuse_depth shots --config shots/fuse_depth.toml      what drone_inspection --save-images "
      "left");
  app.parse(argc, argv);
  check_fusion_settings(s);
  require(!depth_scale || std::isfinite(*depth_scale), "--depth-scale: expected a finite number");

  const auto start = Clock::now();
  SkippedFrames skipped(s.strict);
  const DepthFolder folder = open_depth_folder(s.input, s.max_time_off, skipped);
  Intrinsics k;
  if (!intrinsics.empty())
    k = {intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]};
  else if (folder.intrinsics)
    k = *folder.intrinsics;
  else
    throw Error(s.input + ": no camera-intrinsics.txt; expected it or --intrinsics FX FY CX CY");
  require(k.fx > 0.0 && k.fy > 0.0 && std::isfinite(k.fx + k.fy) && k.cx > -0.5 && k.cy > -0.5 &&
              k.cx < folder.width - 0.5 && k.cy < folder.height - 0.5,
          "intrinsics: expected positive focal lengths and a principal point in images of " +
              std::to_string(folder.width) + " x " + std::to_string(folder.height) + " pixels");
  const PinholeCamera camera{folder.width, folder.height, k.fx,       k.fy,
                             k.cx,         k.cy,          s.range[0], s.range[1]};
  const double scale = depth_scale.value_or(folder.units_per_metre);

  Fusion fusion(s);
  FusionTimes times;
  for_each_read(
      folder.frames, s, "image", skipped, times,
      [&](const RecordedFrame& frame) {
        const std::string name = frame.file.string();
        DepthImage image = decode_png_depth(read_file(name), scale, name);
        require(image.width == folder.width && image.height == folder.height,
                name + ": changed size");
        return image;
      },
      [&](const DepthImage& image, const RecordedFrame& frame) {
        fusion.add(image, camera, frame.T_world_sensor, frame.time);
      });
  times.wall = seconds_since(start);
  return fusion.finish("fuse_depth", camera, skipped, times);
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("fuse_depth", [&] { return run(argc, argv); });
}
