// SPDX-License-Identifier: MIT
/// @file
/// @brief The voxels a straight segment passes through.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
/// Calls `visit(VoxelIndex)` for every voxel on the segment from `from` to `to` [m], in order,
/// both ends' voxels included, until `visit` returns false. True if the end was reached.
///
/// A `visit` that returns an `int` names the aligned cube around the voxel, by its side in voxels
/// (a power of two), the rest of which need not be visited: 1 is the voxel alone. 0 ends the walk.
///
/// Amanatides and Woo (1987): steps from face to face, O(voxels and cubes visited), never skips a
/// voxel the segment's interior crosses. At an exact edge or corner the lower axis is stepped
/// first.
template <typename Visit>
bool traverse_voxels(const Point3& from, const Point3& to, double voxel_size, Visit&& visit) {
  constexpr bool kCubes = !std::same_as<std::invoke_result_t<Visit&, VoxelIndex>, bool>;
  static constexpr double kNever = std::numeric_limits<double>::infinity();
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
    t_next[i] = moves ? (edge - a[i]) / d[i] : kNever;
  }
  // A variable for each axis, in registers: what is stored by axis and read as a vector at once
  // stalls the processor at every voxel.
  int x = v.x(), y = v.y(), z = v.z();
  int x_left = steps.x(), y_left = steps.y(), z_left = steps.z();
  double t_x = t_next.x(), t_y = t_next.y(), t_z = t_next.z();
  const auto advance = [](int& at, int by, double& t, double delta, int& left_here) {
    at += by;
    t = --left_here == 0 ? kNever : t + delta;
  };
  // Steps along an axis until a cube is left, and when the last of them is. Times are summed up as
  // they are for single voxels, so that cubes are left where a walk by voxels leaves them.
  const auto out_of = [](int side, int at, int by) {
    const int inside = at & (side - 1);
    return by > 0 ? side - inside : inside + 1;
  };
  const auto leaves = [](int out, double t, double delta, int left_here) {
    if (out > left_here) return kNever;
    for (int k = 1; k < out; ++k) t += delta;
    return t;
  };
  // Takes the steps along an axis before `end`, and one at `end` if it is `first`.
  const auto skip = [&left](double end, bool first, int& at, int by, double& t, double delta,
                            int& left_here) {
    int count = 0;
    for (; t < end || (first && t == end); ++count) t = --left_here == 0 ? kNever : t + delta;
    at += by * count;
    left -= count;
  };
  for (;;) {
    const auto answer = visit(VoxelIndex(x, y, z));
    if (!answer) return false;
    if (left == 0) return true;
    if constexpr (kCubes) {
      if (answer > 1) {
        const int x_out = out_of(answer, x, step.x()), y_out = out_of(answer, y, step.y()),
                  z_out = out_of(answer, z, step.z());
        const double x_end = leaves(x_out, t_x, t_delta.x(), x_left),
                     y_end = leaves(y_out, t_y, t_delta.y(), y_left),
                     z_end = leaves(z_out, t_z, t_delta.z(), z_left);
        const double end = std::min({x_end, y_end, z_end});
        if (end == kNever) return true;
        const bool by_z = z_end < std::min(x_end, y_end), by_x = !by_z && x_end <= y_end;
        skip(end, true, x, step.x(), t_x, t_delta.x(), x_left);
        skip(end, !by_x, y, step.y(), t_y, t_delta.y(), y_left);
        skip(end, by_z, z, step.z(), t_z, t_delta.z(), z_left);
        continue;
      }
    }
    --left;
    if (t_z < (t_x <= t_y ? t_x : t_y))
      advance(z, step.z(), t_z, t_delta.z(), z_left);
    else if (t_x <= t_y)
      advance(x, step.x(), t_x, t_delta.x(), x_left);
    else
      advance(y, step.y(), t_y, t_delta.y(), y_left);
  }
}
}  // namespace surfleet
