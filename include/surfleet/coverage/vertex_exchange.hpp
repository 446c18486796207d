// SPDX-License-Identifier: MIT
/// @file
/// @brief Coordination by vertex exchange [004 Alg. 8]: neighbouring robots trade sites across
/// their common border as long as that lowers the cost to the regions' centroids.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/coverage/wavefront_propagation.hpp>

namespace surfleet {
namespace detail {
/// The sums of eq. 6.23 (or 6.25 where the tensors are the identity) of one region, about a
/// common origin so that nothing cancels.
struct RegionSums {
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // Σ M K̃ c
  Eigen::Matrix3d metric = Eigen::Matrix3d::Zero();  // Σ M K̃, unless isotropic

  /// The partial cost −vᵀ Σ M K̃ c at the centroid v.
  double partial(bool isotropic) const {
    if (!(mass > 0.0)) return 0.0;
    if (isotropic) return -moment.squaredNorm() / mass;
    return -moment.dot(metric.inverse() * moment);
  }
  Eigen::Vector3d centroid(bool isotropic) const {
    if (!(mass > 0.0)) return Eigen::Vector3d::Zero();
    return isotropic ? Eigen::Vector3d(moment / mass) : Eigen::Vector3d(metric.inverse() * moment);
  }
};
}  // namespace detail

/// Alg. 8 as a coordinator: isotropic cost (6.25), or anisotropic (6.23) where the graph carries
/// tensors. It measures straight through space; the exponent of the cost is 2 by nature.
///
/// Regions grow from the robots' sites over free ones, one layer a step. Every trade lowers the
/// cost and keeps both regions whole. A robot stands on the site of its region that is nearest to
/// the region's centroid. O(n) a step.
struct VertexExchange {
  int rounds = 1;           ///< k_R: passes over a border before a robot turns to the next.
  std::size_t reach = 256;  ///< Sites searched for a path around a site that is to be given
                            ///< away; if none is found it stays.
  static constexpr double kGain = 1e-12;  ///< Least relative gain of a trade.

  /// Keeps the regions it finds, as far as they hang together with their robots.
  void start(DeploymentState& state) {
    const SurfaceGraph& graph = *state.graph;
    SurfacePartition& p = state.partition;
    const std::size_t n = graph.size();
    p.region.resize(n, SurfacePartition::kNone);
    p.first_step.assign(n, -1);
    p.distance.assign(n, ShortestPaths::kUnreached);
    origin_.setZero();
    for (const Point3& x : graph.position) origin_ += x / static_cast<double>(n);
    std::vector<std::int32_t> firm(n, SurfacePartition::kNone), stack;
    for (std::size_t i = 0; i < p.robots(); ++i) {
      if (p.generator[i] < 0) continue;
      const auto g = static_cast<std::size_t>(p.generator[i]);
      require(g < n, "vertex exchange: a robot stands on a site that is not there");
      require(firm[g] < 0, "vertex exchange: two robots stand on the same site");
      firm[g] = static_cast<std::int32_t>(i);
      stack.push_back(p.generator[i]);
    }
    while (!stack.empty()) {
      const auto v = static_cast<std::size_t>(stack.back());
      stack.pop_back();
      for (const Arc& arc : graph.links.arcs(static_cast<std::int32_t>(v))) {
        const auto j = static_cast<std::size_t>(arc.to);
        if (firm[j] >= 0 || p.region[j] != firm[v] || !state.keep()(arc.to)) continue;
        firm[j] = firm[v];
        stack.push_back(arc.to);
      }
    }
    p.region = std::move(firm);
    measure(state);
  }

  /// Eq. 6.20 with the robots at the centroids, without the J terms that no partition changes.
  double cost(const DeploymentState& state) const {
    const SurfaceGraph& graph = *state.graph;
    const bool isotropic = graph.tensor.empty();
    double sum = 0.0;
    for (std::size_t v = 0; v < graph.size(); ++v) {
      if (state.partition.region[v] < 0) continue;
      const Eigen::Vector3d c = graph.position[v] - origin_;
      sum += graph.mass[v] * (isotropic ? c.squaredNorm() : c.dot(graph.tensor[v] * c));
    }
    for (const detail::RegionSums& s : sums_of(state)) sum += s.partial(isotropic);
    return sum;
  }

  bool step(DeploymentState& state) {
    const std::vector<std::int32_t> actors = state.actors();
    sums_ = sums_of(state);
    borders_.assign(state.partition.robots(), {});
    for (std::size_t v = 0; v < state.graph->size(); ++v) {
      const std::int32_t robot = state.partition.region[v];
      if (robot >= 0 && on_border(state, static_cast<std::int32_t>(v)))
        borders_[static_cast<std::size_t>(robot)].push_back(static_cast<std::int32_t>(v));
    }
    bool changed = false;
    for (const std::int32_t robot : actors) changed |= take_free(state, robot);
    for (const std::int32_t robot : actors) changed |= trade(state, robot);
    if (changed) settle(state);
    return changed;
  }

 private:
  bool on_border(const DeploymentState& state, std::int32_t v) const {
    const std::int32_t robot = state.partition.region[static_cast<std::size_t>(v)];
    for (const Arc& arc : state.graph->links.arcs(v))
      if (state.partition.region[static_cast<std::size_t>(arc.to)] != robot && state.keep()(arc.to))
        return true;
    return false;
  }
  detail::RegionSums site_sums(const SurfaceGraph& graph, std::size_t v) const {
    const Eigen::Vector3d c = graph.position[v] - origin_;
    if (graph.tensor.empty()) return {graph.mass[v], graph.mass[v] * c, Eigen::Matrix3d::Zero()};
    const Eigen::Matrix3d k = graph.mass[v] * graph.tensor[v];
    return {graph.mass[v], k * c, k};
  }
  static void add(detail::RegionSums& sums, const detail::RegionSums& other, double sign) {
    sums.mass += sign * other.mass;
    sums.moment += sign * other.moment;
    sums.metric += sign * other.metric;
  }
  std::vector<detail::RegionSums> sums_of(const DeploymentState& state) const {
    std::vector<detail::RegionSums> sums(state.partition.robots());
    for (std::size_t v = 0; v < state.graph->size(); ++v)
      if (state.partition.region[v] >= 0)
        add(sums[static_cast<std::size_t>(state.partition.region[v])], site_sums(*state.graph, v),
            1.0);
    return sums;
  }

  bool take_free(DeploymentState& state, std::int32_t robot) {
    auto& region = state.partition.region;
    auto& border = borders_[static_cast<std::size_t>(robot)];
    bool changed = false;
    for (std::size_t k = 0, end = border.size(); k < end; ++k)
      for (const Arc& arc : state.graph->links.arcs(border[k])) {
        const auto j = static_cast<std::size_t>(arc.to);
        if (region[j] >= 0 || !state.keep()(arc.to)) continue;
        region[j] = robot;
        add(sums_[static_cast<std::size_t>(robot)], site_sums(*state.graph, j), 1.0);
        border.push_back(arc.to);
        changed = true;
      }
    return changed;
  }

  /// One robot deals with each of its neighbours, lowest first.
  bool trade(DeploymentState& state, std::int32_t robot) {
    const auto& region = state.partition.region;
    const std::vector<std::int32_t> border = borders_[static_cast<std::size_t>(robot)];
    std::vector<std::int32_t> others;
    for (const std::int32_t v : border)
      for (const Arc& arc : state.graph->links.arcs(v)) {
        const std::int32_t other = region[static_cast<std::size_t>(arc.to)];
        if (other >= 0 && other != robot) others.push_back(other);
      }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    bool changed = false;
    for (const std::int32_t other : others) {
      std::vector<std::int32_t> from = border;
      for (int round = 0; round < rounds; ++round) {
        std::vector<std::int32_t> moved = exchange(state, robot, other, from);
        if (moved.empty()) break;
        changed = true;
        // The border is now where sites changed hands, and where it was.
        for (const std::int32_t v : moved) {
          from.push_back(v);
          for (const Arc& arc : state.graph->links.arcs(v)) from.push_back(arc.to);
        }
        std::sort(from.begin(), from.end());
        from.erase(std::unique(from.begin(), from.end()), from.end());
      }
    }
    return changed;
  }

  /// One pass over the border sites `from` of `a` against `b`; the sites that changed hands.
  std::vector<std::int32_t> exchange(DeploymentState& state, std::int32_t a, std::int32_t b,
                                     const std::vector<std::int32_t>& from) {
    const SurfaceGraph& graph = *state.graph;
    const bool isotropic = graph.tensor.empty();
    auto& region = state.partition.region;
    std::vector<std::int32_t> moved;
    for (const std::int32_t va : from) {
      for (const Arc& arc : graph.links.arcs(va)) {
        const auto i = static_cast<std::size_t>(va), j = static_cast<std::size_t>(arc.to);
        if (region[i] != a) break;
        if (region[j] != b) continue;
        detail::RegionSums& sa = sums_[static_cast<std::size_t>(a)];
        detail::RegionSums& sb = sums_[static_cast<std::size_t>(b)];
        const double now = sa.partial(isotropic) + sb.partial(isotropic);
        const auto after = [&](std::size_t site, double sign) {
          detail::RegionSums na = sa, nb = sb;
          const detail::RegionSums piece = site_sums(graph, site);
          add(na, piece, -sign);
          add(nb, piece, sign);
          return std::pair(na, nb);
        };
        const auto give = after(i, 1.0), take = after(j, -1.0);
        const double gain = kGain * std::abs(now);
        double by_giving = now - give.first.partial(isotropic) - give.second.partial(isotropic);
        double by_taking = now - take.first.partial(isotropic) - take.second.partial(isotropic);
        if (by_giving > gain && !removable(state, va)) by_giving = 0.0;
        if (by_taking > gain && by_taking > by_giving && !removable(state, arc.to)) by_taking = 0.0;
        if (std::max(by_giving, by_taking) <= gain) continue;
        const bool giving = by_giving >= by_taking;
        const auto& next = giving ? give : take;
        sa = next.first;
        sb = next.second;
        const std::size_t site = giving ? i : j;
        region[site] = giving ? b : a;
        borders_[static_cast<std::size_t>(region[site])].push_back(static_cast<std::int32_t>(site));
        for (const Arc& around : graph.links.arcs(static_cast<std::int32_t>(site))) {
          const std::int32_t owner = region[static_cast<std::size_t>(around.to)];
          if (owner >= 0) borders_[static_cast<std::size_t>(owner)].push_back(around.to);
        }
        moved.push_back(static_cast<std::int32_t>(site));
      }
    }
    return moved;
  }

  bool removable(const DeploymentState& state, std::int32_t v) {
    return removal_(state.graph->links, state.partition.region, v, reach);
  }

  /// UpdateGoal and MoveToGoal: every robot to the site nearest to its centroid.
  void settle(DeploymentState& state) {
    const SurfaceGraph& graph = *state.graph;
    SurfacePartition& p = state.partition;
    const bool isotropic = graph.tensor.empty();
    std::vector<Eigen::Vector3d> centroid;
    for (const detail::RegionSums& s : sums_) centroid.push_back(s.centroid(isotropic) + origin_);
    std::vector<double> best(p.robots(), ShortestPaths::kUnreached);
    for (std::size_t v = 0; v < graph.size(); ++v) {
      if (p.region[v] < 0) continue;
      const auto i = static_cast<std::size_t>(p.region[v]);
      const Eigen::Vector3d d = graph.position[v] - centroid[i];
      const double squared = isotropic ? d.squaredNorm() : d.dot(graph.tensor[v] * d);
      if (squared >= best[i]) continue;
      best[i] = squared;
      p.generator[i] = static_cast<std::int32_t>(v);
    }
    measure(state);
  }
  static void measure(DeploymentState& state) {
    SurfacePartition& p = state.partition;
    for (std::size_t v = 0; v < p.region.size(); ++v)
      p.distance[v] = p.region[v] < 0 ? ShortestPaths::kUnreached
                                      : (state.graph->position[v] -
                                         state.graph->position[static_cast<std::size_t>(
                                             p.generator[static_cast<std::size_t>(p.region[v])])])
                                            .norm();
  }

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  std::vector<detail::RegionSums> sums_;
  std::vector<std::vector<std::int32_t>> borders_;
  RemovalTest removal_;
};
static_assert(SurfaceCoordinator<VertexExchange>);
}  // namespace surfleet
