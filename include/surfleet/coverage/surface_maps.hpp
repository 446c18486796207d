// SPDX-License-Identifier: MIT
/// @file
/// @brief What each robot knows of a surface it has not seen before: sensing, and the merging of
/// maps within communication range [004 §6.5].
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/coverage/mesh_graph.hpp>

namespace surfleet {
/// The discovered subgraph of every robot.
class SurfaceMaps {
 public:
  SurfaceMaps() = default;
  SurfaceMaps(const SurfaceGraph& graph, std::size_t robots, double sensing_range,
              double communication_range)
      : sensing_(sensing_range),
        communication_(communication_range),
        known_(robots, std::vector<std::uint8_t>(graph.size(), 0)),
        team_(robots) {
    require(sensing_range > 0.0 && communication_range >= 0.0,
            "maps: the sensing range must be positive, the communication range not negative");
    std::iota(team_.begin(), team_.end(), 0);
  }

  /// Adds the sites that `robot` sees from `site`: those within the sensing range, straight, that
  /// hang together with its own. True if any was new. O(sites seen).
  bool sense(const SurfaceGraph& graph, std::int32_t robot, std::int32_t site) {
    auto& known = known_[static_cast<std::size_t>(robot)];
    const Point3& here = graph.position[static_cast<std::size_t>(site)];
    std::vector<std::int32_t> queue{site};
    std::vector<std::uint8_t> seen(graph.size(), 0);
    seen[static_cast<std::size_t>(site)] = 1;
    bool fresh = false;
    for (std::size_t k = 0; k < queue.size(); ++k) {
      std::uint8_t& mark = known[static_cast<std::size_t>(queue[k])];
      fresh |= mark == 0;
      mark = 1;
      for (const Arc& arc : graph.links.arcs(queue[k])) {
        const auto j = static_cast<std::size_t>(arc.to);
        if (seen[j] != 0 || (graph.position[j] - here).norm() > sensing_) continue;
        seen[j] = 1;
        queue.push_back(arc.to);
      }
    }
    return fresh;
  }

  /// Robots within communication range whose maps share a site merge them and become a team,
  /// named after its lowest robot; what one of a team learns all of it learn. A team does not
  /// split: robots that agreed on a partition stay in touch by relay. True if any map or team
  /// changed. O(robots² n).
  bool exchange(const SurfaceGraph& graph, std::span<const std::int32_t> sites) {
    const std::size_t robots = known_.size();
    const std::vector<std::int32_t> before = team_;
    const auto root = [&](std::size_t i) {
      while (team_[i] != static_cast<std::int32_t>(i)) i = static_cast<std::size_t>(team_[i]);
      return i;
    };
    for (std::size_t i = 0; i < robots; ++i) {
      for (std::size_t j = i + 1; j < robots; ++j) {
        if (sites[i] < 0 || sites[j] < 0 || root(i) == root(j)) continue;
        const double gap = (graph.position[static_cast<std::size_t>(sites[i])] -
                            graph.position[static_cast<std::size_t>(sites[j])])
                               .norm();
        if (gap > communication_ || !overlap(i, j)) continue;
        const std::size_t a = root(i), b = root(j);
        team_[std::max(a, b)] = static_cast<std::int32_t>(std::min(a, b));
      }
    }
    bool changed = false;
    for (std::size_t i = 0; i < robots; ++i) team_[i] = static_cast<std::int32_t>(root(i));
    for (std::size_t i = 0; i < robots; ++i) {
      auto& shared = known_[static_cast<std::size_t>(team_[i])];
      for (std::size_t v = 0; v < shared.size(); ++v) {
        changed |= shared[v] != known_[i][v];
        shared[v] |= known_[i][v];
      }
    }
    for (std::size_t i = 0; i < robots; ++i)
      if (team_[i] != static_cast<std::int32_t>(i))
        known_[i] = known_[static_cast<std::size_t>(team_[i])];
    return changed || team_ != before;
  }

  const std::vector<std::uint8_t>& known(std::int32_t robot) const {
    return known_[static_cast<std::size_t>(robot)];
  }
  /// The lowest robot of the team of each robot.
  const std::vector<std::int32_t>& teams() const { return team_; }

  /// The share of the surface's area that some robot knows.
  double known_fraction(const SurfaceGraph& graph) const {
    double all = 0.0, seen = 0.0;
    for (std::size_t v = 0; v < graph.size(); ++v) {
      all += graph.area[v];
      for (const auto& map : known_)
        if (map[v] != 0) {
          seen += graph.area[v];
          break;
        }
    }
    return all > 0.0 ? seen / all : 0.0;
  }

 private:
  bool overlap(std::size_t i, std::size_t j) const {
    for (std::size_t v = 0; v < known_[i].size(); ++v)
      if (known_[i][v] != 0 && known_[j][v] != 0) return true;
    return false;
  }
  double sensing_ = std::numeric_limits<double>::infinity();
  double communication_ = std::numeric_limits<double>::infinity();
  std::vector<std::vector<std::uint8_t>> known_;
  std::vector<std::int32_t> team_;
};
}  // namespace surfleet
