// SPDX-License-Identifier: MIT
/// @file
/// @brief Frontier views for a planner that finds no viewpoint for want of known space.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/viewpoint/frontier_view.hpp>
#include <surfleet/viewpoint/view_limits.hpp>

namespace surfleet {
struct FrontierViewsOptions {
  double distance = 4.7;         ///< δ_pose: from which elements would be viewed [m].
  double spacing_share = 0.15;   ///< Lattice spacing over the camera's range.
  double stop_cost = 1.0;        ///< What a stop costs beside its flight [m].
  int max_views = kViewsInVain;  ///< Of a cell before it is given up.
  int least_cells = 10;          ///< Of two voxels along each axis, that a view must show.
  /// Least number of elements without a view, over the most that were ever left at once.
  double least_share = 0.1;
};

/// A planner that never ends for want of known space.
///
/// Views are taken only from where the body is known to fit. Where a camera sees little above and
/// below itself and the body is large, what is known can shrink to a pocket in which every robot
/// stands before a surface that goes on, and not one view of it can be flown to. So when the
/// planner finds nothing for robots that all wait, they are sent to view unknown space: that in and
/// before the places from which the elements left would be in view, where nothing known keeps a
/// body out. A view is chosen by the space it shows over the metres it costs, and what stays
/// unknown after `max_views` is given up, so this ends. For the few elements in nooks that every
/// mission leaves, none is sent.
template <FleetPlanner Planner>
class WithFrontierViews {
 public:
  Planner planner;
  FrontierViewsOptions options;

  explicit WithFrontierViews(Planner p = Planner{}, FrontierViewsOptions o = {})
      : planner(std::move(p)), options(o) {}

  Plan operator()(const SurfaceSituation& situation) {
    Plan result = ask(planner, situation);
    most_work_ = std::max(most_work_, situation.goals.size());
    const bool waiting = situation.asked.size() == situation.team.size();
    if (waiting && result.nothing()) send(situation, result);
    return result;
  }
  /// How many frontier views were ordered so far.
  std::size_t views_ordered() const { return count_; }

 private:
  using Cell = SpaceCells::Cell;

  void send(const SurfaceSituation& situation, Plan& result) {
    frontier_views_.max_views = options.max_views;
    std::vector<FrontierViews::Wanted> wanted;
    for (const Cell& c : space_wanted(situation, result))
      if (!frontier_views_.given_up(c)) wanted.push_back({c});
    if (wanted.empty()) return;
    const double least = std::max(1, options.least_cells);
    const double range = situation.space().kind.camera.max_range;
    const FreeSpace& space = situation.space().free;
    FlightLattice<FreeSpace> lattice(space, space.options().bounds, options.spacing_share * range);
    FrontierViews::Search search(frontier_views_, lattice, situation.space().roadmap,
                                 std::move(wanted), situation.belief.observed(),
                                 situation.space().headings, kUsefulRange * range);
    for (const RobotState& robot : situation.team) {
      const auto view =
          search.best(space.free_start(robot.at.position), {.least = least},
                      [&](const auto& site) { return site.distance + options.stop_cost; });
      if (!view) continue;
      search.take(*view);
      result.routes[robot.id] = Stops{{view->configuration, {}}};
      ++count_;
    }
  }

  /// Unknown cells in and before the places from which elements without a view would be in view.
  std::set<Cell> space_wanted(const SurfaceSituation& situation, const Plan& result) const {
    std::set<VoxelKey> unreachable, other;  // elements, by why they are left
    for (const auto& [v, reason] : result.impossible)
      if (reason != LeftReason::no_free_pose)
        (reason == LeftReason::unreachable ? unreachable : other).insert(key_of(v));
    if (static_cast<double>(situation.goals.size()) - static_cast<double>(other.size()) <
        options.least_share * static_cast<double>(most_work_))
      return {};
    SpaceCells space(situation.belief.observed());
    const double body = situation.space().free.required_distance();
    std::set<Cell> cells;
    const auto add = [&](const Cell& c) { cells.insert(c); };
    for (const IncompleteElement& e : situation.goals) {
      if (other.contains(key_of(e.voxel))) continue;
      const Eigen::Vector3d towards = view_direction(situation, e);
      for (const double share : {1.0, 0.75, 1.25}) {
        const Point3 pose = e.position + share * options.distance * towards;
        if (!situation.space().free.in_bounds(pose)) continue;
        if (!space.has_room(pose, body, add)) continue;
        // The line of sight, and the straight line there if that is what lacks.
        for (double t = 0.0; t < share * options.distance; t += space.edge()) {
          const VoxelIndex c = space.at(e.position + t * towards);
          if (space.state(c) == VoxelState::unknown) add(key_of(c));
        }
        if (!unreachable.contains(key_of(e.voxel))) break;
        const Eigen::Vector3d towards_pose = nearest_robot(situation, pose) - pose;
        for (double t = body; t < towards_pose.norm(); t += body)
          space.has_room(pose + towards_pose * (t / towards_pose.norm()), body, add);
        break;
      }
    }
    return cells;
  }

  static Point3 nearest_robot(const SurfaceSituation& situation, const Point3& p) {
    return std::min_element(situation.team.begin(), situation.team.end(),
                            [&](const RobotState& a, const RobotState& b) {
                              return (a.at.position - p).squaredNorm() <
                                     (b.at.position - p).squaredNorm();
                            })
        ->at.position;
  }
  /// From the element to a camera that would have it in view: n̄_v, turned to the level as far as
  /// the camera's mount asks for.
  static Eigen::Vector3d view_direction(const SurfaceSituation& situation,
                                        const IncompleteElement& e) {
    double azimuth = std::atan2(e.direction.y(), e.direction.x());
    if (e.direction.head<2>().norm() < 0.1) {
      const Eigen::Vector3d d = nearest_robot(situation, e.position) - e.position;
      azimuth = std::atan2(d.y(), d.x());
    }
    double elevation = std::asin(std::clamp(e.direction.z(), -1.0, 1.0));
    const auto direction = [&] {
      return Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation),
                             std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    };
    while (std::abs(elevation) > kTurn && situation.space().headings(-direction()) == 0)
      elevation -= std::copysign(kTurn, elevation);
    return direction();
  }
  static constexpr double kTurn =
      radians(5.0);  ///< Of a view's elevation, from one try to the next.

  FrontierViews frontier_views_;
  std::size_t count_ = 0, most_work_ = 0;
};
}  // namespace surfleet
