// SPDX-License-Identifier: MIT
#include <surfleet/allocation/assignment.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double brute_force(const CostMatrix& c, bool forbid_diagonal) {
  std::vector<int> p(c.size());
  std::iota(p.begin(), p.end(), 0);
  double best = kInfinity;
  do {
    double sum = 0.0;
    for (int i = 0; i < c.size(); ++i) sum += forbid_diagonal && p[i] == i ? kInfinity : c(i, p[i]);
    best = std::min(best, sum);
  } while (std::next_permutation(p.begin(), p.end()));
  return best;
}
void laws(const CostMatrix& c, bool forbid_diagonal) {
  const Assignment a = solve_assignment(c, forbid_diagonal);
  CHECK_NEAR(a.cost, brute_force(c, forbid_diagonal), 1e-9);
  std::vector<int> columns = a.column_of_row;
  std::sort(columns.begin(), columns.end());
  double dual = 0.0;
  for (int i = 0; i < c.size(); ++i) {
    CHECK(columns[i] == i);
    dual += a.row_price[i] + a.column_price[i];
    for (int j = 0; j < c.size(); ++j)
      if (!(forbid_diagonal && i == j)) CHECK(a.row_price[i] + a.column_price[j] <= c(i, j) + 1e-9);
  }
  CHECK_NEAR(dual, a.cost, 1e-9);
}
}  // namespace

TEST(assignment_is_optimal_and_its_prices_prove_it) {
  Random random(3);
  for (int trial = 0; trial < 120; ++trial) {
    const int n = 2 + trial % 6;
    CostMatrix c(n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        c(i, j) = trial % 2 == 0 ? static_cast<double>(random.below(5)) - 2.0 : random.normal();
    laws(c, trial % 3 == 0);
  }
}

TEST(assignment_avoids_forbidden_pairs) {
  Random random(4);
  for (int trial = 0; trial < 60; ++trial) {
    CostMatrix c(5);
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) c(i, j) = random.uniform() < 0.3 ? kInfinity : random.uniform();
    if (brute_force(c, false) < kInfinity)
      laws(c, false);
    else
      CHECK_THROWS(Error, solve_assignment(c));
  }
}

TEST(assignment_of_degenerate_sizes) {
  CHECK(solve_assignment(CostMatrix()).cost == 0.0);
  CHECK(solve_assignment(CostMatrix(1, 4.0)).cost == 4.0);
  CHECK_THROWS(Error, solve_assignment(CostMatrix(1, 4.0), true));
  CostMatrix bad(3, 1.0);
  bad(1, 2) = std::nan("");
  CHECK_THROWS(Error, solve_assignment(bad));
  CHECK_THROWS(Error, CostMatrix(-1));
}
