// SPDX-License-Identifier: MIT
/// @file
/// @brief Paths along the lattice of a free space's voxels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/geometry/graph.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/reachable_set.hpp>

namespace surfleet {
/// The free voxels as a graph with face neighbours; node = slot · 512 + offset.
struct FreeVoxelGraph {
  struct Arcs {
    std::array<Arc, 6> list;
    std::size_t count = 0;
    const Arc* begin() const { return list.data(); }
    const Arc* end() const { return list.data() + count; }
  };
  const FreeSpace* space;

  std::size_t size() const { return space->grid().block_count() * FreeSpace::Grid::kBlockVoxels; }
  VoxelIndex voxel(std::int32_t node) const {
    constexpr auto n = static_cast<std::int32_t>(FreeSpace::Grid::kBlockVoxels);
    const auto& block = space->grid().block(static_cast<std::uint32_t>(node / n));
    return FreeSpace::Grid::index_in(block, static_cast<std::size_t>(node % n));
  }
  std::int32_t node(const VoxelIndex& v) const {
    const std::uint32_t slot = space->grid().find_slot(FreeSpace::Grid::block_of(v));
    return static_cast<std::int32_t>(slot * FreeSpace::Grid::kBlockVoxels +
                                     FreeSpace::Grid::offset_of(v));
  }
  Arcs arcs(std::int32_t from) const {
    Arcs a;
    const VoxelIndex v = voxel(from);
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        VoxelIndex w = v;
        w[axis] += step;
        const std::uint32_t slot = space->grid().find_slot(FreeSpace::Grid::block_of(w));
        if (slot == FreeSpace::Grid::kNone ||
            !space->is_free_in(slot, FreeSpace::Grid::offset_of(w)))
          continue;
        a.list[a.count++] = {node(w), space->voxel_size()};
      }
    return a;
  }
};
/// A path along the voxel lattice from `a` to `b`, by the free voxels they are anchored to; empty
/// if there is none. O(voxels · log voxels).
inline std::vector<Point3> lattice_path(const ReachableSet& reachable, const Point3& a,
                                        const Point3& b) {
  const FreeSpace& space = reachable.space();
  const auto from = reachable.anchor(a), to = reachable.anchor(b);
  if (!from || !to) return {};
  const FreeVoxelGraph lattice{&space};
  const std::int32_t goal = lattice.node(*to);
  const Source source{lattice.node(*from), 0.0};
  const auto manhattan = [&](std::int32_t node) {
    return (lattice.voxel(node) - *to).cwiseAbs().sum() * space.voxel_size();
  };
  const auto tree = shortest_paths(lattice, std::span<const Source>(&source, 1), manhattan,
                                   [&](std::int32_t node, double) { return node == goal; });
  std::vector<Point3> points;
  if (!tree.reached(goal)) return points;
  points.push_back(a);
  for (const std::int32_t node : tree.path(goal))
    points.push_back(space.grid().center(lattice.voxel(node)));
  points.push_back(b);
  return points;
}
}  // namespace surfleet
