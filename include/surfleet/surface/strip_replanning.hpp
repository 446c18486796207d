// SPDX-License-Identifier: MIT
/// @file
/// @brief Strips to one goal, planned again as triangles become blocked or dearer and the robot
/// moves on [004 §7.2.4].
///
///     StripReplanner plan(mesh, goal);
///     auto strip = plan(start);
///     plan.set_user_cost(triangle, std::numeric_limits<double>::infinity());  // blocked
///     strip = plan(here);
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/geometry/incremental_search.hpp>
#include <surfleet/surface/strip_search.hpp>

namespace surfleet {
static_assert(ReversibleGraph<StripSearch>);

/// `StripSearch` with a memory: answers cost what its own do, and a change costs what it concerns.
/// What lies far from the goal is cheap to change, what lies next to it is not: all strips lead
/// there. Where much changes at once (a hundredth of all
/// triangles) a search anew by `StripSearch` is as fast or faster. Takes some 100 bytes for every
/// triangle.
class StripReplanner {
 public:
  /// The mesh must outlive it. Throws `Error` as `StripSearch` does. O(n).
  StripReplanner(const TriangleMesh& mesh, const SurfacePoint& goal, StripCosts costs = {},
                 StripNodes nodes = StripNodes::centroids)
      : graph_(mesh, std::move(costs), nodes),
        goal_(goal),
        to_(goal.position(mesh)),
        search_(graph_, {}) {
    set_ends();
  }
  StripReplanner(const StripReplanner&) = delete;  // the search knows the graph by its address
  StripReplanner& operator=(const StripReplanner&) = delete;

  const StripSearch& graph() const { return graph_; }
  const SurfacePoint& goal() const { return goal_; }

  /// One triangle's own cost from now on, 0 or more; infinite blocks it. O(1); the work is done by
  /// the next question.
  void set_user_cost(std::int32_t triangle, double cost) {
    graph_.set_user_cost(triangle, cost);
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t in = graph_.twin(3 * triangle + k);
      if (in < 0) continue;
      search_.changed(in);  // goes on inside
      for (const std::int32_t h : graph_.before(in))
        if (h >= 0) search_.changed(h);  // comes here by the neighbour
    }
    if (triangle == goal_.triangle) set_ends();
  }

  /// The cheapest strip from where the robot is; nothing where none leads to the goal.
  std::optional<StripPath> operator()(const SurfacePoint& start) {
    StripPath path;
    if (graph_.blocked(start.triangle) || graph_.blocked(goal_.triangle)) return std::nullopt;
    if (start.triangle == goal_.triangle) {
      path.triangles.push_back(start.triangle);
      path.cost = graph_.within_triangle(start, goal_);
      return path;
    }
    const Point3 from = start.position(graph_.mesh());
    const double moved = last_ ? (from - *last_).norm() : 0.0;
    last_ = from;
    const std::vector<Source> sources = graph_.sources(start);
    path.cost = search_.distance(
        sources, [&](std::int32_t h) { return (graph_.at(h) - from).norm(); }, moved);
    path.expanded = search_.expanded();
    if (!(path.cost < ShortestPaths::kUnreached)) return std::nullopt;
    std::int32_t first = -1;
    double best = ShortestPaths::kUnreached;
    for (const auto& [node, length] : sources)
      if (length + search_.known(node) < best) {
        best = length + search_.known(node);
        first = node;
      }
    path.triangles.push_back(start.triangle);
    for (const std::int32_t h : search_.path(first)) path.triangles.push_back(graph_.twin(h) / 3);
    return path;
  }

 private:
  void set_ends() {
    const bool closed = graph_.blocked(goal_.triangle);
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t in = graph_.twin(3 * goal_.triangle + k);
      if (in < 0) continue;
      search_.end_at(in, closed ? ShortestPaths::kUnreached
                                : graph_.factor(goal_.triangle) * (graph_.at(in) - to_).norm());
    }
  }

  StripSearch graph_;
  SurfacePoint goal_;
  Point3 to_;
  IncrementalSearch<StripSearch> search_;
  std::optional<Point3> last_;
};
}  // namespace surfleet
