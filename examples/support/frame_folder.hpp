// SPDX-License-Identifier: MIT
/// @file
/// @brief Recorded observations in a folder: which there are, where each was taken, and which
/// cannot be used.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/pose_io.hpp>

namespace surfleet::examples {
/// Frames that cannot be used, counted by reason; or, where that is strict, the first is refused.
class SkippedFrames {
 public:
  explicit SkippedFrames(bool strict = false) : strict_(strict) {}
  /// `why` is a line for people, `reason` a word for `metrics.json`. Throws `Error` if strict.
  void add(const std::string& reason, const std::string& why) {
    if (strict_) throw Error(why);
    if (first_.empty()) first_ = why;
    ++counts_[reason];
  }
  bool strict() const { return strict_; }
  const std::map<std::string, int>& counts() const { return counts_; }
  int total() const {
    int sum = 0;
    for (const auto& [reason, count] : counts_) sum += count;
    return sum;
  }
  /// "3 skipped (no_pose 2, bad_image 1; first: …)", or nothing.
  std::string summary() const;

 private:
  bool strict_;
  std::map<std::string, int> counts_;
  std::string first_;
};

/// A file and the pose it was taken from.
struct RecordedFrame {
  std::filesystem::path file;
  Pose T_world_sensor = Pose::Identity();
  double time = 0.0;  ///< [s], or the number of the frame where there are no times.
};

struct DepthFolder {
  std::vector<RecordedFrame> frames;     ///< In the order in which they were taken.
  int width = 0, height = 0;             ///< Of most of the images; others were skipped [px].
  double units_per_metre = 1000.0;       ///< As this layout has it.
  std::optional<Intrinsics> intrinsics;  ///< From `camera-intrinsics.txt`.
};
/// Finds the depth images of a folder and their poses, in the layout of 7-Scenes
/// (`NAME.depth.png` beside `NAME.pose.txt`, millimetres) or of TUM RGB-D (`depth.txt`,
/// `groundtruth.txt`, 5000 units a metre; poses at most `max_time_off` [s] away; a frame whose
/// nearest pose is none is skipped). Sizes are read from the images' headers alone. Throws `Error`
/// if it is neither or nothing in it can be used.
DepthFolder open_depth_folder(const std::filesystem::path& folder, double max_time_off,
                              SkippedFrames& skipped);

/// Finds the clouds (`.ply`, `.xyz`) of a folder in the order of their names, by value if these are
/// numbers, and their poses: a file `NAME.pose.txt` beside each, or a trajectory in TUM format.
///
/// Scans named by times (numbers, some with decimals, or all with a pose near, or not as many as
/// poses) have the pose nearest in time, at most `max_time_off` [s] away; others are as many as
/// poses, in the same order. Throws `Error` likewise.
std::vector<RecordedFrame> open_scan_folder(const std::filesystem::path& folder,
                                            const std::string& trajectory, double max_time_off,
                                            SkippedFrames& skipped);
}  // namespace surfleet::examples
