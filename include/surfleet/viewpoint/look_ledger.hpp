// SPDX-License-Identifier: MIT
/// @file
/// @brief What was looked at in vain, so that no robot looks for ever.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/viewpoint/left_reason.hpp>

namespace surfleet {
struct LookLedgerOptions {
  int max_looks = 1;     ///< Looks in vain before an element is given up.
  int max_failures = 3;  ///< Flights that found no way before it is.
  /// A look within this angle of one in vain would be in vain too [rad].
  double same_side = radians(40.0);
};

/// Remembers the looks that should have completed incomplete elements and did not.
///
/// What two voxels in each direction hold shares its looks: where surface cannot be completed,
/// noise moves the elements about by a voxel, and none of them is new.
class LookLedger {
 public:
  explicit LookLedger(LookLedgerOptions options = {})
      : options_(options), same_side_(std::cos(options.same_side)) {}

  /// A look that should have been enough left the element incomplete; `direction` is the unit
  /// vector from it to the camera. Looks from the same place count as one.
  void looked_in_vain(const VoxelIndex& v, const Eigen::Vector3d& direction) {
    std::vector<Eigen::Vector3d>& looks = entries_[key(v)].looks;
    if (std::none_of(looks.begin(), looks.end(),
                     [&](const Eigen::Vector3d& l) { return l.dot(direction) > kSamePlace; }))
      looks.push_back(direction);
  }
  /// No path was found to a configuration that sees these: one failure for each place.
  void not_reached(std::span<const VoxelIndex> voxels) {
    std::set<VoxelKey> places;
    for (const VoxelIndex& v : voxels) places.insert(key(v));
    for (const VoxelKey& place : places) ++entries_[place].failures;
  }

  /// How many sides were looked at in vain.
  std::size_t looks(const VoxelIndex& v) const {
    const auto it = entries_.find(key(v));
    return it == entries_.end() ? 0 : it->second.looks.size();
  }
  bool fresh(const VoxelIndex& v) const { return looks(v) == 0; }  ///< No look was in vain yet.
  /// Whether a look along this direction shows a side that was not looked at in vain.
  bool promises(const VoxelIndex& v, const Eigen::Vector3d& direction) const {
    const auto it = entries_.find(key(v));
    if (it == entries_.end()) return true;
    return std::none_of(it->second.looks.begin(), it->second.looks.end(),
                        [&](const Eigen::Vector3d& l) { return l.dot(direction) > same_side_; });
  }
  bool given_up(const VoxelIndex& v) const { return reason(v).has_value(); }
  /// Why nobody is sent there any more; nothing while it is worth another look.
  std::optional<LeftReason> reason(const VoxelIndex& v) const {
    const auto it = entries_.find(key(v));
    if (it == entries_.end()) return std::nullopt;
    if (static_cast<int>(it->second.looks.size()) >= options_.max_looks)
      return LeftReason::seen_incomplete;
    if (it->second.failures >= options_.max_failures) return LeftReason::unreachable;
    return std::nullopt;
  }

 private:
  struct Entry {
    std::vector<Eigen::Vector3d> looks;
    int failures = 0;
  };
  static constexpr double kSamePlace = 0.98;  ///< Cosine of ten degrees.
  static VoxelKey key(const VoxelIndex& v) { return {v.x() >> 1, v.y() >> 1, v.z() >> 1}; }
  LookLedgerOptions options_;
  double same_side_;
  std::map<VoxelKey, Entry> entries_;
};
}  // namespace surfleet
