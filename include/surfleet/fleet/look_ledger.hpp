// SPDX-License-Identifier: MIT
/// @file  What was looked at in vain, so that no robot looks for ever.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include <surfleet/fleet/plan.hpp>

namespace surfleet {
/// Counts, for every incomplete element, the looks that should have completed it and did not.
class LookLedger {
 public:
  explicit LookLedger(int max_looks = 3) : max_looks_(max_looks) {}

  /// A look that should have been enough left the element incomplete.
  void looked_in_vain(const VoxelIndex& v) { ++entries_[key(v)].looks; }
  /// No path was found to a configuration that sees it.
  void not_reached(const VoxelIndex& v) { ++entries_[key(v)].failures; }
  bool given_up(const VoxelIndex& v) const { return reason(v).has_value(); }
  /// Why nobody is sent there any more; nothing while it is worth another look.
  std::optional<LeftReason> reason(const VoxelIndex& v) const {
    const auto it = entries_.find(key(v));
    if (it == entries_.end()) return std::nullopt;
    if (it->second.looks >= max_looks_) return LeftReason::seen_incomplete;
    if (it->second.failures >= max_looks_) return LeftReason::unreachable;
    return std::nullopt;
  }

 private:
  struct Entry {
    int looks = 0, failures = 0;
  };
  using Key = std::array<int, 3>;
  static Key key(const VoxelIndex& v) { return {v.x(), v.y(), v.z()}; }
  int max_looks_;
  std::map<Key, Entry> entries_;
};
}  // namespace surfleet
