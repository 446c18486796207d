// SPDX-License-Identifier: MIT
/// @file
/// @brief Coordination by vertex substitution: robots also leap to where they are missed, so that
/// the final cost no longer depends on the start.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/p_median.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/coverage/wavefront_propagation.hpp>

namespace surfleet {
/// A few sites of a surface that stand for all, and the distances between them along it.
struct CoarseSurface {
  std::vector<std::int32_t> site;  ///< The chosen sites of the fine graph.
  std::vector<double> mass;        ///< Of the fine sites nearest to each.
  Graph graph;  ///< Between neighbours, by the shortest path from one to the other.
};

/// `count` of the kept sites, drawn at random, each with the mass of its Voronoi region, which
/// makes up for an uneven draw. O(n log n).
template <typename Keep>
CoarseSurface coarsen(const SurfaceGraph& graph, std::size_t count, const Keep& keep,
                      Random& random) {
  const std::size_t n = graph.size();
  CoarseSurface coarse;
  std::vector<std::int32_t> kept;
  for (std::size_t v = 0; v < n; ++v)
    if (keep(static_cast<std::int32_t>(v))) kept.push_back(static_cast<std::int32_t>(v));
  count = std::min(count, kept.size());
  random.shuffle(kept);
  kept.resize(count);
  std::sort(kept.begin(), kept.end());
  coarse.site = kept;
  const SurfacePartition p = voronoi_partition(graph, kept, keep);
  coarse.mass.assign(count, 0.0);
  std::vector<std::pair<std::pair<std::int32_t, std::int32_t>, double>> links;
  for (std::size_t v = 0; v < n; ++v) {
    if (p.region[v] < 0) continue;
    coarse.mass[static_cast<std::size_t>(p.region[v])] += graph.mass[v];
    for (const Arc& arc : graph.arcs(static_cast<std::int32_t>(v))) {
      const auto j = static_cast<std::size_t>(arc.to);
      if (p.region[j] > p.region[v])
        links.push_back({{p.region[v], p.region[j]}, p.distance[v] + arc.length + p.distance[j]});
    }
  }
  std::sort(links.begin(), links.end());
  std::vector<detail::Link> shortest;
  for (std::size_t k = 0; k < links.size(); ++k)
    if (k == 0 || links[k].first != links[k - 1].first)
      shortest.push_back({links[k].first.first, links[k].first.second, links[k].second});
  coarse.graph = detail::symmetric_graph(count, shortest);
  return coarse;
}

/// Deploys by p-median interchange, then wavefront propagation.
///
/// A step is one pass of swaps: each candidate site collects what the regions around it would
/// save, each robot knows what its region would lose without it, and the cheapest robot leaps to
/// the dearest site as long as that lowers the total. When no swap is left, `perturbations`
/// rounds send a few robots astray and keep what comes back cheaper; then every robot walks to
/// the centroid of its region. The cost never rises.
///
/// Up to `full` sites every site is a candidate and distances are exact; larger surfaces are
/// sampled first, `samples_per_robot` sites a robot.
struct VertexSubstitution {
  int perturbations = 40;
  std::size_t full = 1500;
  std::size_t samples_per_robot = 30;
  WavefrontPropagation walk{};

  void start(DeploymentState& state) {
    state.partition = state.partition_for(state.partition.generator);
    phase_ = Phase::kSwap;
    candidates_.clear();
    problem_.reset();
  }
  double cost(const DeploymentState& state) const { return walk.cost(state); }

  bool step(DeploymentState& state) {
    if (phase_ == Phase::kWalk) {
      const bool moved = walk.step(state);
      return moved;
    }
    if (problem_ == nullptr) prepare(state);
    // Robots' places among the candidates; a robot off them counts as on the nearest one.
    PMedianSolution solution(*problem_, places_of(state));
    if (phase_ == Phase::kSwap) {
      if (!substitution_pass(*problem_, solution)) phase_ = Phase::kEscape;
    }
    if (phase_ == Phase::kEscape) {
      search_medians(*problem_, solution, perturbations, state.random);
      phase_ = Phase::kWalk;
    }
    if (!adopt(state, solution.chosen())) phase_ = Phase::kWalk;
    return true;
  }

 private:
  enum class Phase { kSwap, kEscape, kWalk };

  void prepare(const DeploymentState& state) {
    const SurfaceGraph& graph = *state.graph;
    std::size_t kept = 0, robots = 0;
    for (std::size_t v = 0; v < graph.size(); ++v)
      kept += state.keep()(static_cast<std::int32_t>(v)) ? 1 : 0;
    for (const std::int32_t g : state.partition.generator) robots += g >= 0 ? 1 : 0;
    SurfaceGraph coarse;
    candidates_.clear();
    if (kept == graph.size() && kept <= full) {
      for (std::size_t v = 0; v < kept; ++v) candidates_.push_back(static_cast<std::int32_t>(v));
      problem_ = std::make_shared<PMedianProblem>(p_median_problem(graph, state.exponent));
      return;
    }
    Random random = state.random.fork(7);
    CoarseSurface sample =
        coarsen(graph, std::clamp(samples_per_robot * robots, std::size_t{300}, full), state.keep(),
                random);
    candidates_ = std::move(sample.site);
    coarse.mass = std::move(sample.mass);
    coarse.links = std::move(sample.graph);
    coarse.position.resize(candidates_.size());
    problem_ = std::make_shared<PMedianProblem>(p_median_problem(coarse, state.exponent));
  }

  std::vector<std::int32_t> places_of(const DeploymentState& state) const {
    std::vector<std::int32_t> places;
    std::vector<std::uint8_t> taken(candidates_.size(), 0);
    for (const std::int32_t g : state.partition.generator) {
      if (g < 0) continue;
      const Point3& here = state.graph->position[static_cast<std::size_t>(g)];
      double best = ShortestPaths::kUnreached;
      std::size_t at = 0;
      for (std::size_t k = 0; k < candidates_.size(); ++k) {
        const double d =
            (state.graph->position[static_cast<std::size_t>(candidates_[k])] - here).squaredNorm();
        if (taken[k] != 0 || d >= best) continue;
        best = d;
        at = k;
      }
      taken[at] = 1;
      places.push_back(static_cast<std::int32_t>(at));
    }
    return places;
  }

  /// Sends the robots to the chosen candidates if that is truly cheaper.
  bool adopt(DeploymentState& state, const std::vector<std::int32_t>& chosen) const {
    std::vector<std::int32_t> generators = state.partition.generator;
    std::size_t k = 0;
    for (std::int32_t& g : generators)
      if (g >= 0) g = candidates_[static_cast<std::size_t>(chosen[k++])];
    if (generators == state.partition.generator) return true;
    SurfacePartition next = state.partition_for(std::move(generators));
    if (!(partition_cost(*state.graph, next, state.exponent) < cost(state))) return false;
    state.partition = std::move(next);
    return true;
  }

  Phase phase_ = Phase::kSwap;
  std::vector<std::int32_t> candidates_;
  std::shared_ptr<const PMedianProblem> problem_;
};
static_assert(SurfaceCoordinator<VertexSubstitution>);
}  // namespace surfleet
