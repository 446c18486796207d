// SPDX-License-Identifier: MIT
/// @file
/// @brief What a calibrated camera is, and lenses beyond the pinhole: radial-tangential and
/// equidistant fish-eye.
///
/// Camera frame: x right, y down, z forward. Pixel centres are at whole coordinates, as in
/// `PinholeCamera`, which is a model too.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>

namespace surfleet {
/// A central camera: points of its frame to pixels, and pixels to rays.
///
/// `project(p)` is the pixel of a point of the camera frame, nothing if the image does not show it.
/// `bearing(camera, px)` is the unit vector of the ray through a pixel; where both are defined each
/// undoes the other. `width` and `height` are those of the image [px].
template <typename C>
concept CameraModel = requires(const C& c, const Point3& p) {
  { c.project(p) } -> std::convertible_to<std::optional<Eigen::Vector2d>>;
  { c.width } -> std::convertible_to<int>;
  { c.height } -> std::convertible_to<int>;
};

/// Whether a pixel lies in the image, whose edges are half a pixel beyond the outer centres.
inline bool in_image(const Eigen::Vector2d& px, int width, int height) {
  return px.x() >= -0.5 && px.y() >= -0.5 && px.x() < width - 0.5 && px.y() < height - 0.5;
}

/// A lens with radial distortion k and tangential distortion p (Brown):
/// x_d = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2x²), and y alike.
struct RadialTangentialCamera {
  int width = 640, height = 480;       ///< [px]
  double fx = 525.0, fy = 525.0;       ///< Focal lengths [px].
  double cx = 319.5, cy = 239.5;       ///< Principal point [px].
  std::array<double, 3> radial{};      ///< k1, k2, k3.
  std::array<double, 2> tangential{};  ///< p1, p2.

  /// Nothing beyond the radius at which the distorted radius stops to grow, where the model folds.
  std::optional<Eigen::Vector2d> project(const Point3& p) const {
    if (p.z() <= 0.0) return std::nullopt;
    const Eigen::Vector2d x = p.head<2>() / p.z();
    if (!monotonic_to(x.squaredNorm())) return std::nullopt;
    const Eigen::Vector2d d = distort(x);
    const Eigen::Vector2d px(fx * d.x() + cx, fy * d.y() + cy);
    if (!in_image(px, width, height)) return std::nullopt;
    return px;
  }
  /// By Newton's method on the distortion.
  Eigen::Vector3d bearing(const Eigen::Vector2d& px) const {
    const Eigen::Vector2d wanted((px.x() - cx) / fx, (px.y() - cy) / fy);
    Eigen::Vector2d x = wanted;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d step = jacobian(x).inverse() * (distort(x) - wanted);
      if (!step.allFinite()) break;
      x -= step;
      if (step.squaredNorm() < 1e-28) break;
    }
    return Eigen::Vector3d(x.x(), x.y(), 1.0).normalized();
  }

 private:
  Eigen::Vector2d distort(const Eigen::Vector2d& x) const {
    const double r2 = x.squaredNorm(), xy = 2.0 * x.x() * x.y();
    const double gain = 1.0 + r2 * (radial[0] + r2 * (radial[1] + r2 * radial[2]));
    return gain * x +
           Eigen::Vector2d(tangential[0] * xy + tangential[1] * (r2 + 2 * x.x() * x.x()),
                           tangential[1] * xy + tangential[0] * (r2 + 2 * x.y() * x.y()));
  }
  Eigen::Matrix2d jacobian(const Eigen::Vector2d& x) const {
    const double r2 = x.squaredNorm();
    const double gain = 1.0 + r2 * (radial[0] + r2 * (radial[1] + r2 * radial[2]));
    const double slope = 2.0 * (radial[0] + r2 * (2.0 * radial[1] + r2 * 3.0 * radial[2]));
    Eigen::Matrix2d j = slope * x * x.transpose();
    j.diagonal().array() += gain;
    const double a = 2 * tangential[0], b = 2 * tangential[1];
    j(0, 0) += a * x.y() + 3 * b * x.x();
    j(0, 1) += a * x.x() + b * x.y();
    j(1, 0) += a * x.x() + b * x.y();
    j(1, 1) += b * x.x() + 3 * a * x.y();
    return j;
  }
  bool monotonic_to(double r2) const {
    for (int i = 1; i <= 4; ++i) {
      const double u = 0.25 * i * r2;
      if (!(1.0 + u * (3 * radial[0] + u * (5 * radial[1] + u * 7 * radial[2])) > 0.0))
        return false;
    }
    return true;
  }
};

/// A fish-eye whose image radius grows with the angle θ from the axis:
/// r = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸), to half of a field of view that may pass 180°.
struct EquidistantCamera {
  int width = 752, height = 480;       ///< [px]
  double fx = 226.0, fy = 226.0;       ///< Pixels a radian at the centre.
  double cx = 375.5, cy = 239.5;       ///< Principal point [px].
  double max_angle = radians(95.0);    ///< From the axis [rad].
  std::array<double, 4> distortion{};  ///< k1 … k4; the radius must grow up to `max_angle`.

  /// The lens without distortion that shows the full angle `fov` [rad] over the image's width.
  static EquidistantCamera from_fov(double fov, int width, int height) {
    require(fov > 0.0 && fov < 2.0 * kPi, "fish-eye: expected a field of view in (0, 360) degrees");
    EquidistantCamera c;
    c.width = width;
    c.height = height;
    c.fx = c.fy = width / fov;
    c.cx = 0.5 * (width - 1);
    c.cy = 0.5 * (height - 1);
    c.max_angle = 0.5 * fov;
    return c;
  }

  std::optional<Eigen::Vector2d> project(const Point3& p) const {
    const double side = std::hypot(p.x(), p.y());
    const double angle = std::atan2(side, p.z());
    if (angle > max_angle || (side == 0.0 && p.z() <= 0.0)) return std::nullopt;
    const double scale = side > 0.0 ? radius(angle) / side : 0.0;
    const Eigen::Vector2d px(fx * scale * p.x() + cx, fy * scale * p.y() + cy);
    if (!in_image(px, width, height)) return std::nullopt;
    return px;
  }
  Eigen::Vector3d bearing(const Eigen::Vector2d& px) const {
    const Eigen::Vector2d x((px.x() - cx) / fx, (px.y() - cy) / fy);
    const double wanted = x.norm();
    if (wanted == 0.0) return Eigen::Vector3d::UnitZ();
    double angle = std::min(wanted, max_angle);
    for (int i = 0; i < 20; ++i) {
      const double u = angle * angle;
      const double slope =
          1.0 + u * (3 * distortion[0] +
                     u * (5 * distortion[1] + u * (7 * distortion[2] + u * 9 * distortion[3])));
      const double step = (radius(angle) - wanted) / slope;
      if (!std::isfinite(step)) break;
      angle -= step;
      if (std::abs(step) < 1e-15) break;
    }
    const Eigen::Vector2d side = std::sin(angle) / wanted * x;
    return {side.x(), side.y(), std::cos(angle)};
  }

 private:
  double radius(double angle) const {
    const double u = angle * angle;
    return angle * (1.0 + u * (distortion[0] +
                               u * (distortion[1] + u * (distortion[2] + u * distortion[3]))));
  }
};

/// The unit vector through a pixel, in the camera frame.
template <typename C>
Eigen::Vector3d bearing(const C& camera, const Eigen::Vector2d& px) {
  return camera.bearing(px);
}
inline Eigen::Vector3d bearing(const PinholeCamera& camera, const Eigen::Vector2d& px) {
  return camera.ray(px.x(), px.y()).normalized();
}

/// A camera whose lens is chosen while the program runs.
struct AnyCamera {
  using Lens = std::variant<PinholeCamera, RadialTangentialCamera, EquidistantCamera>;

  template <typename C>
  requires(!std::same_as<std::remove_cvref_t<C>, AnyCamera>) AnyCamera(
      C camera)  // NOLINT(google-explicit-constructor): any of the lenses is such a camera
      : width(camera.width), height(camera.height), lens(std::move(camera)) {}

  int width, height;  ///< [px]
  Lens lens;

  std::optional<Eigen::Vector2d> project(const Point3& p) const {
    return std::visit([&](const auto& c) { return c.project(p); }, lens);
  }
  Eigen::Vector3d bearing(const Eigen::Vector2d& px) const {
    return std::visit([&](const auto& c) { return surfleet::bearing(c, px); }, lens);
  }
};

static_assert(CameraModel<PinholeCamera> && CameraModel<RadialTangentialCamera>);
static_assert(CameraModel<EquidistantCamera> && CameraModel<AnyCamera>);
}  // namespace surfleet
