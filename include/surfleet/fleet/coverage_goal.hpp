// SPDX-License-Identifier: MIT
/// @file
/// @brief When a mission by its own account has covered the share that was asked for.
///
///     if (goal.is_reached(belief, now)) agent.retire(StopReason::coverage_goal);
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
/// Follows what a belief covers by the change. An account costs O(surface), so the next is taken
/// once so much of the surface has changed that the goal may be reached: half of what was lacking,
/// and a hundredth of the surface at the least, so that all accounts together cost O(changes).
class CoverageGoal {
 public:
  /// Of all surface that was met or is expected, a share; nothing: never reached.
  explicit CoverageGoal(std::optional<double> share = {}) : share_(share) {}

  /// To be asked in every step of the clock, of the same belief.
  bool is_reached(const SurfaceBelief& belief, double now) {
    if (!share_ || reached_ || now < next_question_) return reached_;
    next_question_ = now + kQuestions;
    const VoxelStateMap::Grid& grid = belief.known().grid();
    if (grid.revision() == revision_) return false;
    if (asked_) {
      std::size_t changed = 0;
      for (const std::uint32_t slot : grid.changed_since(revision_))
        changed += holds_surface(grid.block(slot)) ? 1 : 0;
      const double least = std::max(kLeastChange, 0.5 * lacking_) * static_cast<double>(surface_);
      if (static_cast<double>(changed) < least && now < *asked_ + kLongest) return false;
    }
    asked_ = now;
    revision_ = grid.revision();
    surface_ = 0;
    grid.for_each_block(
        [&](const VoxelStateMap::Grid::Block& block) { surface_ += holds_surface(block) ? 1 : 0; });
    const double covered = belief.estimate_coverage().share();
    ++accounts_;
    lacking_ = *share_ - covered;
    reached_ = lacking_ <= 0.0;
    return reached_;
  }
  std::size_t accounts() const { return accounts_; }  ///< Taken so far.

 private:
  static constexpr double kLeastChange = 0.01;  ///< Of the surface's blocks.
  static constexpr double kQuestions = 1.0;     ///< Between looks at what has changed [s].
  static constexpr double kLongest = 20.0;      ///< Between accounts while anything changes [s].

  static bool holds_surface(const VoxelStateMap::Grid::Block& block) {
    return !block.layer.known.empty() || std::find(block.voxels.begin(), block.voxels.end(),
                                                   VoxelState::occupied) != block.voxels.end();
  }

  std::optional<double> share_;
  std::optional<double> asked_;  // when the last account was taken [s]
  bool reached_ = false;
  double lacking_ = 1.0;        // of the goal, by that account
  std::size_t surface_ = 0;     // blocks that held surface then
  std::uint64_t revision_ = 0;  // of the states that it was of
  double next_question_ = 0.0;  // [s]
  std::size_t accounts_ = 0;
};
}  // namespace surfleet
