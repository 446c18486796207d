// SPDX-License-Identifier: MIT
/// @file
/// @brief A planner that flies where the most surface per metre is to be seen next.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/motion/optimistic_lattice.hpp>
#include <surfleet/motion/taut_path.hpp>
#include <surfleet/motion/team_flights.hpp>
#include <surfleet/motion/traffic_policy.hpp>
#include <surfleet/planning/opening_look.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/tour_ahead.hpp>
#include <surfleet/viewpoint/left_below.hpp>
#include <surfleet/viewpoint/look_bound.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>
#include <surfleet/viewpoint/surface_prediction.hpp>
#include <surfleet/viewpoint/unseen_space.hpp>
#include <surfleet/viewpoint/worth_around.hpp>

namespace surfleet {
/// Of one drone alone in a region that has to be climbed.
struct LoneClimbOptions {
  /// `RatePlannerOptions::sight_share` and `prediction_share`: looks that reach farther take fewer
  /// turns around, and what stands so high goes on upward.
  double sight_share = 0.97, prediction_share = 1.0;
  LeftBelowOptions left_below;
  /// What counts where something was seen already, if not well enough to be known, and predicted
  /// surface each time that a look did not bring it.
  double seen_share = 0.5, vain_share = 0.5;
  /// What the place it is under way to counts: much else is about as good, and who changes his
  /// mind at every image flies ways that nobody chose.
  double goal_worth = 1.3;
  double utility_share = 0.35;  ///< A new plan is wanted when so much of a route is complete.
  double unknown_worth = 0.65;  ///< Worth of a look from unknown space beside one from known.
  /// So far beside their places stops may be for a shorter way, over the range, as long as they
  /// show this share of their worth.
  double slack = 0.2, slack_worth = 0.7;
  double reach = 16.0;  ///< `ahead_reach`: the foot is far from the top.
};

struct RatePlannerOptions {
  double stop_share = 0.125;  ///< What a stop costs beside its flight, over the range.
  double turn_cost = 0.1;     ///< What turning costs [m/rad].
  /// What it costs, over the range, to meet a teammate on the way: one of them has to wait.
  double meeting_share = 0.6;
  double spacing_share = 0.15;    ///< Lattice spacing over the camera's range.
  double sight_share = 0.85;      ///< Farthest look that counts, over the camera's range.
  double prediction_share = 0.6;  ///< How far surface is predicted to go on, over the range.
  double prediction_worth = 0.6;  ///< Worth of predicted surface beside surface at hand.
  /// What an element counts, in faces of a voxel: more than it shows, as left behind it costs a
  /// stop.
  double element_faces = 4.0;
  /// Worth of the border to unseen space beside surface at hand, for what it may hide; 0: none.
  /// It counts by how much surface is to be seen around, and far from any the less the less of what
  /// was opened there held surface.
  double space_worth = 0.5;
  double space_near = 0.6;  ///< So near is not far, over the range.
  double space_full = 0.3;  ///< Surface near by that makes it count fully, over the range squared.
  double climb_height = 4.0;  ///< A region so many times as high as the range has to be climbed.
  /// Such a region, by a team: how much surface makes unseen space count fully, and how many times
  /// its full worth that may be at the most. A level camera opens the space above but slowly, and
  /// where robots can fly only what was seen empty, the team is no faster than that.
  double climb_space_full = 0.8, climb_space_most = 4.0;
  LoneClimbOptions climb_alone;  ///< Such a region, by one drone alone.
  double space_share = 0.19;     ///< Cells of unseen space over the camera's range.
  int stops = 2;                 ///< Stops given out to each robot at a time.
  /// Stops that one drone alone plans ahead, in space that it takes for free where it is unknown;
  /// 0: it looks no farther than each of a team does.
  int ahead = 10;
  /// So far off, over the range, every node of the lattice may be one of these stops, beyond it
  /// every other one along each axis.
  double ahead_fine = 1.0;
  double ahead_reach = 8.0;       ///< So far off they may be at the most, over the range.
  OptimisticLatticeOptions ways;  ///< What ways there cost that are not known.
  double unknown_worth = 0.8;     ///< Worth of a look from unknown space beside one from known.
  /// What one look is thought to see at the most of the worth around a place: where that much would
  /// not pay for the way, no look is tried. 1 makes the search exact.
  double view_share = 0.25;
};

/// Flights by marginal rate.
///
/// What is worth seeing is the incomplete surface, the surface predicted to go on behind it, and
/// for the little that it may hide the unseen space of the region. A stop is a node of the flight
/// lattice and a heading; its rate is what it sees and nobody else was sent to see, over the metres
/// it costs, and it costs more where a teammate would be met. Each robot in turn, the best first,
/// is given the stop of the highest rate. The search goes outward from the robot, leaves out what
/// is worth too little for the way, and ends when all the rest is. Where the published method
/// commits to a tour over what is known, this one is paid for by what the next flight will
/// discover. What was looked at in vain once, it leaves to others; and where a robot has just
/// looked it does not look again for what that look has left, were it the best there is. As most
/// goals change under way, robots turn into new routes in flight.
///
/// One drone alone has to see to it all, so what it passes by it comes back for: it plans a tour of
/// stops by worth per metre inserted, in space that is known or may be free, and begins it. Where
/// the way to the first stop is not known, it flies to the look that opens most of it. In a region
/// that has to be climbed, what it would leave below counts more (`worth_left_below`), what was
/// seen already less, and it keeps to a goal unless another is clearly better.
///
/// It remembers what it has seen of the map: one planner for one mission.
class RatePlanner {
 public:
  RatePlannerOptions options;

  explicit RatePlanner(RatePlannerOptions o = {}) : options(o) {}

  /// The rate of the best stop given out by the last call [m²/m]; 0 if there was none.
  double last_rate() const { return last_rate_; }
  /// The most that any look tried by the last call would have shown [m²].
  double broadest_look() const { return broadest_; }

  Plan operator()(const SurfaceSituation& situation) {
    const double range = situation.space().kind.camera.max_range;
    const bool climb_alone = climbs_alone(situation);
    const double sight = climb_alone ? options.climb_alone.sight_share : options.sight_share;
    const SightTargets targets(make_targets(situation), MapSight(situation.belief.observed()),
                               situation.space().headings, {.max_range = sight * range});
    FlightLattice<FreeSpace>& lattice =
        follow(situation.space().free, options.spacing_share * range);
    const WorthAround around(targets.all(), targets.reach());
    const LookBound most(targets.all(), lattice, situation.space().headings, targets.reach());
    const Search search{situation, lattice, targets, around, most};
    sites_.clear();
    std::vector<char> done(targets.size(), 0);
    broadest_ = 0.0;

    Plan result;
    result.replan.turn_in_flight = true;
    if (climb_alone) {
      result.replan.utility_share = options.climb_alone.utility_share;
      result.replan.watch_on = true;
    }
    std::vector<RobotId> waiting;
    // Where those who wait will go is not settled before it is their turn.
    const double gap = 2.0 * situation.space().free.options().radius + TrafficOptions{}.clearance;
    TeamFlights flights(gap);
    const TeamFlights nobody(gap);
    for (const RobotState& robot : situation.team) {
      if (situation.is_asked(robot.id)) {
        waiting.push_back(robot.id);
        note_what_is_left(search, robot.at);
      } else {
        for (const Stop& stop : robot.route)
          mark_in_view(targets.seen_from(stop.configuration.position),
                       nearest_heading(stop.configuration.yaw), done, [](std::size_t) {});
        const Configuration& at = robot.at;
        flights.settle({at.position, robot.route.empty()
                                         ? at.position
                                         : robot.route.front().configuration.position});
      }
    }
    last_rate_ = 0.0;
    if (options.ahead > 0 && situation.alone() && !waiting.empty()) {
      auto [route, rate] = begin_tour(search, done);
      if (!route.empty()) {
        result.routes[waiting.front()] = std::move(route);
        last_rate_ = rate;
        waiting.clear();
      }
    }
    while (!waiting.empty()) {
      std::optional<Candidate> best;
      std::size_t who = 0;
      for (std::size_t w = 0; w < waiting.size(); ++w) {
        const auto c = best_stop(search, done, situation.robot(waiting[w]).at, flights);
        if (c && (!best || c->rate > best->rate)) {
          best = c;
          who = w;
        }
      }
      if (!best) break;
      last_rate_ = std::max(last_rate_, best->rate);
      flights.settle({situation.robot(waiting[who]).at.position, best->configuration.position});
      Stops route;
      Configuration at = best->configuration;
      route.push_back(make_stop(situation, *best, done));
      for (int s = 1; s < options.stops; ++s) {
        const auto next = best_stop(search, done, at, nobody);
        if (!next || next->rate < 0.5 * best->rate) break;
        at = next->configuration;
        route.push_back(make_stop(situation, *next, done));
      }
      result.routes[waiting[who]] = std::move(route);
      waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(who));
    }
    for (const RobotId r : waiting) result.routes[r] = Stops{};
    // With everybody waiting and nothing found, what is left is in view from nowhere on the
    // lattice.
    const bool nowhere = last_rate_ <= 0.0 && waiting.size() == situation.team.size();
    for (const IncompleteElement& e : situation.goals) {
      if (!situation.belief.ledger().fresh(e.voxel))
        result.impossible.emplace_back(e.voxel, LeftReason::seen_incomplete);
      else if (nowhere)
        result.impossible.emplace_back(e.voxel, LeftReason::no_free_pose);
    }
    return result;
  }

 private:
  struct Search {
    const SurfaceSituation& situation;
    FlightLattice<FreeSpace>& lattice;
    const SightTargets<>& targets;
    const WorthAround& around;
    const LookBound& most;
  };
  struct Candidate {
    Configuration configuration;
    double rate = 0.0;
    std::size_t site = 0;
    int heading = 0;
  };

  bool has_to_climb(const SurfaceSituation& situation) const {
    return relative_height(situation) > options.climb_height;
  }
  bool climbs_alone(const SurfaceSituation& situation) const {
    return has_to_climb(situation) && situation.alone();
  }

  /// Elements in cells of two voxels that face alike are one target, stood for by its first.
  std::vector<SightTarget> make_targets(const SurfaceSituation& situation) {
    const double voxel = situation.belief.known().voxel_size();
    const bool climb_alone = climbs_alone(situation);
    VoxelStateMap::Accessor observed(situation.belief.observed());
    const auto seen_share = [&](const VoxelIndex& v) {
      return climb_alone && observed(v) != VoxelState::unknown ? options.climb_alone.seen_share
                                                               : 1.0;
    };
    std::vector<SightTarget> targets;
    members_.clear();
    std::unordered_map<std::uint64_t, std::size_t> groups;
    for (std::size_t i = 0; i < situation.goals.size(); ++i) {
      const IncompleteElement& e = situation.goals[i];
      if (!situation.belief.ledger().fresh(e.voxel)) continue;
      int axis = 0;
      e.direction.cwiseAbs().maxCoeff(&axis);
      std::uint64_t key = static_cast<std::uint64_t>(2 * axis + (e.direction[axis] > 0.0 ? 1 : 0));
      for (int k = 0; k < 3; ++k)
        key = key << 20 | (static_cast<std::uint64_t>(e.voxel[k] >> 1) & 0xfffffU);
      const auto [it, fresh] = groups.try_emplace(key, targets.size());
      if (fresh) {
        targets.push_back({e.frontier(voxel), e.direction, 0.0, 2});
        members_.emplace_back();
      }
      targets[it->second].worth += seen_share(e.voxel) * options.element_faces * voxel * voxel;
      members_[it->second].push_back(static_cast<std::int32_t>(i));
    }
    const double range = situation.space().kind.camera.max_range;
    const double reach =
        (climb_alone ? options.climb_alone.prediction_share : options.prediction_share) * range;
    for (const PredictedPatch& p : predict_surface(
             situation.goals, situation.belief.known(),
             {.reach = reach, .step = 2.0 * voxel, .region = situation.belief.region()}, frames_))
      targets.push_back({p.position, p.normal,
                         options.prediction_worth * p.area *
                             seen_share(situation.belief.observed().grid().index_of(p.position)) *
                             (climb_alone ? vain_share(p.position, voxel) : 1.0),
                         static_cast<int>(reach / voxel)});
    first_space_ = targets.size();
    if (climb_alone)
      for (SightTarget& t : targets)
        t.worth *= worth_left_below(situation.team.front().at.position, t.position,
                                    situation.belief.region().min().z(), range,
                                    options.climb_alone.left_below);
    if (options.space_worth > 0.0) {
      space_.update(situation.belief.observed(), situation.belief.region(),
                    options.space_share * range);
      const WorthAround surface(targets, options.space_near * range);
      const bool climb_together = has_to_climb(situation) && !situation.alone();
      const double full =
          (climb_together ? options.climb_space_full : options.space_full) * range * range;
      const double limit = climb_together ? options.climb_space_most : 1.0;
      const double unit = options.space_worth * space_.edge() * space_.edge();
      for (std::size_t i = 0; i < space_.size(); ++i) {
        const double near = surface(space_.center(i));
        if (near > 0.0) space_.note_near(i);
        const double share =
            std::max(near > 0.0 ? std::min(limit, near / full) : 0.0,
                     std::min(1.0, space_.chance(i) / space_.options().prior_chance));
        targets.push_back({space_.center(i), Eigen::Vector3d::Zero(), share * unit,
                           static_cast<int>(std::lround(space_.edge() / voxel))});
      }
    }
    return targets;
  }

  /// The lattice of the mission's free space, as that is now.
  FlightLattice<FreeSpace>& follow(const FreeSpace& space, double spacing) {
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

  /// What is in view from a place of the lattice, at first without asking what is in the way.
  struct View {
    std::vector<Sighting> seen;
    std::size_t in_sight = 0;  // so many are known to be in sight, the rest may be
    bool complete() const { return in_sight == seen.size(); }
  };
  View& view_from(const SightTargets<>& targets, std::size_t site, const Point3& position) {
    const auto [it, fresh] = sites_.try_emplace(site);
    if (fresh) {
      const std::span<const Sighting> view = targets.in_view(position, buffer_);
      it->second.seen.assign(view.begin(), view.end());
    }
    return it->second;
  }
  /// Leaves of a view what is really in sight. `go_on(s)` is told of each target that is not, and
  /// may put the rest off.
  template <typename GoOn>
  static void look(const SightTargets<>& targets, const Point3& position, View& view,
                   GoOn&& go_on) {
    look(targets, targets.sight(), position, view, std::forward<GoOn>(go_on));
  }
  template <typename GoOn>
  static void look(const SightTargets<>& targets, MapSight sees, const Point3& position, View& view,
                   GoOn&& go_on) {
    std::size_t next = view.in_sight;
    for (bool on = true; on && next < view.seen.size(); ++next) {
      const Sighting& s = view.seen[next];
      if (sees(position, targets[static_cast<std::size_t>(s.target)]))
        view.seen[view.in_sight++] = s;
      else
        on = go_on(s);
    }
    const auto at = [&](std::size_t k) {
      return view.seen.begin() + static_cast<std::ptrdiff_t>(k);
    };
    view.seen.erase(at(view.in_sight), at(next));
  }

  /// Predicted surface is remembered by cells of two voxels.
  static VoxelKey vain_key(const Point3& p, double voxel) {
    return key_of(VoxelIndex((p / (2.0 * voxel)).array().floor().cast<int>()));
  }
  double vain_share(const Point3& p, double voxel) const {
    const auto it = vain_looks_.find(vain_key(p, voxel));
    return it == vain_looks_.end() ? 1.0 : std::pow(options.climb_alone.vain_share, it->second);
  }

  /// What is still in view from where a robot stands its look did not bring: so much worth there,
  /// that predicted surface and those cells of unseen space.
  void note_what_is_left(const Search& s, const Configuration& at) {
    const auto moved = std::find_if(moved_.begin(), moved_.end(), [&](const auto& m) {
      return (m.first - at.position).norm() <= kSamePlace;
    });
    const VoxelIndex cell = moved == moved_.end() ? s.lattice.nearest(at.position) : moved->second;
    const Point3 place = s.lattice.position(cell);
    const int heading = nearest_heading(at.yaw);
    if ((moved == moved_.end() && (place - at.position).norm() > kSamePlace) ||
        std::abs(wrap_angle(heading_angle(heading) - at.yaw)) > kSamePlace)
      return;
    View& view = view_from(s.targets, s.lattice.index(cell), place);
    look(s.targets, place, view, [](const Sighting&) { return true; });
    std::vector<char> done(s.targets.size(), 0);
    const double worth =
        worth_by_heading(s.targets, view.seen, done)[static_cast<std::size_t>(heading)];
    const bool fresh =
        left_.insert_or_assign(std::pair(s.lattice.index(cell), heading), worth).second;
    if (!fresh) return;  // A robot that stands there still has not looked anew.
    mark_in_view(view.seen, heading, done, [&](std::size_t id) {
      if (id >= first_space_)
        space_.note_look(id - first_space_);
      else if (id >= members_.size() && climbs_alone(s.situation))
        ++vain_looks_[vain_key(s.targets[id].position, s.situation.belief.known().voxel_size())];
    });
  }
  bool is_vain(std::size_t site, std::size_t heading, double worth) const {
    const auto it = left_.find({site, static_cast<int>(heading)});
    return it != left_.end() && worth <= kMore * it->second;
  }

  static constexpr double kSamePlace = 0.02;  ///< [m, rad]
  static constexpr double kLeastMove = 0.05;  ///< Of a stop that is moved [m].
  static constexpr double kRounding = 1e-9;   ///< Of sums of worth [m²].
  static constexpr double kMore = 1.1;  ///< Times what was left, for another look to be worth it.

  std::optional<Candidate> best_stop(const Search& s, std::span<const char> done,
                                     const Configuration& from, const TeamFlights& flights) {
    std::optional<Candidate> best;
    if (s.targets.size() == 0) return best;
    const Point3 start = s.situation.space().free.free_start(from.position);
    const LazyPrmStar::Reach reach = s.situation.space().roadmap.reach_from(start);
    const double stop_cost = options.stop_share * s.situation.space().kind.camera.max_range;
    std::array<double, kHeadings> turn;
    for (int k = 0; k < kHeadings; ++k)
      turn[static_cast<std::size_t>(k)] =
          options.turn_cost * std::abs(wrap_angle(heading_angle(k) - from.yaw));
    const auto beats = [&](double worth, double cost) {
      return !best || worth > best->rate * cost;
    };
    const auto any_heading = [](auto&& holds) {
      for (std::size_t k = 0; k < kHeadings; ++k)
        if (holds(k)) return true;
      return false;
    };
    const auto visit = [&](const auto& site) {
      const double least_cost = site.distance + stop_cost;  // of no later site it is less
      if (!beats(options.view_share * s.around.largest(), least_cost)) return false;
      double cost = least_cost;
      if (flights.meet({from.position, site.position}))
        cost += options.meeting_share * s.situation.space().kind.camera.max_range;
      const auto could_be_best = [&] {
        if (!beats(s.most.at_any_heading(site.cell), cost)) return false;
        const auto most = s.most(site.cell);
        return any_heading([&](std::size_t k) { return beats(most[k], cost + turn[k]); });
      };
      if (!beats(options.view_share * s.around(site.position), cost)) return true;
      const std::size_t id = s.lattice.index(site.cell);
      // What has been looked at already costs nothing, and may be the broadest look.
      const auto looked = sites_.find(id);
      if ((looked == sites_.end() || !looked->second.complete()) && !could_be_best()) return true;
      // Lines of the lattice may lead where no path of the roadmap does.
      if (!reach(site.position)) return true;
      View& view = view_from(s.targets, id, site.position);
      const auto better = [&](std::size_t k, double worth) {
        return worth > 0.0 && beats(worth, cost + turn[k]);
      };
      auto worth = worth_by_heading(s.targets, view.seen, done);
      if (!view.complete()) {
        // Rays are cast only as long as the view could be the best, or the broadest, if nothing
        // were in the way of the rest.
        if (!any_heading([&](std::size_t k) { return better(k, worth[k]); })) return true;
        look(s.targets, site.position, view, [&](const Sighting& hidden) {
          const auto target = static_cast<std::size_t>(hidden.target);
          if (done[target] != 0) return true;
          for (unsigned bits = hidden.headings; bits != 0; bits &= bits - 1)
            worth[static_cast<std::size_t>(std::countr_zero(bits))] -= s.targets[target].worth;
          return any_heading([&](std::size_t k) {
            return better(k, worth[k] + kRounding) || worth[k] + kRounding > broadest_;
          });
        });
        if (!view.complete()) return true;
        worth = worth_by_heading(s.targets, view.seen, done);
      }
      for (std::size_t k = 0; k < kHeadings; ++k) {
        if (is_vain(id, k, worth[k])) continue;
        broadest_ = std::max(broadest_, worth[k]);
        if (better(k, worth[k]))
          best = Candidate{{site.position, heading_angle(static_cast<int>(k))},
                           worth[k] / (cost + turn[k]),
                           id,
                           static_cast<int>(k)};
      }
      return true;
    };
    s.lattice.search(start, visit, [&](std::span<const Point3> places) {
      return s.situation.space().roadmap.distances(start, places);
    });
    return best;
  }

  /// What the places of a tour ahead would show, each looked from when it is first asked for.
  class LooksAhead {
   public:
    struct Place {
      VoxelIndex cell;
      bool known = true;  // to be free
    };

    LooksAhead(RatePlanner& planner, const Search& search, std::span<const char> done,
               double unknown_worth)
        : planner_(&planner),
          search_(&search),
          done_(done.begin(), done.end()),
          unknown_worth_(unknown_worth) {}
    void add(const Place& place) { places_.push_back({place, search_->lattice.index(place.cell)}); }
    const Place& operator[](std::size_t s) const { return places_[s].place; }

    double look(std::size_t s, double enough, WorthByHeading& worth) {
      State& at = places_[s];
      const auto shared = [&](const WorthByHeading& most) {
        return share(at) * *std::max_element(most.begin(), most.end());
      };
      const Point3 position = search_->lattice.position(at.place.cell);
      if (!at.looked) {
        const double any = share(at) * search_->most.at_any_heading(at.place.cell);
        if (any <= enough) return any;
        if (const double most = shared(search_->most(at.place.cell)); most <= enough) return most;
      }
      View& view = view_of(at);
      worth = worth_by_heading(search_->targets, view.seen, done_);
      if (const double most = shared(worth); most <= enough) return most;
      if (!at.looked) {
        MapSight sees = search_->targets.sight();
        if (!at.place.known) sees.look_through_unknown();
        RatePlanner::look(search_->targets, sees, position, view,
                          [](const Sighting&) { return true; });
        at.looked = true;
        worth = worth_by_heading(search_->targets, view.seen, done_);
      }
      for (std::size_t k = 0; k < kHeadings; ++k) {
        worth[k] = planner_->is_vain(at.id, k, worth[k]) ? 0.0 : share(at) * worth[k];
        if (!taken_) planner_->broadest_ = std::max(planner_->broadest_, worth[k]);
      }
      return *std::max_element(worth.begin(), worth.end());
    }
    void take(std::size_t s, int heading) {
      mark_in_view(view_of(places_[s]).seen, heading, done_, [](std::size_t) {});
      taken_ = true;
    }

   private:
    struct State {
      Place place;
      std::size_t id;
      bool looked = false;
    };
    double share(const State& at) const {
      const double known = at.place.known ? 1.0 : unknown_worth_;
      return at.id == planner_->goal_ ? planner_->options.climb_alone.goal_worth * known : known;
    }
    View& view_of(const State& at) {
      return planner_->view_from(search_->targets, at.id, search_->lattice.position(at.place.cell));
    }

    RatePlanner* planner_;
    const Search* search_;
    std::vector<char> done_;
    double unknown_worth_;
    std::vector<State> places_;
    bool taken_ = false;
  };

  /// The first stops of a tour ahead for one drone, or the look that opens the way there, and the
  /// best rate on that tour.
  std::pair<Stops, double> begin_tour(const Search& s, std::vector<char>& done) {
    const SurfaceSituation& situation = s.situation;
    const double range = situation.space().kind.camera.max_range;
    const Configuration& from = situation.team.front().at;
    const Point3 start = situation.space().free.free_start(from.position);
    const LazyPrmStar::Reach reach = situation.space().roadmap.reach_from(start);
    optimistic_.options = options.ways;
    optimistic_.follow(situation.space().free, s.lattice.spacing());
    const bool climb = climbs_alone(situation);
    LooksAhead looks(*this, s, done,
                     climb ? options.climb_alone.unknown_worth : options.unknown_worth);
    const double farthest = (climb ? options.climb_alone.reach : options.ahead_reach) * range;
    std::vector<TourSite> sites;
    optimistic_.search(start, s.lattice, [&](const auto& site, bool known) {
      if (site.distance > farthest) return false;
      const bool coarse = ((site.cell.x() | site.cell.y() | site.cell.z()) & 1) == 0;
      if ((coarse || site.distance <= options.ahead_fine * range) &&
          s.most.at_any_heading(site.cell) > 0.0 && (!known || reach(site.position))) {
        looks.add({site.cell, known});
        sites.push_back({site.position, site.distance});
      }
      return true;
    });
    const std::vector<TourAheadStop> tour = tour_ahead(from, sites, looks,
                                                       {.stops = options.ahead,
                                                        .stop_cost = options.stop_share * range,
                                                        .turn_cost = options.turn_cost});
    Stops route;
    if (tour.empty()) return {};
    double rate = 0.0;
    for (const TourAheadStop& stop : tour) rate = std::max(rate, stop.rate);
    if (const auto& first = looks[tour.front().site]; !first.known) {
      std::vector<Point3> way{start};
      for (const VoxelIndex& c : optimistic_.way_to(first.cell)) {
        if (way.size() == 1 && s.lattice.is_free(c)) way.clear();
        way.push_back(s.lattice.position(c));
      }
      if (auto look = opening_(situation, s.lattice, reach, from, start, way))
        route.push_back(*look);
      return {std::move(route), rate};
    }
    std::vector<Point3> places;
    for (const TourAheadStop& stop : tour) places.push_back(sites[stop.site].position);
    const std::vector<Point3> taut =
        taut_path(start, places, climb ? options.climb_alone.slack * range : 0.0);
    moved_.clear();
    goal_.reset();
    for (std::size_t k = 0; k < tour.size(); ++k) {
      const auto& place = looks[tour[k].site];
      if (!place.known || route.size() == static_cast<std::size_t>(options.stops)) break;
      const Candidate c{{places[k], heading_angle(tour[k].heading)},
                        tour[k].rate,
                        s.lattice.index(place.cell),
                        tour[k].heading};
      if (climb && k == 0) goal_ = c.site;
      auto moved = moved_stop(s, c, taut[k], done);
      if (moved) moved_.emplace_back(moved->configuration.position, place.cell);
      route.push_back(moved ? *std::move(moved) : make_stop(situation, c, done));
    }
    return {std::move(route), rate};
  }

  /// A stop beside its place, as near to `wish` as it still shows enough; nothing if there is none.
  std::optional<Stop> moved_stop(const Search& s, const Candidate& c, const Point3& wish,
                                 std::vector<char>& done) {
    const Point3& place = c.configuration.position;
    const auto worth = [&](std::span<const Sighting> seen) {
      return worth_by_heading(s.targets, seen, done)[static_cast<std::size_t>(c.heading)];
    };
    for (const double share : {1.0, 0.67, 0.33}) {
      const Point3 p = place + share * (wish - place);
      if ((p - place).norm() < kLeastMove) break;
      if (!s.situation.space().free.is_free(p) ||
          !s.situation.space().free.is_free_segment(p, place))
        continue;
      const std::vector<Sighting> seen = s.targets.seen_from(p);
      if (worth(seen) >= options.climb_alone.slack_worth * worth(sites_.at(c.site).seen))
        return make_stop(s.situation, {p, c.configuration.yaw}, seen, c.heading, done);
    }
    return std::nullopt;
  }

  /// Marks what the stop sees and names the incomplete elements among it.
  Stop make_stop(const SurfaceSituation& situation, const Candidate& c, std::vector<char>& done) {
    return make_stop(situation, c.configuration, sites_.at(c.site).seen, c.heading, done);
  }
  Stop make_stop(const SurfaceSituation& situation, const Configuration& at,
                 std::span<const Sighting> seen, int heading, std::vector<char>& done) {
    Stop stop{at, {}};
    mark_in_view(seen, heading, done, [&](std::size_t id) {
      if (id >= members_.size()) return;
      for (const std::int32_t i : members_[id])
        stop.targets.push_back(situation.goals[static_cast<std::size_t>(i)].voxel);
    });
    return stop;
  }

  OptimisticLattice optimistic_;
  OpeningLooks opening_;
  std::optional<FlightLattice<FreeSpace>> lattice_;
  std::uint64_t followed_ = 0;  // revision of its space
  std::unordered_map<std::size_t, View> sites_;
  std::vector<Sighting> buffer_;
  // Targets are groups of elements, then predicted patches, then cells of unseen space.
  std::vector<std::vector<std::int32_t>> members_;  // elements by target
  SurfaceFrameMemory frames_;
  UnseenSpace space_;
  std::size_t first_space_ = 0;  // target
  /// In view from places and headings when a robot last had looked from there [m²].
  std::map<std::pair<std::size_t, int>, double> left_;
  std::map<VoxelKey, int> vain_looks_;  // at predicted surface
  /// Stops of the last tour that are beside their nodes of the lattice, and these.
  std::vector<std::pair<Point3, VoxelIndex>> moved_;
  std::optional<std::size_t> goal_;  // the node a robot that climbs alone was sent to
  double broadest_ = 0.0;
  double last_rate_ = 0.0;
};
}  // namespace surfleet
