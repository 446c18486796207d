// SPDX-License-Identifier: MIT
/// @file
/// @brief One covering triangle strip for a region: a path from triangle to neighbouring triangle
/// that visits every one of them [004 §7.2.4].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/coverage/surface_regions.hpp>

namespace surfleet {
/// A sweep of one region.
struct CoveringStrip {
  std::vector<std::int32_t> triangles;  ///< Each shares an edge with the one before.
  std::vector<Point3> path;             ///< On the surface, centroid to centroid over the edges.
  std::vector<double> travelled;        ///< Length of the path at every triangle [m].

  double length() const { return travelled.empty() ? 0.0 : travelled.back(); }
};

struct CoveringStripOptions {
  int passes = 30;  ///< Of local improvement, each O(n) moves.
};

/// The footprint for which a strip is the ideal sweep [m]: on equilateral triangles a path that
/// steps once from each to the next is exactly area / footprint long.
inline double strip_footprint(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      sum += (mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm();
  return mesh.triangles.empty() ? 0.0
                                : 0.75 * sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

namespace detail {
/// The order in which the triangles of one region are first visited, improved by exchanges.
class StripTour {
 public:
  /// `stops` is connected in `links`, `first` one of them.
  StripTour(const Graph& links, std::span<const std::int32_t> stops, std::int32_t first) {
    // A graph of the region alone, under local names.
    name_.assign(stops.begin(), stops.end());
    std::vector<std::int32_t> local(links.size(), -1);
    for (std::size_t i = 0; i < name_.size(); ++i)
      local[static_cast<std::size_t>(name_[i])] = static_cast<std::int32_t>(i);
    std::vector<std::pair<std::int32_t, Arc>> list;
    double sum = 0.0;
    for (std::size_t i = 0; i < name_.size(); ++i)
      for (const Arc& arc : links.arcs(name_[i])) {
        const std::int32_t j = local[static_cast<std::size_t>(arc.to)];
        if (j < 0) continue;
        list.push_back({static_cast<std::int32_t>(i), {j, arc.length}});
        sum += arc.length;
      }
    graph_ = Graph(name_.size(), list);
    hop_ = list.empty() ? 0.0 : sum / static_cast<double>(list.size());
    near_.resize(name_.size());
    std::vector<double> best(name_.size(), ShortestPaths::kUnreached);
    for (std::size_t i = 0; i < name_.size(); ++i) find_near(i, best);
    walk(local[static_cast<std::size_t>(first)]);
  }

  void improve(int passes) {
    for (int pass = 0; pass < passes; ++pass) {
      bool changed = false;
      for (std::int32_t t = 0; t < size(); ++t) {
        int guard = 0;
        while (guard++ < 8 && (two_opt(t) || move_segment(t))) changed = true;
      }
      if (!changed) break;
    }
  }

  /// The strip with the paths between stops filled in, in the names of the whole surface.
  std::vector<std::int32_t> strip() const {
    std::vector<std::int32_t> result;
    for (std::size_t k = 0; k < tour_.size(); ++k) {
      if (k > 0 && !adjacent(tour_[k - 1], tour_[k])) {
        const std::int32_t goal = tour_[k];
        const Source source{tour_[k - 1], 0.0};
        const auto path = shortest_paths(graph_, std::span<const Source>(&source, 1), NoHeuristic{},
                                         [&](std::int32_t v, double) { return v == goal; })
                              .path(goal);
        for (std::size_t w = 1; w + 1 < path.size(); ++w)
          result.push_back(name_[static_cast<std::size_t>(path[w])]);
      }
      result.push_back(name_[static_cast<std::size_t>(tour_[k])]);
    }
    return result;
  }

 private:
  struct Near {
    std::int32_t to;
    double distance;
  };
  static constexpr std::size_t kTable = 22, kCandidates = 8;

  std::int32_t size() const { return static_cast<std::int32_t>(tour_.size()); }

  /// The nearest stops of `i`, nearest first; `best` is scratch, left infinite.
  void find_near(std::size_t i, std::vector<double>& best) {
    std::vector<std::pair<double, std::int32_t>> open{{0.0, static_cast<std::int32_t>(i)}};
    std::vector<std::int32_t> touched{static_cast<std::int32_t>(i)};
    best[i] = 0.0;
    while (!open.empty() && near_[i].size() < kTable) {
      const auto least = std::min_element(open.begin(), open.end());
      const auto [d, v] = *least;
      *least = open.back();
      open.pop_back();
      if (d > best[static_cast<std::size_t>(v)]) continue;
      if (v != static_cast<std::int32_t>(i)) near_[i].push_back({v, d});
      for (const Arc& arc : graph_.arcs(v)) {
        double& old = best[static_cast<std::size_t>(arc.to)];
        if (d + arc.length >= old) continue;
        old = d + arc.length;
        open.push_back({old, arc.to});
        touched.push_back(arc.to);
      }
    }
    for (const std::int32_t v : touched)
      best[static_cast<std::size_t>(v)] = ShortestPaths::kUnreached;
  }

  bool adjacent(std::int32_t a, std::int32_t b) const {
    for (const Arc& arc : graph_.arcs(a))
      if (arc.to == b) return true;
    return false;
  }

  /// First visits by always taking the free neighbour with the fewest free neighbours of its own,
  /// and the nearest free triangle when stuck.
  void walk(std::int32_t at) {
    const std::size_t n = name_.size();
    std::vector<std::uint8_t> seen(n, 0);
    position_.assign(n, -1);
    const auto visit = [&](std::int32_t t) {
      seen[static_cast<std::size_t>(t)] = 1;
      position_[static_cast<std::size_t>(t)] = static_cast<std::int32_t>(tour_.size());
      tour_.push_back(t);
    };
    visit(at);
    while (tour_.size() < n) {
      std::int32_t next = -1;
      int fewest = 1 << 30;
      for (const Arc& arc : graph_.arcs(at)) {
        if (seen[static_cast<std::size_t>(arc.to)] != 0) continue;
        int free = 0;
        for (const Arc& beyond : graph_.arcs(arc.to))
          free += seen[static_cast<std::size_t>(beyond.to)] == 0 ? 1 : 0;
        if (free >= fewest) continue;
        fewest = free;
        next = arc.to;
      }
      if (next < 0) {
        const Source source{at, 0.0};
        double length = 0.0;
        shortest_paths(graph_, std::span<const Source>(&source, 1), NoHeuristic{},
                       [&](std::int32_t v, double d) {
                         if (seen[static_cast<std::size_t>(v)] != 0) return false;
                         next = v;
                         length = d;
                         return true;
                       });
        require(next >= 0, "covering strip: the region is not one piece over common edges");
        far_[std::minmax(at, next)] = length;
      }
      visit(next);
      at = next;
    }
  }

  /// The length of the path from a to b; infinite if they are far apart and no part of the first
  /// walk.
  double distance(std::int32_t a, std::int32_t b) const {
    for (const Near& near : near_[static_cast<std::size_t>(a)])
      if (near.to == b) return near.distance;
    for (const Near& near : near_[static_cast<std::size_t>(b)])
      if (near.to == a) return near.distance;
    const auto found = far_.find(std::minmax(a, b));
    return found == far_.end() ? ShortestPaths::kUnreached : found->second;
  }
  /// The step from position i to i + 1; nothing after the last.
  double step(std::int32_t i) const {
    return i < 0 || i + 1 >= size() ? 0.0 : distance(at(i), at(i + 1));
  }
  /// A new step between positions; nothing beyond the last.
  double join(std::int32_t i, std::int32_t j) const {
    return i >= size() || j >= size() ? 0.0 : distance(at(i), at(j));
  }
  std::int32_t at(std::int32_t i) const { return tour_[static_cast<std::size_t>(i)]; }
  void place(std::int32_t from, std::int32_t to) {
    for (std::int32_t i = from; i <= to; ++i) position_[static_cast<std::size_t>(at(i))] = i;
  }
  void reverse(std::int32_t from, std::int32_t to) {
    std::reverse(tour_.begin() + from, tour_.begin() + to + 1);
    place(from, to);
  }

  bool two_opt(std::int32_t t) {
    const auto& near = near_[static_cast<std::size_t>(t)];
    const std::int32_t i = position_[static_cast<std::size_t>(t)];
    const double gain = 1e-9 * hop_;
    for (std::size_t k = 0; k < std::min(near.size(), kCandidates); ++k) {
      const std::int32_t j = position_[static_cast<std::size_t>(near[k].to)];
      const std::int32_t low = std::min(i, j), high = std::max(i, j);
      // Join what starts here: … low | low+1 … high | high+1 …
      if (near[k].distance < step(low) + step(high) &&
          step(low) + step(high) - near[k].distance - join(low + 1, high + 1) > gain) {
        reverse(low + 1, high);
        return true;
      }
      // Join what ends here: … low−1 | low … high−1 | high …; the first triangle stays.
      if (low == 0) continue;
      const double old = step(low - 1) + step(high - 1);
      if (near[k].distance < old && old - near[k].distance - join(low - 1, high - 1) > gain) {
        reverse(low, high - 1);
        return true;
      }
    }
    return false;
  }

  /// Moves one to three triangles that begin or end at `t` next to a near triangle.
  bool move_segment(std::int32_t t) {
    const auto& near = near_[static_cast<std::size_t>(t)];
    const std::int32_t i = position_[static_cast<std::size_t>(t)];
    const double gain = 1e-9 * hop_;
    for (std::int32_t length = 1; length <= 3; ++length) {
      for (int ends = 0; ends < (length == 1 ? 1 : 2); ++ends) {
        const std::int32_t s = ends == 0 ? i : i - length + 1, e = s + length - 1;
        if (s < 1 || e >= size()) continue;
        const double freed =
            step(s - 1) + step(e) - (e + 1 < size() ? distance(at(s - 1), at(e + 1)) : 0.0);
        if (!(freed > gain)) continue;
        for (std::size_t k = 0; k < std::min(near.size(), kCandidates); ++k) {
          if (near[k].distance >= freed) break;
          const std::int32_t j = position_[static_cast<std::size_t>(near[k].to)];
          if (j >= s && j <= e) continue;
          for (const std::int32_t after : {j, j - 1}) {  // between `after` and after + 1
            if (after < 0 || (after >= s - 1 && after <= e)) continue;
            const std::int32_t left = at(after);
            const double right_old = step(after);
            for (const bool flip : {false, true}) {
              const std::int32_t head = flip ? at(e) : at(s), tail = flip ? at(s) : at(e);
              const double added = distance(left, head) +
                                   (after + 1 < size() ? distance(tail, at(after + 1)) : 0.0) -
                                   right_old;
              if (!(freed - added > gain)) continue;
              if (flip) std::reverse(tour_.begin() + s, tour_.begin() + e + 1);
              if (after > e)
                std::rotate(tour_.begin() + s, tour_.begin() + e + 1, tour_.begin() + after + 1);
              else
                std::rotate(tour_.begin() + after + 1, tour_.begin() + s, tour_.begin() + e + 1);
              place(std::min(s, after + 1), std::max(e, after));
              return true;
            }
          }
        }
      }
    }
    return false;
  }

  std::vector<std::int32_t> name_, tour_, position_;
  Graph graph_;
  double hop_ = 0.0;
  std::vector<std::vector<Near>> near_;
  std::map<std::pair<std::int32_t, std::int32_t>, double> far_;
};
}  // namespace detail

/// A strip that visits each of `triangles`, connected over common edges, from `start`.
///
/// A walk that hugs what is already covered, then 2-opt and Or-opt with neighbour lists. O(n²) at
/// worst for the exchanges, about 1 s for 10 000 triangles.
inline CoveringStrip covering_strip(const TriangleMesh& mesh, const Graph& links,
                                    std::span<const std::int32_t> triangles, std::int32_t start,
                                    const CoveringStripOptions& options = {}) {
  CoveringStrip strip;
  if (triangles.empty()) return strip;
  require(std::find(triangles.begin(), triangles.end(), start) != triangles.end(),
          "covering strip: the start is not in the region");
  detail::StripTour tour(links, triangles, start);
  tour.improve(options.passes);
  strip.triangles = tour.strip();
  strip.path.push_back(mesh.centroid(static_cast<std::size_t>(start)));
  strip.travelled.push_back(0.0);
  for (std::size_t k = 1; k < strip.triangles.size(); ++k) {
    const auto a = static_cast<std::size_t>(strip.triangles[k - 1]);
    const auto b = static_cast<std::size_t>(strip.triangles[k]);
    const Point3 over = crossing_point(mesh, a, b);
    const Point3 end = mesh.centroid(b);
    strip.travelled.push_back(strip.travelled.back() + (over - strip.path.back()).norm() +
                              (end - over).norm());
    strip.path.push_back(over);
    strip.path.push_back(end);
  }
  return strip;
}

/// One strip for every region, from where its robot stands; empty for a robot without a region.
inline std::vector<CoveringStrip> covering_strips(const SurfaceRegions& regions,
                                                  const CoveringStripOptions& options = {}) {
  std::vector<CoveringStrip> strips(regions.robots());
  for (std::size_t i = 0; i < regions.robots(); ++i)
    if (regions.start[i] >= 0)
      strips[i] = covering_strip(*regions.mesh, regions.dual->links, regions.triangles(i),
                                 regions.start[i], options);
  return strips;
}

/// The share of the mesh's area whose triangles some strip visits.
inline double swept_fraction(const TriangleMesh& mesh, std::span<const CoveringStrip> strips) {
  std::vector<std::uint8_t> seen(mesh.triangles.size(), 0);
  for (const CoveringStrip& s : strips)
    for (const std::int32_t t : s.triangles) seen[static_cast<std::size_t>(t)] = 1;
  double swept = 0.0, all = 0.0;
  for (std::size_t t = 0; t < seen.size(); ++t) {
    all += mesh.area(t);
    if (seen[t] != 0) swept += mesh.area(t);
  }
  return all > 0.0 ? swept / all : 1.0;
}

/// The longest strip against the mean; 1 is even.
inline double sweep_balance(std::span<const CoveringStrip> strips) {
  double longest = 0.0, sum = 0.0, count = 0.0;
  for (const CoveringStrip& s : strips) {
    if (s.triangles.empty()) continue;
    longest = std::max(longest, s.length());
    sum += s.length();
    count += 1.0;
  }
  return sum > 0.0 ? longest * count / sum : 1.0;
}
}  // namespace surfleet
