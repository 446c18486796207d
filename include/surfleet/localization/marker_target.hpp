// SPDX-License-Identifier: MIT
/// @file
/// @brief A rigid target of like markers: the printed one, files of targets, and what is wrong with
/// a target [004 §9.3].
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/text_scanner.hpp>

namespace surfleet {
/// Spherical markers of one size, in the target's own frame.
struct MarkerTarget {
  std::vector<Point3> markers;  ///< Centres [m].
  double marker_radius = 0.0;   ///< [m]; 0: a point.

  /// Radius about the origin of all centres [m].
  double reach() const {
    double r = 0.0;
    for (const Point3& p : markers) r = std::max(r, p.norm());
    return r;
  }
};

/// The published target of four markers, 3 cm in diameter; at `scale` 0.5 the one of the small
/// robots, 1.5 cm [004 §9.3.2].
inline MarkerTarget printed_target(double scale = 1.0) {
  MarkerTarget t{{{0.0, -0.1651, 0.2366},
                  {0.0, 0.1304, 0.1845},
                  {0.0626, -0.0221, 0.0539},
                  {-0.0802, 0.0249, 0.0621}},
                 0.015 * scale};
  for (Point3& p : t.markers) p *= scale;
  return t;
}

/// Tolerances of `check_target`, as parts of the target's largest distance.
struct TargetCheckOptions {
  double alike = 0.02;  ///< Distances that differ less are confused.
  double flat = 0.02;   ///< Markers within this of a line or plane lie on it.
};

namespace detail {
/// Spread of the points about their mean along their principal axes, largest first [m].
inline Eigen::Vector3d principal_spreads(const std::vector<Point3>& points) {
  Point3 mean = Point3::Zero();
  for (const Point3& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
  for (const Point3& p : points) s += (p - mean) * (p - mean).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(s / static_cast<double>(points.size()),
                                                       Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().reverse();
}

/// Looks for relabellings that a rotation undoes, marker by marker.
class SymmetrySearch {
 public:
  SymmetrySearch(const std::vector<Point3>& points, double tolerance, bool flat)
      : points_(points), tolerance_(tolerance), flat_(flat), image_(points.size()) {}

  /// A permutation other than the identity; empty if there is none.
  std::vector<std::size_t> find() {
    found_.clear();
    used_.assign(points_.size(), false);
    extend(0);
    return found_;
  }

 private:
  void extend(std::size_t i) {
    if (!found_.empty()) return;
    if (i == points_.size()) {
      bool identity = true;
      for (std::size_t k = 0; k < i; ++k) identity = identity && image_[k] == k;
      if (!identity && (flat_ || keeps_side())) found_ = image_;
      return;
    }
    for (std::size_t j = 0; j < points_.size(); ++j) {
      if (used_[j]) continue;
      bool fits = true;
      for (std::size_t k = 0; k < i && fits; ++k)
        fits = std::abs((points_[i] - points_[k]).norm() -
                        (points_[j] - points_[image_[k]]).norm()) <= tolerance_;
      if (!fits) continue;
      used_[j] = true;
      image_[i] = j;
      extend(i + 1);
      used_[j] = false;
    }
  }
  /// False for a mirror image, which no rotation reaches: the largest tetrahedron changes its side.
  bool keeps_side() const {
    double largest = 0.0, its_image = 0.0;
    const auto volume = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
      return (points_[b] - points_[a]).cross(points_[c] - points_[a]).dot(points_[d] - points_[a]);
    };
    for (std::size_t a = 0; a < points_.size(); ++a)
      for (std::size_t b = a + 1; b < points_.size(); ++b)
        for (std::size_t c = b + 1; c < points_.size(); ++c)
          for (std::size_t d = c + 1; d < points_.size(); ++d)
            if (const double v = volume(a, b, c, d); std::abs(v) > std::abs(largest)) {
              largest = v;
              its_image = volume(image_[a], image_[b], image_[c], image_[d]);
            }
    return largest * its_image > 0.0;
  }

  const std::vector<Point3>& points_;
  double tolerance_;
  bool flat_;
  std::vector<std::size_t> image_, found_;
  std::vector<bool> used_;
};
}  // namespace detail

/// Throws `Error` on a target from which no pose follows: fewer than four markers or more than 32,
/// coinciding or collinear ones. The answer is what it can be used with all the same: coplanar
/// markers, and a pair that is confused because a rotation takes the target to itself.
inline std::vector<std::string> check_target(const MarkerTarget& target,
                                             const TargetCheckOptions& options = {}) {
  const auto& points = target.markers;
  require(points.size() >= 4 && points.size() <= 32,
          "target: " + std::to_string(points.size()) + " markers; expected 4 to 32");
  require(target.marker_radius >= 0.0 && std::isfinite(target.marker_radius),
          "target: marker radius: expected 0 or more metres");
  for (std::size_t i = 0; i < points.size(); ++i)
    require(points[i].allFinite() && points[i].norm() < 1e4,
            "target: marker " + std::to_string(i) + ": expected coordinates within 10 km");
  double size = 0.0;
  for (const Point3& a : points)
    for (const Point3& b : points) size = std::max(size, (a - b).norm());
  const double apart = std::max(2.0 * target.marker_radius, options.flat * size);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = i + 1; k < points.size(); ++k)
      require((points[i] - points[k]).norm() > apart,
              "target: markers " + std::to_string(i) + " and " + std::to_string(k) +
                  " coincide; expected markers that do not touch");
  const Eigen::Vector3d spread = detail::principal_spreads(points);
  require(spread[1] > options.flat * size,
          "target: its markers lie on a line; expected at least three that do not");
  const bool flat = spread[2] <= options.flat * size;
  std::vector<std::string> warnings;
  if (flat) warnings.emplace_back("the markers lie in a plane: seen face on, two poses look alike");
  const auto image = detail::SymmetrySearch(points, options.alike * size, flat).find();
  for (std::size_t i = 0; i < image.size(); ++i)
    if (image[i] != i) {
      warnings.push_back("markers " + std::to_string(i) + " and " + std::to_string(image[i]) +
                         " can be confused: a rotation takes the target to itself");
      break;
    }
  return warnings;
}

/// A target from text: a line `x y z` [m] for each marker, and perhaps `radius r` [m]. Blank lines
/// and what follows `#` are passed over. Throws `Error` on anything else, and as `check_target`.
inline MarkerTarget parse_target(std::string_view text, const std::string& name = "target") {
  MarkerTarget target;
  TextScanner lines(text);
  while (const auto whole = lines.next_line()) {
    const std::string_view line = whole->substr(0, whole->find('#'));
    TextScanner words(line);
    std::vector<double> numbers;
    bool radius = false;
    while (const auto word = words.next_word()) {
      if (numbers.empty() && !radius && *word == "radius") {
        radius = true;
        continue;
      }
      const auto value = parse_number<double>(*word);
      require(value && std::isfinite(*value), name + ": line " + std::to_string(lines.line()) +
                                                  ": no finite number; expected " +
                                                  "'x y z' or 'radius r' in metres");
      numbers.push_back(*value);
    }
    if (numbers.empty() && !radius) continue;
    require(numbers.size() == (radius ? 1U : 3U),
            name + ": line " + std::to_string(lines.line()) + ": expected 'x y z' or 'radius r'");
    if (radius)
      target.marker_radius = numbers[0];
    else
      target.markers.emplace_back(numbers[0], numbers[1], numbers[2]);
    require(target.markers.size() <= 32, name + ": expected 4 to 32 markers");
  }
  try {
    check_target(target);
  } catch (const Error& e) {
    throw Error(name + ": " + e.what());
  }
  return target;
}
inline MarkerTarget read_target(const std::filesystem::path& path) {
  return parse_target(text_of(read_file(path)), path.string());
}
}  // namespace surfleet
