// SPDX-License-Identifier: MIT
/// @file  A weighted directed graph in compressed rows, and the library's one shortest-path routine.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/assert.hpp>

namespace surfleet {
/// An arc of a graph: its head and its non-negative length.
struct Arc {
  std::int32_t to = 0;
  double length = 0.0;
};

/// What the shortest-path routine asks of a graph: the number of nodes, and for a node a range of
/// things with `to` and `length`. A graph may make its arcs as they are asked for.
template <typename G>
concept WeightedGraph = requires(const G& g, std::int32_t node) {
  { g.size() } -> std::convertible_to<std::size_t>;
  { g.arcs(node).begin()->to } -> std::convertible_to<std::int32_t>;
  { g.arcs(node).begin()->length } -> std::convertible_to<double>;
};

/// A graph whose arcs lie in one array, node after node.
class Graph {
 public:
  Graph() : first_(1, 0) {}
  /// From a list of (tail, arc); parallel arcs are kept. O(n + m).
  Graph(std::size_t nodes, std::span<const std::pair<std::int32_t, Arc>> list)
      : first_(nodes + 1, 0), arcs_(list.size()) {
    for (const auto& [tail, arc] : list) ++first_[static_cast<std::size_t>(tail) + 1];
    for (std::size_t i = 0; i < nodes; ++i) first_[i + 1] += first_[i];
    std::vector<std::size_t> at(first_.begin(), first_.end() - 1);
    for (const auto& [tail, arc] : list) arcs_[at[static_cast<std::size_t>(tail)]++] = arc;
  }
  std::size_t size() const { return first_.size() - 1; }
  std::span<const Arc> arcs(std::int32_t node) const {
    const auto i = static_cast<std::size_t>(node);
    return std::span<const Arc>(arcs_).subspan(first_[i], first_[i + 1] - first_[i]);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<Arc> arcs_;
};

/// Distances and predecessors from one or many sources.
struct ShortestPaths {
  static constexpr double kUnreached = std::numeric_limits<double>::infinity();
  std::vector<double> distance;        ///< From the nearest source; `kUnreached` if there is none.
  std::vector<std::int32_t> previous;  ///< On the path from the source; −1 at a source.

  bool reached(std::int32_t node) const {
    return distance[static_cast<std::size_t>(node)] < kUnreached;
  }
  /// From the source to `node`, both included; empty if it was not reached.
  std::vector<std::int32_t> path(std::int32_t node) const {
    std::vector<std::int32_t> p;
    if (!reached(node)) return p;
    for (std::int32_t v = node; v >= 0; v = previous[static_cast<std::size_t>(v)]) p.push_back(v);
    std::reverse(p.begin(), p.end());
    return p;
  }
};

/// A source and the distance it starts with.
using Source = std::pair<std::int32_t, double>;

struct NoHeuristic {
  double operator()(std::int32_t) const { return 0.0; }
};
struct NeverStop {
  bool operator()(std::int32_t, double) const { return false; }
};

/// Dijkstra's algorithm; A* when a heuristic is given [000 §1.4.1].
///
/// `heuristic(node)` must not overestimate and must be consistent. `stop(node, distance)` is asked
/// once for every node when its distance is final; true ends the search. Ties go to the lower
/// node. O((n + m) log n).
template <WeightedGraph G, typename Heuristic = NoHeuristic, typename Stop = NeverStop>
ShortestPaths shortest_paths(const G& graph, std::span<const Source> sources,
                             const Heuristic& heuristic = {}, const Stop& stop = {}) {
  const std::size_t n = graph.size();
  ShortestPaths result{std::vector<double>(n, ShortestPaths::kUnreached),
                       std::vector<std::int32_t>(n, -1)};
  using Entry = std::pair<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::vector<bool> closed(n, false);
  for (const auto& [node, start] : sources) {
    const auto i = static_cast<std::size_t>(node);
    if (start < result.distance[i]) {
      result.distance[i] = start;
      open.push({start + heuristic(node), node});
    }
  }
  while (!open.empty()) {
    const std::int32_t node = open.top().second;
    open.pop();
    const auto i = static_cast<std::size_t>(node);
    if (closed[i]) continue;
    closed[i] = true;
    const double distance = result.distance[i];
    if (stop(node, distance)) break;
    for (const auto& arc : graph.arcs(node)) {
      const auto j = static_cast<std::size_t>(arc.to);
      const double through = distance + arc.length;
      if (!closed[j] && through < result.distance[j]) {
        result.distance[j] = through;
        result.previous[j] = node;
        open.push({through + heuristic(arc.to), arc.to});
      }
    }
  }
  return result;
}
template <WeightedGraph G>
ShortestPaths shortest_paths(const G& graph, std::int32_t source) {
  const Source s{source, 0.0};
  return shortest_paths(graph, std::span<const Source>(&s, 1));
}
}  // namespace surfleet
