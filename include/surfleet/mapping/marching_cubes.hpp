// SPDX-License-Identifier: MIT
/// @file
/// @brief Marching cubes: the triangles of every sign pattern of a cube's corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace surfleet {
/// Corners of a cube are numbered by their coordinates' bits, x + 2 y + 4 z. The edge along axis a
/// whose other two coordinates, in the order a + 1, a + 2 (mod 3), are p and q has the number
/// 4 a + p + 2 q.
struct CubeEdge {
  std::uint8_t axis;
  std::uint8_t lower;  ///< The corner at the edge's start.
  std::uint8_t upper;
};

constexpr CubeEdge cube_edge(int edge) {
  const int a = edge / 4, p = edge & 1, q = (edge >> 1) & 1;
  const int lower = (p << ((a + 1) % 3)) | (q << ((a + 2) % 3));
  return {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(lower),
          static_cast<std::uint8_t>(lower | (1 << a))};
}

/// The triangles of one sign pattern; their corners are edge numbers, anticlockwise seen from the
/// empty side.
struct CubeTriangles {
  std::uint8_t count = 0;
  std::array<std::array<std::uint8_t, 3>, 10> triangles{};
};

namespace detail {
/// Derives the triangles of a pattern by tracing the surface's outline over the cube's faces.
///
/// On a face whose solid corners are diagonal the two empty corners are cut off one by one. That
/// depends on the face alone, so the two cubes that share it agree and the surface has no cracks.
/// Outlines are split into triangles without a diagonal between two points of one face: the cube
/// on its other side could draw the same line, and four triangles would meet there.
class CubeTracer {
 public:
  static CubeTriangles trace(unsigned solid) {
    std::array<int, 12> next{};
    next.fill(-1);
    for (int face = 0; face < 6; ++face) outline_face(solid, face, next);
    CubeTriangles result;
    for (int start = 0; start < 12; ++start) {
      std::array<int, 12> loop{};
      int n = 0;
      for (int e = start; next[at(e)] >= 0;) {
        loop[at(n++)] = e;
        const int following = next[at(e)];
        next[at(e)] = -1;
        e = following;
      }
      if (n >= 3) triangulate(loop, n, result);
    }
    return result;
  }

  static bool on_one_face(int e, int f) {
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        if (touches(e, axis, side) && touches(f, axis, side)) return true;
    return false;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static bool touches(int edge, int axis, int side) {
    const CubeEdge e = cube_edge(edge);
    return (e.lower >> axis & 1) == side && (e.upper >> axis & 1) == side;
  }

  /// Links the crossings of one face: from where a walk around it, anticlockwise seen from outside
  /// the cube, enters solid ground to where it had left it.
  static void outline_face(unsigned solid, int face, std::array<int, 12>& next) {
    const int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3, side = face & 1;
    std::array<int, 4> ring{};
    for (int k = 0; k < 4; ++k) {
      const int turn = side == 1 ? k : 3 - k;
      const int p = turn == 1 || turn == 2 ? 1 : 0, q = turn >= 2 ? 1 : 0;
      ring[at(k)] = (side << a) | (p << b) | (q << c);
    }
    const auto is_solid = [&](int k) { return (solid >> ring[at(k & 3)] & 1U) != 0U; };
    const auto edge_after = [&](int k) {
      const int u = ring[at(k & 3)], v = ring[at((k + 1) & 3)];
      for (int e = 0; e < 12; ++e) {
        const CubeEdge ce = cube_edge(e);
        if ((ce.lower == u && ce.upper == v) || (ce.lower == v && ce.upper == u)) return e;
      }
      return -1;
    };
    for (int k = 0; k < 4; ++k) {
      if (!is_solid(k) || is_solid(k + 1)) continue;
      int back = k + 1;
      while (!is_solid(back + 1)) ++back;
      next[at(edge_after(back))] = edge_after(k);
    }
  }

  /// Fewest diagonals within a face, by dynamic programming over the polygon's chords.
  static void triangulate(const std::array<int, 12>& loop, int n, CubeTriangles& result) {
    std::array<std::array<int, 12>, 12> cost{}, split{};
    for (int span = 2; span < n; ++span)
      for (int i = 0; i + span < n; ++i) {
        const int j = i + span;
        int best = std::numeric_limits<int>::max();
        for (int m = i + 1; m < j; ++m) {
          const int total = cost[at(i)][at(m)] + cost[at(m)][at(j)];
          if (total < best) {
            best = total;
            split[at(i)][at(j)] = m;
          }
        }
        const bool is_side = span == n - 1;
        cost[at(i)][at(j)] = best + (!is_side && on_one_face(loop[at(i)], loop[at(j)]) ? 1 : 0);
      }
    emit(loop, split, 0, n - 1, result);
  }
  static void emit(const std::array<int, 12>& loop,
                   const std::array<std::array<int, 12>, 12>& split, int i, int j,
                   CubeTriangles& result) {
    if (j - i < 2) return;
    const int m = split[at(i)][at(j)];
    result.triangles[result.count++] = {static_cast<std::uint8_t>(loop[at(i)]),
                                        static_cast<std::uint8_t>(loop[at(m)]),
                                        static_cast<std::uint8_t>(loop[at(j)])};
    emit(loop, split, i, m, result);
    emit(loop, split, m, j, result);
  }
};
}  // namespace detail

/// The triangles for every pattern; bit c of the index is set if corner c is solid. Made on first
/// use.
inline const std::array<CubeTriangles, 256>& cube_triangles() {
  static const auto table = [] {
    std::array<CubeTriangles, 256> t;
    for (unsigned solid = 0; solid < 256; ++solid) t[solid] = detail::CubeTracer::trace(solid);
    return t;
  }();
  return table;
}
}  // namespace surfleet
