// SPDX-License-Identifier: MIT
/// @file
/// @brief What planning keeps from call to call of viewpoints and of what they show.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/view_ledger.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>
#include <surfleet/viewpoint/viewpoint_generation.hpp>

namespace surfleet {
/// Where the maps of a mission changed between two calls.
class ChangedRegions {
 public:
  /// Boxes that hold whatever has changed since the last call, in either map, the free space and
  /// the incomplete elements that follow them. Always of the same. O(blocks changed).
  std::vector<Box3> operator()(const VoxelStateMap& known, const VoxelStateMap& observed,
                               const FreeSpace& free_space) {
    std::vector<Box3> boxes;
    const auto follow = [&](const auto& grid, std::uint64_t& cursor) {
      // An element and a free place depend on the voxels beside them.
      const double h = grid.voxel_size();
      const Eigen::Vector3d beside = Eigen::Vector3d::Constant(2.0 * h);
      for (const std::uint32_t slot : grid.changed_since(cursor)) {
        const Point3 low = grid.block(slot).origin().template cast<double>() * h;
        const Point3 high = low + Eigen::Vector3d::Constant(VoxelStateMap::Grid::kBlockSide * h);
        boxes.emplace_back(low - beside, high + beside);
      }
      cursor = grid.revision();
    };
    follow(known.grid(), known_);
    follow(observed.grid(), observed_);
    follow(free_space.grid(), free_);
    return boxes;
  }

 private:
  std::uint64_t known_ = 0, observed_ = 0, free_ = 0;
};

/// Values by key that hold until something changes in the region they were found in.
template <typename Key, typename Value>
class RegionalMemory {
 public:
  /// O(values × boxes).
  void forget(std::span<const Box3> changed) {
    std::erase_if(entries_, [&](const auto& entry) {
      return std::any_of(changed.begin(), changed.end(),
                         [&](const Box3& box) { return box.intersects(entry.second.region); });
    });
  }
  const Value* find(const Key& key) const {
    const auto it = entries_.find(key);
    return it == entries_.end() ? nullptr : &it->second.value;
  }
  void keep(const Key& key, const Box3& region, Value value) {
    entries_.insert_or_assign(key, Entry{region, std::move(value)});
  }

 private:
  struct Entry {
    Box3 region;
    Value value;
  };
  std::map<Key, Entry> entries_;
};

/// The viewpoints chosen for elements.
class ViewpointMemory {
 public:
  void forget(std::span<const Box3> changed) { memory_.forget(changed); }

  /// What `generate` finds for each element, as `generate_viewpoints` gives it. `is_free` must be a
  /// function of the free space and `promises` one of the ledger's views alone; `is_reachable` is
  /// asked anew.
  template <ConfigurationPredicate IsFree, ConfigurationPredicate IsReachable,
            ViewPredicate Promises>
  ViewpointSet operator()(ViewpointGenerator& generate, std::span<const IncompleteElement> elements,
                          const ViewLedger& ledger, const IsFree& is_free,
                          const IsReachable& is_reachable, const Promises& promises) {
    ViewpointSet set;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const IncompleteElement& e = elements[i];
      const VoxelKey key = key_of(e.voxel);
      const std::size_t in_vain = ledger.views_in_vain(e.voxel);
      const Known* known = memory_.find(key);
      const bool holds = known != nullptr && known->in_vain == in_vain &&
                         known->unknown == e.unknown && known->direction == e.direction &&
                         (!known->choice.view || is_reachable(known->choice.view->configuration));
      const ViewpointChoice choice =
          holds ? known->choice : generate(e, is_free, is_reachable, promises);
      // What can be reached changes everywhere at once.
      if (!holds && !choice.out_of_reach)
        memory_.keep(key, choice.asked, {e.direction, e.unknown, in_vain, choice});
      set.add(static_cast<std::int32_t>(i), choice);
    }
    return set;
  }

 private:
  struct Known {
    Eigen::Vector3d direction;  // of the element
    std::uint32_t unknown;      // its neighbours
    std::size_t in_vain;        // views of it
    ViewpointChoice choice;
  };
  RegionalMemory<VoxelKey, Known> memory_;
};

/// The elements that configurations show.
class SightMemory {
 public:
  void forget(std::span<const Box3> changed) { memory_.forget(changed); }

  /// `shows(q)` for the configuration of each view: indices into `elements`, ascending. They must
  /// be a function of the maps inside the frustum. Between calls without a change there elements
  /// may leave the list, but none may come.
  template <typename Shows>
  std::vector<std::vector<std::int32_t>> operator()(std::span<const Viewpoint> views,
                                                    std::span<const IncompleteElement> elements,
                                                    const ViewFrustum& frustum,
                                                    const Shows& shows) {
    std::map<VoxelKey, std::int32_t> index;
    for (std::size_t i = 0; i < elements.size(); ++i)
      index.emplace(key_of(elements[i].voxel), static_cast<std::int32_t>(i));
    std::vector<std::vector<std::int32_t>> all;
    all.reserve(views.size());
    for (const Viewpoint& view : views) {
      const Configuration& q = view.configuration;
      const std::array<double, 5> key{q.position.x(), q.position.y(), q.position.z(), q.yaw,
                                      q.pitch};
      std::vector<std::int32_t> ids;
      if (const std::vector<VoxelKey>* known = memory_.find(key)) {
        for (const VoxelKey& v : *known)
          if (const auto it = index.find(v); it != index.end()) ids.push_back(it->second);
        std::sort(ids.begin(), ids.end());
      } else {
        ids = shows(q);
        std::vector<VoxelKey> voxels;
        for (const std::int32_t id : ids)
          voxels.push_back(key_of(elements[static_cast<std::size_t>(id)].voxel));
        Box3 region = frustum.at(q).bounds();
        region.extend(frustum.at(q).eye());
        memory_.keep(key, region, std::move(voxels));
      }
      all.push_back(std::move(ids));
    }
    return all;
  }

 private:
  RegionalMemory<std::array<double, 5>, std::vector<VoxelKey>> memory_;
};
}  // namespace surfleet
