// SPDX-License-Identifier: MIT
#include "support/frame_folder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
/// The lines of a trajectory's file, of which some are no poses, by time.
class RecordedPoses {
 public:
  RecordedPoses(const fs::path& file, double max_time_off)
      : file_(file), max_time_off_(max_time_off) {
    in_order_ = parse_tum_lines(text_of(read_file(file)));
    for (const TumLine& line : in_order_)
      if (line.time) by_time_.push_back(&line);
    std::stable_sort(by_time_.begin(), by_time_.end(),
                     [](const TumLine* a, const TumLine* b) { return *a->time < *b->time; });
    for (const TumLine* line : by_time_) times_.push_back(*line->time);
  }
  RecordedPoses(const RecordedPoses&) = delete;
  RecordedPoses& operator=(const RecordedPoses&) = delete;

  std::size_t size() const { return in_order_.size(); }
  bool has_near(double time) const {
    return nearest_in_time(times_, time, max_time_off_).has_value();
  }
  /// A frame with the pose nearest to `time`, or nothing with the reason counted.
  void add_nearest(const fs::path& frame, double time, SkippedFrames& skipped,
                   std::vector<RecordedFrame>& frames) const {
    if (const auto at = nearest_in_time(times_, time, max_time_off_))
      add(frame, *by_time_[*at], time, skipped, frames);
    else
      skipped.add("no_pose", frame.string() + ": no pose in " + file_.string() + " within " +
                                 std::to_string(max_time_off_) + " s of its time " +
                                 std::to_string(time));
  }
  /// The same with the pose of the `i`th line that has one.
  void add_at(std::size_t i, const fs::path& frame, SkippedFrames& skipped,
              std::vector<RecordedFrame>& frames) const {
    add(frame, in_order_[i], in_order_[i].time.value_or(0.0), skipped, frames);
  }
  /// Refuses what is no pose, if that is strict; else it counts once a frame would need it.
  void check(const SkippedFrames& skipped) const {
    for (const TumLine& line : in_order_)
      require(line.error.empty() || !skipped.strict(), why(line));
  }

 private:
  std::string why(const TumLine& line) const {
    return file_.string() + ": line " + std::to_string(line.number) + ": " + line.error;
  }
  void add(const fs::path& frame, const TumLine& line, double time, SkippedFrames& skipped,
           std::vector<RecordedFrame>& frames) const {
    if (line.error.empty())
      frames.push_back({frame, line.T_world_body, time});
    else
      skipped.add("bad_pose", why(line));
  }

  fs::path file_;
  double max_time_off_;
  std::vector<TumLine> in_order_;
  std::vector<const TumLine*> by_time_;
  std::vector<double> times_;
};

/// Of a scan that is named by a number, as by the time when it was taken.
std::optional<double> number_in_name(const fs::path& cloud) {
  const auto number = parse_number<double>(cloud.stem().string());
  return number && std::isfinite(*number) ? number : std::nullopt;
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
  const bool listed = fs::exists(folder / "depth.txt", ec);
  if (!poses.empty() || (!images.empty() && !listed)) {
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
  } else if (listed) {
    found.units_per_metre = 5000.0;
    const RecordedPoses truth(folder / "groundtruth.txt", max_time_off);
    truth.check(skipped);
    const auto skip = [&](const std::string& why) { skipped.add("bad_line", why); };
    for (const StampedFile& f : read_stamped_files(folder / "depth.txt", skip))
      truth.add_nearest(folder / f.file, f.time, skipped, found.frames);
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
  std::vector<fs::path> clouds = files_ending_in(folder, kClouds);
  require(!clouds.empty(),
          folder.string() + ": no scans; expected clouds as .ply or .xyz with their poses");
  if (std::all_of(clouds.begin(), clouds.end(), number_in_name))
    std::stable_sort(clouds.begin(), clouds.end(), [](const fs::path& a, const fs::path& b) {
      return *number_in_name(a) < *number_in_name(b);
    });
  std::vector<RecordedFrame> frames;
  if (trajectory.empty()) {
    double number = 0.0;
    for (const fs::path& cloud : clouds)
      add_with_pose_file(cloud, without(cloud, cloud.extension().string()) + ".pose.txt", number++,
                         skipped, frames);
  } else {
    const RecordedPoses poses(trajectory, max_time_off);
    poses.check(skipped);
    std::vector<double> stamps;
    bool with_decimals = false, all_near = true;
    for (const fs::path& cloud : clouds)
      if (const auto stamp = number_in_name(cloud)) {
        stamps.push_back(*stamp);
        with_decimals = with_decimals || cloud.stem().string().find('.') != std::string::npos;
        all_near = all_near && poses.has_near(*stamp);
      }
    const bool as_many = poses.size() == clouds.size();
    const bool numbered = stamps.size() == clouds.size();
    require(numbered || as_many,
            trajectory + ": " + std::to_string(poses.size()) + " poses for " +
                std::to_string(clouds.size()) +
                " scans; expected one each, in the order of their names, or scans named by time");
    // Whole numbers may be no times: as many poses then belong to the scans in order.
    const bool by_time = numbered && (with_decimals || all_near || !as_many);
    for (std::size_t i = 0; i < clouds.size(); ++i)
      if (by_time)
        poses.add_nearest(clouds[i], stamps[i], skipped, frames);
      else
        poses.add_at(i, clouds[i], skipped, frames);
  }
  require(!frames.empty(), folder.string() + ": no scan can be used; " + skipped.summary());
  return frames;
}
}  // namespace surfleet::examples
