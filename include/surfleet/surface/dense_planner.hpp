// SPDX-License-Identifier: MIT
/// @file
/// @brief Paths over a raw cloud: A* over cells and headings of its feature maps [004 §8.2.3].
///
///     const FeatureMaps maps(cloud_tokens(cloud.points), 0.06);
///     const DensePlanner plan(maps);
///     if (auto path = plan(start, goal)) use(path->cells);
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/surface/feature_maps.hpp>

namespace surfleet {
/// The weights of eq. 8.1: k₁ d + k₂ w_surf d + k₃ w_turn / d + k₄ w_curv. A metre on the best
/// surface costs k₁.
struct DenseCosts {
  double distance = 1.0;   ///< k₁ [1/m].
  double surface = 2.0;    ///< k₂ [1/m].
  double turn = 0.02;      ///< k₃ [m/rad²].
  double curvature = 0.1;  ///< k₄ [1/rad²].
};

struct DensePlannerOptions {
  DenseCosts costs = {};
  double least_saliency = 0.35;  ///< λ_surf, as a share of the greatest.
  double least_edge_saliency =
      0.175;                          ///< At edges half of it: a sheet has votes of one side alone.
  double most_turn = radians(50.0);   ///< λ_turn: turns in a step stay below [rad].
  double fan = radians(48.0);         ///< Half opening of the fan of moves on the surface [rad].
  double fan_step = radians(8.0);     ///< Between its moves [rad].
  double pitch = radians(24.0);       ///< Moves are tried so far up and down as well [rad].
  double edge_pitch = radians(48.0);  ///< The same across edges [rad].
  int threads = 1;                    ///< To index the steps.
};

/// A path from cell to cell.
struct DensePath {
  std::vector<std::int32_t> cells;
  std::vector<int> headings;  ///< By which each cell was entered; the first one's, begun with.
  double cost = 0.0;          ///< By eq. 8.1.
  double length = 0.0;        ///< Of the steps between the cells' centres [m].
  std::size_t expanded = 0;   ///< Nodes whose cost was settled.
};

/// The graph of [004 Alg. 10], made as it is searched, and A* on it.
///
/// A node is a cell and one of 98 headings, the offsets to the cells two away (5³ − 3³), by which
/// it was entered. On the surface a fan of moves about the heading is snapped to those offsets; at
/// an edge the moves go across it alone, to the side of the heading. Only cells of the feature maps
/// above λ_surf are nodes. The maps must outlive the planner. Memory O(98 cells).
class DensePlanner {
 public:
  static constexpr int kHeadings = 98;

  explicit DensePlanner(const FeatureMaps& maps, const DensePlannerOptions& options = {})
      : maps_(maps), options_(options) {
    const DenseCosts& k = options.costs;
    require(k.distance >= 0.0 && k.surface >= 0.0 && k.turn >= 0.0 && k.curvature >= 0.0,
            "dense planner: expected weights of 0 or more");
    for (const double least : {options.least_saliency, options.least_edge_saliency})
      require(least >= 0.0 && least <= 1.0,
              "dense planner: expected least saliencies of 0 to 1 times the greatest");
    require(
        options.fan >= 0.0 && options.fan_step > 0.0 && options.most_turn > 0.0,
        "dense planner: expected a fan of 0 or more, a step and a greatest turn of more than 0");
    for (int z = -2; z <= 2; ++z)
      for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) {
          const Eigen::Vector3i o(x, y, z);
          if (o.cwiseAbs().maxCoeff() < 2) continue;
          number_[static_cast<std::size_t>(slot(o))] = static_cast<std::int8_t>(steps_.size());
          steps_.push_back(o);
          directions_.push_back(o.cast<double>().normalized());
        }
    const std::size_t n = maps.cells().size();
    neighbor_.assign(n * kHeadings, -1);
    parallel_for(
        n, options.threads,
        [&](std::size_t c) {
          for (std::size_t h = 0; h < kHeadings; ++h) {
            const std::int32_t j = maps.find(maps.cells()[c].index + steps_[h]);
            if (j >= 0 && is_surface(j)) neighbor_[c * kHeadings + h] = j;
          }
        },
        256);
  }

  const FeatureMaps& maps() const { return maps_; }
  const DensePlannerOptions& options() const { return options_; }
  bool is_surface(std::int32_t cell) const {
    const double least = maps_[cell].edge ? options_.least_edge_saliency : options_.least_saliency;
    return maps_[cell].saliency() > least * maps_.greatest_saliency();
  }

  /// The surface cell that a step along a heading leads to from a cell; −1 where there is none.
  std::int32_t neighbor(std::int32_t cell, int heading) const {
    return neighbor_[static_cast<std::size_t>(cell) * kHeadings +
                     static_cast<std::size_t>(heading)];
  }

  /// @name The graph, for shortest_paths
  /// @{
  std::size_t size() const { return maps_.cells().size() * kHeadings; }
  std::vector<Arc> arcs(std::int32_t node) const {
    const std::int32_t cell = node / kHeadings;
    const auto from = static_cast<std::size_t>(cell);
    const FeatureCell& here = maps_[cell];
    const Eigen::Vector3d& h = directions_[static_cast<std::size_t>(node % kHeadings)];
    std::vector<Arc> arcs;
    std::bitset<kHeadings> tried;
    const Eigen::Vector3d bz = here.normal;
    Eigen::Vector3d bx = h;
    if (here.edge) {
      bx = here.tangent.cross(bz);
      if (!(bx.norm() > 1e-9)) return arcs;
      bx.normalize();
      if (bx.dot(h) < 0.0) bx = -bx;
    } else {
      bx = h - h.dot(bz) * bz;  // the fan lies in the tangent plane
      if (!(bx.norm() > 1e-9)) return arcs;
      bx.normalize();
    }
    const Eigen::Vector3d by = bz.cross(bx);
    const double fan = here.edge ? 0.0 : options_.fan;
    const double pitch = here.edge ? options_.edge_pitch : options_.pitch;
    const int turns = static_cast<int>(std::floor(fan / options_.fan_step + 1e-9));
    for (int k = -turns; k <= turns; ++k) {
      const double a = k * options_.fan_step;
      const Eigen::Vector3d level = std::cos(a) * bx + std::sin(a) * by;
      for (int up = -2; up <= 2; ++up) {
        const double p = 0.5 * up * pitch;
        const int step = snapped(std::cos(p) * level + std::sin(p) * bz);
        if (tried[static_cast<std::size_t>(step)]) continue;
        tried.set(static_cast<std::size_t>(step));
        const std::int32_t to = neighbor_[from * kHeadings + static_cast<std::size_t>(step)];
        if (to < 0) continue;
        const auto cost = step_cost(here, h, maps_[to]);
        if (cost) arcs.push_back({to * kHeadings + step, *cost});
      }
    }
    return arcs;
  }
  /// @}

  /// The cost of a step by eq. 8.1, or nothing if it turns too far.
  std::optional<double> step_cost(const FeatureCell& from, const Eigen::Vector3d& heading,
                                  const FeatureCell& to) const {
    const Eigen::Vector3d m = to.position - from.position;
    const double d = m.norm();
    Eigen::Vector3d other = to.normal;
    if (other.dot(from.normal) < 0.0) other = -other;
    const Eigen::Vector3d mean = (from.normal + other).normalized();
    const Eigen::Vector3d along = m - m.dot(mean) * mean;
    const Eigen::Vector3d ahead = heading - heading.dot(mean) * mean;
    const double turn = std::atan2(along.cross(ahead).norm(), along.dot(ahead));
    if (!(turn < options_.most_turn)) return std::nullopt;
    const double greatest = maps_.greatest_saliency();
    const double lack = std::max(0.0, greatest - to.saliency()) / greatest;
    const DenseCosts& k = options_.costs;
    return k.distance * d + k.surface * lack * lack * lack * lack * d + k.turn * turn * turn / d +
           k.curvature * bend(from.normal, other, mean.cross(m));
  }

  /// Eq. 8.4: the angle between two normals times that between the axis of the bend and the robot's
  /// y axis, in [0, π/2]; 0 for parallel normals.
  static double bend(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& y) {
    const Eigen::Vector3d axis = a.cross(b);
    if (!(axis.norm() > 1e-12) || !(y.norm() > 1e-12)) return 0.0;
    return std::atan2(axis.norm(), a.dot(b)) *
           std::atan2(axis.cross(y).norm(), std::abs(axis.dot(y)));
  }

  /// The surface cell nearest to a point, up to `reach` [m].
  std::optional<std::int32_t> cell_at(const Point3& p, double reach) const {
    for (const Neighbor& n : maps_.near(p, reach))
      if (is_surface(n.index)) return n.index;
    return std::nullopt;
  }

  /// The best path between two surface cells, entered with any heading, or begun with `heading`
  /// where that is not zero; nothing if there is none. `steered` false leaves the heuristic out.
  std::optional<DensePath> operator()(std::int32_t start, std::int32_t goal,
                                      const Eigen::Vector3d& heading = Eigen::Vector3d::Zero(),
                                      bool steered = true) const {
    if (!is_surface(start) || !is_surface(goal)) return std::nullopt;
    DensePath path;
    if (start == goal) {
      path.cells = {start};
      path.headings = {heading.norm() > 0.0 ? snapped(heading) : 0};
      return path;
    }
    std::vector<Source> sources;
    if (heading.norm() > 0.0)
      sources.push_back({start * kHeadings + snapped(heading.normalized()), 0.0});
    else
      for (int h = 0; h < kHeadings; ++h) sources.push_back({start * kHeadings + h, 0.0});
    const Point3 end = maps_[goal].position;
    const double k1 = steered ? options_.costs.distance : 0.0;
    std::int32_t reached = -1;
    const ShortestPaths found = shortest_paths(
        *this, std::span<const Source>(sources),
        [&](std::int32_t node) { return k1 * (maps_[node / kHeadings].position - end).norm(); },
        [&](std::int32_t node, double cost) {
          ++path.expanded;
          if (node / kHeadings != goal) return false;
          reached = node;
          path.cost = cost;
          return true;
        });
    if (reached < 0) return std::nullopt;
    for (const std::int32_t node : found.path(reached)) {
      path.cells.push_back(node / kHeadings);
      path.headings.push_back(node % kHeadings);
    }
    for (std::size_t i = 1; i < path.cells.size(); ++i)
      path.length += (maps_[path.cells[i]].position - maps_[path.cells[i - 1]].position).norm();
    return path;
  }

  /// The offset that a direction is snapped to.
  int snapped(const Eigen::Vector3d& direction) const {
    const double longest = direction.cwiseAbs().maxCoeff();
    Eigen::Vector3i o;
    for (int a = 0; a < 3; ++a) o[a] = static_cast<int>(std::lround(2.0 * direction[a] / longest));
    return number_[static_cast<std::size_t>(slot(o))];
  }
  const Eigen::Vector3d& direction(int heading) const {
    return directions_[static_cast<std::size_t>(heading)];
  }

 private:
  static int slot(const Eigen::Vector3i& o) {
    return (o.x() + 2) + 5 * (o.y() + 2) + 25 * (o.z() + 2);
  }

  const FeatureMaps& maps_;
  DensePlannerOptions options_;
  std::array<std::int8_t, 125> number_{};
  std::vector<Eigen::Vector3i> steps_;
  std::vector<Eigen::Vector3d> directions_;
  std::vector<std::int32_t> neighbor_;  // by cell and heading; −1 where there is no surface cell
};
static_assert(WeightedGraph<DensePlanner>);
}  // namespace surfleet
