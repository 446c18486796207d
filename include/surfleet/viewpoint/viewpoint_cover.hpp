// SPDX-License-Identifier: MIT
/// @file
/// @brief Few viewpoints that see what many were made for.
///
///     const auto few = cover_viewpoints(views, seen_from_all(gain, views));
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>

namespace surfleet {
/// A set chosen for a cover, and how many of its elements no earlier choice has.
struct CoverChoice {
  std::size_t set = 0, adds = 0;
};

/// Greedy set cover, at most so many: time after time the set with most elements that none chosen
/// before has, ties to the lower one, until nothing is added; so all of them are at most
/// 1 + ln(most elements in a set) times as many as needed. Each set's elements are distinct and
/// from 0 on. O(Σ|set| · log sets) as a rule.
inline std::vector<CoverChoice> cover_greedily(
    std::span<const std::vector<std::int32_t>> sets,
    std::size_t most = std::numeric_limits<std::size_t>::max()) {
  std::int32_t last = -1;
  for (const auto& set : sets)
    for (const std::int32_t e : set) last = std::max(last, e);
  std::vector<char> covered(static_cast<std::size_t>(last + 1), 0);
  // Lazy: what a set adds only shrinks, so an old count bounds the new one.
  using Entry = std::pair<std::size_t, std::ptrdiff_t>;
  std::priority_queue<Entry> queue;
  for (std::size_t i = 0; i < sets.size(); ++i)
    queue.emplace(sets[i].size(), -static_cast<std::ptrdiff_t>(i));
  std::vector<CoverChoice> chosen;
  while (!queue.empty() && chosen.size() < most) {
    const auto [bound, negative] = queue.top();
    queue.pop();
    const auto i = static_cast<std::size_t>(-negative);
    const auto adds =
        static_cast<std::size_t>(std::count_if(sets[i].begin(), sets[i].end(), [&](std::int32_t e) {
          return covered[static_cast<std::size_t>(e)] == 0;
        }));
    if (adds == 0) continue;
    if (adds < bound) {
      queue.emplace(adds, negative);
      continue;
    }
    chosen.push_back({i, adds});
    for (const std::int32_t e : sets[i]) covered[static_cast<std::size_t>(e)] = 1;
  }
  return chosen;
}

/// A subset of the views that together show everything all of them show.
///
/// `seen[i]` are the elements that view i shows, ascending; what a view was made for counts as seen
/// in any case. They are covered greedily (`cover_greedily`), then those that the later ones made
/// useless are dropped. Every element is a target of one of the views returned, which keep their
/// order. O(Σ|seen| · log views). Throws `Error` unless there is one list a view.
inline std::vector<Viewpoint> cover_viewpoints(std::span<const Viewpoint> views,
                                               std::vector<std::vector<std::int32_t>> seen) {
  require(seen.size() == views.size(), "viewpoint cover: expected one list of elements a view");
  std::int32_t last = -1;
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::vector<std::int32_t>& own = seen[i];
    own.insert(own.end(), views[i].targets.begin(), views[i].targets.end());
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    if (!own.empty()) {
      require(own.front() >= 0, "viewpoint cover: expected elements numbered from 0");
      last = std::max(last, own.back());
    }
  }
  std::vector<int> shown_by(static_cast<std::size_t>(last + 1), 0);
  const auto times = [&](std::int32_t e) -> int& { return shown_by[static_cast<std::size_t>(e)]; };

  std::vector<std::size_t> chosen;
  for (const CoverChoice& choice : cover_greedily(seen)) {
    chosen.push_back(choice.set);
    for (const std::int32_t e : seen[choice.set]) ++times(e);
  }
  // The first choices are the broadest, but later ones may have overlapped one altogether.
  std::vector<std::size_t> kept;
  for (auto it = chosen.rbegin(); it != chosen.rend(); ++it) {
    const bool needed = std::any_of(seen[*it].begin(), seen[*it].end(),
                                    [&](std::int32_t e) { return times(e) == 1; });
    if (needed) {
      kept.push_back(*it);
    } else {
      for (const std::int32_t e : seen[*it]) --times(e);
    }
  }
  std::sort(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) {
    return seen[a].size() != seen[b].size() ? seen[a].size() > seen[b].size() : a < b;
  });
  // The broader view takes what both show, and the narrower one what is its own.
  std::vector<char> taken(shown_by.size(), 0);
  std::vector<std::pair<std::size_t, Viewpoint>> result;
  for (const std::size_t i : kept) {
    Viewpoint view = views[i];
    view.targets.clear();
    for (const std::int32_t e : seen[i])
      if (std::exchange(taken[static_cast<std::size_t>(e)], 1) == 0) view.targets.push_back(e);
    result.emplace_back(i, std::move(view));
  }
  std::sort(result.begin(), result.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Viewpoint> few;
  for (auto& [i, view] : result) few.push_back(std::move(view));
  return few;
}
}  // namespace surfleet
