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
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/core/types.hpp>

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

/// Reads the text of a TUM file; `name` stands for the file in errors. Blank lines and lines that
/// begin with `#` are passed over. Throws `Error` on a line that is not eight finite numbers, on a
/// quaternion whose length is more than a hundredth off one, and on times that run backwards.
inline Trajectory parse_tum(std::string_view text, const std::string& name = "trajectory") {
  Trajectory trajectory;
  std::size_t line_number = 0;
  while (!text.empty()) {
    ++line_number;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto refuse = [&](const char* why) {
      throw Error(name + ": line " + std::to_string(line_number) + ": " + why);
    };
    const auto skip_blanks = [&line] {
      line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    };
    skip_blanks();
    if (line.empty() || line.front() == '#') continue;
    std::array<double, 8> row{};
    for (double& value : row) {
      const auto used = parse_prefix(line, value);
      const bool ended = used && (*used == line.size() || line[*used] == ' ' ||
                                  line[*used] == '\t' || line[*used] == '\r');
      if (!ended || !std::isfinite(value))
        refuse("expected eight finite numbers: time tx ty tz qx qy qz qw");
      line.remove_prefix(*used);
      skip_blanks();
    }
    if (!line.empty()) refuse("expected no more than eight numbers");
    Eigen::Quaterniond q(row[7], row[4], row[5], row[6]);
    if (!(std::abs(q.norm() - 1.0) <= 0.01)) refuse("expected a quaternion of length one");
    if (!trajectory.empty() && row[0] < trajectory.back().time)
      refuse("expected times that do not decrease");
    StampedPose stamped{row[0], Pose::Identity()};
    stamped.T_world_body.linear() = q.normalized().toRotationMatrix();
    stamped.T_world_body.translation() = Point3(row[1], row[2], row[3]);
    trajectory.push_back(stamped);
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
