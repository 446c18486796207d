// SPDX-License-Identifier: MIT
/// @file
/// @brief Maps for the tests of the motion room, written down rather than observed.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <surfleet/mapping/voxel_state_map.hpp>

namespace motion_scenes {
using namespace surfleet;

/// Signed distance to the nearest of some boxes, positive outside.
struct Boxes {
  std::vector<Box3> boxes;
  double operator()(const Point3& p) const {
    double d = std::numeric_limits<double>::infinity();
    for (const Box3& b : boxes) {
      if (b.contains(p))
        d = std::min(d, -std::min((p - b.min()).minCoeff(), (b.max() - p).minCoeff()));
      else
        d = std::min(d, b.exteriorDistance(p));
    }
    return std::min(d, 1e3);
  }
};
inline Box3 box(double x0, double y0, double z0, double x1, double y1, double z1) {
  return Box3(Point3(x0, y0, z0), Point3(x1, y1, z1));
}

/// Writes the field into every voxel whose centre lies in `known`.
template <typename Field>
void observe(TsdfMap& map, const Box3& known, const Field& field) {
  const VoxelIndex lo = map.index_of(known.min()), hi = map.index_of(known.max());
  std::vector<std::uint32_t> touched;
  for_each_index(lo, hi, [&](const VoxelIndex& v) {
    const Point3 c = map.center(v);
    if (!known.contains(c)) return;
    const std::uint32_t slot = map.ensure_slot(TsdfMap::block_of(v));
    map.block(slot).voxels[TsdfMap::offset_of(v)] = {static_cast<float>(field(c)), 1.0F};
    touched.push_back(slot);
  });
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const std::uint32_t slot : touched) map.mark_changed(slot);
}
}  // namespace motion_scenes
