// SPDX-License-Identifier: MIT
/// @file
/// @brief What each robot knows of a surface it has not seen before: sensing, and the merging of
/// maps within communication range [004 §6.5].
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/transport.hpp>
#include <surfleet/coverage/mesh_graph.hpp>

namespace surfleet {
/// What a robot tells the others.
struct SurfaceMapReport {
  std::int32_t site = -1;           ///< Where it is; -1: nowhere.
  std::vector<std::uint8_t> mates;  ///< By robot: whether it shares a map with it.
  std::vector<std::uint8_t> known;  ///< By site.
};
/// For networks that count: a site's number, and a bit a robot and a site [bytes].
inline std::size_t byte_size(const SurfaceMapReport& r) {
  return sizeof(r.site) + (r.mates.size() + r.known.size() + 7) / 8;
}
inline std::uint8_t kind_of(const SurfaceMapReport& /*report*/) { return 0; }

/// The discovered subgraph of every robot.
class SurfaceMaps {
 public:
  SurfaceMaps() = default;
  SurfaceMaps(const SurfaceGraph& graph, std::size_t robots, double sensing_range,
              double communication_range)
      : sensing_(sensing_range),
        communication_(communication_range),
        known_(robots, std::vector<std::uint8_t>(graph.size(), 0)),
        mates_(robots, std::vector<std::uint8_t>(robots, 0)),
        team_(robots) {
    require(sensing_range > 0.0 && communication_range >= 0.0,
            "maps: the sensing range must be positive, the communication range not negative");
    for (std::size_t i = 0; i < robots; ++i) mates_[i][i] = 1;
    name_teams();
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

  /// Robots on `sites` tell each other what they know, round after round until none learns anything
  /// more. A robot that hears one within communication range whose map shares a site with its own
  /// takes it, and its mates, for mates; what one of a team learns all of it learn. A team does not
  /// split: robots that agreed on a partition stay in touch by relay. True if any map or team
  /// changed. O(robots² n) a round, of at most as many as there are robots; what a network loses is
  /// told again with the next exchange.
  template <Transport Network>
  bool exchange(const SurfaceGraph& graph, std::span<const std::int32_t> sites, Network& network) {
    bool changed = false, fresh = true;
    for (std::size_t round = 0; fresh && round < robots(); ++round, ++time_) {
      for (std::size_t i = 0; i < robots(); ++i)
        network.send({.time = static_cast<double>(time_),
                      .from = static_cast<RobotId>(i),
                      .payload = {sites[i], mates_[i], known_[i]}});
      fresh = false;
      for (std::size_t i = 0; i < robots(); ++i)
        for (const auto& report : network.receive(static_cast<RobotId>(i)))
          fresh = hear(graph, i, sites[i], report.from, report.payload) || fresh;
      changed = changed || fresh;
    }
    name_teams();
    return changed;
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
  std::size_t robots() const { return known_.size(); }
  /// True if the robot learns anything.
  bool hear(const SurfaceGraph& graph, std::size_t robot, std::int32_t site, RobotId from,
            const SurfaceMapReport& report) {
    auto& mates = mates_[robot];
    auto& known = known_[robot];
    if (mates[from] == 0) {
      if (site < 0 || report.site < 0) return false;
      const double gap = (graph.position[static_cast<std::size_t>(site)] -
                          graph.position[static_cast<std::size_t>(report.site)])
                             .norm();
      if (gap > communication_ || !overlap(known, report.known)) return false;
    }
    const bool team = add(report.mates, mates), map = add(report.known, known);
    return team || map;
  }
  /// True if `to` did not have all of it.
  static bool add(const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to) {
    bool fresh = false;
    for (std::size_t i = 0; i < to.size(); ++i) {
      fresh |= from[i] != 0 && to[i] == 0;
      to[i] |= from[i];
    }
    return fresh;
  }
  static bool overlap(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    for (std::size_t i = 0; i < a.size(); ++i)
      if (a[i] != 0 && b[i] != 0) return true;
    return false;
  }
  /// After a robot that may itself have named its team after another.
  void name_teams() {
    for (std::size_t i = 0; i < robots(); ++i) {
      const auto lowest = std::find(mates_[i].begin(), mates_[i].end(), std::uint8_t{1});
      const auto name = static_cast<std::size_t>(lowest - mates_[i].begin());
      team_[i] = name == i ? static_cast<std::int32_t>(i) : team_[name];
    }
  }
  double sensing_ = std::numeric_limits<double>::infinity();
  double communication_ = std::numeric_limits<double>::infinity();
  std::vector<std::vector<std::uint8_t>> known_;  // sites, by robot
  std::vector<std::vector<std::uint8_t>> mates_;  // robots, by robot, itself among them
  std::vector<std::int32_t> team_;
  std::uint64_t time_ = 0;  // of rounds
};
}  // namespace surfleet
