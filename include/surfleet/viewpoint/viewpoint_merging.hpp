// SPDX-License-Identifier: MIT
/// @file
/// @brief Viewpoints that nearly coincide become one.
///
///     const auto fewer = merge_viewpoints(views, {.distance = 0.75}, sees_and_is_free);
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/viewpoint/detail/point_cells.hpp>
#include <surfleet/viewpoint/incomplete_element.hpp>
#include <surfleet/viewpoint/revealing_view.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>
#include <surfleet/viewpoint/viewpoint_predicates.hpp>
#include <surfleet/viewpoint/visibility.hpp>

namespace surfleet {
struct MergeOptions {
  double distance = 0.75;    ///< ε: positions at most this far apart are merged [m].
  double cos_angle = 0.966;  ///< Least cosine between viewing directions that are merged (15°).
};

/// Merges viewpoints that nearly coincide by averaging positions and headings [000 §2.4.2].
///
/// In order, each viewpoint joins the nearest group whose first member is within ε and has nearly
/// the same viewing direction, if `accept(merged)` holds for what the group becomes; else it starts
/// a group of its own. So what was acceptable stays acceptable: pass a predicate that asks whether
/// the pose is free, and, where that matters, whether its targets are seen (`SeesTargets`).
/// Directions count with their sign: opposite viewing directions are not merged. Targets are
/// united. About O(viewpoints).
template <typename Accept>
requires std::predicate<const Accept&, const Viewpoint&> std::vector<Viewpoint> merge_viewpoints(
    std::span<const Viewpoint> views, const MergeOptions& options, const Accept& accept) {
  require(options.distance >= 0.0 && std::isfinite(options.distance),
          "merging distance: expected a length of zero or more");
  struct Group {
    Eigen::Vector3d position_sum, direction_sum;
    Eigen::Vector2d heading_sum;
    double count;
  };
  std::vector<Viewpoint> merged;
  std::vector<Group> groups;
  std::vector<Eigen::Vector3d> first_direction;
  std::vector<double> first_yaw;
  detail::PointCells cells(std::max(options.distance, 1e-3));
  std::vector<std::pair<double, std::int32_t>> near;
  for (const Viewpoint& view : views) {
    const Configuration& q = view.configuration;
    near.clear();
    cells.for_each_within(q.position, options.distance, [&](std::int32_t id, double d2) {
      const auto g = static_cast<std::size_t>(id);
      if (first_direction[g].dot(view.direction) >= options.cos_angle &&
          std::cos(first_yaw[g] - q.yaw) >= options.cos_angle)
        near.emplace_back(d2, id);
    });
    std::sort(near.begin(), near.end());
    const Eigen::Vector2d heading(std::cos(q.yaw), std::sin(q.yaw));
    bool joined = false;
    for (const auto& [d2, id] : near) {
      const auto g = static_cast<std::size_t>(id);
      Group grown = groups[g];
      grown.position_sum += q.position;
      grown.direction_sum += view.direction;
      grown.heading_sum += heading;
      grown.count += 1.0;
      Viewpoint candidate;
      candidate.configuration.position = grown.position_sum / grown.count;
      candidate.configuration.yaw = std::atan2(grown.heading_sum.y(), grown.heading_sum.x());
      candidate.direction = grown.direction_sum.normalized();
      std::set_union(merged[g].targets.begin(), merged[g].targets.end(), view.targets.begin(),
                     view.targets.end(), std::back_inserter(candidate.targets));
      if (!accept(static_cast<const Viewpoint&>(candidate))) continue;
      groups[g] = grown;
      merged[g] = std::move(candidate);
      joined = true;
      break;
    }
    if (joined) continue;
    cells.insert(q.position, static_cast<std::int32_t>(merged.size()));
    merged.push_back(view);
    groups.push_back({q.position, view.direction, heading, 1.0});
    first_direction.push_back(view.direction);
    first_yaw.push_back(q.yaw);
  }
  return merged;
}
/// The same where every merged pose is welcome.
inline std::vector<Viewpoint> merge_viewpoints(std::span<const Viewpoint> views,
                                               const MergeOptions& options = {}) {
  return merge_viewpoints(views, options, [](const Viewpoint&) { return true; });
}

/// Whether a viewpoint's pose is free and it reveals each of its targets. For `merge_viewpoints`.
/// The map and the elements must outlive it.
template <ConfigurationPredicate IsFree>
struct SeesTargets {
  std::span<const IncompleteElement> elements;
  const VoxelStateMap* map;
  ViewFrustum frustum;
  IsFree is_free;
  SightOptions sight = {};

  bool operator()(const Viewpoint& view) const {
    if (!is_free(view.configuration)) return false;
    const ViewFrustum::Placed placed = frustum.at(view.configuration);
    LineOfSight line(*map, sight);
    return std::all_of(view.targets.begin(), view.targets.end(), [&](std::int32_t t) {
      const IncompleteElement& e = elements[static_cast<std::size_t>(t)];
      return reveals(placed, e, line);
    });
  }
};
template <typename IsFree>
SeesTargets(std::span<const IncompleteElement>, const VoxelStateMap*, ViewFrustum, IsFree)
    -> SeesTargets<IsFree>;
}  // namespace surfleet
