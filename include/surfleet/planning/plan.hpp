// SPDX-License-Identifier: MIT
/// @file
/// @brief What a planner is asked, and what it answers.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/planning/surface_belief.hpp>
#include <surfleet/viewpoint/left_reason.hpp>

namespace surfleet {
/// One stop of a robot: where to be, and which elements are to be viewed from there.
struct Stop {
  Configuration configuration;
  std::vector<VoxelIndex> targets;  ///< Incomplete elements this stop is for; may be empty.
};
/// What a robot is to do, in order.
using Stops = std::vector<Stop>;

/// A robot as its team knows it.
struct RobotState {
  RobotId id = 0;
  RobotKindId kind = 0;
  Configuration at;             ///< Where it is, or will be when it can follow a new route.
  std::vector<Point3> ahead{};  ///< The path it is on, from where it is.
  Stops route{};                ///< What it still has to do.
  bool idle = true;             ///< It has nothing to do.
  bool done = false;        ///< Nor has its map, as far as it knows, anything left for any robot.
  std::uint64_t holds = 0;  ///< If it is done: a digest of what its map is made of.
  double age = 0.0;         ///< Of this news [s].
  // In traffic, see `TrafficAgent`:
  bool held = false, cornered = false, first = false;
};

/// All that a planner is given: a value, whose views last for the call.
template <typename Belief>
struct Situation {
  const Belief& belief;
  std::span<const typename Belief::Goal> goals;  ///< To be planned for, in voxel order.
  std::span<const RobotId> asked;                ///< Those to plan for, ascending.
  std::span<const RobotState> team;              ///< All, always, by ascending id.
  double time = 0.0;                             ///< [s]
  std::uint64_t seed = 0;                        ///< Never the same twice.

  bool alone() const { return team.size() == 1; }
  bool is_asked(RobotId id) const { return std::binary_search(asked.begin(), asked.end(), id); }
  /// Throws `Error` for a robot that is not of the team.
  const RobotState& robot(RobotId id) const {
    const auto it = std::lower_bound(team.begin(), team.end(), id,
                                     [](const RobotState& r, RobotId i) { return r.id < i; });
    require(it != team.end() && it->id == id,
            "robot " + std::to_string(id) + ": expected one of the team");
    return *it;
  }
  /// Space and views of the robots planned for, which are of one kind; of the team's first if
  /// there are none.
  const auto& space() const {
    return belief.space(asked.empty() ? (team.empty() ? 0 : team.front().kind)
                                      : robot(asked.front()).kind);
  }
};
using SurfaceSituation = Situation<SurfaceBelief>;

/// When the next plan is wanted, and how robots come to follow it.
struct ReplanRule {
  /// When this share of what a route was made for is complete; if not said, the fleet's own share
  /// decides.
  std::optional<double> utility_share;
  /// Whether robots under way turn to their next stop without braking first, if it lies ahead.
  bool turn_in_flight = false;
  /// Whether robots under way turn to what there is to see until they have to turn for their goal;
  /// if not, they turn to the goal's heading as soon as it is no farther off than half a turn
  /// takes.
  bool watch_on = false;
  /// Whether routes are followed as the low-level planner is printed [000 Alg. 1, 3]: every stop is
  /// flown to, with the camera turned to its heading; between stops, what is complete is a share of
  /// all that the route was made for, whatever was visited; an obstacle ahead ends the route.
  bool as_printed = false;
  /// Whether every robot is planned for anew whenever the map has changed.
  bool every_map = false;
};

/// What a flight is expected to bring.
struct Yield {
  double gain = 0.0;      ///< New surface [m²].
  double distance = 0.0;  ///< To be flown for it [m].
};
/// What is expected of a route and of what would follow it, by the planner.
class Outlook {
 public:
  /// The next stop of the tour.
  void add(double gain, double distance) {
    whole_.gain += gain;
    whole_.distance += distance;
    if (!any_ || whole_.gain * best_.distance > best_.gain * whole_.distance) best_ = whole_;
    any_ = true;
  }
  /// The beginning of the tour that pays best: the most gain for a metre.
  const Yield& best() const { return best_; }
  const Yield& whole() const { return whole_; }

 private:
  Yield whole_, best_;
  bool any_ = false;
};

/// New routes and the elements for which the planner found none.
struct Plan {
  /// By robot: one that is not named keeps the route it has; an empty route takes it away.
  std::map<RobotId, Stops> routes;
  /// Of routes, if the planner has an opinion. Without, a route shows what its stops are for.
  std::map<RobotId, Outlook> outlook{};
  std::vector<std::pair<VoxelIndex, LeftReason>> impossible;
  ReplanRule replan{};

  /// Whether no robot is given anything to do.
  bool nothing() const {
    return std::all_of(routes.begin(), routes.end(),
                       [](const auto& route) { return route.second.empty(); });
  }
};

/// A high-level planner: turns what is believed into routes. It may keep state between calls, of
/// that belief, so a planner is for one mission. Models: `RollingTours`, `TourPlanner` (TSGA, NNB
/// and their kin), `WithFrontierViews`.
template <typename P>
concept FleetPlanner = requires(P& planner, const SurfaceSituation& situation) {
  { planner(situation) } -> std::same_as<Plan>;
};

/// The planner's answer. Throws `Error` if it gives a robot that was asked for no answer, or names
/// one that is not of the team.
template <FleetPlanner P>
Plan ask(P& planner, const SurfaceSituation& situation) {
  Plan plan = planner(situation);
  for (const RobotId id : situation.asked)
    require(plan.routes.contains(id), "planner: gave robot " + std::to_string(id) +
                                          " no route; expected one for each that was asked for, "
                                          "empty for nothing to do");
  for (const auto& [id, route] : plan.routes) situation.robot(id);
  return plan;
}

/// Any copyable planner behind one type, so that what takes a planner is compiled once.
class AnyPlanner {
 public:
  /// `SurfaceBeliefOptions::observed_share` of the belief it is flown with, whatever the mission
  /// says; nothing: as that says.
  std::optional<double> observed_share;

  AnyPlanner() = default;  ///< None.
  template <typename P>
  requires(!std::same_as<P, AnyPlanner> && FleetPlanner<P>)
      AnyPlanner(P planner)  // NOLINT(google-explicit-constructor): takes the place of any of them
      : plan_(std::move(planner)) {}

  explicit operator bool() const { return plan_ != nullptr; }
  Plan operator()(const SurfaceSituation& situation) { return plan_(situation); }

 private:
  std::function<Plan(const SurfaceSituation&)> plan_;
};
static_assert(FleetPlanner<AnyPlanner>);

/// The belief's options with what the planner asks of it.
template <FleetPlanner P>
SurfaceBeliefOptions belief_for(const P& planner, SurfaceBeliefOptions options) {
  if constexpr (requires { planner.observed_share; })
    options.observed_share = planner.observed_share.value_or(options.observed_share);
  return options;
}
}  // namespace surfleet
