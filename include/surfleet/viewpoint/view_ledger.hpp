// SPDX-License-Identifier: MIT
/// @file
/// @brief Which views were in vain, so that observation ends.
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
#include <surfleet/mapping/view_notes.hpp>
#include <surfleet/viewpoint/left_reason.hpp>

namespace surfleet {
struct ViewLedgerOptions {
  int max_views = 1;     ///< In vain, before an element is given up.
  int max_failures = 3;  ///< Searches without a path, before it is.
  /// A view within this angle of one in vain would be in vain too [rad].
  double same_side = radians(40.0);
};

/// Remembers the views that should have completed incomplete elements and did not.
///
/// Elements within two voxels along each axis share their views: where surface cannot be completed,
/// noise moves the elements about by a voxel, and none of them is new. Views are a set and failures
/// sums, so that what others note is added in any order and taken away again without a trace: equal
/// notes make equal ledgers.
class ViewLedger {
 public:
  explicit ViewLedger(ViewLedgerOptions options = {})
      : options_(options), same_side_(std::cos(options.same_side)) {}

  // -- what comes in -----------------------------------------------------------------------------
  /// A view that should have been enough left the element incomplete; `direction` is the unit
  /// vector from it to the camera. Views from the same place count as one.
  void viewed_in_vain(const VoxelIndex& v, const Eigen::Vector3d& direction) {
    const VoxelKey place = view_place(v);
    Entry& entry = entries_[place];
    for (const auto& [view, times] : entry.views)
      if (unit_vector(view).dot(direction) > kSamePlace) return;
    const ViewDirection view = quantised(direction);
    ++entry.views[view];
    news_.views.push_back({place, view});
  }
  /// No path was found to a configuration that sees these: one failure for each place.
  void not_reached(std::span<const VoxelIndex> voxels) {
    std::set<VoxelKey> places;
    for (const VoxelIndex& v : voxels) places.insert(view_place(v));
    for (const VoxelKey& place : places) {
      int& failures = entries_[place].failures;
      if (failures >= options_.max_failures) continue;
      ++failures;
      news_.failures.push_back({place, 1});
    }
  }
  /// What another robot of this kind has noted. O(n log n).
  void add(const ViewNotes& notes) { change(notes, 1); }
  /// Takes away what was added, or noted here: what is left is as if it had never come. Throws
  /// `Error`, and changes nothing, if it is not there.
  void remove(const ViewNotes& notes) {
    for (const ViewNotes::View& v : notes.views) {
      const auto it = entries_.find(v.place);
      require(it != entries_.end() && it->second.views.contains(v.direction),
              "views in vain: expected some that were added");
    }
    for (const ViewNotes::Failure& f : notes.failures) {
      const auto it = entries_.find(f.place);
      require(it != entries_.end() && it->second.failures >= f.count,
              "failures: expected some that were added");
    }
    change(notes, -1);
  }
  /// What was noted here since the last call, for others.
  ViewNotes take_news() {
    ViewNotes news = merged_notes(std::span<const ViewNotes>(&news_, 1));
    news_ = {};
    return news;
  }
  bool has_news() const { return !news_.empty(); }

  // -- what is held ------------------------------------------------------------------------------
  std::size_t views_in_vain(const VoxelIndex& v) const {
    const auto it = entries_.find(view_place(v));
    return it == entries_.end() ? 0 : it->second.views.size();
  }
  bool fresh(const VoxelIndex& v) const { return views_in_vain(v) == 0; }
  /// Whether this viewing direction shows a side that was not viewed in vain.
  bool promises(const VoxelIndex& v, const Eigen::Vector3d& direction) const {
    const auto it = entries_.find(view_place(v));
    if (it == entries_.end()) return true;
    return std::none_of(it->second.views.begin(), it->second.views.end(), [&](const auto& view) {
      return unit_vector(view.first).dot(direction) > same_side_;
    });
  }
  bool given_up(const VoxelIndex& v) const { return reason(v).has_value(); }
  /// Why no robot is sent there any more; nothing while another view may help.
  std::optional<LeftReason> reason(const VoxelIndex& v) const {
    const auto it = entries_.find(view_place(v));
    if (it == entries_.end()) return std::nullopt;
    const auto most = static_cast<std::size_t>(std::max(options_.max_views, 0));
    if (it->second.views.size() >= most && it->second.sides() >= most)
      return LeftReason::seen_incomplete;
    if (it->second.failures >= options_.max_failures) return LeftReason::unreachable;
    return std::nullopt;
  }
  /// Whether the same was noted, by whichever robots in whatever order.
  bool operator==(const ViewLedger& other) const { return entries_ == other.entries_; }

 private:
  struct Entry {
    std::map<ViewDirection, int> views;  // how often each was noted
    int failures = 0;
    bool operator==(const Entry&) const = default;
    bool empty() const { return views.empty() && failures == 0; }
    /// Views of several robots from the same place count as one, too.
    std::size_t sides() const {
      std::vector<Eigen::Vector3d> counted;
      for (const auto& [view, times] : views) {
        const Eigen::Vector3d l = unit_vector(view);
        if (std::none_of(counted.begin(), counted.end(),
                         [&](const Eigen::Vector3d& c) { return c.dot(l) > kSamePlace; }))
          counted.push_back(l);
      }
      return counted.size();
    }
  };
  void change(const ViewNotes& notes, int sign) {
    for (const ViewNotes::View& v : notes.views) {
      Entry& entry = entries_[v.place];
      if ((entry.views[v.direction] += sign) == 0) entry.views.erase(v.direction);
      if (entry.empty()) entries_.erase(v.place);
    }
    for (const ViewNotes::Failure& f : notes.failures) {
      Entry& entry = entries_[f.place];
      entry.failures += sign * f.count;
      if (entry.empty()) entries_.erase(f.place);
    }
  }

  static constexpr double kSamePlace = 0.98;  ///< Cosine of ten degrees.
  ViewLedgerOptions options_;
  double same_side_;
  std::map<VoxelKey, Entry> entries_;
  ViewNotes news_;  // not sorted
};
}  // namespace surfleet
