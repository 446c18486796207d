// SPDX-License-Identifier: MIT
/// @file
/// @brief Where a picture is taken from, and views that hold all of some points.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// Where a picture is taken from.
struct RenderView {
  Point3 eye{10.0, 0.0, 5.0};
  Point3 target = Point3::Zero();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double vertical_fov = radians(35.0);  ///< Perspective; ignored when orthographic.
  double orthographic_height = 0.0;     ///< Height of the view [m]; positive: orthographic.
  int width = 1280, height = 800;       ///< [px]
};

/// The tightest view of all `points` from the direction with the given azimuth (about +z from +x)
/// and elevation [rad], with a margin of 4 %; `orthographic` for plans and elevations. O(points).
inline RenderView frame_points(std::span<const Point3> points, double azimuth, double elevation,
                               int width, int height, bool orthographic = false) {
  RenderView view;
  view.width = width;
  view.height = height;
  if (points.empty()) return view;
  const Eigen::Vector3d back(std::cos(azimuth) * std::cos(elevation),
                             std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
  const Eigen::Vector3d right(-std::sin(azimuth), std::cos(azimuth), 0.0);
  const Eigen::Vector3d up = back.cross(right);
  view.up = up;
  constexpr double kMargin = 1.04;
  const double tangent_y = std::tan(0.5 * view.vertical_fov) / kMargin;
  const double tangent_x = tangent_y * width / height;
  // Each side of the view is a plane of known slope that all points lie behind. In the units
  // below (u: right or up over its tangent, w: towards the eye) the two planes of a pair are
  // w = eye.w - |u - eye.u|, so the eye stands where those through the extremes meet.
  struct Pair {
    double high = -1e300, low = -1e300;
    void add(double u, double w) {
      high = std::max(high, w + u);
      low = std::max(low, w - u);
    }
    double along() const { return 0.5 * (high - low); }
    double back() const { return 0.5 * (high + low); }
  };
  const double flat = orthographic ? 0.0 : 1.0;
  Pair horizontal, vertical;
  double nearest = -1e300, farthest = 1e300;
  for (const Point3& p : points) {
    const double w = p.dot(back);
    nearest = std::max(nearest, w);
    farthest = std::min(farthest, w);
    horizontal.add(p.dot(right) / tangent_x, flat * w);
    vertical.add(p.dot(up) / tangent_y, flat * w);
  }
  const double depth = std::max(nearest - farthest, 1e-3);
  double eye_back = std::max(horizontal.back(), vertical.back());
  if (orthographic) {
    view.orthographic_height = std::max(2.0 * tangent_y * eye_back * kMargin, 1e-6);
    eye_back = nearest + depth;
  }
  eye_back = std::max(eye_back, nearest + 1e-3 * depth);
  view.eye =
      horizontal.along() * tangent_x * right + vertical.along() * tangent_y * up + eye_back * back;
  view.target = view.eye - (eye_back - 0.5 * (nearest + farthest)) * back;
  return view;
}

/// The same for the corners of `box`.
inline RenderView frame_box(const Box3& box, double azimuth, double elevation, int width,
                            int height, bool orthographic = false) {
  std::vector<Point3> corners;
  for (int k = 0; k < 8 && !box.isEmpty(); ++k)
    corners.push_back(box.corner(static_cast<Box3::CornerType>(k)));
  return frame_points(corners, azimuth, elevation, width, height, orthographic);
}
}  // namespace surfleet
