// SPDX-License-Identifier: MIT
/// @file
/// @brief The voxels a straight segment passes through.
#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>

#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
/// Calls `visit(VoxelIndex)` for every voxel on the segment from `from` to `to` [m], in order,
/// both ends' voxels included, until `visit` returns false. True if the end was reached.
///
/// Amanatides and Woo (1987): steps from face to face, O(voxels passed), never skips a voxel the
/// segment's interior crosses. At an exact edge or corner the lower axis is stepped first.
template <typename Visit>
bool traverse_voxels(const Point3& from, const Point3& to, double voxel_size, Visit&& visit) {
  const Eigen::Vector3d a = from / voxel_size, b = to / voxel_size, d = b - a;
  VoxelIndex v, step, steps;
  Eigen::Vector3d t_next, t_delta;
  int left = 0;
  for (int i = 0; i < 3; ++i) {
    v[i] = static_cast<int>(std::floor(a[i]));
    const int last = static_cast<int>(std::floor(b[i]));
    steps[i] = std::abs(last - v[i]);
    left += steps[i];
    step[i] = last > v[i] ? 1 : -1;
    const double edge = step[i] > 0 ? v[i] + 1.0 : static_cast<double>(v[i]);
    const bool moves = last != v[i];
    t_delta[i] = moves ? std::abs(1.0 / d[i]) : 0.0;
    t_next[i] = moves ? (edge - a[i]) / d[i] : std::numeric_limits<double>::infinity();
  }
  // A variable for each axis, in registers: what is stored by axis and read as a vector at once
  // stalls the processor at every voxel.
  int x = v.x(), y = v.y(), z = v.z();
  int x_left = steps.x(), y_left = steps.y(), z_left = steps.z();
  double t_x = t_next.x(), t_y = t_next.y(), t_z = t_next.z();
  const auto advance = [](int& at, int by, double& t, double delta, int& left_here) {
    at += by;
    t = --left_here == 0 ? std::numeric_limits<double>::infinity() : t + delta;
  };
  for (;;) {
    if (!visit(VoxelIndex(x, y, z))) return false;
    if (left-- == 0) return true;
    if (t_z < (t_x <= t_y ? t_x : t_y))
      advance(z, step.z(), t_z, t_delta.z(), z_left);
    else if (t_x <= t_y)
      advance(x, step.x(), t_x, t_delta.x(), x_left);
    else
      advance(y, step.y(), t_y, t_delta.y(), y_left);
  }
}
}  // namespace surfleet
