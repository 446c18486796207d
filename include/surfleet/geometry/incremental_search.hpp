// SPDX-License-Identifier: MIT
/// @file
/// @brief Shortest paths to one goal that are repaired when arcs change and the start moves: D*
/// Lite (Koenig and Likhachev 2002), as [004 §7.2.4] asks for.
///
///     IncrementalSearch search(graph, goals);
///     auto d = search.distance(starts, heuristic, 0.0);
///     search.changed(node);                             // arcs out of it are others now
///     d = search.distance(moved, heuristic_from_there, distance_moved);
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/assert.hpp>
#include <surfleet/geometry/graph.hpp>

namespace surfleet {
/// A graph that knows for a node the arcs that lead to it, too: `to` is then where they come from.
template <typename G>
concept ReversibleGraph = WeightedGraph<G> && requires(const G& g, std::int32_t node) {
  { g.arcs_into(node).begin()->to } -> std::convertible_to<std::int32_t>;
  { g.arcs_into(node).begin()->length } -> std::convertible_to<double>;
};

/// Distances to the goals, kept from one question to the next; only what a change concerns is
/// searched anew. `shortest_paths` is faster for a single question.
///
/// The graph must outlive it. An arc that is closed may be left out or be infinitely long; either
/// way its tail is `changed`. O((n + m) log n) for the first question and, at worst, for each.
template <ReversibleGraph G>
class IncrementalSearch {
 public:
  static constexpr double kFar = ShortestPaths::kUnreached;

  /// `goals`: nodes, and what is left to go from them.
  IncrementalSearch(const G& graph, std::span<const Source> goals)
      : graph_(&graph),
        known_(graph.size(), kFar),
        ahead_(graph.size(), kFar),
        at_end_(graph.size(), kFar),
        place_(graph.size(), -1),
        key_(graph.size()) {
    for (const auto& [node, left] : goals) end_at(node, left);
  }

  /// What is left to go from a node if it ends there; infinite if it may not.
  void end_at(std::int32_t node, double left) {
    at_end_[index(node)] = left;
    pending_.push_back(node);
  }
  /// Arcs out of this node are others now.
  void changed(std::int32_t node) { pending_.push_back(node); }

  /// The least distance from any of the starts, given with the length to reach them, to a goal;
  /// infinite where there is none. `heuristic(node)` is at most the distance from the place of the
  /// robot to the node, and consistent; `moved` at least by how much it changed at any node since
  /// the last question.
  template <typename Heuristic>
  double distance(std::span<const Source> starts, const Heuristic& heuristic, double moved) {
    offset_ += moved;
    for (const std::int32_t node : pending_) review(node, heuristic);
    pending_.clear();
    expanded_ = 0;
    for (;;) {
      double best = kFar;
      for (const auto& [node, length] : starts) best = std::min(best, length + known_[index(node)]);
      // What rounding lets seem equal is examined, too.
      if (heap_.empty() || key_[index(heap_[0])].first > offset_ + best * (1.0 + 1e-12))
        return best;
      const std::int32_t node = heap_[0];
      const auto i = index(node);
      const Key now = key(node, heuristic);
      if (key_[i] < now) {  // entered before the robot moved
        key_[i] = now;
        sift_down(0);
        continue;
      }
      ++expanded_;
      if (known_[i] > ahead_[i]) {
        known_[i] = ahead_[i];
        remove(node);
        for (const auto& arc : graph_->arcs_into(node)) {
          const auto t = index(arc.to);
          const double through = arc.length + known_[i];
          if (!(through < ahead_[t])) continue;
          ahead_[t] = through;
          place(arc.to, heuristic);
        }
      } else {
        known_[i] = kFar;
        review(node, heuristic);
        for (const auto& arc : graph_->arcs_into(node)) review(arc.to, heuristic);
      }
    }
  }

  /// The nodes of a shortest path from `start`, itself included, after `distance` with it among the
  /// starts; empty where none leads to a goal.
  std::vector<std::int32_t> path(std::int32_t start) const {
    std::vector<std::int32_t> nodes;
    if (!(known_[index(start)] < kFar)) return nodes;
    for (std::int32_t node = start; nodes.size() <= graph_->size();) {
      nodes.push_back(node);
      double best = at_end_[index(node)];
      std::int32_t next = -1;
      for (const auto& arc : graph_->arcs(node))
        if (arc.length + known_[index(arc.to)] < best) {
          best = arc.length + known_[index(arc.to)];
          next = arc.to;
        }
      if (next < 0) return best < kFar ? nodes : std::vector<std::int32_t>{};
      node = next;
    }
    SURFLEET_ASSERT(false, "a path of an incremental search goes in a circle");
    return {};
  }
  /// To a goal, as far as it was settled.
  double known(std::int32_t node) const { return known_[index(node)]; }
  /// Nodes settled or unsettled by the last question.
  std::size_t expanded() const { return expanded_; }

 private:
  using Key = std::pair<double, double>;
  static std::size_t index(std::int32_t node) { return static_cast<std::size_t>(node); }

  template <typename Heuristic>
  Key key(std::int32_t node, const Heuristic& heuristic) const {
    const double least = std::min(known_[index(node)], ahead_[index(node)]);
    return {least + heuristic(node) + offset_, least};
  }
  /// Looks one arc ahead again.
  template <typename Heuristic>
  void review(std::int32_t node, const Heuristic& heuristic) {
    double best = at_end_[index(node)];
    for (const auto& arc : graph_->arcs(node))
      best = std::min(best, arc.length + known_[index(arc.to)]);
    ahead_[index(node)] = best;
    place(node, heuristic);
  }
  /// Puts a node where it belongs in the queue, or out of it.
  template <typename Heuristic>
  void place(std::int32_t node, const Heuristic& heuristic) {
    const auto i = index(node);
    if (known_[i] == ahead_[i]) {
      remove(node);
      return;
    }
    key_[i] = key(node, heuristic);
    if (place_[i] < 0) {
      place_[i] = static_cast<std::int32_t>(heap_.size());
      heap_.push_back(node);
    }
    sift_up(index(place_[i]));
    sift_down(index(place_[i]));
  }
  bool before(std::int32_t a, std::int32_t b) const {
    return key_[index(a)] != key_[index(b)] ? key_[index(a)] < key_[index(b)] : a < b;
  }
  void put(std::size_t at, std::int32_t node) {
    heap_[at] = node;
    place_[index(node)] = static_cast<std::int32_t>(at);
  }
  void sift_up(std::size_t at) {
    const std::int32_t node = heap_[at];
    for (; at > 0 && before(node, heap_[(at - 1) / 2]); at = (at - 1) / 2)
      put(at, heap_[(at - 1) / 2]);
    put(at, node);
  }
  void sift_down(std::size_t at) {
    const std::int32_t node = heap_[at];
    for (;;) {
      std::size_t child = 2 * at + 1;
      if (child >= heap_.size()) break;
      if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
      if (!before(heap_[child], node)) break;
      put(at, heap_[child]);
      at = child;
    }
    put(at, node);
  }
  void remove(std::int32_t node) {
    const std::int32_t at = place_[index(node)];
    if (at < 0) return;
    place_[index(node)] = -1;
    const std::int32_t last = heap_.back();
    heap_.pop_back();
    if (last == node) return;
    put(index(at), last);
    sift_up(index(at));
    sift_down(index(place_[index(last)]));
  }

  const G* graph_;
  std::vector<double> known_, ahead_;  // g and rhs
  std::vector<double> at_end_;
  std::vector<std::int32_t> heap_, place_;
  std::vector<Key> key_;
  std::vector<std::int32_t> pending_;
  double offset_ = 0.0;  // k_m: keys made before the robot moved are too small by no more
  std::size_t expanded_ = 0;
};
}  // namespace surfleet
