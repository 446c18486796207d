// SPDX-License-Identifier: MIT
/// @file
/// @brief Graph Voronoi partitions of a surface and their coverage cost [004 §3.3.1, eq. 6.4].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/geometry/graph.hpp>

namespace surfleet {
/// Which robot has which site. Robots are numbered; a robot without a site takes no part.
struct SurfacePartition {
  static constexpr std::int32_t kNone = -1;
  std::vector<std::int32_t> generator;   ///< Site of every robot, or `kNone`.
  std::vector<std::int32_t> region;      ///< Robot of every site, or `kNone`.
  std::vector<double> distance;          ///< From the own generator; infinite without a region.
  std::vector<std::int32_t> first_step;  ///< First site of the path there from the generator.

  std::size_t robots() const { return generator.size(); }
};

/// The sites of every robot's region, ascending. O(n).
inline std::vector<std::vector<std::int32_t>> region_sites(const SurfacePartition& partition) {
  std::vector<std::vector<std::int32_t>> sites(partition.robots());
  for (std::size_t v = 0; v < partition.region.size(); ++v)
    if (partition.region[v] >= 0)
      sites[static_cast<std::size_t>(partition.region[v])].push_back(static_cast<std::int32_t>(v));
  return sites;
}

/// H = Σ d(v, p)^p M(v) over the sites that have a region (eq. 6.4).
inline double partition_cost(const SurfaceGraph& graph, const SurfacePartition& partition,
                             double exponent = 2.0) {
  double sum = 0.0;
  for (std::size_t v = 0; v < partition.region.size(); ++v) {
    if (partition.region[v] < 0) continue;
    const double d = partition.distance[v];
    sum += (exponent == 2.0 ? d * d : std::pow(d, exponent)) * graph.mass[v];
  }
  return sum;
}

/// Whether every region is one piece on the surface. O(n + m).
inline bool regions_connected(const Graph& links, const std::vector<std::int32_t>& region) {
  std::vector<std::uint8_t> seen(region.size(), 0);
  std::set<std::int32_t> met;
  std::vector<std::int32_t> stack;
  for (std::size_t s = 0; s < region.size(); ++s) {
    if (region[s] < 0 || seen[s] != 0) continue;
    if (!met.insert(region[s]).second) return false;
    seen[s] = 1;
    stack.push_back(static_cast<std::int32_t>(s));
    while (!stack.empty()) {
      const std::int32_t v = stack.back();
      stack.pop_back();
      for (const Arc& arc : links.arcs(v)) {
        const auto j = static_cast<std::size_t>(arc.to);
        if (seen[j] != 0 || region[j] != region[s]) continue;
        seen[j] = 1;
        stack.push_back(arc.to);
      }
    }
  }
  return true;
}

/// The dual Delaunay graph: pairs of robots whose regions touch, lower first, sorted [004 §3.3.1].
inline std::vector<std::pair<std::int32_t, std::int32_t>> dual_delaunay(
    const Graph& links, const std::vector<std::int32_t>& region) {
  std::set<std::pair<std::int32_t, std::int32_t>> pairs;
  for (std::size_t v = 0; v < region.size(); ++v)
    for (const Arc& arc : links.arcs(static_cast<std::int32_t>(v))) {
      const std::int32_t other = region[static_cast<std::size_t>(arc.to)];
      if (region[v] >= 0 && other > region[v]) pairs.insert({region[v], other});
    }
  return {pairs.begin(), pairs.end()};
}

/// Asks whether a region stays in one piece without one of its sites.
class RemovalTest {
 public:
  /// True if the region of `site` without it is not empty and a path around it was found within
  /// `reach` sites. O(reach) at worst, a handful of sites as a rule.
  bool operator()(const Graph& links, const std::vector<std::int32_t>& region, std::int32_t site,
                  std::size_t reach) {
    const std::int32_t robot = region[static_cast<std::size_t>(site)];
    around_.clear();
    for (const Arc& arc : links.arcs(site))
      if (arc.to != site && region[static_cast<std::size_t>(arc.to)] == robot)
        around_.push_back(arc.to);
    if (around_.size() < 2) return around_.size() == 1;
    if (stamp_.size() != region.size() || ++epoch_ == 0) {
      stamp_.assign(region.size(), 0);
      epoch_ = 1;
    }
    queue_.assign(1, around_[0]);
    stamp_[static_cast<std::size_t>(site)] = stamp_[static_cast<std::size_t>(around_[0])] = epoch_;
    for (std::size_t k = 0; k < queue_.size() && k < reach; ++k) {
      for (const Arc& arc : links.arcs(queue_[k])) {
        const auto j = static_cast<std::size_t>(arc.to);
        if (region[j] != robot || stamp_[j] == epoch_) continue;
        stamp_[j] = epoch_;
        queue_.push_back(arc.to);
      }
      if (std::all_of(around_.begin(), around_.end(), [&](std::int32_t u) {
            return stamp_[static_cast<std::size_t>(u)] == epoch_;
          }))
        return true;
    }
    return false;
  }

 private:
  std::vector<std::uint32_t> stamp_;
  std::vector<std::int32_t> queue_, around_;
  std::uint32_t epoch_ = 0;
};

namespace detail {
/// Gives sites that hang on their region only by an arc across faces to a region they touch, at
/// the length of a path along links from that region's generator.
template <typename Keep>
void mend_regions(const SurfaceGraph& graph, SurfacePartition& partition, const Keep& keep) {
  const std::size_t n = graph.size();
  std::vector<std::uint8_t> firm(n, 0);
  std::vector<std::int32_t> stack;
  for (const std::int32_t g : partition.generator)
    if (g >= 0) {
      firm[static_cast<std::size_t>(g)] = 1;
      stack.push_back(g);
    }
  while (!stack.empty()) {
    const std::int32_t v = stack.back();
    stack.pop_back();
    for (const Arc& arc : graph.links.arcs(v)) {
      const auto j = static_cast<std::size_t>(arc.to);
      if (firm[j] != 0 || partition.region[j] != partition.region[static_cast<std::size_t>(v)])
        continue;
      firm[j] = 1;
      stack.push_back(arc.to);
    }
  }
  std::vector<std::uint8_t> loose(n, 0);
  std::vector<Source> sources;
  std::vector<std::int32_t> from(n, -1);
  for (std::size_t v = 0; v < n; ++v) {
    if (partition.region[v] < 0 || firm[v] != 0) continue;
    loose[v] = 1;
    Source best{static_cast<std::int32_t>(v), ShortestPaths::kUnreached};
    for (const Arc& arc : graph.links.arcs(best.first)) {
      const auto j = static_cast<std::size_t>(arc.to);
      if (firm[j] == 0 || partition.distance[j] + arc.length >= best.second) continue;
      best.second = partition.distance[j] + arc.length;
      from[v] = arc.to;
    }
    if (from[v] >= 0) sources.push_back(best);
  }
  if (sources.empty()) return;
  const auto inside = [&](std::int32_t v) {
    return loose[static_cast<std::size_t>(v)] != 0 && keep(v);
  };
  std::vector<std::int32_t> order;
  const auto paths = shortest_paths(Restricted(graph.links, inside), std::span(sources),
                                    NoHeuristic{}, [&](std::int32_t v, double) {
                                      order.push_back(v);
                                      return false;
                                    });
  for (const std::int32_t v : order) {
    const auto i = static_cast<std::size_t>(v);
    const auto u = static_cast<std::size_t>(paths.previous[i] >= 0 ? paths.previous[i] : from[i]);
    const std::int32_t robot = partition.region[u];
    partition.region[i] = robot;
    partition.distance[i] = paths.distance[i];
    partition.first_step[i] =
        static_cast<std::int32_t>(u) == partition.generator[static_cast<std::size_t>(robot)]
            ? v
            : partition.first_step[u];
  }
}
}  // namespace detail

/// Every kept site to the robot whose generator is nearest along the surface, ties to the lower
/// robot (eq. 3.10).
///
/// With distances along links the regions are connected by themselves; with distances across
/// faces a few sites may be given to the second-nearest robot to make them so. Sites that no
/// robot can reach stay without a region. Throws `Error` if two robots share a site. O(n log n).
template <typename Keep = KeepAll>
SurfacePartition voronoi_partition(const SurfaceGraph& graph, std::vector<std::int32_t> generators,
                                   const Keep& keep = {}) {
  const std::size_t n = graph.size();
  SurfacePartition partition{
      std::move(generators), std::vector<std::int32_t>(n, SurfacePartition::kNone),
      std::vector<double>(n, ShortestPaths::kUnreached), std::vector<std::int32_t>(n, -1)};
  std::vector<std::int32_t> owner(n, -1);
  std::vector<Source> sources;
  for (std::size_t i = 0; i < partition.generator.size(); ++i) {
    const std::int32_t g = partition.generator[i];
    if (g < 0) continue;
    require(static_cast<std::size_t>(g) < n,
            "partition: a robot stands on a site that is not there");
    std::int32_t& robot = owner[static_cast<std::size_t>(g)];
    require(robot < 0, "partition: two robots stand on the same site");
    robot = static_cast<std::int32_t>(i);
    sources.push_back({g, 0.0});
  }
  const auto label = [&](const auto& arcs_of) {
    return [&](std::int32_t v, double d) {
      const auto i = static_cast<std::size_t>(v);
      std::int32_t robot = owner[i], step = v;
      if (robot < 0) {
        for (const auto& arc : arcs_of.arcs(v)) {
          const auto u = static_cast<std::size_t>(arc.to);
          const std::int32_t theirs = partition.region[u];
          if (theirs < 0 || (robot >= 0 && theirs >= robot)) continue;
          if (partition.distance[u] + arc.length != d) continue;
          robot = theirs;
          step = owner[u] >= 0 ? v : partition.first_step[u];
        }
      }
      partition.region[i] = robot;
      partition.distance[i] = d;
      partition.first_step[i] = step;
      return false;
    };
  };
  if constexpr (std::same_as<Keep, KeepAll>) {
    const Graph& all = graph.distance_graph();
    shortest_paths(all, std::span<const Source>(sources), NoHeuristic{}, label(all));
  } else {
    const Restricted kept(graph.distance_graph(), keep);
    shortest_paths(kept, std::span<const Source>(sources), NoHeuristic{}, label(kept));
  }
  if (graph.across.size() > 0) detail::mend_regions(graph, partition, keep);
  return partition;
}

/// h(site, V): what the region of `robot` would cost with the robot at `site` of it, walking
/// inside the region only. Infinite if a part of the region cannot be reached.
inline double region_cost_at(const SurfaceGraph& graph, const SurfacePartition& partition,
                             std::int32_t robot, std::int32_t site, double exponent = 2.0) {
  std::size_t wanted = 0, reached = 0;
  for (const std::int32_t r : partition.region) wanted += r == robot ? 1 : 0;
  const auto inside = [&](std::int32_t v) {
    return partition.region[static_cast<std::size_t>(v)] == robot;
  };
  double sum = 0.0;
  const Source source{site, 0.0};
  shortest_paths(Restricted(graph.distance_graph(), inside), std::span<const Source>(&source, 1),
                 NoHeuristic{}, [&](std::int32_t v, double d) {
                   sum += (exponent == 2.0 ? d * d : std::pow(d, exponent)) *
                          graph.mass[static_cast<std::size_t>(v)];
                   return ++reached == wanted;
                 });
  return reached == wanted ? sum : ShortestPaths::kUnreached;
}

/// Eq. 6.4 for robots at `generators`, whatever coordinator brought them there.
inline double surface_cost(const SurfaceGraph& graph, std::vector<std::int32_t> generators,
                           double exponent = 2.0) {
  return partition_cost(graph, voronoi_partition(graph, std::move(generators)), exponent);
}
}  // namespace surfleet
