// SPDX-License-Identifier: MIT
/// @file
/// @brief The arcs that good tours are made of, by reduced cost, and the prices they follow from.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/allocation/assignment.hpp>
#include <surfleet/allocation/cost_matrix.hpp>
#include <surfleet/allocation/three_opt.hpp>

namespace surfleet::detail {
/// For each node the arcs out of it that good tours are made of, cheapest first.
class CandidateArcs {
 public:
  CandidateArcs(const CostMatrix& costs, const Assignment& dual, int by_price, int by_cost) {
    const int n = costs.size();
    std::vector<char> chosen(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0);
    std::vector<std::pair<double, int>> keys;
    const auto choose = [&](int node, int count, auto&& key, bool into) {
      keys.clear();
      for (int j = 0; j < n; ++j)
        if (j != node) keys.emplace_back(key(j), j);
      if (count < static_cast<int>(keys.size()))
        std::nth_element(keys.begin(), keys.begin() + count, keys.end());
      for (int k = 0; k < std::min(count, static_cast<int>(keys.size())); ++k) {
        const int j = keys[k].second;
        chosen[static_cast<std::size_t>(into ? j : node) * static_cast<std::size_t>(n) +
               static_cast<std::size_t>(into ? node : j)] = 1;
      }
    };
    for (int i = 0; i < n; ++i) {
      choose(
          i, by_price, [&](int j) { return costs(i, j) - dual.column_price[j]; }, false);
      choose(
          i, by_cost, [&](int j) { return costs(i, j); }, false);
      choose(
          i, (by_price + 1) / 2, [&](int j) { return costs(j, i) - dual.row_price[j]; }, true);
    }
    first_.reserve(static_cast<std::size_t>(n) + 1);
    first_.push_back(0);
    for (int i = 0; i < n; ++i) {
      keys.clear();
      const char* row = chosen.data() + static_cast<std::size_t>(i) * static_cast<std::size_t>(n);
      for (int j = 0; j < n; ++j)
        if (row[j] != 0) keys.emplace_back(costs(i, j), j);
      std::sort(keys.begin(), keys.end());
      for (const auto& [cost, j] : keys) arcs_.push_back({j, cost});
      first_.push_back(static_cast<int>(arcs_.size()));
    }
  }
  struct Candidate {
    int to;
    double cost;
  };
  std::span<const Candidate> operator[](int node) const {
    return std::span<const Candidate>(arcs_).subspan(first_[node], first_[node + 1] - first_[node]);
  }

 private:
  std::vector<int> first_;
  std::vector<Candidate> arcs_;
};

/// A greedy tour along arcs of small reduced cost.
inline std::vector<int> priced_neighbour_cycle(const CostMatrix& costs, const Assignment& dual,
                                               int first) {
  const int n = costs.size();
  CostMatrix reduced(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      reduced(i, j) = costs(i, j) - dual.row_price[i] - dual.column_price[j];
  return nearest_neighbour_cycle(reduced, first);
}

/// Feasible prices of the assignment relaxation by row and column minima: a weaker bound.
inline Assignment reduced_prices(const CostMatrix& costs) {
  const int n = costs.size();
  Assignment dual;
  dual.row_price.assign(n, std::numeric_limits<double>::infinity());
  dual.column_price.assign(n, std::numeric_limits<double>::infinity());
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j) dual.row_price[i] = std::min(dual.row_price[i], costs(i, j));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j)
        dual.column_price[j] = std::min(dual.column_price[j], costs(i, j) - dual.row_price[i]);
  for (int i = 0; i < n; ++i) dual.cost += dual.row_price[i] + dual.column_price[i];
  return dual;
}
}  // namespace surfleet::detail
