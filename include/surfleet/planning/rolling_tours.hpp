// SPDX-License-Identifier: MIT
/// @file
/// @brief A planner by tours of the whole team, begun and planned anew as the map grows.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/motion/optimistic_lattice.hpp>
#include <surfleet/motion/roadmap_passages.hpp>
#include <surfleet/motion/string_pulling.hpp>
#include <surfleet/planning/interest.hpp>
#include <surfleet/planning/lattice_views.hpp>
#include <surfleet/planning/opening_view.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/team_tour.hpp>
#include <surfleet/viewpoint/view_limits.hpp>

namespace surfleet {
struct RollingToursOptions {
  InterestOptions interest;
  double view_range = kUsefulRange;        ///< Farthest view that counts, over the camera's range.
  double stop_share = 0.125;               ///< What a stop costs beside its flight, over the range.
  double turn_cost = 0.1;                  ///< What turning costs [m/rad].
  double keep = 1.3;                       ///< See `TeamTourOptions`.
  double balance = 0.3;                    ///< The same.
  int stops = 10;                          ///< Of each robot's tour.
  double spacing_share = 0.15;             ///< Lattice spacing over the camera's range.
  OptimisticLatticeOptions unknown_space;  ///< What paths cost there.
  double unknown_gain = 0.7;  ///< Of a view from unknown space, over that of one from known.
  /// So far beside their places stops may be for a shorter path, over the range.
  double slack = 0.2;
  double utility_share = 0.2;  ///< A new plan is wanted when so much of a route is complete.
  int threads = 1;             ///< Plans are the same for any number.
};

/// Orienteering tours of the whole team over all targets, planned anew with every image.
///
/// Targets come from `Interest`; a stop is a node of the flight lattice and a view. Each plan makes
/// a tour for every robot by gain per metre inserted (`TeamTours`), in space that is known or may
/// be free; robots under way keep the stops they were given, and their tours go on from there. A
/// robot that is asked for is given the first stops of its tour, or the view that opens most of the
/// path where that is not known. The rule is the same for one robot and for many.
///
/// It remembers what it has seen of the map: one planner for one mission.
class RollingTours {
 public:
  RollingToursOptions options;

  explicit RollingTours(RollingToursOptions o = {}) : options(o), interest_(o.interest) {}

  Plan operator()(const SurfaceSituation& s) {
    const double range = s.space().kind.camera.max_range;
    FlightLattice<FreeSpace>& lattice = follow(s.space().free, options.spacing_share * range);
    // A robot without a view that can be hoped for has those that can be flown to; from everywhere
    // only where there is nothing to be seen from nearby.
    const Search near{kReach * range, kFine * range}, anywhere{};
    optimistic_.options = options.unknown_space;
    optimistic_.follow(s.space().free, lattice.spacing());
    std::optional<SightTargets<>> targets_found;
    const auto find_targets = [&](bool finely) {
      targets_found.emplace(interest_(s, finely), MapSight(s.belief.observed()), s.space().headings,
                            TargetSightOptions{.max_range = options.view_range * range});
    };
    // Targets and reachable nodes are found at the same time.
    parallel_for(2, options.threads, [&](std::size_t part) {
      if (part == 0)
        find_targets(false);
      else
        reach_from(s, near, lattice);
    });
    for (const RobotId id : s.asked) note_what_is_left(s, *targets_found, lattice, s.robot(id).at);
    Plan plan;
    plan.replan = {
        .utility_share = options.utility_share, .turn_in_flight = true, .watch_on = true};
    for (const RobotId id : s.asked) plan.routes[id];
    const auto plan_both = [&] {
      for (const bool hopeful : {true, false})
        plan_within(hopeful, s, *targets_found, lattice, plan);
    };
    plan_both();
    if (plan.nothing()) {
      reach_from(s, anywhere, lattice);
      plan_both();
    }
    if (plan.nothing() && !interest_.is_fine()) {
      find_targets(true);
      plan_both();
    }
    const bool found = !plan.nothing();
    const bool nowhere = !found && s.asked.size() == s.team.size();
    for (const IncompleteElement& e : s.goals) {
      if (!s.belief.ledger().fresh(e.voxel))
        plan.impossible.emplace_back(e.voxel, LeftReason::seen_incomplete);
      else if (nowhere)
        plan.impossible.emplace_back(e.voxel, LeftReason::no_free_pose);
    }
    return plan;
  }

 private:
  using Lattice = FlightLattice<FreeSpace>;
  /// Stops may be so far off at the most, and up to `fine` at every node of the lattice, beyond it
  /// at every other one along each axis [m].
  struct Search {
    double farthest = std::numeric_limits<double>::infinity();
    double fine = std::numeric_limits<double>::infinity();
  };
  /// A node of the lattice that may be reached.
  struct Reached {
    VoxelIndex cell;
    Point3 position;
    double distance;  // [m]
    bool known;       // to be free
  };
  /// A robot that waits for a route: where it starts, and what can be reached from there.
  struct Waiting {
    RobotId id;
    Point3 start;
    ReachFrom reach;
  };
  /// Where stops could be, and how far that is for the waiting robots.
  struct Sites {
    std::vector<Point3> positions;
    std::unordered_map<std::size_t, std::size_t> by_node;
    std::vector<std::vector<double>> distances;  // by waiting robot and site [m]
  };

  /// Routes for those that are asked for and have none yet, over the reached nodes; unless
  /// `hopeful`, in known space alone.
  void plan_within(bool hopeful, const SurfaceSituation& s, const SightTargets<>& targets,
                   Lattice& lattice, Plan& plan) {
    std::vector<Waiting> waiting;
    std::vector<std::pair<RobotId, const Stops*>> under_way;
    for (const RobotState& robot : s.team) {
      const auto given = plan.routes.find(robot.id);
      const Stops& route = given == plan.routes.end() ? robot.route : given->second;
      if (given != plan.routes.end() && route.empty()) {
        const Point3 start = s.space().free.free_start(robot.at.position);
        waiting.push_back({robot.id, start, s.space().roadmap.reach_from(start)});
      } else if (!route.empty()) {
        under_way.push_back({robot.id, &route});
      }
    }
    if (waiting.empty()) return;
    LatticeViews views(targets, lattice, s.space().headings, vain_, options.unknown_gain);
    for (const auto& [id, route] : under_way)
      for (const Stop& stop : *route) views.mark(stop.configuration);
    Sites sites = find_sites(hopeful, lattice, waiting, views);
    std::vector<TourStart> starts;
    for (std::size_t w = 0; w < waiting.size(); ++w) {
      starts.push_back({s.robot(waiting[w].id).at, std::move(sites.distances[w]), options.stops});
      if (const auto goal = goals_.find(waiting[w].id); goal != goals_.end())
        if (const auto it = sites.by_node.find(goal->second); it != sites.by_node.end())
          starts.back().goal = it->second;
    }
    // A robot under way goes on from its last stop.
    for (const auto& [id, route] : under_way) {
      starts.push_back({route->back().configuration,
                        {},
                        options.stops - static_cast<int>(route->size()),
                        {},
                        false});
      for (const Point3& p : sites.positions)
        starts.back().distance.push_back((p - starts.back().from.position).norm());
    }
    std::vector<char> done(views.done().begin(), views.done().end());
    const double range = s.space().kind.camera.max_range;
    const auto tours = TeamTours(starts, sites.positions, views,
                                 {.stop_cost = options.stop_share * range,
                                  .turn_cost = options.turn_cost,
                                  .keep = options.keep,
                                  .balance = options.balance,
                                  .threads = options.threads})();
    for (std::size_t w = 0; w < waiting.size(); ++w) {
      goals_.erase(waiting[w].id);
      if (tours[w].empty()) continue;
      plan.outlook[waiting[w].id] = outlook_of(tours[w], starts[w], sites.positions);
      const std::size_t first = tours[w].front().site;
      if (views[first].known) {
        plan.routes[waiting[w].id] =
            begin(s, targets, views, waiting[w], tours[w], sites.positions, done);
        goals_[waiting[w].id] = views.node(first);
      } else if (auto view = open_path(s, lattice, waiting[w], views[first].cell)) {
        plan.routes[waiting[w].id] = {*view};
      }
    }
  }

  static Outlook outlook_of(std::span<const TeamTourStop> tour, const TourStart& start,
                            std::span<const Point3> sites) {
    Outlook outlook;
    for (std::size_t k = 0; k < tour.size(); ++k) {
      const std::size_t s = tour[k].site;
      outlook.add(tour[k].gain,
                  k == 0 ? start.distance[s] : (sites[tour[k - 1].site] - sites[s]).norm());
    }
    return outlook;
  }

  /// The nodes that may be reached by each robot asked for, in the order of their distance; last
  /// those beyond passages too narrow for the lattice.
  void reach_from(const SurfaceSituation& s, const Search& search, Lattice& lattice) {
    reached_.clear();
    for (const RobotId id : s.asked) {
      const Point3 start = s.space().free.free_start(s.robot(id).at.position);
      optimistic_.search(
          start, lattice,
          [&, &nodes = reached_[id]](const auto& site, bool known) {
            if (site.distance > search.farthest) return false;
            const VoxelIndex& c = site.cell;
            if (((c.x() | c.y() | c.z()) & 1) == 0 || site.distance <= search.fine)
              nodes.push_back({c, site.position, site.distance, known});
            return true;
          },
          RoadmapPassages(s.space().roadmap, s.space().roadmap.reach_from(start)));
    }
  }
  Sites find_sites(bool hopeful, const Lattice& lattice, std::span<const Waiting> waiting,
                   LatticeViews& views) const {
    Sites sites;
    std::vector<std::vector<std::pair<std::size_t, double>>> found(waiting.size());
    for (std::size_t w = 0; w < waiting.size(); ++w)
      for (const Reached& node : reached_.at(waiting[w].id)) {
        if (!(node.known || hopeful) || !views.any(node.cell) ||
            (node.known && !waiting[w].reach(node.position)))
          continue;
        const auto [it, fresh] =
            sites.by_node.try_emplace(lattice.index(node.cell), sites.positions.size());
        if (fresh) {
          sites.positions.push_back(node.position);
          views.add({node.cell, node.known});
        }
        found[w].emplace_back(it->second, node.distance);
      }
    for (const auto& reached : found) {
      sites.distances.emplace_back(sites.positions.size(), std::numeric_limits<double>::infinity());
      for (const auto& [site, distance] : reached) sites.distances.back()[site] = distance;
    }
    return sites;
  }
  /// The view that opens most of the path to a node in unknown space.
  std::optional<Stop> open_path(const SurfaceSituation& s, Lattice& lattice, const Waiting& robot,
                                const VoxelIndex& goal) {
    optimistic_.search(
        robot.start, lattice, [&](const auto& site, bool) { return site.cell != goal; },
        RoadmapPassages(s.space().roadmap, robot.reach));
    std::vector<Point3> path{robot.start};
    for (const VoxelIndex& c : optimistic_.path_to(goal)) {
      if (path.size() == 1 && lattice.is_free(c)) path.clear();
      path.push_back(lattice.position(c));
    }
    return opening_(s, lattice, robot.reach, s.robot(robot.id).at, robot.start, path);
  }

  /// The first stops of a tour, as far as they are in known space, moved by string pulling.
  Stops begin(const SurfaceSituation& s, const SightTargets<>& targets, const LatticeViews& views,
              const Waiting& robot, std::span<const TeamTourStop> tour,
              std::span<const Point3> sites, std::vector<char>& done) {
    const double range = s.space().kind.camera.max_range;
    std::vector<Point3> places;
    for (const TeamTourStop& stop : tour) places.push_back(sites[stop.site]);
    const std::vector<Point3> pulled = pulled_string(robot.start, places, options.slack * range);
    Stops route;
    std::erase_if(moved_, [&](const Moved& m) { return m.robot == robot.id; });
    for (std::size_t k = 0; k < std::min(tour.size(), kGiven); ++k) {
      const LatticeViews::Site& site = views[tour[k].site];
      if (!site.known) break;
      const Configuration at = s.space().headings.at(places[k], tour[k].view);
      Configuration moved = at;
      moved.position = place_beside(s, targets, at, tour[k].view, pulled[k], done);
      if (moved.position != at.position) moved_.push_back({robot.id, moved.position, site.cell});
      Stop stop{moved, {}};
      mark_in_view(targets.seen_from(moved.position), tour[k].view, done, [&](std::size_t id) {
        for (const std::int32_t i : interest_.goals(id))
          stop.targets.push_back(s.goals[static_cast<std::size_t>(i)].voxel);
      });
      route.push_back(std::move(stop));
    }
    return route;
  }
  /// As near to `wish` as a view still shows enough of what it shows from its place.
  Point3 place_beside(const SurfaceSituation& s, const SightTargets<>& targets,
                      const Configuration& at, int view, const Point3& wish,
                      std::span<const char> done) const {
    const auto gain = [&](const Point3& p) {
      return gain_by_view(targets, targets.seen_from(p), done)[static_cast<std::size_t>(view)];
    };
    const double whole = gain(at.position);
    for (const double share : {1.0, 0.67, 0.33}) {
      const Point3 p = at.position + share * (wish - at.position);
      if ((p - at.position).norm() < kLeastMove) break;
      if (s.space().free.is_free(p) && s.space().free.is_free_segment(p, at.position) &&
          gain(p) >= kEnough * whole)
        return p;
    }
    return at.position;
  }

  /// The lattice of the mission's free space, as that is now.
  Lattice& follow(const FreeSpace& space, double spacing) {
    if (!lattice_ || &lattice_->space() != &space || lattice_->spacing() != spacing ||
        followed_ > space.revision()) {
      lattice_.emplace(space, space.options().bounds, spacing);
    } else {
      for (const std::uint32_t slot : space.changed_since(followed_))
        lattice_->forget(space.influence(slot));
    }
    followed_ = space.revision();
    return *lattice_;
  }
  /// What is still in view from where a robot stands was viewed in vain.
  void note_what_is_left(const SurfaceSituation& s, const SightTargets<>& targets, Lattice& lattice,
                         const Configuration& at) {
    const auto moved = std::find_if(moved_.begin(), moved_.end(), [&](const Moved& m) {
      return (m.at - at.position).norm() <= kSamePlace;
    });
    const VoxelIndex cell = moved == moved_.end() ? lattice.nearest(at.position) : moved->cell;
    const Point3 place = lattice.position(cell);
    const int view = s.space().headings.nearest_view(at);
    const Configuration nearest = s.space().headings.at(place, view);
    if ((moved == moved_.end() && (place - at.position).norm() > kSamePlace) ||
        std::abs(wrap_angle(nearest.yaw - at.yaw)) > kSamePlace ||
        std::abs(nearest.pitch - at.pitch) > kSamePlace)
      return;
    const std::vector<Sighting> seen = targets.seen_from(place);
    std::vector<char> done(targets.size(), 0);
    const double gain = gain_by_view(targets, seen, done)[static_cast<std::size_t>(view)];
    if (!vain_.note(lattice.index(cell), view, gain))
      return;  // The robot still stands there and has taken no new view.
    mark_in_view(seen, view, done, [&](std::size_t id) {
      interest_.viewed_in_vain(id, targets[id].position, s.belief.known().voxel_size());
    });
  }

  /// A stop that was moved off its node of the lattice.
  struct Moved {
    RobotId robot;
    Point3 at;
    VoxelIndex cell;
  };
  static constexpr double kReach = 8.0, kFine = 1.0;  ///< See `Search`, over the range.
  static constexpr std::size_t kGiven = 2;            ///< Stops given out to each robot at a time.
  static constexpr double kEnough = 0.7;              ///< Of a view's gain, for it to be moved.
  static constexpr double kLeastMove = 0.05;          ///< Of a stop [m].
  static constexpr double kSamePlace = 0.02;          ///< [m, rad]

  Interest interest_;
  OptimisticLattice optimistic_;
  OpeningViews opening_;
  ViewsInVain vain_;
  std::optional<Lattice> lattice_;
  std::uint64_t followed_ = 0;                       // revision of its space
  std::map<RobotId, std::vector<Reached>> reached_;  // by robot asked for
  std::vector<Moved> moved_;                         // of the stops given out last
  std::map<RobotId, std::size_t> goals_;             // the node each was sent to
};
}  // namespace surfleet
