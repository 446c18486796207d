// SPDX-License-Identifier: MIT
/// @file  Looks that make room: when nothing can be looked at for want of known space.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <surfleet/fleet/flight_lattice.hpp>
#include <surfleet/fleet/plan.hpp>
#include <surfleet/fleet/sight_targets.hpp>

namespace surfleet {
struct SpaceLooksOptions {
  double distance = 4.7;        ///< δ_pose: where elements would be looked at from [m].
  double spacing_share = 0.15;  ///< Lattice spacing over the camera's range.
  double sight_share = 0.85;    ///< Farthest look that counts, over the camera's range.
  double stop_cost = 1.0;       ///< What a stop costs beside its flight [m].
  int max_looks = 3;            ///< Looks at a piece of space before it is given up.
  int least_cells = 10;         ///< Of two voxels each way, that a look must show.
  /// Elements without a view that are worth it, over the most that were ever left to do at once.
  double least_share = 0.1;
};

/// A planner that never ends for want of known space.
///
/// Views are taken only from where the body is known to fit. Where a camera sees little above and
/// below itself and the body is large, what is known can shrink to a pocket in which every robot
/// stands before a surface that goes on, and not one view of it can be flown to. So when the
/// planner finds nothing for robots that all wait, they are sent to look at unknown space: at that
/// in and before the places from which the elements left would be in view, where nothing known
/// stands in a body's way. A look is chosen by the space it shows over the metres it costs, and
/// what stays unknown after some looks is left alone, so this ends. For the few elements in nooks
/// that every mission leaves, nobody is sent.
template <FleetPlanner Planner>
class WithSpaceLooks {
 public:
  Planner planner;
  SpaceLooksOptions options;

  explicit WithSpaceLooks(Planner p = Planner{}, SpaceLooksOptions o = {})
      : planner(std::move(p)), options(o) {}

  PlanResult operator()(const PlanRequest& request) {
    PlanResult result = ask(planner, request);
    most_work_ = std::max(most_work_, request.work.size());
    const bool waiting = std::all_of(request.robots.begin(), request.robots.end(),
                                     [](const RobotRequest& r) { return r.idle; });
    const bool nothing = std::all_of(result.routes.begin(), result.routes.end(),
                                     [](const auto& route) { return !route || route->empty(); });
    if (waiting && nothing) send(request, result);
    return result;
  }
  /// How many looks at space were ordered so far.
  std::size_t looks() const { return count_; }

 private:
  using Cell = VoxelKey;  // of two voxels each way

  void send(const PlanRequest& request, PlanResult& result) {
    std::vector<Cell> cells;
    std::vector<SightTarget> wanted;
    for (const Cell& c : space_wanted(request, result)) {
      if (const auto it = looks_.find(c); it != looks_.end() && it->second >= options.max_looks)
        continue;
      cells.push_back(c);
      wanted.push_back({center(request, c), Eigen::Vector3d::Zero(), 1.0, kDepth});
    }
    if (wanted.empty()) return;
    const double least = std::max(1, options.least_cells);
    const double range = request.camera.max_range;
    const SightTargets targets(std::move(wanted), MapSight(request.observed), request.headings,
                               {.max_distance = options.sight_share * range});
    const FreeSpace& space = request.free_space;
    FlightLattice<FreeSpace> lattice(space, space.options().bounds, options.spacing_share * range);
    std::map<std::size_t, std::vector<Sighting>> seen;  // by site
    std::vector<char> done(targets.size(), 0);
    for (std::size_t r = 0; r < request.robots.size(); ++r) {
      std::optional<Stop> best;
      std::size_t best_site = 0;
      double best_rate = 0.0;
      lattice.search(space.free_start(request.robots[r].configuration.position),
                     [&](const auto& site) {
                       const double cost = site.distance + options.stop_cost;
                       if (static_cast<double>(targets.size()) <= best_rate * cost) return false;
                       const std::size_t id = lattice.index(site.cell);
                       const auto [it, fresh] = seen.try_emplace(id);
                       if (fresh) it->second = targets.seen_from(site.position);
                       const auto worth = worth_by_heading(targets, it->second, done);
                       for (std::size_t k = 0; k < kHeadings; ++k)
                         if (worth[k] >= least && worth[k] > best_rate * cost) {
                           best_rate = worth[k] / cost;
                           best = Stop{{site.position, heading_angle(static_cast<int>(k))}, {}};
                           best_site = id;
                         }
                       return true;
                     });
      if (!best) continue;
      mark_in_view(seen.at(best_site), nearest_heading(best->configuration.yaw), done,
                   [&](std::size_t id) { ++looks_[cells[id]]; });
      result.routes[r] = Stops{*best};
      ++count_;
    }
  }

  /// Unknown cells in and before the places from which elements without a view would be in view.
  std::set<Cell> space_wanted(const PlanRequest& request, const PlanResult& result) const {
    std::set<VoxelKey> unreachable, other;  // elements, by why they are left
    for (const auto& [v, reason] : result.impossible)
      if (reason != LeftReason::no_free_pose)
        (reason == LeftReason::unreachable ? unreachable : other).insert(key_of(v));
    if (static_cast<double>(request.work.size()) - static_cast<double>(other.size()) <
        options.least_share * static_cast<double>(most_work_))
      return {};
    VoxelStateMap::Accessor state(request.observed);
    const double cell = 2.0 * request.observed.voxel_size();
    std::set<Cell> cells;
    for (const IncompleteElement& e : request.work) {
      if (other.contains(key_of(e.voxel))) continue;
      const Eigen::Vector3d towards = view_direction(request, e);
      for (const double share : {1.0, 0.75, 1.25}) {
        const Point3 pose = e.position + share * options.distance * towards;
        if (!request.free_space.in_bounds(pose)) continue;
        if (!has_room(request, state, pose, cells)) continue;
        // The line of sight, and the straight way there if that is what lacks.
        for (double t = 0.0; t < share * options.distance; t += cell) {
          const VoxelIndex c =
              ((e.position + t * towards) / cell).array().floor().template cast<int>();
          if (state(c * 2) == VoxelState::unknown) cells.insert(key_of(c));
        }
        if (!unreachable.contains(key_of(e.voxel))) break;
        const Eigen::Vector3d way = nearest_robot(request, pose) - pose;
        const double step = request.free_space.required_distance();
        for (double t = step; t < way.norm(); t += step)
          has_room(request, state, pose + way * (t / way.norm()), cells);
        break;
      }
    }
    return cells;
  }

  static Point3 nearest_robot(const PlanRequest& request, const Point3& p) {
    return std::min_element(request.robots.begin(), request.robots.end(),
                            [&](const RobotRequest& a, const RobotRequest& b) {
                              return (a.configuration.position - p).squaredNorm() <
                                     (b.configuration.position - p).squaredNorm();
                            })
        ->configuration.position;
  }
  /// From the element to a camera that would have it in view: n̄_v, turned to the level as far as
  /// the camera's mount asks for.
  static Eigen::Vector3d view_direction(const PlanRequest& request, const IncompleteElement& e) {
    double azimuth = std::atan2(e.direction.y(), e.direction.x());
    if (e.direction.head<2>().norm() < 0.1) {
      const Eigen::Vector3d d = nearest_robot(request, e.position) - e.position;
      azimuth = std::atan2(d.y(), d.x());
    }
    double elevation = std::asin(std::clamp(e.direction.z(), -1.0, 1.0));
    const auto direction = [&] {
      return Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation),
                             std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    };
    while (std::abs(elevation) > kTurn && request.headings(-direction()) == 0)
      elevation -= std::copysign(kTurn, elevation);
    return direction();
  }
  /// Whether nothing that is known stands in the way of a body there; if so, notes what is unknown.
  static bool has_room(const PlanRequest& request, VoxelStateMap::Accessor& state,
                       const Point3& pose, std::set<Cell>& unknown) {
    const double cell = 2.0 * request.observed.voxel_size();
    const double radius = request.free_space.required_distance();
    const int n = static_cast<int>(std::ceil(radius / cell));
    const VoxelIndex middle = (pose / cell).array().floor().cast<int>();
    std::vector<Cell> found;
    for (int z = -n; z <= n; ++z)
      for (int y = -n; y <= n; ++y)
        for (int x = -n; x <= n; ++x) {
          const VoxelIndex c = middle + VoxelIndex(x, y, z);
          const Cell key = key_of(c);
          if ((center(request, key) - pose).norm() > radius) continue;
          const VoxelState s = state(c * 2);
          if (s == VoxelState::occupied) return false;
          if (s == VoxelState::unknown) found.push_back(key);
        }
    unknown.insert(found.begin(), found.end());
    return true;
  }
  static Point3 center(const PlanRequest& request, const Cell& c) {
    return (Point3(c[0], c[1], c[2]) + Point3::Constant(0.25)) * 2.0 *
           request.observed.voxel_size();
  }

  static constexpr int kDepth = 3;  ///< Unknown voxels a look at space may pass.
  static constexpr double kTurn =
      radians(5.0);  ///< Of a view's elevation, from one try to the next.

  std::map<Cell, int> looks_;
  std::size_t count_ = 0, most_work_ = 0;
};
}  // namespace surfleet
