// SPDX-License-Identifier: MIT
/// @file
/// @brief Trajectories in the TUM text format: a line `time tx ty tz qx qy qz qw` for each pose.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/text_scanner.hpp>

namespace surfleet {
/// Where a body was at a moment.
struct StampedPose {
  double time = 0.0;  ///< [s]
  Pose T_world_body = Pose::Identity();
};
using Trajectory = std::vector<StampedPose>;

/// Sum of the distances between consecutive positions [m].
inline double path_length(std::span<const StampedPose> trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    length +=
        (trajectory[i].T_world_body.translation() - trajectory[i - 1].T_world_body.translation())
            .norm();
  return length;
}

/// The text of a TUM file. Numbers are the shortest that read back as the same value.
inline std::string format_tum(std::span<const StampedPose> trajectory) {
  std::string text = "# time tx ty tz qx qy qz qw\n";
  for (const StampedPose& stamped : trajectory) {
    const Eigen::Vector3d t = stamped.T_world_body.translation();
    Eigen::Quaterniond q(stamped.T_world_body.linear());
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    const std::array<double, 8> row{stamped.time, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
    for (std::size_t k = 0; k < row.size(); ++k) {
      char number[32];
      const auto end = std::to_chars(number, number + sizeof number, row[k] + 0.0);
      text.append(number, end.ptr).push_back(k + 1 < row.size() ? ' ' : '\n');
    }
  }
  return text;
}

/// A line of a TUM file: a pose, or why it is none.
struct TumLine {
  std::size_t number = 0;      ///< From 1 on.
  std::optional<double> time;  ///< [s]; of a line that is no pose, too, where it can be read.
  Pose T_world_body = Pose::Identity();
  std::string error;  ///< Empty of a pose.
};

/// Reads the text of a TUM file line by line, in order; blank lines and lines that begin with `#`
/// are passed over. No pose is a line that is not eight finite numbers, whose quaternion's length
/// is more than a hundredth off one, or whose time is before that of the last pose. O(text).
inline std::vector<TumLine> parse_tum_lines(std::string_view text) {
  std::vector<TumLine> lines;
  std::optional<double> last;
  TextScanner scanner(text);
  while (const auto line = scanner.next_line()) {
    TextScanner words(*line);
    std::array<double, 8> row{};
    std::size_t count = 0;
    bool numbers = true;
    TumLine found;
    found.number = scanner.line();
    auto word = words.next_word();
    if (!word || word->front() == '#') continue;
    for (; word; word = words.next_word(), ++count) {
      const auto value = parse_number<double>(*word);
      const bool finite = value && std::isfinite(*value);
      if (finite && count == 0) found.time = *value;
      if (finite && count < row.size()) row[count] = *value;
      numbers = numbers && finite;
    }
    const Eigen::Quaterniond q(row[7], row[4], row[5], row[6]);
    if (!numbers || count != row.size())
      found.error = "expected eight finite numbers: time tx ty tz qx qy qz qw";
    else if (!(std::abs(q.norm() - 1.0) <= 0.01))
      found.error = "not rigid; expected a quaternion of length one";
    else if (last && row[0] < *last)
      found.error = "expected times that do not decrease";
    if (found.error.empty()) {
      last = row[0];
      found.T_world_body.linear() = q.normalized().toRotationMatrix();
      found.T_world_body.translation() = Point3(row[1], row[2], row[3]);
    }
    lines.push_back(std::move(found));
  }
  return lines;
}
/// The same of a file in which every line is a pose; `name` stands for it in errors. Throws `Error`
/// at the first that is none.
inline Trajectory parse_tum(std::string_view text, const std::string& name = "trajectory") {
  Trajectory trajectory;
  for (const TumLine& line : parse_tum_lines(text)) {
    require(line.error.empty(), name + ": line " + std::to_string(line.number) + ": " + line.error);
    trajectory.push_back({*line.time, line.T_world_body});
  }
  return trajectory;
}

inline void write_tum(const std::filesystem::path& path, std::span<const StampedPose> trajectory) {
  write_file(path, std::string_view(format_tum(trajectory)));
}
inline Trajectory read_tum(const std::filesystem::path& path) {
  const Bytes bytes = read_file(path);
  return parse_tum(text_of(bytes), path.string());
}
}  // namespace surfleet
