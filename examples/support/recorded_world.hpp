// SPDX-License-Identifier: MIT
/// @file
/// @brief A simulated world that leaves the images it gives behind, as `fuse_depth` reads them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "support/inspection_settings.hpp"

#include <surfleet/adapters/png_depth.hpp>
#include <surfleet/core/binary_io.hpp>
#include <surfleet/geometry/pose_io.hpp>
#include <surfleet/geometry/teammate_mask.hpp>

namespace surfleet::examples {
/// Another world whose images are also written to a folder in the layout of 7-Scenes, in
/// millimetres and without the teammates that a mission takes out of them, with
/// `camera-intrinsics.txt` and the settings to fuse them by in `fuse_depth.toml`. Without a folder
/// nothing but the other world. Frames are numbered in the order in which a mission folds them.
template <typename World>
class RecordedWorld {
 public:
  RecordedWorld(World world, const InspectionSettings& s, const PinholeCamera& camera,
                Pose T_body_camera = forward_camera_mount())
      : world_(std::move(world)),
        folder_(s.save_images),
        camera_(camera),
        T_body_camera_(std::move(T_body_camera)),
        mate_radius_(s.radius + s.voxel) {
    if (folder_.empty()) return;
    write_file(folder_ / "camera-intrinsics.txt",
               format_intrinsics({camera.fx, camera.fy, camera.cx, camera.cy}));
    char text[320];
    std::snprintf(text, sizeof text,
                  "voxel = %.17g\nrange = [%.17g, %.17g]\ntruncation = %.17g\nknown-weight = "
                  "%.17g\n",
                  s.voxel, camera.min_range, camera.max_range, s.truncation.value_or(3.0 * s.voxel),
                  s.known_weight);
    write_file(folder_ / "fuse_depth.toml", std::string(text));
  }

  DepthImage capture(std::size_t robot, std::uint64_t shot,
                     std::span<const Configuration> fleet) const {
    DepthImage image = world_.capture(robot, shot, fleet);
    if (!folder_.empty()) record(image, robot, shot, fleet);
    return image;
  }
  bool sees(const Point3& a, const Point3& b) const { return world_.sees(a, b); }

 private:
  void record(DepthImage image, std::size_t robot, std::uint64_t shot,
              std::span<const Configuration> fleet) const {
    std::vector<Point3> mates;
    for (std::size_t k = 0; k < fleet.size(); ++k)
      if (k != robot) mates.push_back(fleet[k].position);
    const Pose pose = camera_pose(fleet[robot], T_body_camera_);
    mask_teammates(image, camera_, pose, mates, mate_radius_);
    char name[40];
    std::snprintf(name, sizeof name, "frame-%06llu",
                  static_cast<unsigned long long>(shot * fleet.size() + robot));
    const std::string base = (folder_ / name).string();
    write_file(base + ".pose.txt", format_pose(pose));
    write_file(base + ".depth.png", encode_png_depth(image, kUnitsPerMetre));
  }
  static constexpr double kUnitsPerMetre = 1000.0;

  World world_;
  std::filesystem::path folder_;
  PinholeCamera camera_;
  Pose T_body_camera_;
  double mate_radius_;
};

/// Throws `Error` if images of such a range do not fit into 16 bits.
inline void check_recording(const InspectionSettings& s) {
  require(s.save_images.empty() || s.farthest < 1e-3 * kMostDepthValue,
          "--save-images: depth in millimetres reaches to 65.5 m; expected a nearer --range");
  require(s.save_images.empty() || !s.has_lidar(),
          "--save-images: saves depth images; expected --sensor camera");
  require(s.save_images.empty() || s.weight == "inverse-square",
          "--save-images: fuse_depth weighs by 1/z^2; expected --weight inverse-square");
}
}  // namespace surfleet::examples
