// SPDX-License-Identifier: MIT
/// @file
/// @brief The image of a sphere is not centred on the image of its centre: by how much, and
/// observations without that.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/localization/observation.hpp>

namespace surfleet {
/// From the image of a sphere's centre to the centre of its outline's area [px]; nothing where not
/// all of it is in the image. O(1): 24 projections.
template <CameraModel Camera>
std::optional<Eigen::Vector2d> sphere_outline_offset(const Camera& camera, const Point3& center,
                                                     double radius) {
  const double distance = center.norm();
  if (!(distance > radius)) return std::nullopt;
  const auto middle = camera.project(center);
  if (!middle) return std::nullopt;
  const Eigen::Vector3d n = center / distance, u = n.unitOrthogonal(), v = n.cross(u);
  const double sine = radius / distance, cosine = std::sqrt(1.0 - sine * sine);
  constexpr int kCorners = 24;
  double twice = 0.0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero(), before, start;
  for (int i = 0; i <= kCorners; ++i) {
    Eigen::Vector2d corner;
    if (i == kCorners) {
      corner = start;
    } else {
      const double a = 2.0 * kPi * i / kCorners;
      const auto px = camera.project(cosine * n + sine * (std::cos(a) * u + std::sin(a) * v));
      if (!px) return std::nullopt;
      corner = *px - *middle;
    }
    if (i == 0) {
      start = corner;
    } else {
      const double cross = before.x() * corner.y() - before.y() * corner.x();
      twice += cross;
      first += cross * (before + corner);
    }
    before = corner;
  }
  if (twice == 0.0) return std::nullopt;
  return Eigen::Vector2d(first / (3.0 * twice));
}

/// The observations as they would be of the spheres' centres at `points` (target frame), seen from
/// about `T_camera_target`.
template <CameraModel Camera>
std::vector<Observation> without_sphere_offsets(const Camera& camera,
                                                std::span<const Observation> seen,
                                                std::span<const Point3> points,
                                                const Pose& T_camera_target, double radius) {
  std::vector<Observation> out(seen.begin(), seen.end());
  if (radius <= 0.0) return out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i].merged) continue;  // rougher than that
    if (const auto offset = sphere_outline_offset(camera, T_camera_target * points[i], radius))
      out[i] = observe(camera, seen[i].pixel - *offset, seen[i].diameter);
  }
  return out;
}
}  // namespace surfleet
