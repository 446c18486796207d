// SPDX-License-Identifier: MIT
/// @file
/// @brief Coordination by wavefront propagation [004 Alg. 7]: each robot finds its own Voronoi
/// region by a wave with back propagation and steps towards the region's centroid.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/surface_partition.hpp>

namespace surfleet {
/// Where a deployment stands: what a coordinator reads and changes.
struct DeploymentState {
  const SurfaceGraph* graph = nullptr;
  std::vector<std::uint8_t> known;  ///< Sites that take part; empty: all.
  SurfacePartition partition;
  double exponent = 2.0;      ///< p of the cost.
  bool asynchronous = false;  ///< One robot a step, in a random order, instead of all.
  Random random{1};
  std::vector<std::int32_t> turns;  ///< Robots still to act in this asynchronous round.

  KeepMarked keep() const { return {&known}; }
  /// The robots that act in this step.
  std::vector<std::int32_t> actors() {
    if (!asynchronous || turns.empty()) {
      turns.clear();
      for (std::size_t i = 0; i < partition.robots(); ++i)
        if (partition.generator[i] >= 0) turns.push_back(static_cast<std::int32_t>(i));
      if (asynchronous) random.shuffle(turns);
    }
    if (!asynchronous) return std::exchange(turns, {});
    if (turns.empty()) return {};
    const std::int32_t robot = turns.back();
    turns.pop_back();
    return {robot};
  }
  /// The partition for other generators on the known sites.
  SurfacePartition partition_for(std::vector<std::int32_t> generators) const {
    if (known.empty()) return voronoi_partition(*graph, std::move(generators));
    return voronoi_partition(*graph, std::move(generators), keep());
  }
};

/// What deploys the robots: `start(state)` once, then `step(state)` until it returns false for
/// every robot in turn; `cost(state)` is what it brings down.
template <typename C>
concept SurfaceCoordinator = requires(C c, DeploymentState& state) {
  c.start(state);
  { c.step(state) } -> std::convertible_to<bool>;
  { c.cost(state) } -> std::convertible_to<double>;
};

/// What one robot knows after its wave has run out.
struct WavefrontRegion {
  std::vector<std::int32_t> sites;  ///< In the order of their distance.
  std::size_t visited = 0;          ///< Sites the wave passed, own or not.
  bool aborted = false;             ///< Ended by eq. 6.17, not for want of sites.
};

/// The Voronoi region of `robot`, found from its own site and its neighbours' positions alone.
///
/// The wave spreads from the robot's site. Where it meets another robot a back propagation runs
/// from there over the visited sites and corrects the label of those that are closer to the
/// other; sites visited later are corrected as they come. The wave ends once half its radius
/// exceeds the farthest own site (eq. 6.17) and no own site has an unvisited neighbour. O(k log k)
/// for k visited sites, plus O(n) memory.
template <typename Keep = KeepAll>
WavefrontRegion propagate_wavefront(const SurfaceGraph& graph,
                                    std::span<const std::int32_t> generators, std::int32_t robot,
                                    const Keep& keep = {}) {
  const std::size_t n = graph.size();
  constexpr double kFar = ShortestPaths::kUnreached;
  std::vector<double> own(n, kFar), other(n, kFar);
  std::vector<std::int32_t> owner(n, -1), other_id(n, std::numeric_limits<std::int32_t>::max());
  for (std::size_t i = 0; i < generators.size(); ++i)
    if (generators[i] >= 0) owner[static_cast<std::size_t>(generators[i])] = static_cast<int>(i);
  const Restricted kept(graph.distance_graph(), keep);
  std::vector<std::int32_t> visited;
  std::deque<std::int32_t> work;
  const auto lost = [&](std::size_t v) {
    return other[v] < own[v] || (other[v] == own[v] && other_id[v] < robot);
  };
  const auto offer = [&](std::int32_t v, double d, std::int32_t id) {
    const auto i = static_cast<std::size_t>(v);
    if (d > other[i] || (d == other[i] && id >= other_id[i])) return;
    other[i] = d;
    other_id[i] = id;
    if (lost(i)) work.push_back(v);
  };
  double checked = 0.0;
  WavefrontRegion result;
  const Source source{generators[static_cast<std::size_t>(robot)], 0.0};
  shortest_paths(
      kept, std::span<const Source>(&source, 1), NoHeuristic{}, [&](std::int32_t v, double d) {
        const auto i = static_cast<std::size_t>(v);
        own[i] = d;
        visited.push_back(v);
        if (owner[i] >= 0 && owner[i] != robot) offer(v, 0.0, owner[i]);
        for (const auto& arc : kept.arcs(v)) {
          const auto u = static_cast<std::size_t>(arc.to);
          if (own[u] < kFar && lost(u)) offer(v, other[u] + arc.length, other_id[u]);
        }
        while (!work.empty()) {  // back propagation by label correction
          const std::int32_t u = work.front();
          work.pop_front();
          for (const auto& arc : kept.arcs(u))
            if (own[static_cast<std::size_t>(arc.to)] < kFar)
              offer(arc.to, other[static_cast<std::size_t>(u)] + arc.length,
                    other_id[static_cast<std::size_t>(u)]);
        }
        if (d <= 1.05 * checked) return false;
        checked = d;
        double farthest = 0.0;
        for (const std::int32_t u : visited)
          if (!lost(static_cast<std::size_t>(u)))
            farthest = std::max(farthest, own[static_cast<std::size_t>(u)]);
        if (!(d / 2.0 > farthest)) return false;
        // A region as small as its robot's site must not miss an unvisited neighbour.
        result.aborted = std::all_of(visited.begin(), visited.end(), [&](std::int32_t u) {
          if (lost(static_cast<std::size_t>(u))) return true;
          for (const auto& arc : kept.arcs(u))
            if (!(own[static_cast<std::size_t>(arc.to)] < kFar)) return false;
          return true;
        });
        return result.aborted;
      });
  result.visited = visited.size();
  for (const std::int32_t v : visited)
    if (!lost(static_cast<std::size_t>(v))) result.sites.push_back(v);
  return result;
}

/// Where a robot should step: one value per site of its one ring, the best first.
template <typename G>
concept GoalDirection = requires(const G& rule, const DeploymentState& state, std::int32_t robot) {
  { rule(state, robot) } -> std::convertible_to<std::vector<std::int32_t>>;
};

namespace detail {
/// The ring sites of the robot's own region, by falling cosine to `direction`.
inline std::vector<std::int32_t> ring_along(const DeploymentState& state, std::int32_t robot,
                                            const Eigen::Vector3d& direction) {
  const SurfacePartition& p = state.partition;
  const std::int32_t at = p.generator[static_cast<std::size_t>(robot)];
  const Point3& here = state.graph->position[static_cast<std::size_t>(at)];
  std::vector<std::pair<double, std::int32_t>> ring;
  for (const Arc& arc : state.graph->arcs(at)) {
    const auto j = static_cast<std::size_t>(arc.to);
    if (p.region[j] != robot) continue;
    const Eigen::Vector3d w = (state.graph->position[j] - here).stableNormalized();
    const double cosine = w.dot(direction);
    if (cosine > 0.0) ring.push_back({-cosine, arc.to});
  }
  std::sort(ring.begin(), ring.end());
  std::vector<std::int32_t> best;
  for (const auto& [minus, v] : ring) best.push_back(v);
  return best;
}
}  // namespace detail

/// Eq. 6.16: z = Σ p d^(p−1) ŵ M over the region, ŵ the first piece of the path to each site.
struct GeodesicGradient {
  std::vector<std::int32_t> operator()(const DeploymentState& state, std::int32_t robot) const {
    const SurfacePartition& p = state.partition;
    const std::int32_t at = p.generator[static_cast<std::size_t>(robot)];
    const Point3& here = state.graph->position[static_cast<std::size_t>(at)];
    Eigen::Vector3d z = Eigen::Vector3d::Zero();
    for (std::size_t v = 0; v < p.region.size(); ++v) {
      if (p.region[v] != robot || static_cast<std::int32_t>(v) == at) continue;
      const auto step = static_cast<std::size_t>(p.first_step[v]);
      const double pull =
          state.exponent == 2.0 ? p.distance[v] : std::pow(p.distance[v], state.exponent - 1.0);
      z += pull * state.graph->mass[v] * (state.graph->position[step] - here).stableNormalized();
    }
    return detail::ring_along(state, robot, z);
  }
};

/// Eq. 6.8: a least-squares gradient of the region's cost over the one ring.
struct LeastSquaresGradient {
  std::vector<std::int32_t> operator()(const DeploymentState& state, std::int32_t robot) const {
    const SurfacePartition& p = state.partition;
    const std::int32_t at = p.generator[static_cast<std::size_t>(robot)];
    const Point3& here = state.graph->position[static_cast<std::size_t>(at)];
    const double now = region_cost_at(*state.graph, p, robot, at, state.exponent);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Arc& arc : state.graph->links.arcs(at)) {
      const auto j = static_cast<std::size_t>(arc.to);
      if (p.region[j] != robot) continue;
      const Eigen::Vector3d edge = state.graph->position[j] - here;
      const double length = edge.norm();
      const double there = region_cost_at(*state.graph, p, robot, arc.to, state.exponent);
      if (!(length > 0.0) || !(there < ShortestPaths::kUnreached)) continue;
      const Eigen::Vector3d unit = edge / length;
      normal += unit * unit.transpose();
      right += unit * ((there - now) / length);
    }
    // A little of the identity stands for the pseudo-inverse: the ring is nearly flat.
    normal.diagonal().array() += 1e-9 * normal.trace() + 1e-300;
    return detail::ring_along(state, robot, -(normal.inverse() * right));
  }
};

/// The ring site that most path length leads over, the text's substitute for eq. 6.16 on regular
/// meshes: it needs no positions.
struct RingWeights {
  std::vector<std::int32_t> operator()(const DeploymentState& state, std::int32_t robot) const {
    const SurfacePartition& p = state.partition;
    const std::int32_t at = p.generator[static_cast<std::size_t>(robot)];
    std::vector<std::pair<double, std::int32_t>> weight;
    for (const Arc& arc : state.graph->arcs(at))
      if (p.region[static_cast<std::size_t>(arc.to)] == robot) weight.push_back({0.0, arc.to});
    for (std::size_t v = 0; v < p.region.size(); ++v) {
      if (p.region[v] != robot || static_cast<std::int32_t>(v) == at) continue;
      for (auto& [sum, site] : weight)
        if (site == p.first_step[v]) sum -= p.distance[v] * state.graph->mass[v];
    }
    std::sort(weight.begin(), weight.end());
    std::vector<std::int32_t> best;
    for (const auto& [minus, v] : weight) best.push_back(v);
    return best;
  }
};
static_assert(GoalDirection<GeodesicGradient> && GoalDirection<LeastSquaresGradient> &&
              GoalDirection<RingWeights>);

/// Alg. 7 as a coordinator. A robot moves only where that lowers the cost of its own region, so
/// the total cost never rises. O(n log n) a synchronous step.
template <GoalDirection Direction>
struct BasicWavefrontPropagation {
  Direction direction{};
  int tries = 3;  ///< Ring sites tried, best direction first, before a robot stays.

  void start(DeploymentState& state) {
    state.partition = state.partition_for(state.partition.generator);
  }

  double cost(const DeploymentState& state) const {
    return partition_cost(*state.graph, state.partition, state.exponent);
  }

  /// The ring site to which `robot` should go, if there is a better one than where it is.
  std::optional<std::int32_t> goal(const DeploymentState& state, std::int32_t robot) const {
    const SurfacePartition& p = state.partition;
    double now = 0.0;
    for (std::size_t v = 0; v < p.region.size(); ++v)
      if (p.region[v] == robot)
        now += (state.exponent == 2.0 ? p.distance[v] * p.distance[v]
                                      : std::pow(p.distance[v], state.exponent)) *
               state.graph->mass[v];
    int left = tries;
    for (const std::int32_t site : direction(state, robot)) {
      if (left-- == 0) break;
      const double then = region_cost_at(*state.graph, p, robot, site, state.exponent);
      if (then < now * (1.0 - 1e-12)) return site;
    }
    return std::nullopt;
  }

  bool step(DeploymentState& state) {
    std::vector<std::pair<std::size_t, std::int32_t>> moves;
    for (const std::int32_t robot : state.actors())
      if (const auto site = goal(state, robot))
        moves.push_back({static_cast<std::size_t>(robot), *site});
    if (moves.empty()) return false;
    const double before = cost(state);
    const auto attempt = [&](std::span<const std::pair<std::size_t, std::int32_t>> list) {
      std::vector<std::int32_t> generators = state.partition.generator;
      for (const auto& [robot, site] : list) generators[robot] = site;
      SurfacePartition next = state.partition_for(std::move(generators));
      if (!(partition_cost(*state.graph, next, state.exponent) < before)) return false;
      state.partition = std::move(next);
      return true;
    };
    if (attempt(moves)) return true;
    // Only mended regions (distances across faces) or rounding come here: one robot at a time.
    for (const auto& move : moves)
      if (attempt(std::span(&move, 1))) return true;
    return false;
  }
};
using WavefrontPropagation = BasicWavefrontPropagation<GeodesicGradient>;
static_assert(SurfaceCoordinator<WavefrontPropagation>);
}  // namespace surfleet
