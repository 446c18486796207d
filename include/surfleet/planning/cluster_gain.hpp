// SPDX-License-Identifier: MIT
/// @file
/// @brief The gain of clusters of viewpoints, for tour planners [000 §2.4.3, 2.4.4].
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/viewpoint/gain.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/view_memory.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>
#include <surfleet/viewpoint/viewpoint_clustering.hpp>

namespace surfleet {
/// Viewpoints that are to be valued, and what they were made for.
struct ViewsToValue {
  std::span<const Viewpoint> views;
  std::span<const IncompleteElement> elements;  ///< Their targets; may leave from call to call.
  const ViewFrustum& frustum;
  const SurfaceSituation& situation;
};

/// The gain of every cluster: `gain(views, clusters)` sets it, above 0. It may keep what views
/// showed until `forget(boxes)` names where maps have changed, or `reset()` all of it.
template <typename G>
concept ClusterGain = requires(G& gain, const ViewsToValue& views,
                               std::span<ViewpointCluster> clusters, std::span<const Box3> boxes) {
  gain(views, clusters);
  gain.forget(boxes);
  gain.reset();
};

namespace detail {
/// Every view was made for something in its sight, so only a merged one can show nothing: half of
/// one thing then.
template <GainModel G>
void assign_positive_gains(const G& gain, const std::vector<SeenBy<G>>& seen,
                           std::span<ViewpointCluster> clusters) {
  assign_gains(gain, seen, clusters);
  for (ViewpointCluster& c : clusters) c.gain = std::max(c.gain, 0.5 * gain.value(1));
}
}  // namespace detail

/// The share of the incomplete elements in sight [000 eq. 2.1].
struct ElementsInSight {
  /// Whether rays end at the first voxel that is not empty [000 §2.4.3]; if not, they pass what is
  /// unknown.
  bool ends_at_unknown = false;

  void operator()(const ViewsToValue& v, std::span<ViewpointCluster> clusters) {
    const IncompleteSurfaceGain gain(v.elements, v.situation.belief.observed(), v.frustum,
                                     {.unknown_blocks = ends_at_unknown});
    detail::assign_positive_gains(
        gain,
        seen_(v.views, v.elements, v.frustum, [&](const Configuration& q) { return gain.seen(q); }),
        clusters);
  }
  void forget(std::span<const Box3> changed) { seen_.forget(changed); }
  void reset() { seen_ = {}; }

 private:
  SightMemory seen_;
};

/// The volume of the unknown voxels in sight [m³], as explorers count it.
struct UnknownInSight {
  UnknownVolumeOptions rays;

  void operator()(const ViewsToValue& v, std::span<ViewpointCluster> clusters) {
    const UnknownVolumeGain gain(v.situation.belief.observed(), v.frustum, rays);
    detail::assign_positive_gains(gain, seen_from_all(gain, v.views), clusters);
  }
  void forget(std::span<const Box3> /*changed*/) {}
  void reset() {}
};
static_assert(ClusterGain<ElementsInSight> && ClusterGain<UnknownInSight>);
}  // namespace surfleet
