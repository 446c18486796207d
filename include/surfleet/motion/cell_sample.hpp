// SPDX-License-Identifier: MIT
/// @file
/// @brief Samples of a cube of space, for roadmaps that are even and miss no narrow place.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <surfleet/core/random.hpp>
#include <surfleet/motion/free_space.hpp>

namespace surfleet {
namespace detail {
inline Random cell_random(const VoxelIndex& c, std::uint64_t seed) {
  for (int i = 0; i < 3; ++i) seed = mix64(seed ^ static_cast<std::uint32_t>(c[i]));
  return Random(seed);
}
}  // namespace detail

/// A place where the body fits in the cube `c` of edge `spacing` [m]: the first free of a few
/// jittered tries, else the roomiest free voxel; nothing if there is none. The same for the same
/// seed, cube and free space. O(voxels of the cube).
inline std::optional<Point3> cell_sample(const FreeSpace& space, const VoxelIndex& c,
                                         double spacing, std::uint64_t seed) {
  Random random = detail::cell_random(c, seed);
  const double s = spacing;
  const Point3 corner = c.cast<double>() * s;
  for (int attempt = 0; attempt < 4; ++attempt) {
    // The middle half of the cell: nearly even spacing, no lattice directions.
    // One draw a statement: the order in an argument list is the compiler's choice.
    const double z = random.uniform(0.25, 0.75);
    const double y = random.uniform(0.25, 0.75);
    const double x = random.uniform(0.25, 0.75);
    const Point3 p = corner + s * Point3(x, y, z);
    if (space.is_free(p)) return p;
  }
  const auto& grid = space.grid();
  const VoxelIndex lo = grid.index_of(corner), hi = grid.index_of(corner + Point3::Constant(s));
  std::optional<Point3> best;
  std::size_t room = 0;
  using Grid = FreeSpace::Grid;
  for_each_index(Grid::block_of(lo), Grid::block_of(hi), [&](const BlockIndex& b) {
    const std::uint32_t slot = grid.find_slot(b);
    if (slot == Grid::kNone) return;
    const auto& bits = space.free_bits(slot);
    for (std::size_t w = 0; w < bits.size(); ++w)
      for (std::uint64_t left = bits[w]; left != 0; left &= left - 1) {
        const std::size_t o = w * 64 + static_cast<std::size_t>(std::countr_zero(left));
        const auto d = static_cast<std::size_t>(grid.block(slot).voxels[o]);
        if (d <= room) continue;
        const Point3 p = grid.center(Grid::index_in(grid.block(slot), o));
        if (((p * (1.0 / s)).array().floor().cast<int>() != c.array()).any()) continue;
        room = d;
        best = p;
      }
  });
  return best;
}

/// The `k`-th of a sequence of places that fills the cube evenly (Halton's, of bases 2, 3 and 5,
/// shifted at random); nothing if the body does not fit there. O(log k).
inline std::optional<Point3> further_sample(const FreeSpace& space, const VoxelIndex& c,
                                            double spacing, std::uint64_t seed, std::uint64_t k) {
  Random random = detail::cell_random(c, mix64(seed));
  Eigen::Vector3d at;
  constexpr std::array<std::uint64_t, 3> kBases{2, 3, 5};
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t base = kBases[static_cast<std::size_t>(i)];
    double digit = 1.0;
    at[i] = random.uniform();
    for (std::uint64_t left = k; left != 0; left /= base)
      at[i] += static_cast<double>(left % base) * (digit /= static_cast<double>(base));
    at[i] -= std::floor(at[i]);
  }
  const Point3 p = spacing * (c.cast<double>() + at);
  return space.is_free(p) ? std::optional(p) : std::nullopt;
}

/// Whether the body fits at the centre of every voxel whose centre lies in the cube `c`. O(those).
inline bool is_open_cell(const FreeSpace& space, const VoxelIndex& c, double spacing) {
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * space.voxel_size());
  const VoxelIndex lo = space.grid().index_of(spacing * c.cast<double>() + half);
  const VoxelIndex hi =
      space.grid().index_of(spacing * (c + VoxelIndex::Ones()).cast<double>() - half);
  for (int z = lo.z(); z <= hi.z(); ++z)
    for (int y = lo.y(); y <= hi.y(); ++y)
      for (int x = lo.x(); x <= hi.x(); ++x)
        if (!space.is_free_voxel({x, y, z})) return false;
  return true;
}
}  // namespace surfleet
