// SPDX-License-Identifier: MIT
/// @file
/// @brief Regions of equal work: triangles pass from busy robots to idle neighbours.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/coverage/surface_regions.hpp>

namespace surfleet {
struct BalanceOptions {
  double tolerance = 0.01;  ///< Ends when no region exceeds the mean by more.
  int rounds = 400;
  std::size_t reach = 512;  ///< As in `VertexExchange`.
};

/// The work of sweeping each triangle: the mean step to its neighbours [m].
inline std::vector<double> sweep_work(const SurfaceRegions& regions) {
  std::vector<double> work(regions.region.size(), 0.0);
  for (std::size_t t = 0; t < work.size(); ++t) {
    const auto arcs = regions.dual->links.arcs(static_cast<std::int32_t>(t));
    for (const Arc& arc : arcs) work[t] += arc.length / static_cast<double>(arcs.size());
  }
  return work;
}

/// Evens out the work between neighbouring regions; each stays one piece and keeps its robot's
/// triangle. Returns the greatest load against the mean of its connected part of the surface.
///
/// Diffusion on the dual Delaunay graph: in each round a region gives every lighter neighbour a
/// share of the difference, border triangles first that lie closest to the neighbour's robot.
/// O(m log m) a round.
inline double balance_regions(SurfaceRegions& regions, const std::vector<double>& work,
                              const BalanceOptions& options = {}) {
  const std::size_t robots = regions.robots(), m = regions.region.size();
  require(work.size() == m, "balance: need the work of every triangle");
  const Graph& links = regions.dual->links;
  std::vector<double> load(robots, 0.0);
  for (std::size_t t = 0; t < m; ++t)
    if (regions.region[t] >= 0) load[static_cast<std::size_t>(regions.region[t])] += work[t];
  // The mean of a robot's part of the surface: work cannot pass between parts.
  std::vector<std::int32_t> part(robots);
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](std::int32_t i) {
    while (part[static_cast<std::size_t>(i)] != i) i = part[static_cast<std::size_t>(i)];
    return static_cast<std::size_t>(i);
  };
  for (const auto& [a, b] : dual_delaunay(links, regions.region))
    part[root(b)] = static_cast<std::int32_t>(root(a));
  std::vector<double> sum(robots, 0.0), count(robots, 0.0);
  for (std::size_t i = 0; i < robots; ++i) {
    if (regions.start[i] < 0) continue;
    sum[root(static_cast<std::int32_t>(i))] += load[i];
    count[root(static_cast<std::int32_t>(i))] += 1.0;
  }
  const auto excess = [&] {
    double worst = 1.0;
    for (std::size_t i = 0; i < robots; ++i) {
      const std::size_t r = root(static_cast<std::int32_t>(i));
      if (regions.start[i] >= 0 && sum[r] > 0.0)
        worst = std::max(worst, load[i] * count[r] / sum[r]);
    }
    return worst;
  };
  RemovalTest removable;
  std::vector<std::int32_t> best_region = regions.region;
  double best = excess();
  for (int round = 0; round < options.rounds && best > 1.0 + options.tolerance; ++round) {
    const auto neighbours = dual_delaunay(links, regions.region);
    std::vector<double> degree(robots, 0.0);
    for (const auto& [a, b] : neighbours) {
      degree[static_cast<std::size_t>(a)] += 1.0;
      degree[static_cast<std::size_t>(b)] += 1.0;
    }
    bool moved = false;
    for (auto [heavy, light] : neighbours) {
      if (load[static_cast<std::size_t>(heavy)] < load[static_cast<std::size_t>(light)])
        std::swap(heavy, light);
      const auto h = static_cast<std::size_t>(heavy), l = static_cast<std::size_t>(light);
      double quota = (load[h] - load[l]) / (1.0 + std::max(degree[h], degree[l]));
      const Point3& from = regions.dual->position[static_cast<std::size_t>(regions.start[h])];
      const Point3& to = regions.dual->position[static_cast<std::size_t>(regions.start[l])];
      std::vector<std::pair<double, std::int32_t>> offers;
      for (std::size_t t = 0; t < m; ++t) {
        if (regions.region[t] != heavy || regions.start[h] == static_cast<std::int32_t>(t))
          continue;
        int touching = 0;
        for (const Arc& arc : links.arcs(static_cast<std::int32_t>(t)))
          touching += regions.region[static_cast<std::size_t>(arc.to)] == light ? 1 : 0;
        if (touching == 0) continue;
        const Point3& p = regions.dual->position[t];
        offers.push_back({(p - to).norm() - (p - from).norm() - touching * work[t],
                          static_cast<std::int32_t>(t)});
      }
      std::sort(offers.begin(), offers.end());
      for (const auto& [rank, t] : offers) {
        const double w = work[static_cast<std::size_t>(t)];
        if (quota < 0.5 * w) break;
        if (!removable(links, regions.region, t, options.reach)) continue;
        regions.region[static_cast<std::size_t>(t)] = light;
        load[h] -= w;
        load[l] += w;
        quota -= w;
        moved = true;
      }
    }
    if (!moved) break;
    const double now = excess();
    if (now < best) {
      best = now;
      best_region = regions.region;
    }
  }
  regions.region = std::move(best_region);
  return best;
}
}  // namespace surfleet
