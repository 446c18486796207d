// SPDX-License-Identifier: MIT
/// @file
/// @brief The linear assignment problem with its dual prices: the relaxation that bounds a tour.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/allocation/cost_matrix.hpp>

namespace surfleet {
/// An optimal assignment of rows to columns. For all arcs c(i, j) ≥ row_price[i] +
/// column_price[j], with equality on the chosen ones, up to rounding.
struct Assignment {
  std::vector<int> column_of_row;
  std::vector<double> row_price, column_price;
  double cost = 0.0;
};

/// The cheapest assignment, by shortest augmenting paths [Jonker & Volgenant 1987]. Infinite
/// entries are forbidden pairs; with `forbid_diagonal` so is every (i, i), and the optimum is a
/// lower bound on any closed tour. O(n³). Throws `Error` if every assignment is forbidden or an
/// entry is NaN or −∞.
inline Assignment solve_assignment(const CostMatrix& costs, bool forbid_diagonal = false) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const int n = costs.size();
  Assignment result;
  result.column_of_row.assign(n, -1);
  result.row_price.assign(n, 0.0);
  result.column_price.assign(n, 0.0);
  auto& u = result.row_price;
  auto& v = result.column_price;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      require(costs(i, j) > -kInfinity,
              "assignment: a cost is NaN or -infinity; expected numbers "
              "or +infinity for a forbidden pair");
  const auto cost = [&](int i, int j) {
    return forbid_diagonal && i == j ? kInfinity : costs.row(i)[j];
  };
  // Column reduction and a first greedy matching leave few rows to augment.
  std::vector<int> row_of_column(n, -1);
  for (int j = 0; j < n; ++j) {
    double least = kInfinity;
    int best = -1;
    for (int i = 0; i < n; ++i)
      if (cost(i, j) < least) least = cost(i, j), best = i;
    require(best >= 0, "assignment: column " + std::to_string(j) + " has no permitted row");
    v[j] = least;
    if (result.column_of_row[best] < 0) result.column_of_row[best] = j, row_of_column[j] = best;
  }
  std::vector<double> distance(n);
  std::vector<int> previous(n);
  std::vector<char> done(n);
  for (int free_row = 0; free_row < n; ++free_row) {
    if (result.column_of_row[free_row] >= 0) continue;
    // Dijkstra over columns by reduced cost from the free row to a free column.
    for (int j = 0; j < n; ++j) {
      distance[j] = cost(free_row, j) - u[free_row] - v[j];
      previous[j] = free_row;
      done[j] = 0;
    }
    int sink = -1;
    double reach = 0.0;
    while (sink < 0) {
      int next = -1;
      for (int j = 0; j < n; ++j)
        if (!done[j] && (next < 0 || distance[j] < distance[next])) next = j;
      require(next >= 0 && distance[next] < kInfinity,
              "assignment: every assignment uses a forbidden pair");
      done[next] = 1;
      reach = distance[next];
      if (row_of_column[next] < 0) {
        sink = next;
        break;
      }
      const int i = row_of_column[next];
      const double base = reach - u[i];
      for (int j = 0; j < n; ++j) {
        if (done[j]) continue;
        const double through = base + cost(i, j) - v[j];
        if (through < distance[j]) distance[j] = through, previous[j] = i;
      }
    }
    for (int j = 0; j < n; ++j) {
      if (!done[j] || j == sink) continue;
      const double slack = reach - distance[j];
      v[j] -= slack;
      u[row_of_column[j]] += slack;
    }
    u[free_row] += reach;
    for (int j = sink;;) {
      const int i = previous[j];
      row_of_column[j] = i;
      std::swap(j, result.column_of_row[i]);
      if (i == free_row) break;
    }
  }
  for (int i = 0; i < n; ++i) result.cost += cost(i, result.column_of_row[i]);
  return result;
}
}  // namespace surfleet
