// SPDX-License-Identifier: MIT
/// @file
/// @brief One strip through every triangle of a mesh, each once (Gopi and Eppstein 2004) [004
/// §7.2.4].
///
///     const SingleStrip strip = single_strip(mesh, start);
///     drive(strip.mesh, strip.triangles);    // some triangles of `mesh` in two halves there
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/matching.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/strip_search.hpp>

namespace surfleet {
struct SingleStrip {
  TriangleMesh mesh;                    ///< The part that hangs together with the start.
  std::vector<std::int32_t> triangles;  ///< The strip over `mesh`, from the start on.
  std::vector<std::int32_t> source;     ///< For every triangle of `mesh`, that of the input.
  std::size_t split = 0;                ///< Triangles of the input that are in halves.
  /// Places of `triangles` that lead past a border to where the strip goes on: over triangles that
  /// have their place elsewhere. None on a closed surface.
  std::size_t detours = 0;
  std::size_t circles = 0;  ///< That were joined.
};

namespace detail {
/// The dual of a mesh closed by a fan of imagined triangles over every border: three links at each.
class ClosedDual {
 public:
  ClosedDual(const TriangleMesh& mesh, const HalfEdges& half, std::int32_t start)
      : mesh_(mesh), half_(half), number_(mesh.triangles.size(), -1) {
    real_.push_back(start);
    number_[at(start)] = 0;
    for (std::size_t i = 0; i < real_.size(); ++i)
      for (std::int32_t k = 0; k < 3; ++k) {
        const std::int32_t g = half.twin(3 * real_[i] + k);
        if (g < 0 || number_[at(g / 3)] >= 0) continue;
        number_[at(g / 3)] = static_cast<std::int32_t>(real_.size());
        real_.push_back(g / 3);
      }
    link_.assign(real_.size(), {-1, -1, -1});
    ends_.resize(real_.size());
    std::vector<std::int32_t> borders;
    for (std::size_t i = 0; i < real_.size(); ++i)
      for (std::int32_t k = 0; k < 3; ++k) {
        const std::int32_t h = 3 * real_[i] + k, g = half.twin(h);
        ends_[i][at(k)] = {half.from(h), half.to(h)};
        if (g >= 0)
          link_[i][at(k)] = 3 * number_[at(g / 3)] + g % 3;
        else
          borders.push_back(h);
      }
    close(borders);
  }

  std::size_t size() const { return link_.size(); }
  std::size_t real_count() const { return real_.size(); }
  std::int32_t real(std::int32_t node) const { return real_[at(node)]; }
  bool is_real(std::int32_t node) const { return at(node) < real_.size(); }
  /// The link at the other end of link 3 · node + k.
  std::int32_t twin(std::int32_t link) const { return link_[at(link / 3)][at(link % 3)]; }
  /// The vertex that two sides of a node have in common.
  std::int32_t shared(std::int32_t a, std::int32_t b) const {
    const auto &p = ends_[at(a / 3)][at(a % 3)], &q = ends_[at(b / 3)][at(b % 3)];
    return p[0] == q[0] || p[0] == q[1] ? p[0] : p[1];
  }
  struct Arcs {
    std::array<Arc, 3> arc;
    const Arc* begin() const { return arc.data(); }
    const Arc* end() const { return arc.data() + 3; }
  };
  Arcs arcs(std::int32_t node) const {
    Arcs arcs;
    for (std::size_t k = 0; k < 3; ++k) arcs.arc[k] = {link_[at(node)][k] / 3, 1.0};
    return arcs;
  }

 private:
  static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

  /// Side 0 of an imagined triangle lies on the border, 1 and 2 meet its neighbours' at the ends.
  void close(const std::vector<std::int32_t>& borders) {
    std::vector<std::int32_t> node_of(3 * mesh_.triangles.size(), -1);
    for (const std::int32_t h : borders) {
      node_of[at(h)] = static_cast<std::int32_t>(link_.size());
      const std::int32_t link = 3 * number_[at(h / 3)] + h % 3;
      link_[at(link / 3)][at(link % 3)] = 3 * node_of[at(h)];
      link_.push_back({link, -1, -1});
      ends_.push_back({{{half_.from(h), half_.to(h)}, {half_.to(h), -1}, {half_.from(h), -1}}});
    }
    std::int32_t apex = static_cast<std::int32_t>(mesh_.vertices.size());
    for (const std::int32_t first : borders) {
      std::int32_t h = first, pivot = half_.to(first);
      for (bool any = false;; any = true) {
        const std::int32_t node = node_of[at(h)];
        const std::int32_t side = 3 * node + (pivot == half_.to(h) ? 1 : 2);
        if (link_[at(node)][at(side % 3)] >= 0) {
          apex += any ? 1 : 0;
          break;
        }
        // About the pivot, to the border on the other side of its triangles.
        std::int32_t g = h;
        for (;;) {
          const std::int32_t t = 3 * (g / 3);
          const std::int32_t a = t + (g - t + 1) % 3, b = t + (g - t + 2) % 3;
          g = half_.from(a) == pivot || half_.to(a) == pivot ? a : b;
          if (half_.twin(g) < 0) break;
          g = half_.twin(g);
        }
        const std::int32_t next = node_of[at(g)];
        const std::int32_t other = 3 * next + (pivot == half_.to(g) ? 1 : 2);
        link_[at(node)][at(side % 3)] = other;
        link_[at(next)][at(other % 3)] = side;
        ends_[at(node)][at(side % 3)][1] = ends_[at(next)][at(other % 3)][1] = apex;
        pivot = pivot == half_.to(g) ? half_.from(g) : half_.to(g);
        h = g;
      }
    }
  }

  const TriangleMesh& mesh_;
  const HalfEdges& half_;
  std::vector<std::int32_t> real_, number_;
  std::vector<std::array<std::int32_t, 3>> link_;
  std::vector<std::array<std::array<std::int32_t, 2>, 3>> ends_;
};
static_assert(WeightedGraph<ClosedDual>);
}  // namespace detail

/// A strip through all triangles that hang together with `start` over edges of two triangles.
///
/// A perfect matching of the dual leaves circles of triangles. Where a matched pair lies on two
/// circles, both of its triangles are halved from the middle of their common side, and the circles
/// become one. Borders, and edges of three triangles or more, are closed by fans of imagined
/// triangles; where the strip would cross these it goes on along the cheapest detour over triangles
/// that have their turn elsewhere. So every piece has one place, and recurs in detours alone.
///
/// Throws `Error` where the mesh is not valid, or the closed dual has no perfect matching (no
/// surface without a bridge in its dual lacks one). Matching aside O(n log n), and a search for
/// each detour.
inline SingleStrip single_strip(const TriangleMesh& mesh, std::int32_t start) {
  require_valid_surface(mesh);
  require(start >= 0 && static_cast<std::size_t>(start) < mesh.triangles.size(),
          "single strip: expected a triangle of the mesh to start from");
  const auto at = [](std::int32_t i) { return static_cast<std::size_t>(i); };
  const HalfEdges half(mesh);
  const detail::ClosedDual dual(mesh, half, start);
  const auto n = static_cast<std::int32_t>(dual.size());
  const std::vector<std::int32_t> mate = maximum_matching(dual);
  std::vector<std::int32_t> matched(dual.size(), -1);  // the link that leads to the partner
  for (std::int32_t v = 0; v < n; ++v) {
    require(mate[at(v)] >= 0, "single strip: the dual of the mesh has no perfect matching");
    if (matched[at(v)] >= 0) continue;
    for (std::int32_t k = 0; k < 3 && matched[at(v)] < 0; ++k) {
      if (dual.twin(3 * v + k) / 3 != mate[at(v)]) continue;
      matched[at(v)] = 3 * v + k;
      matched[at(mate[at(v)])] = dual.twin(3 * v + k);
    }
  }
  SingleStrip strip;
  DisjointSets circles(dual.size());
  std::size_t count = dual.size();
  for (std::int32_t v = 0; v < n; ++v)
    for (std::int32_t k = 0; k < 3; ++k)
      if (3 * v + k != matched[at(v)] && circles.unite(v, dual.twin(3 * v + k) / 3)) --count;
  strip.circles = count;
  std::vector<std::uint8_t> halved(dual.size(), 0);
  for (const bool real : {true, false})  // imagined pairs only where no others join
    for (std::int32_t v = 0; v < n; ++v) {
      const std::int32_t other = mate[at(v)];
      if (other < v || (real && !(dual.is_real(v) && dual.is_real(other)))) continue;
      if (circles.unite(v, other)) halved[at(v)] = halved[at(other)] = 1;
    }

  // The pieces: for a half, those of its corner at the matched side's first vertex come first.
  strip.mesh.vertices = mesh.vertices;
  std::vector<std::array<std::int32_t, 2>> piece(dual.size(), {-1, -1});  // by the link kept
  std::vector<std::int32_t> middle(dual.size(), -1);
  for (std::int32_t v = 0; at(v) < dual.real_count(); ++v) {
    const Triangle& t = mesh.triangles[at(dual.real(v))];
    const auto add = [&](const Triangle& corners) {
      strip.mesh.triangles.push_back(corners);
      strip.source.push_back(dual.real(v));
      return static_cast<std::int32_t>(strip.mesh.triangles.size()) - 1;
    };
    if (halved[at(v)] == 0) {
      piece[at(v)][0] = piece[at(v)][1] = add(t);
      continue;
    }
    ++strip.split;
    const auto k = at(matched[at(v)] % 3);
    const std::int32_t p = t[k], q = t[(k + 1) % 3], r = t[(k + 2) % 3];
    const std::int32_t other = mate[at(v)];
    std::int32_t m = middle[at(other)];
    if (m < 0) {
      m = static_cast<std::int32_t>(strip.mesh.vertices.size());
      strip.mesh.vertices.push_back(0.5 * (mesh.vertices[at(p)] + mesh.vertices[at(q)]));
    }
    middle[at(v)] = m;
    piece[at(v)][0] = add({p, m, r});
    piece[at(v)][1] = add({m, q, r});
  }

  // Along the one circle, from the start until it comes round.
  const auto kept = [&](std::int32_t v, int which) {  // one of the two links that are not matched
    const std::int32_t m = matched[at(v)] % 3;
    return 3 * v + (m + 1 + which) % 3;
  };
  std::vector<std::int32_t> order;
  const std::int32_t first = kept(0, 0);
  std::int32_t out = first;  // the link by which a node is left
  bool begun = false;
  do {
    const std::int32_t in = dual.twin(out);
    const std::int32_t v = in / 3;
    std::int32_t next = kept(v, in == kept(v, 0) ? 1 : 0);
    const auto place = [&](std::int32_t link) {
      const std::int32_t node = link / 3;
      if (!dual.is_real(node)) return;
      const auto& t = mesh.triangles[at(dual.real(node))];
      const std::int32_t p = t[at(matched[at(node)] % 3)];
      const bool low = dual.shared(link, matched[at(node)]) == p;
      order.push_back(piece[at(node)][halved[at(node)] != 0 && !low ? 1 : 0]);
    };
    place(in);
    if (halved[at(v)] != 0) {  // over to the partner's half at the same vertex
      const std::int32_t partner = mate[at(v)];
      const std::int32_t vertex = dual.shared(in, matched[at(v)]);
      next = dual.shared(kept(partner, 0), matched[at(partner)]) == vertex ? kept(partner, 0)
                                                                           : kept(partner, 1);
      place(next);
    }
    out = next;
    begun = true;
  } while (!begun || out != first);

  // From a piece of the start on, with detours where imagined triangles were.
  std::rotate(order.begin(),
              std::find_if(order.begin(), order.end(),
                           [&](std::int32_t t) { return strip.source[at(t)] == start; }),
              order.end());
  strip.mesh = selected(strip.mesh, [](std::size_t) { return true; });
  const StripSearch search(strip.mesh);
  const auto joined = [&](std::int32_t a, std::int32_t b) {
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t g = search.twin(3 * a + k);
      if (g >= 0 && g / 3 == b) return true;
    }
    return false;
  };
  for (const std::int32_t t : order) {
    if (!strip.triangles.empty() && !joined(strip.triangles.back(), t)) {
      const auto detour = search(SurfacePoint{strip.triangles.back()}, SurfacePoint{t});
      require(detour.has_value(), "single strip: no detour leads past a border");
      strip.detours += detour->triangles.size() - 2;
      strip.triangles.insert(strip.triangles.end(), detour->triangles.begin() + 1,
                             detour->triangles.end() - 1);
    }
    strip.triangles.push_back(t);
  }
  return strip;
}
}  // namespace surfleet
