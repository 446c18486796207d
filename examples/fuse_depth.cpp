// SPDX-License-Identifier: MIT
// requires: fusion
// Recorded depth images with poses become a map, a mesh, points, a report and the next viewpoints.
//
//   fuse_depth DIR --intrinsics 585 585 320 240 --up 0 -1 0 --out out/room
#include <chrono>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "support/ahead.hpp"
#include "support/cli.hpp"
#include "support/frame_folder.hpp"
#include "support/fusion.hpp"

#include <surfleet/adapters/png_depth.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A decoded image, or why there is none.
struct Decoded {
  std::optional<DepthImage> image;
  std::string why;
  double seconds = 0.0;
};

int run(int argc, char** argv) {
  cli::Options app(
      "Recorded depth images with poses become a map, a mesh, points, a report and the next "
      "viewpoints.\n"
      "DIR holds 16-bit PNG images, 0 and 65535 being no measurement, laid out as 7-Scenes\n"
      "(NAME.depth.png, NAME.pose.txt: camera to world, millimetres) or TUM RGB-D (depth.txt,\n"
      "groundtruth.txt, 5000 units a metre), and camera-intrinsics.txt (3 x 3) unless "
      "--intrinsics\n"
      "is given.\n"
      "Example: fuse_depth recordings/office --intrinsics 585 585 320 240 --up 0 -1 0\n"
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
  cli::watch_interrupts();
  {
    cli::ProgressLine line(!s.quiet);
    // On one thread, reading and fusing take turns.
    Ahead<Decoded> images(folder.frames.size(), s.threads == 1, [&](std::size_t i) {
      const auto before = Clock::now();
      Decoded d;
      try {
        const std::string name = folder.frames[i].file.string();
        d.image = decode_png_depth(read_file(name), scale, name);
      } catch (const Error& e) {
        d.why = e.what();
      }
      d.seconds = seconds_since(before);
      return d;
    });
    for (std::size_t i = 0; !images.done() && !cli::interrupted(); ++i) {
      const Decoded d = images.next();
      times.read += d.seconds;
      const bool fits =
          d.image && d.image->width == folder.width && d.image->height == folder.height;
      if (fits)
        fusion.add(*d.image, camera, folder.frames[i].T_world_sensor, folder.frames[i].time);
      else
        skipped.add("bad_image",
                    d.image ? folder.frames[i].file.string() + ": changed size" : d.why);
      line("image " + std::to_string(i + 1) + " of " + std::to_string(folder.frames.size()));
    }
  }
  times.wall = seconds_since(start);
  return fusion.finish("fuse_depth", camera, skipped, times);
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("fuse_depth", [&] { return run(argc, argv); });
}
