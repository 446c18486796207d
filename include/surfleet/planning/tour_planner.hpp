// SPDX-License-Identifier: MIT
/// @file
/// @brief The published high-level planner: viewpoints, clusters, tours, allocation [000 ch. 2, 3].
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <optional>
#include <set>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <surfleet/allocation/greedy_allocator.hpp>
#include <surfleet/allocation/hamiltonian_path.hpp>
#include <surfleet/allocation/improve_allocation.hpp>
#include <surfleet/planning/cluster_gain.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/viewpoint/gain.hpp>
#include <surfleet/viewpoint/revealing_view.hpp>
#include <surfleet/viewpoint/view_access.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/view_memory.hpp>
#include <surfleet/viewpoint/viewpoint_clustering.hpp>
#include <surfleet/viewpoint/viewpoint_cover.hpp>
#include <surfleet/viewpoint/viewpoint_generation.hpp>
#include <surfleet/viewpoint/viewpoint_merging.hpp>

namespace surfleet {
/// Leaves a plan as it is.
struct KeepAllocation {
  template <typename Graph>
  FleetPlan operator()(const Graph& /*graph*/, FleetPlan plan,
                       const AlreadyAssigned& /*assigned*/ = {}) const {
    return plan;
  }
};

/// What a selection of viewpoints is given.
struct ViewSelection {
  const ViewpointSet& views;                    ///< One for each element that has one.
  std::span<const IncompleteElement> elements;  ///< Their targets.
  const ViewFrustum& frustum;
  const SurfaceSituation& situation;
  std::span<const ReachFrom> reach;  ///< Of the robots that are planned for.
  SightMemory& revealed;             ///< Of what such a selector finds the views to reveal.
};
/// Fewer viewpoints with the same targets. Models: `MergeNearby`, `CoverGreedily`.
template <typename S>
concept ViewSelector = requires(const S& select, const ViewSelection& selection) {
  { select(selection) } -> std::same_as<std::vector<Viewpoint>>;
};
/// Those at about the same place with about the same viewing direction become one [000 §2.4.2].
struct MergeNearby {
  MergeOptions merge;  ///< ε and "almost parallel".
  std::vector<Viewpoint> operator()(const ViewSelection& s) const {
    const auto is_free = [&](const Configuration& q) {
      return s.situation.space().free.is_free(q.position) && any_reaches(s.reach, q.position);
    };
    return merge_viewpoints(
        s.views, merge,
        SeesTargets{s.elements, &s.situation.belief.observed(), s.frustum, is_free});
  }
};
/// As few as reveal them all, each at a fair angle and from a side not viewed in vain.
struct CoverGreedily {
  double max_incidence = 1.16;  ///< Greatest angle between n̄_v and the line of sight [rad].
  std::vector<Viewpoint> operator()(const ViewSelection& s) const {
    const IncompleteSurfaceGain gain(s.elements, s.situation.belief.observed(), s.frustum);
    const double least = std::cos(max_incidence);
    LineOfSight line(s.situation.belief.observed());
    const auto element = [&](std::int32_t id) -> const IncompleteElement& {
      return s.elements[static_cast<std::size_t>(id)];
    };
    const auto to_eye = [&](const Configuration& q, std::int32_t id) {
      return (s.frustum.at(q).eye() - element(id).position).normalized().eval();
    };
    auto revealed = s.revealed(s.views.views, s.elements, s.frustum, [&](const Configuration& q) {
      std::vector<std::int32_t> ids = gain.seen(q);
      std::erase_if(ids, [&](std::int32_t id) {
        return !element(id).faces(to_eye(q, id), least) ||
               !shows_unknown(s.frustum.at(q), element(id), line);
      });
      return ids;
    });
    for (std::size_t i = 0; i < revealed.size(); ++i)
      std::erase_if(revealed[i], [&](std::int32_t id) {
        return !s.situation.belief.ledger().promises(element(id).voxel,
                                                     to_eye(s.views[i].configuration, id));
      });
    return cover_viewpoints(s.views, std::move(revealed));
  }
};
static_assert(ViewSelector<MergeNearby> && ViewSelector<CoverGreedily>);

struct TourPlannerOptions {
  double distance = 4.7;  ///< δ_pose [m].
  /// d_ν and d_ν^max; without a bound on its extent one chain of views could go round it all.
  ClusterOptions clusters{.max_extent = 10.0};
  /// Whether viewpoints are joined by the length of the roadmap's path between them, in place of
  /// the straight one: what a wall parts is then no cluster. Some tens of queries a viewpoint.
  bool by_path = false;
  /// Where a team has fewer clusters than this for each robot, they are made finer, as far as there
  /// are views: a single one cannot be shared. The published method has no such bound.
  std::size_t least_clusters = 0;
  StopDistance cost;  ///< Of the path to each viewpoint; the published one is its length.
  /// Whether robots under way keep their route, and only those without get a new one from the work
  /// that no robot has; else every call plans for all.
  bool asynchronous = false;
  /// Whether work that a robot is flying to is left to it, where plans are asynchronous.
  bool exclusive = true;
  /// Whether each robot's stops are put in order once more without regard to their clusters, for
  /// the cheapest path through all of them.
  bool reorder_stops = false;
  ReplanRule replan{};
};

/// Viewpoints at the incomplete surface, made fewer, clustered, valued by ray casting, allocated to
/// the robots and put in order by maximum-utility open paths: with the default allocator TSGA, with
/// the rule `NearestNeighbour` NNB. `Improve` is a second step over the whole plan, `Utility`
/// weighs a cluster's `Gain` against the path to it and through it.
template <typename Allocator = GreedyAllocator<>, typename Improve = KeepAllocation,
          ViewSelector Select = MergeNearby, UtilityPolicy Utility = ExponentialUtility,
          ClusterGain Gain = ElementsInSight>
class TourPlanner {
 public:
  TourPlannerOptions options;
  Allocator allocate;
  Improve improve;
  Select select;
  Utility utility;  ///< With `ExponentialUtility`, λ_tc and λ_ic.
  Gain gain;

  explicit TourPlanner(TourPlannerOptions o = {}, Allocator a = {}, Improve i = {}, Select s = {},
                       Utility u = {}, Gain g = {})
      : options(std::move(o)),
        allocate(std::move(a)),
        improve(std::move(i)),
        select(std::move(s)),
        utility(std::move(u)),
        gain(std::move(g)) {}

  Plan operator()(const SurfaceSituation& situation) {
    Plan result;
    result.replan = options.replan;
    std::vector<RobotId> serve;
    std::vector<Configuration> starts;
    for (const RobotState& robot : situation.team)
      if (!options.asynchronous || situation.is_asked(robot.id)) {
        serve.push_back(robot.id);
        starts.push_back(robot.at);
      }
    if (serve.empty()) return result;
    for (const RobotId r : serve) result.routes[r] = Stops{};
    const std::vector<IncompleteElement> elements = unassigned(situation);

    // Viewpoints, and the elements there is none for.
    const ViewFrustum& frustum = situation.space().frustum;
    const auto is_free = [&](const Configuration& q) {
      return situation.space().free.is_free(q.position);
    };
    std::vector<ReachFrom> reach;
    for (const Configuration& s : starts)
      reach.push_back(situation.space().roadmap.reach_from(s.position));
    const auto is_reachable = [&](const Configuration& q) {
      return any_reaches(reach, q.position);
    };
    const auto promises = [&](const IncompleteElement& e, const Eigen::Vector3d& direction) {
      return situation.belief.ledger().promises(e.voxel, direction);
    };
    const std::vector<Box3> changed =
        changed_(situation.belief.known(), situation.belief.observed(), situation.space().free);
    viewpoints_.forget(changed);
    gain.forget(changed);
    revealed_.forget(changed);
    if (options.asynchronous && options.exclusive) {  // others' work returns
      gain.reset();
      revealed_ = {};
    }
    ViewpointGenerator generate(
        situation.belief.observed(), situation.space().kind.camera,
        {.distance = options.distance, .T_body_camera = situation.space().kind.T_body_camera});
    const ViewpointSet set =
        viewpoints_(generate, elements, situation.belief.ledger(), is_free, is_reachable, promises);
    for (const UnseenElement& u : set.unseen)
      result.impossible.emplace_back(elements[static_cast<std::size_t>(u.element)].voxel,
                                     left_reason(u.reason));
    const std::vector<Viewpoint> views =
        select(ViewSelection{set, elements, frustum, situation, reach, revealed_});
    if (views.empty()) return result;

    // Clusters and their gains.
    const ViewAccess access(reach, views);
    std::vector<ViewpointCluster> clusters =
        share_out(access, views, situation.space().roadmap, serve.size());
    gain({views, elements, frustum, situation}, clusters);
    using Place = ViewAccess::Place;
    std::vector<ConfigurationCluster<Place>> nodes;
    for (const ViewpointCluster& c : clusters) {
      ConfigurationCluster<Place> node;
      for (const std::int32_t v : c.views) {
        node.configurations.push_back(
            {.configuration = views[static_cast<std::size_t>(v)].configuration, .view = v});
      }
      node.gain = c.gain;
      nodes.push_back(std::move(node));
    }
    std::vector<Place> origins;
    for (const Configuration& s : starts)
      origins.push_back({.configuration = s, .robot = static_cast<std::int32_t>(origins.size())});
    const ClusterGraph<Place, Utility, ViewAccess::Distance, LinKernighan> graph(
        std::move(nodes), std::move(origins), {utility}, {&access, options.cost},
        {.search = {.max_iterations = kKicksInside}, .quick_bound = true});
    const FleetPlan plan = improve(graph, allocate(graph));
    for (std::size_t k = 0; k < serve.size(); ++k) {
      Stops route;
      for (const int c : graph.viewpoints(static_cast<int>(k), plan.routes[k])) {
        const Viewpoint& view = views[static_cast<std::size_t>(graph.configuration(c).view)];
        Stop stop{view.configuration, {}};
        for (const std::int32_t t : view.targets)
          stop.targets.push_back(elements[static_cast<std::size_t>(t)].voxel);
        route.push_back(std::move(stop));
      }
      if (options.reorder_stops) reorder(starts[k], route);
      result.routes[serve[k]] = std::move(route);
    }
    return result;
  }

 private:
  static constexpr int kKicksInside = 40;  ///< For the order inside a cluster.
  static constexpr int kHalvings = 5;      ///< Of the clusters' radii at most.

  /// Clusters, at half the radii time after time until there are enough for so many robots.
  std::vector<ViewpointCluster> share_out(const ViewAccess& access,
                                          std::span<const Viewpoint> views,
                                          const LazyPrmStar& roadmap, std::size_t robots) const {
    const std::size_t wanted =
        robots > 1 ? std::min(options.least_clusters * robots, views.size()) : 0;
    ClusterOptions finer = options.clusters;
    for (int halvings = 0;; ++halvings) {
      std::vector<ViewpointCluster> clusters =
          options.by_path ? access.clusters(views, roadmap, finer)
                          : access.clusters(views, EuclideanDistance{}, finer);
      if (clusters.size() >= wanted || halvings == kHalvings) return clusters;
      for (double* length : {&finer.radius, &finer.max_radius, &finer.max_extent}) *length *= 0.5;
    }
  }
  /// The cheapest open path from `start` through all stops that is found.
  void reorder(const Configuration& start, Stops& route) const {
    const int n = static_cast<int>(route.size()) + 1;
    if (n < 4) return;
    const auto place = [&](int i) -> const Configuration& {
      return i == 0 ? start : route[static_cast<std::size_t>(i - 1)].configuration;
    };
    const auto cost = [&](int i, int j) { return options.cost(place(i), place(j)); };
    Stops ordered;
    for (const int i : shortest_hamiltonian_path(n, cost, LinKernighan{}).order)
      if (i > 0) ordered.push_back(std::move(route[static_cast<std::size_t>(i - 1)]));
    route = std::move(ordered);
  }
  static LeftReason left_reason(NoViewReason reason) {
    switch (reason) {
      case NoViewReason::viewed_in_vain:
        return LeftReason::seen_incomplete;
      case NoViewReason::unreachable:
        return LeftReason::unreachable;
      case NoViewReason::occluded:
        return LeftReason::hidden;
      default:
        return LeftReason::no_free_pose;
    }
  }
  /// The work less what robots that keep their route are about to see.
  std::vector<IncompleteElement> unassigned(const SurfaceSituation& situation) const {
    std::vector<IncompleteElement> elements(situation.goals.begin(), situation.goals.end());
    if (!options.asynchronous || !options.exclusive) return elements;
    std::set<VoxelKey> taken;
    for (const RobotState& robot : situation.team)
      if (!situation.is_asked(robot.id))
        for (const Stop& stop : robot.route)
          for (const VoxelIndex& v : stop.targets) taken.insert(key_of(v));
    std::erase_if(elements,
                  [&](const IncompleteElement& e) { return taken.contains(key_of(e.voxel)); });
    return elements;
  }

  // The map is asked only about what has changed since the last call.
  ChangedRegions changed_;
  ViewpointMemory viewpoints_;
  SightMemory revealed_;
};

/// TSGA [000 Alg. 2] and NNB [000 Alg. 4], and what goes beyond them: an improvement step after the
/// greedy pass, and a rule that evens out the robots' times.
using TsgaPlanner = TourPlanner<>;
using NnbPlanner = TourPlanner<
    GreedyAllocator<TourUtility<LinKernighan>, NearestFirst, PartitionMatroid, NearestNeighbour>>;
using ImprovedTsgaPlanner = TourPlanner<GreedyAllocator<>, ImproveAllocation<>>;
template <FleetObjective Objective, ViewSelector Select>
using MakespanTours =
    TourPlanner<MakespanAllocator, ImproveAllocation<Objective, TourShortness<LinKernighan>>,
                Select>;
using MakespanPlanner = MakespanTours<Makespan, MergeNearby>;
/// The same with few, broad views and the team's total path in the objective: for what is left when
/// most has been seen.
using CoverPlanner = MakespanTours<MakespanAndMean, CoverGreedily>;
}  // namespace surfleet
