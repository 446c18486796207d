// SPDX-License-Identifier: MIT
/// @file
/// @brief What a configuration would show of the map, found by casting rays through it.
///
///     IncompleteSurfaceGain gain(elements, states, frustum);
///     const auto seen = seen_from_all(gain, views, threads);
///     assign_gains(gain, seen, clusters);               // g(U) of eq. 2.1
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/mapping/voxel_traversal.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>
#include <surfleet/viewpoint/viewpoint_clustering.hpp>
#include <surfleet/viewpoint/visibility.hpp>

namespace surfleet {
/// What counts as gain.
///
/// `g.seen(q)` names what a configuration shows, as a sorted vector of distinct integers;
/// `g.value(n)` is the gain of n of them. Things are named, not counted, so that what two views
/// share counts once. `seen` is thread-safe.
template <typename G>
concept GainModel = requires(const G& g, const Configuration& q, std::size_t n) {
  { g.seen(q).front() } -> std::convertible_to<std::uint64_t>;
  { g.value(n) } -> std::convertible_to<double>;
};
template <GainModel G>
using SeenBy = std::decay_t<decltype(std::declval<const G&>().seen(Configuration{}))>;

/// C_q: the incomplete elements in the frustum and in sight; 1/|C| each [000 eq. 2.1].
///
/// Elements are kept by cells of eight voxels, so `seen` costs O(cells and elements in the
/// frustum's bounds + rays). Elements are named by their index in the span given, which is not
/// kept; the map must outlive this object and not gain blocks meanwhile.
class IncompleteSurfaceGain {
 public:
  IncompleteSurfaceGain(std::span<const IncompleteElement> elements, const VoxelStateMap& map,
                        const ViewFrustum& frustum, SightOptions sight = {})
      : map_(&map),
        frustum_(frustum),
        sight_(sight),
        total_(elements.size()),
        cells_({.voxel_size = 8.0 * map.voxel_size()}) {
    for (std::size_t i = 0; i < elements.size(); ++i)
      cells_.ensure(cells_.index_of(elements[i].position))
          .push_back({elements[i].position, elements[i].voxel, static_cast<std::int32_t>(i)});
  }

  std::vector<std::int32_t> seen(const Configuration& q) const {
    std::vector<std::int32_t> ids;
    const ViewFrustum::Placed placed = frustum_.at(q);
    const Point3 eye = placed.eye();
    LineOfSight line(*map_, sight_);
    const auto collect = [&](const VoxelIndex& index, const std::vector<Entry>& cell) {
      if (!placed.may_contain(cells_.center(index), 0.87 * cells_.voxel_size())) return;
      for (const Entry& e : cell)
        if (placed.contains(e.position) && line.sees(eye, e.voxel)) ids.push_back(e.id);
    };
    const Box3 box = placed.bounds();
    const VoxelIndex low = cells_.index_of(box.min()), high = cells_.index_of(box.max());
    const Eigen::Vector3d extent = (high - low).cast<double>() + Eigen::Vector3d::Ones();
    if (extent.prod() > static_cast<double>(cells_.block_count())) {
      cells_.for_each_block([&](const auto& b) { collect(b.index, b.voxels[0]); });
    } else {
      for_each_index(low, high, [&](const VoxelIndex& v) {
        if (const auto* cell = cells_.find(v)) collect(v, *cell);
      });
    }
    std::sort(ids.begin(), ids.end());
    return ids;
  }
  double value(std::size_t count) const {
    return total_ == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(total_);
  }

 private:
  struct Entry {
    Point3 position;
    VoxelIndex voxel;
    std::int32_t id;
  };
  const VoxelStateMap* map_;
  ViewFrustum frustum_;
  SightOptions sight_;
  std::size_t total_;
  VoxelGrid<std::vector<Entry>, 1> cells_;
};

struct UnknownVolumeOptions {
  int stride = 16;  ///< Between pixels that a ray is cast for [px].
  /// Along the optical axis [m]; nothing: the camera's farthest depth.
  std::optional<double> max_depth{};
};

/// The unknown voxels that rays through every `stride`-th pixel pass before they meet the surface;
/// the gain is their volume [m³].
///
/// O(rays × voxels a ray). The map must outlive this object and not gain blocks meanwhile.
class UnknownVolumeGain {
 public:
  UnknownVolumeGain(const VoxelStateMap& map, const ViewFrustum& frustum,
                    UnknownVolumeOptions options = {})
      : map_(&map), frustum_(frustum), options_(options) {
    require(options.stride > 0, "ray stride: expected one pixel or more");
    const PinholeCamera& c = frustum.camera();
    const double depth = options.max_depth.value_or(c.max_range);
    require(depth < 1e6 * map.voxel_size(), "depth: expected less than a million voxels");
    for (int v = options.stride / 2; v < c.height; v += options.stride)
      for (int u = options.stride / 2; u < c.width; u += options.stride)
        ends_.push_back(frustum.T_body_camera() * Point3(depth * c.ray(u, v)));
  }

  std::vector<std::uint64_t> seen(const Configuration& q) const {
    std::vector<std::uint64_t> keys;
    const ViewFrustum::Placed placed = frustum_.at(q);
    const Point3 eye = placed.eye();
    VoxelStateMap::Accessor state(*map_);
    for (const Point3& end : ends_) {
      traverse_voxels(eye, placed.to_world(end), map_->voxel_size(), [&](const VoxelIndex& v) {
        const VoxelState s = state(v);
        if (s == VoxelState::unknown) keys.push_back(key(v));
        return s != VoxelState::occupied;
      });
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    return keys;
  }
  double value(std::size_t count) const {
    const double s = map_->voxel_size();
    return static_cast<double>(count) * s * s * s;
  }

 private:
  /// Distinct within 2²¹ voxels an axis.
  static std::uint64_t key(const VoxelIndex& v) {
    const auto bits = [](int i) { return static_cast<std::uint64_t>(i) & 0x1fffffU; };
    return bits(v.x()) | bits(v.y()) << 21 | bits(v.z()) << 42;
  }
  const VoxelStateMap* map_;
  ViewFrustum frustum_;
  UnknownVolumeOptions options_;
  std::vector<Point3> ends_;  // of the rays, in the body frame
};
static_assert(GainModel<IncompleteSurfaceGain> && GainModel<UnknownVolumeGain>);

/// What each viewpoint shows, on up to `threads` threads.
template <GainModel G>
std::vector<SeenBy<G>> seen_from_all(const G& gain, std::span<const Viewpoint> views,
                                     int threads = 1) {
  std::vector<SeenBy<G>> seen(views.size());
  parallel_for(views.size(), threads,
               [&](std::size_t i) { seen[i] = gain.seen(views[i].configuration); });
  return seen;
}

/// What the views of a cluster show together, each thing once: C_U.
template <typename Seen>
Seen seen_by_cluster(const ViewpointCluster& cluster, const std::vector<Seen>& seen) {
  Seen all;
  for (const std::int32_t v : cluster.views) {
    const Seen& own = seen[static_cast<std::size_t>(v)];
    all.insert(all.end(), own.begin(), own.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Sets every cluster's gain, g(U) = value(|C_U|).
template <GainModel G>
void assign_gains(const G& gain, const std::vector<SeenBy<G>>& seen,
                  std::span<ViewpointCluster> clusters) {
  for (ViewpointCluster& c : clusters) c.gain = gain.value(seen_by_cluster(c, seen).size());
}
}  // namespace surfleet
