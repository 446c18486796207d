// SPDX-License-Identifier: MIT
#include "support/frame_folder.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <span>
#include <string_view>

#include <surfleet/adapters/png_depth.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/geometry/stamped_files.hpp>

namespace surfleet::examples {
namespace fs = std::filesystem;

std::string SkippedFrames::summary() const {
  if (counts_.empty()) return {};
  std::string text = std::to_string(total()) + " skipped (";
  for (const auto& [reason, count] : counts_) text += reason + " " + std::to_string(count) + ", ";
  text.resize(text.size() - 2);
  return text + "; first: " + first_ + ")";
}

namespace {
/// The files of `folder` whose names end in one of these; shorter names first, so that numbers of
/// different lengths are in order.
std::vector<fs::path> files_ending_in(const fs::path& folder,
                                      std::span<const std::string_view> endings) {
  std::error_code ec;
  require(fs::is_directory(folder, ec), folder.string() + ": no such folder");
  std::vector<fs::path> found;
  for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
    const std::string name = it->path().filename().string();
    const auto fits = [&](std::string_view ending) { return name.ends_with(ending); };
    if (std::any_of(endings.begin(), endings.end(), fits)) found.push_back(it->path());
  }
  require(!ec, folder.string() + ": cannot be read: " + ec.message());
  std::sort(found.begin(), found.end(), [](const fs::path& a, const fs::path& b) {
    const std::string x = a.filename().string(), y = b.filename().string();
    return x.size() != y.size() ? x.size() < y.size() : x < y;
  });
  return found;
}
std::string without(const fs::path& path, std::string_view ending) {
  const std::string text = path.string();
  return text.substr(0, text.size() - ending.size());
}

/// A frame with the pose in `pose`, or nothing with the reason counted.
void add_with_pose_file(const fs::path& file, const fs::path& pose, double time,
                        SkippedFrames& skipped, std::vector<RecordedFrame>& frames) {
  std::error_code ec;
  if (!fs::exists(pose, ec)) {
    skipped.add("no_pose",
                pose.string() + ": no such file; expected the pose of " + file.filename().string());
    return;
  }
  try {
    frames.push_back({file, read_pose(pose), time});
  } catch (const Error& e) {
    skipped.add("bad_pose", e.what());
  }
}
std::vector<double> times_of(const Trajectory& trajectory) {
  std::vector<double> times;
  for (const StampedPose& p : trajectory) times.push_back(p.time);
  return times;
}

/// Keeps the frames whose images have the size that most have.
void settle_size(DepthFolder& found, SkippedFrames& skipped) {
  std::vector<RecordedFrame> readable;
  std::vector<std::pair<int, int>> sizes;
  std::map<std::pair<int, int>, int> votes;
  for (const RecordedFrame& f : found.frames) {
    std::error_code ec;
    if (!fs::is_regular_file(f.file, ec)) {
      skipped.add("no_image", f.file.string() + ": no such file");
      continue;
    }
    std::array<std::byte, 32> start{};
    std::ifstream in(f.file, std::ios::binary);
    in.read(reinterpret_cast<char*>(start.data()), static_cast<std::streamsize>(start.size()));
    const auto size = png_depth_size(
        std::span<const std::byte>(start).first(static_cast<std::size_t>(in.gcount())));
    if (!size) {
      skipped.add("bad_image", f.file.string() + ": expected a PNG image of 16-bit grey");
      continue;
    }
    readable.push_back(f);
    sizes.push_back(*size);
    ++votes[*size];
  }
  std::pair<int, int> most{};
  int best = 0;
  for (const auto& size : sizes)
    if (votes[size] > best) {
      best = votes[size];
      most = size;
    }
  found.width = most.first;
  found.height = most.second;
  found.frames.clear();
  const auto words = [](const std::pair<int, int>& s) {
    return std::to_string(s.first) + " x " + std::to_string(s.second);
  };
  for (std::size_t i = 0; i < readable.size(); ++i) {
    if (sizes[i] == most)
      found.frames.push_back(readable[i]);
    else
      skipped.add("other_size", readable[i].file.string() + ": " + words(sizes[i]) +
                                    " pixels; expected " + words(most) + " as the others");
  }
}
}  // namespace

DepthFolder open_depth_folder(const fs::path& folder, double max_time_off, SkippedFrames& skipped) {
  constexpr std::string_view kDepth = ".depth.png", kPose = ".pose.txt";
  DepthFolder found;
  std::error_code ec;
  const std::vector<fs::path> images = files_ending_in(folder, std::array{kDepth});
  const std::vector<fs::path> poses = files_ending_in(folder, std::array{kPose});
  if (!images.empty() || !poses.empty()) {
    double number = 0.0;
    for (const fs::path& image : images)
      add_with_pose_file(image, without(image, kDepth) + std::string(kPose), number++, skipped,
                         found.frames);
    for (const fs::path& pose : poses) {
      const fs::path image = without(pose, kPose) + std::string(kDepth);
      if (!fs::exists(image, ec))
        skipped.add("no_image", image.string() + ": no such file; expected the image of " +
                                    pose.filename().string());
    }
  } else if (fs::exists(folder / "depth.txt", ec)) {
    found.units_per_metre = 5000.0;
    const Trajectory truth = read_tum(folder / "groundtruth.txt");
    const std::vector<double> times = times_of(truth);
    for (const StampedFile& f : read_stamped_files(folder / "depth.txt")) {
      const auto at = nearest_in_time(times, f.time, max_time_off);
      if (at)
        found.frames.push_back({folder / f.file, truth[*at].T_world_body, f.time});
      else
        skipped.add("no_pose", (folder / f.file).string() + ": no pose within " +
                                   std::to_string(max_time_off) + " s of its time");
    }
  } else {
    throw Error(folder.string() +
                ": no depth images; expected NAME.depth.png with NAME.pose.txt (7-Scenes) or "
                "depth.txt with groundtruth.txt (TUM RGB-D)");
  }
  settle_size(found, skipped);
  require(!found.frames.empty(), folder.string() + ": no frame can be used; " + skipped.summary());
  for (const char* name : {"camera-intrinsics.txt", "camera_intrinsics.txt"})
    if (!found.intrinsics && fs::exists(folder / name, ec))
      found.intrinsics = read_intrinsics(folder / name);
  return found;
}

std::vector<RecordedFrame> open_scan_folder(const fs::path& folder, const std::string& trajectory,
                                            double max_time_off, SkippedFrames& skipped) {
  constexpr std::array<std::string_view, 2> kClouds{".ply", ".xyz"};
  const std::vector<fs::path> clouds = files_ending_in(folder, kClouds);
  require(!clouds.empty(),
          folder.string() + ": no scans; expected clouds as .ply or .xyz with their poses");
  std::vector<RecordedFrame> frames;
  if (trajectory.empty()) {
    double number = 0.0;
    for (const fs::path& cloud : clouds)
      add_with_pose_file(cloud, without(cloud, cloud.extension().string()) + ".pose.txt", number++,
                         skipped, frames);
  } else {
    const Trajectory poses = read_tum(trajectory);
    const std::vector<double> times = times_of(poses);
    std::vector<double> stamps;
    for (const fs::path& cloud : clouds)
      if (const auto stamp = parse_number<double>(cloud.stem().string())) stamps.push_back(*stamp);
    const bool by_time = stamps.size() == clouds.size();
    require(by_time || poses.size() == clouds.size(),
            trajectory + ": " + std::to_string(poses.size()) + " poses for " +
                std::to_string(clouds.size()) +
                " scans; expected one each, in the order of their names, or scans named by time");
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      // As many poses as scans belong together whatever their times.
      const auto at = poses.size() == clouds.size()
                          ? std::optional(i)
                          : nearest_in_time(times, stamps[i], max_time_off);
      if (at)
        frames.push_back({clouds[i], poses[*at].T_world_body, poses[*at].time});
      else
        skipped.add("no_pose", clouds[i].string() + ": no pose within " +
                                   std::to_string(max_time_off) + " s of its time");
    }
  }
  require(!frames.empty(), folder.string() + ": no scan can be used; " + skipped.summary());
  return frames;
}
}  // namespace surfleet::examples
