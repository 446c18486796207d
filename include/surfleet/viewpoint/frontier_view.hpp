// SPDX-License-Identifier: MIT
/// @file
/// @brief Frontier views: cells of unknown space, and the viewing pose of the most gain for its
/// cost.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/motion/roadmap_passages.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>
#include <surfleet/viewpoint/view_limits.hpp>

namespace surfleet {
/// The space of a map in cells of two voxels along each axis; a cell is what its first voxel is.
/// Remembers the last block it read: one a thread.
class SpaceCells {
 public:
  using Cell = VoxelKey;

  explicit SpaceCells(const VoxelStateMap& map) : edge_(2.0 * map.voxel_size()), state_(map) {}

  double edge() const { return edge_; }  ///< [m]
  VoxelIndex at(const Point3& p) const { return (p / edge_).array().floor().cast<int>(); }
  /// Of the voxel that decides.
  Point3 center(const VoxelIndex& c) const {
    return (c.cast<double>() + Point3::Constant(0.25)) * edge_;
  }
  VoxelState state(const VoxelIndex& c) { return state_(c * 2); }

  /// Whether nothing that is known stands where a body there would be; if so, `note(Cell)` is told
  /// what is unknown. O(cells of the body).
  template <typename Note>
  bool has_room(const Point3& pose, double radius, Note&& note) {
    const int n = static_cast<int>(std::ceil(radius / edge_));
    const VoxelIndex middle = at(pose);
    std::vector<Cell> found;
    for (int z = -n; z <= n; ++z)
      for (int y = -n; y <= n; ++y)
        for (int x = -n; x <= n; ++x) {
          const VoxelIndex c = middle + VoxelIndex(x, y, z);
          if ((center(c) - pose).norm() > radius) continue;
          const VoxelState s = state(c);
          if (s == VoxelState::occupied) return false;
          if (s == VoxelState::unknown) found.push_back(key_of(c));
        }
    for (const Cell& c : found) note(c);
    return true;
  }

 private:
  double edge_;
  VoxelStateMap::Accessor state_;
};

/// Views of cells of unknown space; a cell that stays unknown after `max_views` is given up.
class FrontierViews {
 public:
  int max_views = kViewsInVain;  ///< At a cell before it is given up.

  struct Wanted {
    SpaceCells::Cell cell;
    double gain = 1.0;  ///< At most 1.
  };
  struct View {
    Configuration configuration;
    std::size_t site = 0;  // of the lattice
  };

  bool given_up(const SpaceCells::Cell& c) const {
    const auto it = taken_.find(c);
    return it != taken_.end() && it->second >= max_views;
  }

  /// One search among the cells wanted now; those that are given up should not be.
  class Search {
   public:
    /// From the lattice of the roadmap's space, and as far as `reach` [m]. All but the cells must
    /// outlive it.
    Search(FrontierViews& views, FlightLattice<FreeSpace>& lattice, const LazyPrmStar& roadmap,
           std::vector<Wanted> wanted, const VoxelStateMap& map, const HeadingTable& headings,
           double reach)
        : views_(&views),
          lattice_(&lattice),
          roadmap_(&roadmap),
          wanted_(std::move(wanted)),
          targets_(targets_of(wanted_, map), MapSight(map), headings, {.max_range = reach}),
          done_(wanted_.size(), 0) {}

    struct Limits {
      double least = 0.0;                                         ///< Gain that a view must have.
      double farthest = std::numeric_limits<double>::infinity();  ///< From the start [m].
      double saved = 0.0;  ///< No view costs less than its distance less so much [m].
      /// The last view, not to be repeated.
      std::optional<Configuration> made{};
    };
    /// The view of the highest gain over its cost, if any has gain; `cost(site)` is more than 0,
    /// and infinite where no view is to be taken [m].
    template <typename Cost>
    std::optional<View> best(const Point3& start, const Limits& limits, Cost&& cost) {
      std::optional<View> best;
      double best_rate = 0.0;
      const auto all = static_cast<double>(targets_.size());
      const auto visit = [&](const auto& site) {
        if (site.distance > limits.farthest || all <= best_rate * (site.distance - limits.saved))
          return false;
        const double metres = cost(site);
        if (all <= best_rate * metres || std::isinf(metres)) return true;
        const std::size_t id = lattice_->index(site.cell);
        const auto [it, fresh] = seen_.try_emplace(id);
        if (fresh) it->second = targets_.seen_from(site.position);
        auto gain = gain_by_view(targets_, it->second, done_);
        if (limits.made && (limits.made->position - site.position).norm() < kSamePlace)
          gain[static_cast<std::size_t>(targets_.headings().nearest_view(*limits.made))] = 0.0;
        for (std::size_t k = 0; k < gain.size(); ++k)
          if (gain[k] >= limits.least && gain[k] > best_rate * metres) {
            best_rate = gain[k] / metres;
            best = View{targets_.headings().at(site.position, static_cast<int>(k)), id};
          }
        return true;
      };
      lattice_->search(start, visit, RoadmapPassages(*roadmap_, roadmap_->reach_from(start)));
      return best;
    }
    /// The view will be taken: what it shows is wanted no more, and is one view nearer to being
    /// given up.
    void take(const View& view) {
      mark_in_view(seen_.at(view.site), targets_.headings().nearest_view(view.configuration), done_,
                   [&](std::size_t id) { ++views_->taken_[wanted_[id].cell]; });
    }

   private:
    static constexpr double kSamePlace = 0.02;  // [m]
    static std::vector<SightTarget> targets_of(const std::vector<Wanted>& wanted,
                                               const VoxelStateMap& map) {
      const SpaceCells cells(map);
      std::vector<SightTarget> targets;
      for (const Wanted& w : wanted)
        targets.push_back({cells.center(VoxelIndex(w.cell[0], w.cell[1], w.cell[2])),
                           Eigen::Vector3d::Zero(), w.gain, kDepth});
      return targets;
    }

    FrontierViews* views_;
    FlightLattice<FreeSpace>* lattice_;
    const LazyPrmStar* roadmap_;
    std::vector<Wanted> wanted_;
    SightTargets<> targets_;
    std::vector<char> done_;
    std::map<std::size_t, std::vector<Sighting>> seen_;  // by site
  };

 private:
  static constexpr int kDepth = 3;  ///< Unknown voxels that a line of sight may pass.
  std::map<SpaceCells::Cell, int> taken_;
};
}  // namespace surfleet
