// SPDX-License-Identifier: MIT
/// @file
/// @brief A weighted directed graph in compressed rows, and the library's one shortest-path
/// routine.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
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

namespace detail {
/// A monotone priority queue of (key, node): buckets of equal width ahead, a small heap at hand.
///
/// Keys come out in order, equal keys by node. The width decides how fast, never what comes out:
/// far too wide it is a heap, far too narrow it skips empty buckets. A key below the last one
/// taken (rounding of a heuristic) comes out next.
class BucketQueue {
 public:
  explicit BucketQueue(double width)
      : inverse_width_(width > 0.0 && width < ShortestPaths::kUnreached ? 1.0 / width : 0.0) {
    heads_.fill(-1);
  }
  void push(double key, std::int32_t node) {
    const double slot = (key - base_) * inverse_width_;
    if (slot < heap_end_) {
      heap_.push_back({key, node});
      std::push_heap(heap_.begin(), heap_.end(), std::greater<>{});
    } else if (slot < window_end_) {
      put(static_cast<std::size_t>(slot), key, node);
    } else {
      beyond_.push_back({key, node});
    }
  }
  /// Takes the least entry; false if there is none.
  bool pop(std::int32_t& node) {
    while (heap_.empty())
      if (!refill()) return false;
    node = heap_.front().second;
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>{});
    heap_.pop_back();
    return true;
  }

 private:
  using Entry = std::pair<double, std::int32_t>;
  struct Linked {
    double key;
    std::int32_t node, next;
  };
  static constexpr std::size_t kBuckets = 256;

  void put(std::size_t bucket, double key, std::int32_t node) {
    pool_.push_back({key, node, heads_[bucket]});
    heads_[bucket] = static_cast<std::int32_t>(pool_.size()) - 1;
  }
  bool refill() {
    while (cursor_ < kBuckets && heads_[cursor_] < 0) ++cursor_;
    if (cursor_ < kBuckets) {
      for (std::int32_t e = heads_[cursor_]; e >= 0; e = pool_[static_cast<std::size_t>(e)].next)
        heap_.push_back(
            {pool_[static_cast<std::size_t>(e)].key, pool_[static_cast<std::size_t>(e)].node});
      std::make_heap(heap_.begin(), heap_.end(), std::greater<>{});
      heads_[cursor_++] = -1;
      heap_end_ = static_cast<double>(cursor_);
      return true;
    }
    if (beyond_.empty()) return false;
    base_ = std::min_element(beyond_.begin(), beyond_.end())->first;
    cursor_ = 0;
    heap_end_ = 0.0;
    window_end_ = static_cast<double>(kBuckets);
    pool_.clear();
    std::size_t kept = 0;
    for (const Entry& e : beyond_) {
      const double slot = (e.first - base_) * inverse_width_;
      if (slot < window_end_)
        put(static_cast<std::size_t>(slot), e.first, e.second);
      else
        beyond_[kept++] = e;
    }
    beyond_.resize(kept);
    return true;
  }

  double inverse_width_, base_ = 0.0;
  double heap_end_ = -ShortestPaths::kUnreached, window_end_ = -ShortestPaths::kUnreached;
  std::size_t cursor_ = kBuckets;
  std::array<std::int32_t, kBuckets> heads_;
  std::vector<Linked> pool_;
  std::vector<Entry> heap_, beyond_;
};

/// A bucket width that suits the arcs met at the sources.
template <typename G>
double bucket_width(const G& graph, std::span<const Source> sources) {
  double sum = 0.0;
  int count = 0;
  for (const Source& s : sources) {
    for (const auto& arc : graph.arcs(s.first)) {
      if (!(arc.length < ShortestPaths::kUnreached)) continue;  // an arc that is closed for now
      sum += arc.length;
      ++count;
    }
    if (count >= 16) break;
  }
  return count > 0 ? sum / (16.0 * count) : 0.0;
}
}  // namespace detail

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
/// node. O((n + m) log n), close to O(n + m) where arc lengths are of one scale.
template <WeightedGraph G, typename Heuristic = NoHeuristic, typename Stop = NeverStop>
ShortestPaths shortest_paths(const G& graph, std::span<const Source> sources,
                             const Heuristic& heuristic = {}, const Stop& stop = {}) {
  const std::size_t n = graph.size();
  ShortestPaths result{std::vector<double>(n, ShortestPaths::kUnreached),
                       std::vector<std::int32_t>(n, -1)};
  detail::BucketQueue open(detail::bucket_width(graph, sources));
  std::vector<std::uint8_t> closed(n, 0);
  for (const auto& [node, start] : sources) {
    const auto i = static_cast<std::size_t>(node);
    if (start < result.distance[i]) {
      result.distance[i] = start;
      open.push(start + heuristic(node), node);
    }
  }
  std::int32_t node = -1;
  while (open.pop(node)) {
    const auto i = static_cast<std::size_t>(node);
    if (closed[i] != 0) continue;
    closed[i] = 1;
    const double distance = result.distance[i];
    if (stop(node, distance)) break;
    for (const auto& arc : graph.arcs(node)) {
      const auto j = static_cast<std::size_t>(arc.to);
      const double through = distance + arc.length;
      if (through < result.distance[j] && closed[j] == 0) {
        result.distance[j] = through;
        result.previous[j] = node;
        open.push(through + heuristic(arc.to), arc.to);
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
