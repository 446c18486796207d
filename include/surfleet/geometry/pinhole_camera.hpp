// SPDX-License-Identifier: MIT
/// @file
/// @brief A pinhole depth camera and the image it gives.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// Throws `Error` unless `nearest` and `farthest` bound what `sensor` measures [m].
inline void require_range(double nearest, double farthest, const char* sensor) {
  if (!(nearest >= 0.0 && farthest > nearest && std::isfinite(farthest)))
    throw Error(std::string(sensor) + " range: expected 0 <= minimum < maximum");
}

/// Intrinsics and range of a depth camera without distortion.
///
/// Camera frame: x right, y down, z forward. Pixel (u, v) has its centre at integer coordinates.
/// Ranges are depths along z, as the sensor reports them.
struct PinholeCamera {
  int width = 640;                ///< [px]
  int height = 480;               ///< [px]
  double fx = 525.0, fy = 525.0;  ///< Focal lengths [px].
  double cx = 319.5, cy = 239.5;  ///< Principal point [px].
  double min_range = 0.1;         ///< Nearest depth that is measured [m].
  double max_range = 5.0;         ///< Farthest depth that is measured [m].

  /// A camera with the given full opening angles [rad]. Throws `Error` on angles outside
  /// (0°, 170°], an empty image or an empty range.
  static PinholeCamera from_fov(double horizontal, double vertical, int width, int height,
                                double min_range, double max_range) {
    const auto angle_ok = [](double a) { return a > 0.0 && a <= radians(170.0) + 1e-12; };
    require(angle_ok(horizontal) && angle_ok(vertical),
            "field of view " + std::to_string(degrees(horizontal)) + " x " +
                std::to_string(degrees(vertical)) + " degrees: expected angles in (0, 170]");
    require(width > 0 && height > 0 && width <= 16384 && height <= 16384,
            "camera image: expected 1 to 16384 pixels a side");
    require_range(min_range, max_range, "camera");
    PinholeCamera c;
    c.width = width;
    c.height = height;
    c.fx = 0.5 * width / std::tan(0.5 * horizontal);
    c.fy = 0.5 * height / std::tan(0.5 * vertical);
    c.cx = 0.5 * (width - 1);
    c.cy = 0.5 * (height - 1);
    c.min_range = min_range;
    c.max_range = max_range;
    return c;
  }

  /// The direction of pixel (u, v) in the camera frame, scaled to z = 1.
  Eigen::Vector3d ray(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1.0}; }

  /// The pixel coordinates of a point of the camera frame; nothing if it lies behind the camera
  /// or outside the image (whose edges are half a pixel beyond the outer centres).
  std::optional<Eigen::Vector2d> project(const Point3& p_camera) const {
    if (p_camera.z() <= 0.0) return std::nullopt;
    const Eigen::Vector2d px(fx * p_camera.x() / p_camera.z() + cx,
                             fy * p_camera.y() / p_camera.z() + cy);
    if (px.x() < -0.5 || px.y() < -0.5 || px.x() >= width - 0.5 || px.y() >= height - 0.5)
      return std::nullopt;
    return px;
  }

  double horizontal_fov() const {
    return std::atan((cx + 0.5) / fx) + std::atan((width - 0.5 - cx) / fx);
  }
  double vertical_fov() const {
    return std::atan((cy + 0.5) / fy) + std::atan((height - 0.5 - cy) / fy);
  }
};

/// Depth along the optical axis for every pixel, row by row [m].
///
/// Zero, negative, NaN and infinite values are no measurement. A finite depth beyond the camera's
/// maximum range says that nothing was met up to that range: it may carve free space.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<float> depth;

  DepthImage() = default;
  DepthImage(int w, int h, float value = 0.0F)
      : width(w),
        height(h),
        depth(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}

  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  }
  float operator()(int u, int v) const { return depth[index(u, v)]; }
  float& operator()(int u, int v) { return depth[index(u, v)]; }
  static bool is_measurement(float d) { return d > 0.0F && std::isfinite(d); }
};
}  // namespace surfleet
