// SPDX-License-Identifier: MIT
/// @file
/// @brief A configuration and the incomplete elements that are seen from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// A viewing pose and what it is for.
struct Viewpoint {
  Configuration configuration;
  /// From the targets towards the camera, unit.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  /// Indices into the list of incomplete elements it was made for, ascending.
  std::vector<std::int32_t> targets;
};

/// Why an incomplete element has no viewpoint.
enum class NoViewReason : std::uint8_t {
  viewed_in_vain,  ///< It could be seen, but only from where a view was in vain.
  outside_view,    ///< The camera's mount lets it be seen only from beyond the allowed angle.
  occluded,        ///< Something stands in every line of sight.
  no_free_pose,    ///< It could be seen, but the robot does not fit where it would have to be.
  unreachable,     ///< It could be seen from free poses, none of which can be reached.
};
inline const char* to_string(NoViewReason r) {
  switch (r) {
    case NoViewReason::viewed_in_vain:
      return "viewed_in_vain";
    case NoViewReason::outside_view:
      return "outside_view";
    case NoViewReason::occluded:
      return "occluded";
    case NoViewReason::no_free_pose:
      return "no_free_pose";
    case NoViewReason::unreachable:
      return "unreachable";
  }
  return "unknown";
}

/// What generation finds for one element.
struct ViewpointChoice {
  std::optional<Viewpoint> view;                 ///< Without targets.
  NoViewReason reason = NoViewReason::occluded;  ///< If there is no view.
  bool out_of_reach = false;  ///< A view was passed over because it could not be reached.
  /// Encloses, give or take a voxel's diagonal, where the map and the free space were asked about.
  Box3 asked;
};

/// An element that was given up, by its index in the list of elements.
struct UnseenElement {
  std::int32_t element = 0;
  NoViewReason reason = NoViewReason::occluded;
};

/// Viewpoints, and the elements that none was found for. Together they account for every element.
/// A range of `Viewpoint`, which converts to a span.
struct ViewpointSet {
  std::vector<Viewpoint> views;
  std::vector<UnseenElement> unseen;

  void add(std::int32_t element, const ViewpointChoice& choice) {
    if (choice.view)
      views.push_back({choice.view->configuration, choice.view->direction, {element}});
    else
      unseen.push_back({element, choice.reason});
  }

  std::size_t size() const { return views.size(); }
  bool empty() const { return views.empty(); }
  const Viewpoint* data() const { return views.data(); }
  auto begin() const { return views.begin(); }
  auto end() const { return views.end(); }
  const Viewpoint& operator[](std::size_t i) const { return views[i]; }
};
}  // namespace surfleet
