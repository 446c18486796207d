// SPDX-License-Identifier: MIT
/// @file
/// @brief Which robots can reach which viewpoints, so that none is sent where it cannot get.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>
#include <surfleet/viewpoint/viewpoint_clustering.hpp>

namespace surfleet {
/// Whether any of some robots can reach a place.
inline bool any_reaches(std::span<const ReachFrom> reach, const Point3& p) {
  return std::any_of(reach.begin(), reach.end(), [&](const auto& r) { return r(p); });
}

/// What it costs to go from one viewpoint to the next and stop there, as metres of flight: turning
/// en route costs nothing as long as the flight takes longer. As it stands, the straight length.
struct StopDistance {
  double stop = 0.0;  ///< A stop, for braking, observing and setting off again [m].
  double turn = 0.0;  ///< Turning, at the robot's speed over its yaw rate [m/rad].
  double operator()(const Configuration& a, const Configuration& b) const {
    const double length = EuclideanDistance{}(a, b);
    if (turn <= 0.0) return stop + length;
    return stop + std::max(length, turn * std::abs(wrap_angle(a.yaw - b.yaw)));
  }
};
static_assert(PathDistance<StopDistance> && PathDistance<LazyPrmStar>);

/// Viewpoints by the robots that can reach them: mostly one group, as free space is mostly one.
class ViewAccess {
 public:
  /// O(robots × viewpoints).
  ViewAccess(std::span<const ReachFrom> reach, std::span<const Viewpoint> views) {
    std::map<std::vector<bool>, std::int32_t> known;
    for (const Viewpoint& v : views) {
      std::vector<bool> robots;
      for (const ReachFrom& r : reach) robots.push_back(r(v.configuration.position));
      const auto [it, fresh] = known.try_emplace(robots, static_cast<std::int32_t>(groups_.size()));
      if (fresh) groups_.push_back(std::move(robots));
      group_of_.push_back(it->second);
    }
  }

  bool operator()(std::size_t robot, std::size_t view) const {
    return groups_[static_cast<std::size_t>(group_of_[view])][robot];
  }
  /// As `cluster_viewpoints`, with clusters that a robot can reach the whole of or nothing.
  template <PathDistance D>
  std::vector<ViewpointCluster> clusters(std::span<const Viewpoint> views, D&& distance,
                                         const ClusterOptions& options) const {
    if (groups_.size() < 2) return cluster_viewpoints(views, distance, options);
    std::vector<ViewpointCluster> all;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      std::vector<Viewpoint> members;
      std::vector<std::int32_t> index;
      for (std::size_t i = 0; i < views.size(); ++i)
        if (static_cast<std::size_t>(group_of_[i]) == g) {
          members.push_back(views[i]);
          index.push_back(static_cast<std::int32_t>(i));
        }
      for (ViewpointCluster& c : cluster_viewpoints(members, distance, options)) {
        for (std::int32_t& v : c.views) v = index[static_cast<std::size_t>(v)];
        all.push_back(std::move(c));
      }
    }
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return a.views[0] < b.views[0]; });
    return all;
  }

  /// A robot's start, or a viewpoint.
  struct Place {
    Configuration configuration;
    std::int32_t robot = -1, view = -1;
  };
  /// `StopDistance`, infinite from a robot's start to what it cannot reach. The access must outlive
  /// it.
  struct Distance {
    const ViewAccess* access;
    StopDistance distance{};
    double operator()(const Place& a, const Place& b) const {
      if (a.robot >= 0 &&
          !(*access)(static_cast<std::size_t>(a.robot), static_cast<std::size_t>(b.view)))
        return std::numeric_limits<double>::infinity();
      return distance(a.configuration, b.configuration);
    }
  };

 private:
  std::vector<std::vector<bool>> groups_;  // the robots that reach them
  std::vector<std::int32_t> group_of_;     // by view
};
}  // namespace surfleet
