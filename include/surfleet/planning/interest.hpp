// SPDX-License-Identifier: MIT
/// @file
/// @brief Targets of views: incomplete surface, surface predicted behind it, the frontier.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <vector>

#include <surfleet/planning/plan.hpp>
#include <surfleet/viewpoint/frontiers.hpp>
#include <surfleet/viewpoint/gain_around.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>
#include <surfleet/viewpoint/surface_prediction.hpp>

namespace surfleet {
struct InterestOptions {
  /// Elements and predicted surface are targets in cells this wide, over the range; in whole
  /// voxels, two of them at least.
  double cell_share = 0.08;
  /// What an incomplete element counts, in faces of a voxel: more than it shows, as one that is
  /// left behind costs a stop.
  double element_faces = 4.0;
  double prediction_reach = 0.8;  ///< How far surface is predicted to go on, over the range.
  double prediction_gain = 0.6;   ///< Of predicted surface, over that of surface at hand.
  double frontier_gain = 0.5;     ///< Of an area of frontier, over that of surface at hand.
  /// So much surface to be seen around a piece of frontier makes it count fully, over the range
  /// squared.
  double frontier_full = 0.3;
};

/// The targets of views, from three sources. For one mission, as it remembers views in vain.
///
/// Incomplete elements of a cell that face alike are one target. Predicted surface counts half as
/// much each time that a view did not bring it. The frontier, where unknown space borders on empty
/// space of the region, counts for what it may hide: by how much surface there is around, and far
/// from any by how often frontier at that height turned out to hold some.
class Interest {
 public:
  InterestOptions options;

  explicit Interest(InterestOptions o = {}) : options(o) {}

  /// Of the situation's goals, less those that the ledger has no hope for. The targets of elements
  /// come first, then predicted patches, then frontier. `finely`, elements are in cells of two
  /// voxels: where the one that stands for a cell cannot be seen, another may. O(goals + frontier),
  /// and the change of the map.
  std::vector<SightTarget> operator()(const SurfaceSituation& situation, bool finely = false) {
    const double range = situation.space().kind.camera.max_range;
    cell_ = std::max(kFine, static_cast<int>(options.cell_share * range /
                                             situation.belief.known().voxel_size()));
    is_fine_ = finely || cell_ == kFine;
    std::vector<SightTarget> targets;
    add_elements(situation, is_fine_ ? kFine : cell_, targets);
    elements_ = targets.size();
    add_predicted(situation, range, targets);
    predicted_ = targets.size();
    if (options.frontier_gain > 0.0) add_frontier(situation, range, targets);
    return targets;
  }
  /// Whether the last call had elements in cells of two voxels.
  bool is_fine() const { return is_fine_; }
  /// The goals that a target of the last call stands for, by their place among them.
  std::span<const std::int32_t> goals(std::size_t target) const {
    return target < members_.size() ? std::span<const std::int32_t>(members_[target])
                                    : std::span<const std::int32_t>();
  }
  /// A view of this target of the last call, at `position`, did not bring it.
  void viewed_in_vain(std::size_t target, const Point3& position, double voxel) {
    if (target >= predicted_)
      frontier_.note_view(target - predicted_);
    else if (target >= elements_)
      ++vain_[cell_of(position, voxel)];
  }

 private:
  /// In cells of so many voxels.
  void add_elements(const SurfaceSituation& situation, int cell,
                    std::vector<SightTarget>& targets) {
    const double voxel = situation.belief.known().voxel_size();
    members_.clear();
    std::unordered_map<std::uint64_t, std::size_t> groups;
    for (std::size_t i = 0; i < situation.goals.size(); ++i) {
      const IncompleteElement& e = situation.goals[i];
      if (!situation.belief.ledger().fresh(e.voxel)) continue;
      int axis = 0;
      e.direction.cwiseAbs().maxCoeff(&axis);
      auto key = static_cast<std::uint64_t>(2 * axis + (e.direction[axis] > 0.0 ? 1 : 0));
      for (int k = 0; k < 3; ++k)
        key = key << 20 | (static_cast<std::uint64_t>(cell_of_width(e.voxel[k], cell)) & 0xfffffU);
      const auto [it, fresh] = groups.try_emplace(key, targets.size());
      if (fresh) {
        targets.push_back({e.frontier(voxel), e.direction, 0.0, kDepth});
        members_.emplace_back();
      }
      targets[it->second].gain += options.element_faces * voxel * voxel;
      members_[it->second].push_back(static_cast<std::int32_t>(i));
    }
  }
  void add_predicted(const SurfaceSituation& situation, double range,
                     std::vector<SightTarget>& targets) {
    const double voxel = situation.belief.known().voxel_size();
    const double reach = options.prediction_reach * range;
    // Where patches are wide, one element of a cell leads to those that its neighbours would.
    std::vector<IncompleteElement> first;
    if (cell_ > kFine)
      for (const auto& of : members_)
        first.push_back(situation.goals[static_cast<std::size_t>(of[0])]);
    for (const PredictedPatch& p :
         predict_(cell_ > kFine ? std::span<const IncompleteElement>(first) : situation.goals,
                  situation.belief.known(),
                  {.reach = reach, .step = cell_ * voxel, .region = situation.belief.region()})) {
      const auto vain = vain_.find(cell_of(p.position, voxel));
      const double hope = vain == vain_.end() ? 1.0 : std::pow(0.5, vain->second);
      targets.push_back({p.position, p.normal, options.prediction_gain * p.area * hope,
                         static_cast<int>(reach / voxel)});
    }
  }
  void add_frontier(const SurfaceSituation& situation, double range,
                    std::vector<SightTarget>& targets) {
    frontier_.update(situation.belief.observed(), situation.belief.region(), kFrontierCell * range);
    const GainAround surface(targets, kNear * range);
    const double full = options.frontier_full * range * range;
    const double area = frontier_.edge() * frontier_.edge();
    for (std::size_t i = 0; i < frontier_.size(); ++i) {
      const double near = surface(frontier_.center(i));
      if (near > 0.0) frontier_.note_near(i);
      const double share =
          std::max(std::min(1.0, near / full),
                   std::min(1.0, frontier_.chance(i) / frontier_.options().prior_chance));
      targets.push_back(
          {frontier_.center(i), Eigen::Vector3d::Zero(), share * options.frontier_gain * area,
           static_cast<int>(
               std::lround(frontier_.edge() / situation.belief.known().voxel_size()))});
    }
  }
  VoxelKey cell_of(const Point3& p, double voxel) const {
    return key_of(VoxelIndex((p / (cell_ * voxel)).array().floor().cast<int>()));
  }

  static constexpr int kFine = 2;   ///< The least edge of a cell [voxels].
  static constexpr int kDepth = 2;  ///< Unknown voxels before an element that a view may pass.
  static constexpr double kFrontierCell = 0.19;  ///< Its edge over the range.
  static constexpr double kNear = 0.6;  ///< So near is around a piece of frontier, over the range.

  std::vector<std::vector<std::int32_t>> members_;  // goals by target
  std::size_t elements_ = 0, predicted_ = 0;        // where their targets end
  int cell_ = kFine;                                // its edge [voxels]
  bool is_fine_ = true;
  SurfacePredictor predict_;
  Frontiers frontier_;
  std::map<VoxelKey, int> vain_;  // views of predicted surface
};
}  // namespace surfleet
