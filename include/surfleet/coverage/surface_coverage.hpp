// SPDX-License-Identifier: MIT
/// @file
/// @brief Voronoi coverage on a curved surface [004 Alg. 6].
///
/// @code
/// SurfaceCoverage<MeshGraph, GeodesicDistance, WavefrontPropagation> cover{mesh, robots};
/// while (!cover.converged()) cover.step();
/// const auto sweeps = covering_strips(cover.regions());
/// @endcode
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/metric_field.hpp>
#include <surfleet/coverage/surface_maps.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/coverage/surface_regions.hpp>
#include <surfleet/coverage/vertex_exchange.hpp>
#include <surfleet/coverage/vertex_substitution.hpp>
#include <surfleet/coverage/wavefront_propagation.hpp>

namespace surfleet {
struct SurfaceCoverageOptions {
  MetricField field;          ///< Density and metric per vertex; empty: uniform.
  double exponent = 2.0;      ///< p of the cost d^p.
  bool asynchronous = false;  ///< One robot a step, in a random order.
  std::uint64_t seed = 1;
  double sensing_range = std::numeric_limits<double>::infinity();  ///< [m]; finite: unknown mesh.
  double communication_range = std::numeric_limits<double>::infinity();  ///< [m]
  /// Farthest that a robot may stand off the surface [m]; nothing: one mean edge.
  std::optional<double> snap{};
  bool allow_unreached = false;  ///< Leave parts without a robot uncovered instead of refusing.
};

/// Robots' starts drawn at random from a surface's sites, apart from each other, at least one on
/// every connected part while there are enough. Throws `Error` if there are more robots than
/// sites.
inline std::vector<std::int32_t> random_robot_sites(const SurfaceGraph& graph, std::size_t robots,
                                                    std::uint64_t seed) {
  require(robots >= 1, "robots: need at least one");
  require(robots <= graph.size(), "robots: " + std::to_string(robots) + " on a surface of " +
                                      std::to_string(graph.size()) + " sites; at most one a site");
  Random random(seed);
  std::vector<std::int32_t> order(graph.size()), chosen;
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = static_cast<std::int32_t>(v);
  random.shuffle(order);
  const auto part = connected_components(graph.links);
  std::vector<std::uint8_t> served(graph.size(), 0), taken(graph.size(), 0);
  for (const std::int32_t v : order) {
    std::uint8_t& has = served[static_cast<std::size_t>(part[static_cast<std::size_t>(v)])];
    if (has != 0 || chosen.size() == robots) continue;
    has = taken[static_cast<std::size_t>(v)] = 1;
    chosen.push_back(v);
  }
  for (const std::int32_t v : order)
    if (chosen.size() < robots && taken[static_cast<std::size_t>(v)] == 0) chosen.push_back(v);
  return chosen;
}

/// The deployment of a group of robots over a mesh, step by step.
///
/// `Surface` reads the mesh as sites, `Distance` measures between them, `Coordinator` moves the
/// robots. On an unknown mesh each team of robots that share a map coordinates on that map.
template <SurfaceModel Surface = MeshGraph, GeodesicPolicy Distance = GeodesicDistance,
          SurfaceCoordinator Coordinator = WavefrontPropagation>
class SurfaceCoverage {
 public:
  Coordinator coordinator;

  /// Robots at points [m] on the surface. Throws `Error` if there are more robots than sites, one
  /// is off the surface, two come on one site, or a part of the surface has no robot.
  SurfaceCoverage(const TriangleMesh& mesh, std::span<const Point3> robots,
                  SurfaceCoverageOptions options = {}, Coordinator chosen = {},
                  const Distance& distance = {}, const Surface& surface = {})
      : coordinator(std::move(chosen)),
        options_(std::move(options)),
        mesh_(std::make_shared<const TriangleMesh>(mesh)),
        graph_(std::make_shared<const SurfaceGraph>(surface(mesh, distance, options_.field))) {
    deploy(nearest_sites(robots));
  }
  /// Robots on sites, as `random_robot_sites` gives them.
  SurfaceCoverage(const TriangleMesh& mesh, std::vector<std::int32_t> sites,
                  SurfaceCoverageOptions options = {}, Coordinator chosen = {},
                  const Distance& distance = {}, const Surface& surface = {})
      : coordinator(std::move(chosen)),
        options_(std::move(options)),
        mesh_(std::make_shared<const TriangleMesh>(mesh)),
        graph_(std::make_shared<const SurfaceGraph>(surface(mesh, distance, options_.field))) {
    deploy(std::move(sites));
  }

  /// Whether no robot has anything left to do.
  bool converged() const { return idle_ >= patience_; }

  /// One coordination and one move: of all robots, or of the next in asynchronous mode.
  void step() {
    const bool changed = unknown() ? step_unknown() : coordinator.step(state_);
    idle_ = changed ? 0 : idle_ + 1;
    ++steps_;
  }

  /// What the coordinator brings down.
  double cost() const { return coordinator.cost(state_); }
  /// Eq. 6.4 for the robots where they are now, comparable between coordinators.
  double deployment_cost() const {
    return surface_cost(*graph_, state_.partition.generator, options_.exponent);
  }
  const SurfacePartition& partition() const { return state_.partition; }
  const SurfaceGraph& graph() const { return *graph_; }
  const TriangleMesh& mesh() const { return *mesh_; }
  const SurfaceMaps& maps() const { return maps_; }
  std::size_t steps() const { return steps_; }
  std::vector<Point3> positions() const {
    std::vector<Point3> points;
    for (const std::int32_t g : state_.partition.generator)
      points.push_back(graph_->position[static_cast<std::size_t>(g)]);
    return points;
  }
  /// Whether every region is one piece.
  bool connected() const { return regions_connected(graph_->links, state_.partition.region); }

  /// The regions as sets of triangles, each of one piece over common edges.
  SurfaceRegions regions() const { return make_surface_regions(mesh_, *graph_, state_.partition); }

 private:
  /// Robots that share a map.
  struct Team {
    DeploymentState state;
    Coordinator coordinator;
  };

  bool unknown() const { return std::isfinite(options_.sensing_range); }

  std::vector<std::int32_t> nearest_sites(std::span<const Point3> robots) const {
    require(!graph_->position.empty(), "surface coverage: the mesh has no sites");
    double snap = options_.snap.value_or(0.0);
    if (!options_.snap) {
      double sum = 0.0, count = 0.0;
      for (std::size_t v = 0; v < graph_->size(); ++v)
        for (const Arc& arc : graph_->links.arcs(static_cast<std::int32_t>(v))) {
          sum += (graph_->position[v] - graph_->position[static_cast<std::size_t>(arc.to)]).norm();
          count += 1.0;
        }
      snap = count > 0.0 ? sum / count : 0.0;
    }
    std::vector<std::int32_t> sites;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      double best = ShortestPaths::kUnreached;
      std::size_t at = 0;
      for (std::size_t v = 0; v < graph_->size(); ++v) {
        const double d = (graph_->position[v] - robots[i]).squaredNorm();
        if (d < best) {
          best = d;
          at = v;
        }
      }
      if (!(std::sqrt(best) <= snap))
        throw Error("robots: robot " + std::to_string(i) + " is " +
                    std::to_string(std::sqrt(best)) + " m off the surface; at most " +
                    std::to_string(snap) + " m");
      sites.push_back(static_cast<std::int32_t>(at));
    }
    return sites;
  }

  void deploy(std::vector<std::int32_t> sites) {
    require(!sites.empty(), "robots: need at least one");
    require(sites.size() <= graph_->size(),
            "robots: " + std::to_string(sites.size()) + " on a surface of " +
                std::to_string(graph_->size()) + " sites; at most one a site");
    std::vector<std::int32_t> sorted = sites;
    std::sort(sorted.begin(), sorted.end());
    require(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(),
            "robots: two stand on the same site; expected one a site");
    require(sorted.front() >= 0 && static_cast<std::size_t>(sorted.back()) < graph_->size(),
            "robots: a site that is not on the surface");
    if (!options_.allow_unreached) {
      const auto part = connected_components(graph_->links);
      std::vector<std::uint8_t> served(graph_->size(), 0);
      for (const std::int32_t s : sites)
        served[static_cast<std::size_t>(part[static_cast<std::size_t>(s)])] = 1;
      for (std::size_t v = 0; v < graph_->size(); ++v)
        require(served[static_cast<std::size_t>(part[v])] != 0,
                "robots: a connected part of the surface has none; place one on every part, or "
                "leave the part out");
    }
    state_.graph = graph_.get();
    state_.exponent = options_.exponent;
    state_.asynchronous = options_.asynchronous;
    state_.random = Random(options_.seed);
    state_.partition.generator = std::move(sites);
    // A robot is idle when it had its turn and nothing came of it; growing regions may rest a turn.
    patience_ = options_.asynchronous ? 2 * state_.partition.robots() : 1;
    if (unknown()) {
      maps_ = SurfaceMaps(*graph_, state_.partition.robots(), options_.sensing_range,
                          options_.communication_range);
      network_.emplace(state_.partition.robots());
      sense_and_exchange();
      restart_teams();
    } else {
      coordinator.start(state_);
    }
  }

  bool sense_and_exchange() {
    bool changed = false;
    const auto& g = state_.partition.generator;
    for (std::size_t i = 0; i < g.size(); ++i)
      changed |= maps_.sense(*graph_, static_cast<std::int32_t>(i), g[i]);
    changed |= maps_.exchange(*graph_, g, *network_);
    return changed;
  }
  /// The state of one team: its robots, its map, its regions.
  DeploymentState members(std::size_t team) const {
    DeploymentState state = state_;
    state.known = maps_.known(static_cast<std::int32_t>(team));
    for (std::size_t i = 0; i < state.partition.robots(); ++i)
      if (maps_.teams()[i] != static_cast<std::int32_t>(team))
        state.partition.generator[i] = SurfacePartition::kNone;
    for (std::int32_t& r : state.partition.region)
      if (r >= 0 && maps_.teams()[static_cast<std::size_t>(r)] != static_cast<std::int32_t>(team))
        r = SurfacePartition::kNone;
    return state;
  }
  void restart_teams() {
    teams_.clear();
    for (std::size_t i = 0; i < state_.partition.robots(); ++i) {
      if (maps_.teams()[i] != static_cast<std::int32_t>(i)) continue;
      Coordinator own = coordinator;
      DeploymentState state = members(i);
      state.random = state_.random.fork(i + 977 * steps_);
      state.turns.clear();
      own.start(state);
      teams_.push_back({std::move(state), std::move(own)});
    }
    merge();
  }
  /// The partition that the teams together claim: a site that two know goes to the nearer robot.
  void merge() {
    SurfacePartition& p = state_.partition;
    const std::size_t n = graph_->size();
    p.region.assign(n, SurfacePartition::kNone);
    p.distance.assign(n, ShortestPaths::kUnreached);
    p.first_step.assign(n, -1);
    for (const Team& team : teams_) {
      const SurfacePartition& q = team.state.partition;
      for (std::size_t i = 0; i < p.robots(); ++i)
        if (q.generator[i] >= 0) p.generator[i] = q.generator[i];
      for (std::size_t v = 0; v < n; ++v) {
        if (q.region[v] < 0 || !(q.distance[v] < p.distance[v])) continue;
        p.region[v] = q.region[v];
        p.distance[v] = q.distance[v];
        p.first_step[v] = q.first_step[v];
      }
    }
  }
  bool step_unknown() {
    bool changed = false;
    for (Team& team : teams_) {
      const std::vector<std::int32_t> before = team.state.partition.generator;
      changed |= team.coordinator.step(team.state);
      // Robots out of each other's sight must not meet on one site.
      for (std::size_t i = 0; i < before.size(); ++i) {
        const std::int32_t g = team.state.partition.generator[i];
        if (g < 0 || g == before[i]) continue;
        for (const Team& other : teams_) {
          const auto& theirs = other.state.partition.generator;
          if (&other != &team && std::find(theirs.begin(), theirs.end(), g) != theirs.end())
            team.state.partition.generator[i] = before[i];
        }
      }
    }
    merge();
    bool fresh = sense_and_exchange();
    if (!changed && !fresh && idle_ + 1 >= patience_) {
      for (const Team& team : teams_) fresh |= observe_beyond(team);
      if (fresh) maps_.exchange(*graph_, state_.partition.generator, *network_);
    }
    if (fresh) {
      restart_teams();
      changed = true;
    }
    return changed;
  }
  /// A team at rest whose map does not end at the surface's border sends a robot to observe there:
  /// the one to whose region the nearest such site belongs drives out, senses, and comes back.
  bool observe_beyond(const Team& team) {
    const SurfacePartition& p = team.state.partition;
    double nearest = ShortestPaths::kUnreached;
    std::int32_t site = -1;
    for (std::size_t v = 0; v < p.region.size(); ++v) {
      if (p.region[v] < 0 || p.distance[v] >= nearest) continue;
      for (const Arc& arc : graph_->links.arcs(static_cast<std::int32_t>(v)))
        if (team.state.known[static_cast<std::size_t>(arc.to)] == 0) {
          nearest = p.distance[v];
          site = static_cast<std::int32_t>(v);
          break;
        }
    }
    return site >= 0 && maps_.sense(*graph_, p.region[static_cast<std::size_t>(site)], site);
  }

  SurfaceCoverageOptions options_;
  std::shared_ptr<const TriangleMesh> mesh_;
  std::shared_ptr<const SurfaceGraph> graph_;
  DeploymentState state_;
  SurfaceMaps maps_;
  std::optional<PerfectTransport<SurfaceMapReport>> network_;  // on an unknown surface
  std::vector<Team> teams_;
  std::size_t idle_ = 0, patience_ = 1, steps_ = 0;
};
}  // namespace surfleet
