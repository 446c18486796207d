// SPDX-License-Identifier: MIT
/// @file
/// @brief Hybrid area coverage of a surface [004 Alg. 9]: deploy, sweep, lock what is covered,
/// relocate, and again until nothing is left. Robots may fail or join meanwhile.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/coverage/balance_regions.hpp>
#include <surfleet/coverage/covering_strip.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/coverage/surface_regions.hpp>
#include <surfleet/coverage/vertex_exchange.hpp>

namespace surfleet {
/// A change of the group before an iteration, or in the middle of its sweep.
struct RobotEvent {
  std::size_t iteration = 0;
  std::int32_t robot = -1;    ///< The robot that fails half-way through its sweep; −1: one joins.
  std::int32_t triangle = 0;  ///< Where it joins.
};

struct HybridSurfaceOptions {
  double sweep_range = std::numeric_limits<double>::infinity();  ///< Path of one sweep [m].
  bool balance = true;        ///< Even out the regions before the sweep.
  double unknown_cost = 3.0;  ///< Relocation weighs uncovered ground so much above covered.
  std::size_t deploy_steps = 2000;
  std::size_t iterations = 1000;
  std::uint64_t seed = 1;
  MetricField field;
  std::vector<RobotEvent> events;
  CoveringStripOptions strip;
};

/// One round of deployment, sweep and relocation.
struct HybridSurfaceIteration {
  SurfaceRegions regions;  ///< −1 where the surface was already covered or had no robot.
  std::vector<CoveringStrip> strips;           ///< As far as they were driven.
  std::vector<std::vector<Point3>> transfers;  ///< How each robot came to its region's start.
  std::vector<double> transfer_length;         ///< [m]
  double covered = 0.0;                        ///< Share of the area after the sweep.
};

struct HybridSurfaceCoverage {
  std::vector<HybridSurfaceIteration> iterations;
  std::vector<double> swept_length, transfer_length;  ///< A robot, over all iterations [m].
  double covered = 0.0;
  bool complete = false;  ///< Everything is swept; otherwise no robot was left to do it.

  /// The longest sweep against the mean of the robots that swept.
  double balance() const {
    double longest = 0.0, sum = 0.0, count = 0.0;
    for (const double l : swept_length) {
      if (!(l > 0.0)) continue;
      longest = std::max(longest, l);
      sum += l;
      count += 1.0;
    }
    return sum > 0.0 ? longest * count / sum : 1.0;
  }
};

namespace detail {
/// Up to one spread site for every robot on the open parts of a surface: parts by area, at least
/// one robot each from the largest down.
inline std::vector<std::int32_t> spread_sites(const SurfaceGraph& graph,
                                              const std::vector<std::uint8_t>& open,
                                              std::size_t robots, std::int32_t near) {
  const KeepMarked keep{&open};
  const auto part = connected_components(graph.links, keep);
  std::vector<double> area;
  std::vector<std::size_t> sites;
  for (std::size_t t = 0; t < part.size(); ++t) {
    if (part[t] < 0) continue;
    area.resize(std::max(area.size(), static_cast<std::size_t>(part[t]) + 1), 0.0);
    sites.resize(area.size(), 0);
    area[static_cast<std::size_t>(part[t])] += graph.area[t];
    ++sites[static_cast<std::size_t>(part[t])];
  }
  std::vector<std::size_t> share(area.size(), 0);
  for (std::size_t r = 0; r < robots; ++r) {
    std::size_t neediest = area.size();
    double most = -1.0;
    for (std::size_t c = 0; c < area.size(); ++c) {
      if (share[c] >= sites[c]) continue;
      const double need = area[c] / static_cast<double>(share[c] + 1) +
                          (share[c] == 0 ? 1e6 * area[c] + 1e-9 : 0.0);
      if (need <= most) continue;
      most = need;
      neediest = c;
    }
    if (neediest == area.size()) break;
    ++share[neediest];
  }
  std::vector<std::int32_t> chosen;
  for (std::size_t c = 0; c < area.size(); ++c) {
    std::vector<double> gap(graph.size(), ShortestPaths::kUnreached);
    for (std::size_t k = 0; k < share[c]; ++k) {
      std::int32_t best = -1;
      double value = -1.0;
      for (std::size_t t = 0; t < part.size(); ++t) {
        if (part[t] != static_cast<std::int32_t>(c)) continue;
        // The first lies nearest to the robots, each further one farthest from the others.
        const double d =
            k == 0
                ? 1.0 /
                      (1e-9 +
                       (graph.position[t] - graph.position[static_cast<std::size_t>(near)]).norm())
                : gap[t];
        if (d <= value) continue;
        value = d;
        best = static_cast<std::int32_t>(t);
      }
      chosen.push_back(best);
      const Source source{best, 0.0};
      const auto paths =
          shortest_paths(Restricted(graph.links, keep), std::span<const Source>(&source, 1));
      for (std::size_t t = 0; t < part.size(); ++t) gap[t] = std::min(gap[t], paths.distance[t]);
    }
  }
  return chosen;
}
/// The links of a surface, those that lead onto `open` ground `open_cost` times as long.
inline Graph weighted_ground(const SurfaceGraph& graph, const std::vector<std::uint8_t>& open,
                             double open_cost) {
  std::vector<std::pair<std::int32_t, Arc>> links;
  for (std::size_t t = 0; t < graph.size(); ++t)
    for (const Arc& arc : graph.links.arcs(static_cast<std::int32_t>(t)))
      links.push_back(
          {static_cast<std::int32_t>(t),
           {arc.to, arc.length * (open[static_cast<std::size_t>(arc.to)] != 0 ? open_cost : 1.0)}});
  return Graph(graph.size(), links);
}
}  // namespace detail

/// Sweeps a whole surface with robots that start on `robots`, distinct triangles of `mesh`.
///
/// Every iteration lets `coordinator` deploy the robots over what is not yet covered, evens out
/// their regions, and sweeps each by one covering strip up to `sweep_range`; swept triangles are
/// locked. Robots then relocate, over covered ground where they can, to what is left. Throws
/// `Error` as `SurfaceCoverage` does. `progress(covered)` is called after each iteration.
template <SurfaceCoordinator Coordinator = VertexExchange>
HybridSurfaceCoverage hybrid_area_coverage(const TriangleMesh& mesh,
                                           std::vector<std::int32_t> robots,
                                           const HybridSurfaceOptions& options = {},
                                           Coordinator coordinator = {},
                                           const std::function<void(double)>& progress = {}) {
  const auto shared = std::make_shared<const TriangleMesh>(mesh);
  const auto graph =
      std::make_shared<const SurfaceGraph>(DualMeshGraph{}(*shared, EdgeGeodesic{}, options.field));
  const std::size_t m = mesh.triangles.size();
  require(!robots.empty(), "robots: need at least one");
  require(robots.size() <= m, "robots: more than triangles; at most one a triangle");
  require(options.sweep_range > 0.0, "hybrid coverage: the sweep range must be positive");
  require(options.unknown_cost >= 1.0 && std::isfinite(options.unknown_cost),
          "hybrid coverage: expected an unknown cost of 1 or more");
  for (std::size_t i = 0; i < robots.size(); ++i) {
    require(robots[i] >= 0 && static_cast<std::size_t>(robots[i]) < m,
            "robots: a triangle that is not on the surface");
    for (std::size_t j = 0; j < i; ++j)
      require(robots[i] != robots[j], "robots: two stand on the same triangle");
  }
  const auto component = connected_components(graph->links);
  std::vector<std::uint8_t> open(m, 1), alive(robots.size(), 1);
  double total = 0.0, swept = 0.0;
  for (const double a : graph->area) total += a;
  HybridSurfaceCoverage result;
  result.swept_length.assign(robots.size(), 0.0);
  result.transfer_length.assign(robots.size(), 0.0);

  for (std::size_t round = 0; round < options.iterations; ++round) {
    std::vector<std::int32_t> failing;
    for (const RobotEvent& event : options.events) {
      if (event.iteration != round) continue;
      if (event.robot >= 0) {
        failing.push_back(event.robot);
        continue;
      }
      require(event.triangle >= 0 && static_cast<std::size_t>(event.triangle) < m,
              "hybrid coverage: a robot joins on a triangle that is not there");
      robots.push_back(event.triangle);
      alive.push_back(1);
      result.swept_length.push_back(0.0);
      result.transfer_length.push_back(0.0);
    }
    // Only parts that some robot stands on can be covered.
    std::vector<std::uint8_t> within(m, 0);
    std::size_t left = 0;
    for (std::size_t t = 0; t < m; ++t) {
      for (std::size_t i = 0; i < robots.size() && within[t] == 0; ++i)
        within[t] = alive[i] != 0 && open[t] != 0 &&
                            component[static_cast<std::size_t>(robots[i])] == component[t]
                        ? 1
                        : 0;
      left += within[t];
    }
    if (left == 0) break;

    HybridSurfaceIteration iteration;
    iteration.transfers.resize(robots.size());
    iteration.transfer_length.assign(robots.size(), 0.0);
    // Robots on covered ground, or standing where another does, relocate; the others stay.
    std::vector<std::int32_t> target(robots.size(), -1);
    std::vector<std::size_t> searching;
    std::vector<std::uint8_t> taken(m, 0);
    const Graph ground = detail::weighted_ground(*graph, open, options.unknown_cost);
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (alive[i] == 0) continue;
      const auto t = static_cast<std::size_t>(robots[i]);
      if (round == 0 && taken[t] == 0) {
        target[i] = robots[i];
        taken[t] = 1;
      } else {
        searching.push_back(i);
      }
    }
    if (!searching.empty()) {
      std::vector<std::uint8_t> free = within;
      for (std::size_t t = 0; t < m; ++t)
        if (taken[t] != 0) free[t] = 0;
      const auto sites = detail::spread_sites(*graph, free, searching.size(), robots[searching[0]]);
      struct Trip {
        double length;
        std::size_t robot, site;
      };
      std::vector<Trip> trips;
      std::vector<ShortestPaths> trees;
      for (std::size_t k = 0; k < searching.size(); ++k) {
        trees.push_back(shortest_paths(ground, robots[searching[k]]));
        for (std::size_t s = 0; s < sites.size(); ++s)
          if (trees[k].reached(sites[s]))
            trips.push_back({trees[k].distance[static_cast<std::size_t>(sites[s])], k, s});
      }
      std::sort(trips.begin(), trips.end(), [](const Trip& a, const Trip& b) {
        return std::tie(a.length, a.robot, a.site) < std::tie(b.length, b.robot, b.site);
      });
      std::vector<std::uint8_t> used(sites.size(), 0);
      for (const Trip& trip : trips) {
        const std::size_t i = searching[trip.robot];
        if (target[i] >= 0 || used[trip.site] != 0) continue;
        used[trip.site] = 1;
        target[i] = sites[trip.site];
      }
    }

    DeploymentState state;
    state.graph = graph.get();
    state.known = within;
    state.random = Random(options.seed).fork(round);
    state.partition.generator = target;
    Coordinator deploy = coordinator;
    deploy.start(state);
    for (std::size_t k = 0; k < options.deploy_steps && deploy.step(state); ++k) {
    }
    SurfaceRegions& regions = iteration.regions;
    regions.mesh = shared;
    regions.dual = graph;
    regions.region = state.partition.region;
    regions.start = state.partition.generator;
    if (options.balance) balance_regions(regions, sweep_work(regions));

    iteration.strips.resize(robots.size());
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (regions.start[i] < 0) continue;
      const std::int32_t goal = regions.start[i];
      const Source source{robots[i], 0.0};
      const auto tree = shortest_paths(ground, std::span<const Source>(&source, 1), NoHeuristic{},
                                       [&](std::int32_t t, double) { return t == goal; });
      const std::vector<std::int32_t> cells = tree.path(goal);
      for (const std::int32_t t : cells)
        iteration.transfers[i].push_back(graph->position[static_cast<std::size_t>(t)]);
      for (std::size_t k = 1; k < cells.size(); ++k)
        for (const Arc& arc : graph->links.arcs(cells[k - 1]))
          if (arc.to == cells[k]) {
            iteration.transfer_length[i] += arc.length;
            break;
          }
      CoveringStrip strip =
          covering_strip(*shared, graph->links, regions.triangles(i), goal, options.strip);
      const bool fails =
          std::find(failing.begin(), failing.end(), static_cast<int>(i)) != failing.end();
      const double range = std::min(options.sweep_range, strip.length()) * (fails ? 0.5 : 1.0);
      std::size_t driven = 1;
      while (driven < strip.triangles.size() && strip.travelled[driven] <= range * (1.0 + 1e-12))
        ++driven;
      strip.triangles.resize(driven);
      strip.travelled.resize(driven);
      strip.path.resize(2 * driven - 1);
      for (const std::int32_t t : strip.triangles) {
        std::uint8_t& mark = open[static_cast<std::size_t>(t)];
        if (mark != 0) swept += graph->area[static_cast<std::size_t>(t)];
        mark = 0;
      }
      result.swept_length[i] += strip.length();
      result.transfer_length[i] += iteration.transfer_length[i];
      robots[i] = strip.triangles.back();
      if (fails) alive[i] = 0;
      iteration.strips[i] = std::move(strip);
    }
    iteration.covered = total > 0.0 ? swept / total : 1.0;
    result.iterations.push_back(std::move(iteration));
    if (progress) progress(result.iterations.back().covered);
  }
  result.complete = std::find(open.begin(), open.end(), 1) == open.end();
  result.covered = result.complete ? 1.0 : (total > 0.0 ? swept / total : 1.0);
  return result;
}
}  // namespace surfleet
