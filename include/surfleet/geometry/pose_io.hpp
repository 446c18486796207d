// SPDX-License-Identifier: MIT
/// @file
/// @brief Poses and camera matrices as text: rows of numbers, as data sets of depth images keep
/// them.
///
/// Numbers stand between blanks; lines that begin with `#` and blank lines are passed over, and
/// lines may end as on any system.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/text_scanner.hpp>

namespace surfleet {
/// Focal lengths and principal point of a camera [px]; pixel centres are at whole coordinates.
struct Intrinsics {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
};

namespace detail {
/// Exactly `out.size()` finite numbers, row by row. Throws `Error`.
inline void parse_numbers(std::string_view text, std::span<double> out, const std::string& name,
                          const char* what) {
  TextScanner lines(text);
  std::size_t count = 0;
  const auto expected = [&](std::string_view why) {
    return Error(name + ": line " + std::to_string(lines.line()) + ": " + std::string(why) +
                 "; expected " + what);
  };
  while (const auto line = lines.next_line()) {
    TextScanner words(*line);
    auto word = words.next_word();
    if (!word || word->front() == '#') continue;
    for (; word; word = words.next_word()) {
      if (count == out.size()) throw expected("more numbers than that");
      const auto value = parse_number<double>(*word);
      if (!value || !std::isfinite(*value)) throw expected("no finite number");
      out[count++] = *value;
    }
  }
  if (count < out.size()) throw expected("the numbers end");
}
inline std::string format_rows(std::span<const double> values, std::size_t columns) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    char number[32];
    const auto end = std::to_chars(number, number + sizeof number, values[i] + 0.0);
    text.append(number, end.ptr).push_back((i + 1) % columns == 0 ? '\n' : ' ');
  }
  return text;
}
}  // namespace detail

/// A pose from the text of its 4 × 4 matrix; `name` stands for the file in errors.
///
/// Matrices that were rounded to a few digits are taken: the rotation becomes the nearest true one.
/// Throws `Error` on anything but sixteen finite numbers, on a last row other than 0 0 0 1, and on
/// a rotation whose columns are off by more than half a hundredth or are left-handed.
inline Pose parse_pose(std::string_view text, const std::string& name = "pose") {
  constexpr double kRounded = 5e-3, kExact = 1e-9;
  std::array<double, 16> v{};
  detail::parse_numbers(text, v, name, "a 4 x 4 matrix of finite numbers");
  const Eigen::Matrix4d m =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(v.data());
  const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
  const double off = (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const double last = (m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff();
  require(off <= kRounded && last <= kExact && r.determinant() > 0.0,
          name + ": not rigid; expected a rotation, a translation and the row 0 0 0 1");
  Pose pose = Pose::Identity();
  pose.translation() = m.topRightCorner<3, 1>();
  pose.linear() = r;
  if (off > kExact) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
    pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  }
  return pose;
}
/// The 4 × 4 matrix as text; numbers are the shortest that read back as the same value.
inline std::string format_pose(const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> m = pose.matrix();
  return detail::format_rows({m.data(), 16}, 4);
}

/// Intrinsics from the text of the 3 × 3 camera matrix. Throws `Error` on anything but nine finite
/// numbers that are fx 0 cx, 0 fy cy, 0 0 1 with positive focal lengths.
inline Intrinsics parse_intrinsics(std::string_view text, const std::string& name = "intrinsics") {
  std::array<double, 9> v{};
  detail::parse_numbers(text, v, name, "a 3 x 3 matrix of finite numbers");
  require(v[0] > 0.0 && v[4] > 0.0 && v[1] == 0.0 && v[3] == 0.0 && v[6] == 0.0 && v[7] == 0.0 &&
              v[8] == 1.0,
          name + ": no camera matrix; expected fx 0 cx, 0 fy cy, 0 0 1 with positive fx and fy");
  return {v[0], v[4], v[2], v[5]};
}
inline std::string format_intrinsics(const Intrinsics& k) {
  return detail::format_rows(std::array{k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0}, 3);
}

inline Pose read_pose(const std::filesystem::path& path) {
  return parse_pose(text_of(read_file(path)), path.string());
}
inline Intrinsics read_intrinsics(const std::filesystem::path& path) {
  return parse_intrinsics(text_of(read_file(path)), path.string());
}
}  // namespace surfleet
