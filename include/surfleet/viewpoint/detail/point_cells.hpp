// SPDX-License-Identifier: MIT
/// @file
/// @brief Points in cubic cells, for neighbours within about a cell's edge.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet::detail {
/// Numbers kept by position. A query visits O((radius / edge + 1)³) cells.
class PointCells {
 public:
  explicit PointCells(double edge) : cells_({.voxel_size = edge}) {}

  void insert(const Point3& p, std::int32_t id) {
    cells_.ensure(cells_.index_of(p)).emplace_back(p, id);
  }
  /// Calls `fn(id, squared distance)` for all within `radius` of `p`, in an order that depends on
  /// the order of insertion only.
  template <typename Fn>
  void for_each_within(const Point3& p, double radius, Fn&& fn) const {
    const VoxelIndex low = cells_.index_of(p - Eigen::Vector3d::Constant(radius));
    const VoxelIndex high = cells_.index_of(p + Eigen::Vector3d::Constant(radius));
    for_each_index(low, high, [&](const VoxelIndex& v) {
      const auto* cell = cells_.find(v);
      if (cell == nullptr) return;
      for (const auto& [q, id] : *cell) {
        const double d2 = (q - p).squaredNorm();
        if (d2 <= radius * radius) fn(id, d2);
      }
    });
  }

 private:
  VoxelGrid<std::vector<std::pair<Point3, std::int32_t>>, 1> cells_;
};
}  // namespace surfleet::detail
