// SPDX-License-Identifier: MIT
/// @file
/// @brief A marker as a camera saw it: where in the image, along which ray, and how an error there
/// counts in pixels.
#pragma once

#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/camera_models.hpp>

namespace surfleet {
/// A bearing measured through some lens. What follows needs the lens no more.
///
/// For a point `p` of the camera frame in front of the ray, `to_pixels * p / bearing.dot(p)` is the
/// error of its projection [px] to first order, through any lens.
struct Observation {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< [px]
  Eigen::Vector3d bearing = Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 2, 3> to_pixels = Eigen::Matrix<double, 2, 3>::Zero();
  double diameter = 0.0;   ///< Of the marker's image [px]; 0: unknown.
  bool elongated = false;  ///< Not quite round: perhaps two markers that nearly coincide.
  bool merged = false;     ///< No disc: perhaps two markers, one partly before the other.
};

/// The observation of a marker at a pixel. O(1): five rays.
template <CameraModel Camera>
Observation observe(const Camera& camera, const Eigen::Vector2d& pixel, double diameter = 0.0) {
  constexpr double kStep = 0.5;  // [px]
  Observation o;
  o.pixel = pixel;
  o.diameter = diameter;
  o.bearing = bearing(camera, pixel);
  const Eigen::Vector3d u = o.bearing.unitOrthogonal();
  Eigen::Matrix<double, 2, 3> tangent;
  tangent.row(0) = u;
  tangent.row(1) = o.bearing.cross(u);
  Eigen::Matrix2d slope;
  for (int k = 0; k < 2; ++k) {
    Eigen::Vector2d step = Eigen::Vector2d::Zero();
    step[k] = kStep;
    slope.col(k) =
        tangent * (bearing(camera, pixel + step) - bearing(camera, pixel - step)) / (2.0 * kStep);
  }
  o.to_pixels = slope.inverse() * tangent;
  return o;
}
template <CameraModel Camera>
std::vector<Observation> observe_all(const Camera& camera,
                                     std::span<const Eigen::Vector2d> pixels) {
  std::vector<Observation> all;
  all.reserve(pixels.size());
  for (const Eigen::Vector2d& px : pixels) all.push_back(observe(camera, px));
  return all;
}
}  // namespace surfleet
