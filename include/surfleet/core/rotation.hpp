// SPDX-License-Identifier: MIT
/// @file
/// @brief The shortest rotation from one direction to another.
#pragma once

#include <cmath>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// Turns the direction of `a` into that of `b`, about an axis normal to both; about one of the axes
/// normal to `a` where they are opposite. Neither may be zero.
///
/// Eigen's own solves a singular value problem for the last case, whose templates would take most
/// of the time to compile whatever includes this.
inline Eigen::Quaterniond rotation_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d from = a.normalized(), to = b.normalized();
  const double cosine = to.dot(from);
  if (cosine < -1.0 + 1e-12) {
    const Eigen::Vector3d axis = from.unitOrthogonal().cross(from);
    return {0.0, axis.x(), axis.y(), axis.z()};
  }
  const double twice = std::sqrt((1.0 + cosine) * 2.0);  // the cosine of half the angle
  const Eigen::Vector3d axis = from.cross(to) * (1.0 / twice);
  return {0.5 * twice, axis.x(), axis.y(), axis.z()};
}
}  // namespace surfleet
