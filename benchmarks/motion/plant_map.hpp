// SPDX-License-Identifier: MIT
/// @file
/// @brief A plant-like map written down analytically: hall, flues, tanks and gantries.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <surfleet/mapping/voxel_state_map.hpp>

namespace plant_map {
using namespace surfleet;

struct Cylinder {
  Point2 center;
  double radius, top;
};
/// 65 × 42 × 15 m: a hall with door openings, five flues, rows of tanks with narrow passages.
struct Plant {
  std::vector<Box3> boxes;
  std::vector<Cylinder> cylinders;

  Plant() {
    const auto box = [&](double x0, double y0, double z0, double x1, double y1, double z1) {
      boxes.emplace_back(Point3(x0, y0, z0), Point3(x1, y1, z1));
    };
    box(-60, -60, -1, 60, 60, 0);  // ground
    // The hall's walls with openings 5 m wide, a roof with a hole.
    box(-30, -18, 0, -29.4, -3, 12);
    box(-30, 2, 0, -29.4, 18, 12);
    box(-30, -3, 6, -29.4, 2, 12);
    box(-6, -18, 0, -5.4, 6, 12);
    box(-6, 11, 0, -5.4, 18, 12);
    box(-6, 6, 5, -5.4, 11, 12);
    box(-30, 17.4, 0, -5.4, 18, 12);
    box(-30, -18, 0, -5.4, -17.4, 12);
    box(-30, -18, 11.4, -22, 18, 12);
    box(-15, -18, 11.4, -5.4, 18, 12);
    box(-22, -18, 11.4, -15, -4, 12);
    box(-22, -12, 0, -12, -6, 6);
    box(-22, 4, 0, -14, 10, 4.5);
    for (int i = 0; i < 5; ++i) cylinders.push_back({{2.0 + 6.5 * i, 14.0}, 1.6, 15.0});
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k)
        cylinders.push_back({{4.0 + 7.5 * i, -14.0 + 7.2 * k}, 2.1, 7.0 + 1.5 * ((i + k) % 3)});
    for (int k = 0; k < 2; ++k) {  // gantries
      box(0, -10.8 + 7.2 * k, 6.0, 30, -10.0 + 7.2 * k, 6.5);
      box(0, -10.8 + 7.2 * k, 2.5, 30, -10.0 + 7.2 * k, 2.9);
    }
    box(-4, 9.5, 9, 30, 10.3, 9.6);
  }
  /// Signed distance, positive in the open.
  double operator()(const Point3& p) const {
    double d = std::numeric_limits<double>::infinity();
    for (const Box3& b : boxes)
      d = std::min(d, b.contains(p) ? -std::min((p - b.min()).minCoeff(), (b.max() - p).minCoeff())
                                    : b.exteriorDistance(p));
    for (const Cylinder& c : cylinders) {
      const double side = (p.head<2>() - c.center).norm() - c.radius, top = p.z() - c.top;
      d = std::min(d, side <= 0.0 && top <= 0.0
                          ? std::max(side, top)
                          : std::hypot(std::max(side, 0.0), std::max(top, 0.0)));
    }
    return d;
  }
};

/// Writes what is known within `region`: everything but what lies more than 1.5 voxels deep.
inline void observe(TsdfMap& map, const Box3& region, const Plant& plant) {
  const double h = map.voxel_size();
  const BlockIndex lo = TsdfMap::block_of(map.index_of(region.min()));
  const BlockIndex hi = TsdfMap::block_of(map.index_of(region.max()));
  for_each_index(lo, hi, [&](const VoxelIndex& b) {
    const std::uint32_t slot = map.ensure_slot(b);
    auto& block = map.block(slot);
    for (std::size_t o = 0; o < TsdfMap::kBlockVoxels; ++o) {
      const Point3 c = map.center(TsdfMap::index_in(block, o));
      if (!region.contains(c)) continue;
      const double d = plant(c);
      if (d < -1.5 * h) continue;
      block.voxels[o] = {static_cast<float>(std::min(d, 3.0 * h)), 1.0F};
    }
    map.mark_changed(slot);
  });
}
inline Box3 bounds() { return Box3(Point3(-35, -23, 0), Point3(33, 22, 17)); }
}  // namespace plant_map
