// SPDX-License-Identifier: MIT
/// @file
/// @brief Parts of a graph: what a sieve lets through, and what hangs together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/geometry/graph.hpp>

namespace surfleet {
/// A graph seen through a sieve: only the nodes that `keep(node)` lets through exist.
template <WeightedGraph G, typename Keep>
class Restricted {
 public:
  Restricted(const G& graph, const Keep& keep) : graph_(&graph), keep_(&keep) {}
  std::size_t size() const { return graph_->size(); }

  using Inner = decltype(std::declval<const G&>().arcs(0).begin());
  struct Iterator {
    Inner at, last;
    const Keep* keep;
    void skip() {
      while (at != last && !(*keep)(at->to)) ++at;
    }
    decltype(auto) operator*() const { return *at; }
    auto operator->() const { return &*at; }
    Iterator& operator++() {
      ++at;
      skip();
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at != other.at; }
  };
  struct Range {
    Iterator first, last;
    Iterator begin() const { return first; }
    Iterator end() const { return last; }
  };
  Range arcs(std::int32_t node) const {
    const auto all = graph_->arcs(node);
    Range range{{all.begin(), all.end(), keep_}, {all.end(), all.end(), keep_}};
    range.first.skip();
    return range;
  }

 private:
  const G* graph_;
  const Keep* keep_;
};

/// Lets every node through.
struct KeepAll {
  bool operator()(std::int32_t) const { return true; }
};
/// Lets the marked nodes through; all of them where the marks are empty.
struct KeepMarked {
  const std::vector<std::uint8_t>* marks;
  bool operator()(std::int32_t v) const {
    return marks->empty() || (*marks)[static_cast<std::size_t>(v)] != 0;
  }
};

/// A name from 0 for every connected component among the kept sites, −1 elsewhere. Names follow
/// the lowest site. O(n + m).
template <typename Keep = KeepAll>
std::vector<std::int32_t> connected_components(const Graph& links, const Keep& keep = {}) {
  std::vector<std::int32_t> name(links.size(), -1), stack;
  std::int32_t next = 0;
  for (std::size_t s = 0; s < links.size(); ++s) {
    const auto site = static_cast<std::int32_t>(s);
    if (name[s] >= 0 || !keep(site)) continue;
    name[s] = next;
    stack.push_back(site);
    while (!stack.empty()) {
      const std::int32_t v = stack.back();
      stack.pop_back();
      for (const Arc& arc : links.arcs(v)) {
        const auto j = static_cast<std::size_t>(arc.to);
        if (name[j] >= 0 || !keep(arc.to)) continue;
        name[j] = next;
        stack.push_back(arc.to);
      }
    }
    ++next;
  }
  return name;
}
}  // namespace surfleet
