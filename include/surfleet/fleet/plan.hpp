// SPDX-License-Identifier: MIT
/// @file
/// @brief What a mission asks of a planner, and what it gets back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/left_reason.hpp>
#include <surfleet/viewpoint/look_ledger.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

namespace surfleet {
/// One stop of a robot: where to be, and which elements are to be looked at from there.
struct Stop {
  Configuration configuration;
  std::vector<VoxelIndex> targets;  ///< Incomplete elements this stop is for; may be empty.
};
/// What a robot is to do, in order.
using Stops = std::vector<Stop>;

/// A robot as the planner sees it.
struct RobotRequest {
  Configuration configuration;  ///< Where it is, or will be when it can follow a new route.
  bool idle = true;             ///< It has nothing left to do and waits for a route.
  Stops remaining;              ///< What it still has to do; empty if idle.
};

/// Everything a planner may look at. All views are of the mission's own state and last for the
/// call.
struct PlanRequest {
  std::span<const IncompleteElement> work;  ///< Elements worth planning for, in voxel order.
  const IncompleteSurface& incomplete;      ///< All of them, also those given up.
  const VoxelStateMap& known;               ///< States at W_th: what is complete.
  const VoxelStateMap& observed;  ///< States at a lower weight: what to fly and look through.
  const LookLedger& ledger;       ///< What was looked at in vain.
  const FreeSpace& free_space;
  LazyPrmStar& roadmap;
  const PinholeCamera& camera;
  const Pose& T_body_camera;
  const HeadingTable& headings;  ///< Of that camera on that mount.
  Box3 region;                   ///< Where surface is to be reconstructed.
  std::span<const RobotRequest> robots;
  double time = 0.0;        ///< Of the mission [s].
  std::uint64_t round = 0;  ///< Number of this request: a seed that never repeats.

  bool is_team() const { return robots.size() > 1; }  ///< Or one robot alone.
  /// Height of the region over the camera's range.
  double relative_height() const { return region.sizes().z() / camera.max_range; }
};

/// When the next plan is wanted, and how robots come to follow it.
struct ReplanRule {
  /// When this share of what a route was made for is complete; if not said, the mission's own share
  /// decides.
  std::optional<double> utility_share;
  /// Whether robots under way turn to their next stop without braking first, if it lies ahead.
  bool turn_in_flight = false;
  /// Whether robots under way look at what there is to see until they have to turn for their goal;
  /// if not, they look to their goal as soon as it is no farther off than half a turn takes.
  bool watch_on = false;
};

/// New routes and the elements for which the planner found none.
struct PlanResult {
  /// One a robot: nothing keeps the route it has, an empty route takes it away.
  std::vector<std::optional<Stops>> routes;
  std::vector<std::pair<VoxelIndex, LeftReason>> impossible;
  ReplanRule replan{};
};

/// A high-level planner: turns the state of the map into routes. It may keep state between calls,
/// of that map, so a planner is for one mission. Models: `TourPlanner` (TSGA, NNB and their kin),
/// `RatePlanner`, `RateThenTours`, `ToursBehind`, `WithSpaceLooks`.
template <typename P>
concept FleetPlanner = requires(P& planner, const PlanRequest& request) {
  { planner(request) } -> std::same_as<PlanResult>;
};

/// The planner's answer. Throws `Error` if that is not of as many routes as there are robots.
template <FleetPlanner P>
PlanResult ask(P& planner, const PlanRequest& request) {
  PlanResult result = planner(request);
  require(result.routes.size() == request.robots.size(),
          "planner: gave " + std::to_string(result.routes.size()) + " routes to " +
              std::to_string(request.robots.size()) +
              " robots; expected one for each, nothing to keep the route it has");
  return result;
}

/// Any copyable planner behind one type, so that what takes a planner is compiled once.
using AnyPlanner = std::function<PlanResult(const PlanRequest&)>;
static_assert(FleetPlanner<AnyPlanner>);
}  // namespace surfleet
