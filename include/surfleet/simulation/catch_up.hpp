// SPDX-License-Identifier: MIT
/// @file
/// @brief How long a distributed fleet takes to share what it could not share before.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/fleet/network_conditions.hpp>
#include <surfleet/fleet/patch_ids.hpp>

namespace surfleet {
/// After a partition or a cut, or when a robot began anew: from then until all that are left held
/// every patch that any of them had held at that moment.
struct CatchUp {
  double from = 0.0;           ///< [s]
  std::optional<double> took;  ///< [s]; nothing if it never came to that.
};

/// Compares what robots hold at every tick.
class CatchUpWatch {
 public:
  explicit CatchUpWatch(const NetworkConditions& network) {
    for (const NetworkPartition& p : network.partitions) due_.push_back(p.until);
    for (const OneWayCut& c : network.cuts) due_.push_back(c.until);
  }
  /// Watches from a time on, that of the next tick or later.
  void add(double time) { due_.push_back(time); }

  /// What the robots that are left hold at a time. O(robots × runs of their sets) while it waits.
  void observe(double now, std::span<const PatchIdSet* const> held) {
    for (double& time : due_) {
      if (time > now) continue;
      time = std::numeric_limits<double>::infinity();
      PatchIdSet all;
      for (const PatchIdSet* one : held)
        one->for_each_beyond({}, [&](const PatchKey& key) {
          all.insert(key);
          return true;
        });
      catch_ups_.push_back({now, std::nullopt});
      wanted_.push_back(std::move(all));
    }
    for (std::size_t k = 0; k < wanted_.size(); ++k) {
      if (catch_ups_[k].took) continue;
      bool all = true;
      for (const PatchIdSet* one : held)
        wanted_[k].for_each_beyond(*one, [&](const PatchKey&) { return all = false; });
      if (all) catch_ups_[k].took = now - catch_ups_[k].from;
    }
  }
  const std::vector<CatchUp>& catch_ups() const { return catch_ups_; }

 private:
  std::vector<double> due_;  // [s]; infinite once it has come
  std::vector<CatchUp> catch_ups_;
  std::vector<PatchIdSet> wanted_;  // by each
};
}  // namespace surfleet
