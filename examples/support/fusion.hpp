// SPDX-License-Identifier: MIT
/// @file
/// @brief Recorded observations become a map, a surface, a report and the next viewpoints: what
/// `fuse_depth` and `fuse_scans` have in common.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "support/cli.hpp"
#include "support/frame_folder.hpp"

#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>

namespace surfleet::examples {
struct FusionSettings {
  std::string input;
  double voxel = 0.02;                    ///< [m]
  std::vector<double> range{0.3, 4.0};    ///< [m]
  std::optional<double> truncation;       ///< [m]; nothing: three voxels.
  std::optional<double> known_weight;     ///< W_th; nothing: of `observations` from the far end.
  double observations = 2.0;              ///< That make a voxel known, if all are from the far end.
  std::vector<double> up{0.0, 0.0, 1.0};  ///< In the frame of the poses.
  std::vector<double> bounds;             ///< Box that is meshed and viewed; empty: all [m].
  double max_time_off = 0.02;             ///< [s]
  int views = 20;
  std::optional<double> standoff;  ///< [m]; nothing: the middle of the range.
  double pitch = 0.0;              ///< Of the next views' camera, downwards [deg].
  double radius = 0.0;             ///< Of the body that is to be there [m].
  bool strict = false, quiet = false;
  std::string out;
  int threads = 2;

  double mu() const { return truncation.value_or(3.0 * voxel); }
  double known() const { return known_weight.value_or(observations / (range[1] * range[1])); }
  /// Turns the frame of the poses so that `up` is its z axis.
  Pose upright() const;
};

/// Declares the options that both programs share, into settings that hold the defaults. Call
/// `check` after parsing.
void declare_fusion_options(cli::Options& app, FusionSettings& settings);
/// Throws `Error`.
void check_fusion_settings(const FusionSettings& settings);

/// A pose from which more of the surface would be seen.
struct NextView {
  Configuration body;
  Pose T_world_camera;
  double gain = 0.0;   ///< Share of the incomplete elements that it shows.
  double added = 0.0;  ///< The same, of those that no view before it in the list shows.
};

struct FusionTimes {
  double read = 0.0;  ///< Reading and decoding, on whatever thread [s].
  double fuse = 0.0, extract = 0.0, views = 0.0, wall = 0.0;  ///< [s]
};

/// Folds observations, as missions do.
class Fusion {
 public:
  explicit Fusion(const FusionSettings& settings);
  void add(const DepthImage& image, const PinholeCamera& camera, const Pose& T_world_camera,
           double time);
  void add(const PointCloud& scan, const Pose& T_world_sensor, double time);
  /// Extracts the surface, plans views for `camera` and writes everything to `out`, prints a
  /// summary, and gives the program's exit status. Throws `Error` if there is no surface.
  int finish(const char* program, const PinholeCamera& camera, const SkippedFrames& skipped,
             FusionTimes times);

 private:
  FusionSettings settings_;
  Pose upright_;
  TsdfIntegrator<DropOffWeight<>> integrate_;
  TsdfMap map_;
  Trajectory sensors_;
  bool depth_images_ = false;
  double fuse_ = 0.0;
};
}  // namespace surfleet::examples
