// SPDX-License-Identifier: MIT
/// @file
/// @brief A maximum matching of any graph: Edmonds' blossoms (1965).
///
///     const std::vector<std::int32_t> mate = maximum_matching(graph);   // -1: alone
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/geometry/graph.hpp>

namespace surfleet {
namespace detail {
/// Augmenting paths by breadth-first search from one exposed node at a time; odd circles that are
/// met are shrunk to their base. Only what a search touched is cleaned up after it.
template <WeightedGraph G>
class BlossomMatching {
 public:
  explicit BlossomMatching(const G& graph)
      : graph_(graph),
        n_(graph.size()),
        mate(n_, -1),
        parent_(n_, -1),
        base_(n_),
        even_(n_, 0),
        in_blossom_(n_, 0),
        mark_(n_, 0) {
    for (std::size_t i = 0; i < n_; ++i) base_[i] = static_cast<std::int32_t>(i);
    greedy();
    for (std::size_t i = 0; i < n_; ++i)
      if (mate[i] < 0) augment(static_cast<std::int32_t>(i));
  }

 private:
  const G& graph_;
  std::size_t n_;

 public:
  std::vector<std::int32_t> mate;

 private:
  static std::size_t index(std::int32_t v) { return static_cast<std::size_t>(v); }
  std::int32_t& mate_of(std::int32_t v) { return mate[index(v)]; }

  /// Nodes with the fewest free neighbours first: little is left over.
  void greedy() {
    const auto free_neighbours = [&](std::int32_t v) {
      std::size_t count = 0;
      for (const auto& arc : graph_.arcs(v)) count += arc.to != v && mate_of(arc.to) < 0 ? 1U : 0U;
      return count;
    };
    std::vector<std::vector<std::int32_t>> waiting(4);
    for (std::size_t i = n_; i-- > 0;) {
      const auto v = static_cast<std::int32_t>(i);
      waiting[std::min<std::size_t>(free_neighbours(v), 3)].push_back(v);
    }
    for (std::size_t level = 0; level < waiting.size();) {
      if (waiting[level].empty()) {
        ++level;
        continue;
      }
      const std::int32_t v = waiting[level].back();
      waiting[level].pop_back();
      if (mate_of(v) >= 0) continue;
      const std::size_t now = std::min<std::size_t>(free_neighbours(v), 3);
      if (now == 0) continue;
      if (now > level) {
        waiting[now].push_back(v);
        continue;
      }
      std::int32_t best = -1;
      std::size_t fewest = 0;
      for (const auto& arc : graph_.arcs(v)) {
        if (arc.to == v || mate_of(arc.to) >= 0) continue;
        const std::size_t count = free_neighbours(arc.to);
        if (best < 0 || count < fewest || (count == fewest && arc.to < best)) {
          best = arc.to;
          fewest = count;
        }
      }
      mate_of(v) = best;
      mate_of(best) = v;
      for (const std::int32_t end : {v, best})
        for (const auto& arc : graph_.arcs(end))
          if (mate_of(arc.to) < 0) {
            const std::size_t count = std::min<std::size_t>(free_neighbours(arc.to), 3);
            waiting[count].push_back(arc.to);
            level = std::min(level, count);
          }
    }
  }

  void touch(std::int32_t v) {
    if (mark_[index(v)] == 0) {
      mark_[index(v)] = 1;
      touched_.push_back(v);
    }
  }
  /// The base where the trees' branches to a and b meet.
  std::int32_t meeting(std::int32_t a, std::int32_t b) {
    on_branch_.clear();
    for (std::int32_t v = base_[index(a)];; v = base_[index(parent_[index(mate_of(v))])]) {
      on_branch_.push_back(v);
      if (mate_of(v) < 0) break;
    }
    std::sort(on_branch_.begin(), on_branch_.end());
    for (std::int32_t v = base_[index(b)];; v = base_[index(parent_[index(mate_of(v))])])
      if (std::binary_search(on_branch_.begin(), on_branch_.end(), v)) return v;
  }
  void mark_branch(std::int32_t v, std::int32_t base, std::int32_t child) {
    while (base_[index(v)] != base) {
      in_blossom_[index(base_[index(v)])] = in_blossom_[index(base_[index(mate_of(v))])] = 1;
      parent_[index(v)] = child;
      child = mate_of(v);
      v = parent_[index(child)];
    }
  }
  void augment(std::int32_t root) {
    for (const std::int32_t v : touched_) {
      parent_[index(v)] = -1;
      base_[index(v)] = v;
      even_[index(v)] = mark_[index(v)] = 0;
    }
    touched_.clear();
    queue_.assign(1, root);
    even_[index(root)] = 1;
    touch(root);
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      const std::int32_t v = queue_[head];
      for (const auto& arc : graph_.arcs(v)) {
        const std::int32_t to = arc.to;
        if (base_[index(v)] == base_[index(to)] || mate_of(v) == to) continue;
        touch(to);
        if (to == root || (mate_of(to) >= 0 && parent_[index(mate_of(to))] >= 0)) {
          const std::int32_t base = meeting(v, to);
          mark_branch(v, base, to);
          mark_branch(to, base, v);
          for (std::size_t k = 0; k < touched_.size(); ++k) {
            const std::int32_t i = touched_[k];
            if (in_blossom_[index(base_[index(i)])] == 0) continue;
            shrunk_.push_back(i);
          }
          for (const std::int32_t i : shrunk_) in_blossom_[index(base_[index(i)])] = 0;
          for (const std::int32_t i : shrunk_) {
            base_[index(i)] = base;
            if (even_[index(i)] == 0) {
              even_[index(i)] = 1;
              queue_.push_back(i);
            }
          }
          shrunk_.clear();
        } else if (parent_[index(to)] < 0) {
          parent_[index(to)] = v;
          if (mate_of(to) < 0) {  // turned over, from here back to the root
            for (std::int32_t u = to; u >= 0;) {
              const std::int32_t p = parent_[index(u)], next = mate_of(p);
              mate_of(u) = p;
              mate_of(p) = u;
              u = next;
            }
            return;
          }
          even_[index(mate_of(to))] = 1;
          touch(mate_of(to));
          queue_.push_back(mate_of(to));
        }
      }
    }
  }

  std::vector<std::int32_t> parent_, base_;
  std::vector<std::uint8_t> even_, in_blossom_, mark_;
  std::vector<std::int32_t> touched_, queue_, on_branch_, shrunk_;
};
}  // namespace detail

/// For every node its partner, or −1; as many pairs as there can be. The graph has every arc both
/// ways; lengths do not matter, nor do arcs from a node to itself. Always the same of the matchings
/// there are. O(n m) at worst, near O(n) on duals of meshes.
template <WeightedGraph G>
std::vector<std::int32_t> maximum_matching(const G& graph) {
  return detail::BlossomMatching<G>(graph).mate;
}
}  // namespace surfleet
