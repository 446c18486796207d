// SPDX-License-Identifier: MIT
/// @file
/// @brief The view that opens a path.
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/planning/plan.hpp>
#include <surfleet/viewpoint/frontier_view.hpp>
#include <surfleet/viewpoint/view_limits.hpp>

namespace surfleet {
/// Sends a robot to view the unknown space that its body needs along a path: by the view of the
/// most such space per metre of detour. Space that stays unknown after `max_views` is not asked for
/// again. For one mission.
class OpeningViews {
 public:
  int max_views = kViewsInVain;  ///< At a piece of space before it is given up.

  /// A view for a robot at `from`, or beside it at `start`, which is free; not the view it has just
  /// taken. `path` begins at the last place known to be free, where the robot could be already.
  /// Nothing if no place can be reached from which something wanted shows.
  std::optional<Stop> operator()(const SurfaceSituation& situation,
                                 FlightLattice<FreeSpace>& lattice, const ReachFrom& reach,
                                 const Configuration& from, const Point3& start,
                                 std::span<const Point3> path) {
    const double range = situation.space().kind.camera.max_range;
    const FreeSpace& space = situation.space().free;
    SpaceCells cells(space.map());
    std::map<SpaceCells::Cell, double> wanted;
    double along = 0.0;
    frontier_views_.max_views = max_views;
    for (std::size_t k = 1; k < path.size() && along < kAhead * range; ++k) {
      along += (path[k] - path[k - 1]).norm();
      cells.has_room(path[k], space.required_distance(), [&](const SpaceCells::Cell& c) {
        if (!frontier_views_.given_up(c)) wanted.try_emplace(c, 1.0 / (1.0 + kFalloff * along));
      });
    }
    if (wanted.empty()) return std::nullopt;
    std::vector<FrontierViews::Wanted> list;
    for (const auto& [cell, gain] : wanted) list.push_back({cell, gain});
    FrontierViews::Search search(frontier_views_, lattice, situation.space().roadmap,
                                 std::move(list), space.map(), situation.space().headings,
                                 kUsefulRange * range);
    const Point3& last = path.front();
    const double direct = (last - start).norm();
    const auto view =
        search.best(start, {.farthest = direct + kAside * range, .saved = direct, .made = from},
                    [&](const auto& site) {
                      if (!reach(site.position)) return std::numeric_limits<double>::infinity();
                      return site.distance + (site.position - last).norm() - direct + kStopCost;
                    });
    if (!view) return std::nullopt;
    search.take(*view);
    return Stop{view->configuration, {}};
  }

 private:
  static constexpr double kAhead = 0.75;    ///< Length of the path to be opened, over the range.
  static constexpr double kAside = 1.0;     ///< Distance of views off the path, over the range.
  static constexpr double kStopCost = 2.0;  ///< What a view costs beside its flight [m].
  static constexpr double kFalloff = 0.3;   ///< Space d metres ahead counts 1 / (1 + d kFalloff).

  FrontierViews frontier_views_;
};
}  // namespace surfleet
