// SPDX-License-Identifier: MIT
/// @file
/// @brief The surface of a TSDF map as a triangle mesh, kept up to date block by block.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/mapping/marching_cubes.hpp>
#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet {
struct MeshOptions {
  double min_weight = 1e-4;  ///< Voxels with less weight are unknown: no surface ends at them.
  /// A cube whose distances change by more than this many voxel sizes along an edge that the
  /// surface crosses shows none: it lies between free space and the hidden side of something, not
  /// on it.
  double max_step = std::numeric_limits<double>::infinity();
  bool normals = true;  ///< Area-weighted vertex normals.
  int threads = 1;      ///< The result is the same for any number.
};

/// Marching cubes over the cubes between voxel centres, with the vertices of each block remembered.
///
/// `update` re-meshes the blocks that changed and those below them that share cubes with them:
/// O(changed blocks). `mesh` joins the parts: O(triangles), every vertex once, no cracks between
/// blocks. Triangles are anticlockwise seen from the side of positive distance. A field whose zero
/// set is closed within the known voxels gives a closed, oriented 2-manifold: every edge belongs
/// to exactly two triangles, in opposite directions. Unknown voxels behind known solid ones leave
/// no gaps. Vertices keep 1/1000 of an edge away from voxel centres, so that no triangle collapses.
class MeshExtractor {
 public:
  explicit MeshExtractor(MeshOptions options = {}) : options_(options) {}

  /// Brings the parts up to date with `map`, always the same map. Returns the number of blocks
  /// that were meshed anew.
  std::size_t update(const TsdfMap& map) {
    const std::size_t known = parts_.size();
    parts_.resize(map.block_count());
    voxel_size_ = map.voxel_size();
    std::vector<std::uint32_t> dirty = map.changed_since(cursor_);
    for (std::size_t s = known; s < parts_.size(); ++s)
      dirty.push_back(static_cast<std::uint32_t>(s));
    std::vector<std::uint8_t> queued(parts_.size(), 0);
    std::vector<std::uint32_t> slots;
    for (const std::uint32_t slot : dirty)
      for (int n = 0; n < 8; ++n) {
        const std::uint32_t s = map.find_slot(map.block(slot).index - offset(n));
        if (s == TsdfMap::kNone || queued[s] != 0) continue;
        queued[s] = 1;
        slots.push_back(s);
      }
    parallel_for(
        slots.size(), options_.threads,
        [&](std::size_t i) { mesh_block(map, slots[i], parts_[slots[i]]); }, 16);
    cursor_ = map.revision();
    return slots.size();
  }

  /// The welded mesh of everything seen so far.
  TriangleMesh mesh() const {
    std::vector<std::int32_t> base(parts_.size() + 1, 0);
    std::size_t triangle_count = 0;
    for (std::size_t s = 0; s < parts_.size(); ++s) {
      base[s + 1] = base[s] + static_cast<std::int32_t>(parts_[s].vertices.size());
      triangle_count += parts_[s].corners.size();
    }
    TriangleMesh mesh;
    mesh.triangles.reserve(triangle_count);
    // Crossings beside unknown voxels belong to no cube: keep what the triangles use.
    std::vector<std::int32_t> place(static_cast<std::size_t>(base.back()), -1);
    for (std::size_t s = 0; s < parts_.size(); ++s)
      for (const auto& corners : parts_[s].corners) {
        Triangle t;
        bool whole = true;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t owner = corners[k] < kKeys ? static_cast<std::uint32_t>(s)
                                                         : parts_[s].neighbours[corners[k] / kKeys];
          const std::int32_t local =
              owner < parts_.size() ? parts_[owner].rank(corners[k] % kKeys) : -1;
          whole = whole && local >= 0;
          t[k] = whole ? base[owner] + local : -1;
        }
        if (!whole) continue;
        for (const std::int32_t v : t) place[static_cast<std::size_t>(v)] = 0;
        mesh.triangles.push_back(t);
      }
    std::int32_t used = 0;
    for (std::int32_t& p : place) p = p < 0 ? -1 : used++;
    mesh.vertices.reserve(static_cast<std::size_t>(used));
    std::size_t i = 0;
    for (const Part& part : parts_)
      for (const Point3& v : part.vertices)
        if (place[i++] >= 0) mesh.vertices.push_back(v);
    for (Triangle& t : mesh.triangles)
      for (std::int32_t& v : t) v = place[static_cast<std::size_t>(v)];
    if (options_.normals) mesh.normals = vertex_normals(mesh);
    return mesh;
  }

  const MeshOptions& options() const { return options_; }

 private:
  static constexpr int kSide = TsdfMap::kBlockSide;
  static constexpr int kRow = kSide + 1;
  /// Crossings of a block: axis · voxels + offset of the edge's lower voxel.
  static constexpr std::uint16_t kKeys = static_cast<std::uint16_t>(3 * TsdfMap::kBlockVoxels);
  static constexpr std::size_t kWords = kKeys / 64;

  struct Part {
    std::array<std::uint64_t, kWords> crossed{};  ///< One bit a key.
    std::array<std::uint16_t, kWords> before{};   ///< Crossings in the words before.
    std::vector<Point3> vertices;                 ///< In the order of their keys.
    /// Keys, plus `kKeys` times the number of the upper neighbour they belong to.
    std::vector<std::array<std::uint16_t, 3>> corners;
    std::array<std::uint32_t, 8> neighbours{};

    std::int32_t rank(std::uint16_t key) const {
      const std::size_t word = key / 64;
      const std::uint64_t bit = std::uint64_t{1} << (key % 64);
      if ((crossed[word] & bit) == 0) return -1;
      return before[word] + std::popcount(crossed[word] & (bit - 1));
    }
  };
  /// The voxels of a block and the first layer of its upper neighbours.
  struct Window {
    std::array<float, static_cast<std::size_t>(kRow* kRow* kRow)> distance;
    std::array<std::uint16_t, static_cast<std::size_t>(kRow*kRow)> solid, known;  ///< x by bits.
  };

  static BlockIndex offset(int n) { return {n & 1, n >> 1 & 1, n >> 2}; }
  static std::size_t row(int y, int z) { return static_cast<std::size_t>(z * kRow + y); }

  /// False if the window holds no crossing.
  bool load(const TsdfMap& map, const std::array<std::uint32_t, 8>& slots, Window& w) const {
    const auto threshold =
        std::max(static_cast<float>(options_.min_weight), std::numeric_limits<float>::min());
    unsigned any_solid = 0, any_empty = 0;
    for (int z = 0; z < kRow; ++z)
      for (int y = 0; y < kRow; ++y) {
        unsigned solid = 0, known = 0;
        float* distance = w.distance.data() + row(y, z) * kRow;
        const int n = (y == kSide ? 2 : 0) | (z == kSide ? 4 : 0);
        const auto first =
            static_cast<std::size_t>((y % kSide) * kSide + (z % kSide) * kSide * kSide);
        const std::uint32_t here = slots[static_cast<std::size_t>(n)];
        if (here != TsdfMap::kNone) {
          const TsdfVoxel* v = map.block(here).voxels.data() + first;
          for (unsigned x = 0; x < kSide; ++x) {
            distance[x] = v[x].distance;
            known |= static_cast<unsigned>(v[x].weight >= threshold) << x;
            solid |= static_cast<unsigned>(v[x].distance <= 0.0F) << x;
          }
        }
        const std::uint32_t beside = slots[static_cast<std::size_t>(n | 1)];
        if (beside != TsdfMap::kNone) {
          const TsdfVoxel& v = map.block(beside).voxels[first];
          distance[kSide] = v.distance;
          known |= static_cast<unsigned>(v.weight >= threshold) << kSide;
          solid |= static_cast<unsigned>(v.distance <= 0.0F) << kSide;
        }
        w.known[row(y, z)] = static_cast<std::uint16_t>(known);
        w.solid[row(y, z)] = static_cast<std::uint16_t>(solid & known);
        any_solid |= solid & known;
        any_empty |= known & ~solid;
      }
    return any_solid != 0 && any_empty != 0;
  }

  void mesh_block(const TsdfMap& map, std::uint32_t slot, Part& part) const {
    const TsdfMap::Block& block = map.block(slot);
    for (int n = 0; n < 8; ++n)
      part.neighbours[static_cast<std::size_t>(n)] =
          n == 0 ? slot : map.find_slot(block.index + offset(n));
    part.crossed.fill(0);
    part.vertices.clear();
    part.corners.clear();
    Window w;
    if (!load(map, part.neighbours, w)) return;
    find_crossings(w, block.origin(), part);
    find_triangles(w, part);
  }

  void find_crossings(const Window& w, const VoxelIndex& origin, Part& part) const {
    const auto ratio = [](float a, float b) {
      const double d = static_cast<double>(a) / (static_cast<double>(a) - static_cast<double>(b));
      return std::clamp(d, 1e-3, 1.0 - 1e-3);
    };
    for (int axis = 0; axis < 3; ++axis) {
      const VoxelIndex step = VoxelIndex::Unit(axis);
      const std::size_t stride = axis == 0 ? 1 : axis == 1 ? kRow : kRow * kRow;
      for (int z = 0; z < kSide; ++z)
        for (int y = 0; y < kSide; ++y) {
          const std::size_t a = row(y, z), b = row(y + step.y(), z + step.z());
          const unsigned shift = axis == 0 ? 1 : 0;
          const unsigned known = w.known[a] & (w.known[b] >> shift);
          unsigned cross = (w.solid[a] ^ (w.solid[b] >> shift)) & known & ((1U << kSide) - 1);
          for (; cross != 0; cross &= cross - 1) {
            const int x = std::countr_zero(cross);
            const std::size_t i = a * kRow + static_cast<std::size_t>(x);
            Point3 p = (origin + VoxelIndex(x, y, z)).cast<double>() + Point3::Constant(0.5);
            p[axis] += ratio(w.distance[i], w.distance[i + stride]);
            part.vertices.push_back(p * voxel_size_);
            const std::size_t key = static_cast<std::size_t>(axis) * TsdfMap::kBlockVoxels +
                                    static_cast<std::size_t>(x + kSide * (y + kSide * z));
            part.crossed[key / 64] |= std::uint64_t{1} << (key % 64);
          }
        }
    }
    std::uint16_t sum = 0;
    for (std::size_t i = 0; i < kWords; ++i) {
      part.before[i] = sum;
      sum = static_cast<std::uint16_t>(sum + std::popcount(part.crossed[i]));
    }
  }

  void find_triangles(const Window& w, Part& part) const {
    const auto& table = cube_triangles();
    const bool limited = std::isfinite(options_.max_step);
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y) {
        const std::array<std::size_t, 4> rows{row(y, z), row(y + 1, z), row(y, z + 1),
                                              row(y + 1, z + 1)};
        unsigned known = ~0U, solid = 0, empty = 0;
        for (const std::size_t r : rows) {
          const unsigned s = w.solid[r], e = w.known[r] & ~s;
          known &= static_cast<unsigned>(w.known[r] & (w.known[r] >> 1));
          solid |= s | s >> 1;
          empty |= e | e >> 1;
        }
        // The surface of a cube needs the distances at both ends of the edges it crosses, no
        // others: what lies deep behind a slanted surface may be hidden from all views.
        for (unsigned cubes = solid & empty & ((1U << kSide) - 1); cubes != 0; cubes &= cubes - 1) {
          const int x = std::countr_zero(cubes);
          const auto corners_in = [&](const auto& bits) {
            unsigned pattern = 0;
            for (unsigned k = 0; k < 4; ++k)
              pattern |= (static_cast<unsigned>(bits[rows[k]]) >> x & 3U) << (2 * k);
            return pattern;
          };
          unsigned pattern = corners_in(w.solid);
          if ((known >> x & 1U) == 0U) {  // unknown corners beside solid ones alone are solid
            const unsigned known_corners = corners_in(w.known), unknown = known_corners ^ 0xFFU;
            if ((beside(unknown) & known_corners & ~pattern) != 0U) continue;
            pattern |= unknown;
          }
          if (limited && steep(w, rows, x, pattern)) continue;
          const CubeTriangles& triangles = table[pattern];
          for (std::size_t t = 0; t < triangles.count; ++t) {
            std::array<std::uint16_t, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
              corners[k] = key_of(x, y, z, triangles.triangles[t][k]);
            part.corners.push_back(corners);
          }
        }
      }
  }

  /// The corners that share an edge of the cube with one of `corners`.
  static unsigned beside(unsigned corners) {
    return (corners & 0x55U) << 1 | (corners & 0xAAU) >> 1 | (corners & 0x33U) << 2 |
           (corners & 0xCCU) >> 2 | (corners & 0x0FU) << 4 | corners >> 4;
  }

  bool steep(const Window& w, const std::array<std::size_t, 4>& rows, int x,
             unsigned pattern) const {
    const double limit = options_.max_step * voxel_size_;
    const auto at = [&](unsigned corner) {
      return static_cast<double>(
          w.distance[rows[corner >> 1] * kRow + static_cast<std::size_t>(x) + (corner & 1)]);
    };
    for (int e = 0; e < 12; ++e) {
      const CubeEdge edge = cube_edge(e);
      const bool crossed = ((pattern >> edge.lower ^ pattern >> edge.upper) & 1U) != 0U;
      if (crossed && std::abs(at(edge.lower) - at(edge.upper)) > limit) return true;
    }
    return false;
  }

  static std::uint16_t key_of(int x, int y, int z, int edge) {
    const CubeEdge e = cube_edge(edge);
    const int vx = x + (e.lower & 1), vy = y + (e.lower >> 1 & 1), vz = z + (e.lower >> 2);
    const int n = (vx / kSide) | (vy / kSide) << 1 | (vz / kSide) << 2;
    const int voxel = (vx % kSide) + kSide * ((vy % kSide) + kSide * (vz % kSide));
    return static_cast<std::uint16_t>(n * kKeys + e.axis * static_cast<int>(TsdfMap::kBlockVoxels) +
                                      voxel);
  }

  MeshOptions options_;
  double voxel_size_ = 0.0;
  std::vector<Part> parts_;
  std::uint64_t cursor_ = 0;
};

/// The surface of the whole map at once.
inline TriangleMesh extract_mesh(const TsdfMap& map, MeshOptions options = {}) {
  MeshExtractor extractor(options);
  extractor.update(map);
  return extractor.mesh();
}
}  // namespace surfleet
