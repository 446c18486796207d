// SPDX-License-Identifier: MIT
#include <surfleet/allocation/tour.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <surfleet/allocation/exact_tour.hpp>
#include <surfleet/allocation/hamiltonian_path.hpp>
#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/allocation/three_opt.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
/// The bare minimum of a solver: the nodes as they are numbered.
struct ArchetypeSolver {
  Tour operator()(const TourProblem& p) const {
    const detail::CycleProblem cycle = detail::cycle_problem(p);
    std::vector<int> order(cycle.costs.size());
    std::iota(order.begin(), order.end(), 0);
    return detail::to_tour(p, order, detail::cycle_relaxation(cycle.costs).cost);
  }
};
static_assert(TourSolver<ArchetypeSolver> && !WarmStartedTourSolver<ArchetypeSolver>);
static_assert(!TourSolver<int>);

CostMatrix random_costs(Random& random, int n, int kind) {
  CostMatrix c(n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (kind == 0) c(i, j) = random.normal();
      if (kind == 1) c(i, j) = static_cast<double>(random.below(4));
      if (kind == 2) c(i, j) = j < i ? c(j, i) : random.uniform(1.0, 1e6);
    }
  }
  return c;
}
double brute_force(const TourProblem& p) {
  std::vector<int> order(p.costs.size());
  std::iota(order.begin(), order.end(), 0);
  double best = p.maximize ? -std::numeric_limits<double>::infinity()
                           : std::numeric_limits<double>::infinity();
  do {
    if (!is_tour(p, order)) continue;
    const double length = tour_length(p, order);
    best = p.maximize ? std::max(best, length) : std::min(best, length);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}
/// Every combination of minimising and maximising, open and closed, start fixed and free.
template <typename Body>
void for_all_variants(const CostMatrix& costs, Body&& body) {
  for (int variant = 0; variant < 8; ++variant) {
    TourProblem p{costs, (variant & 1) != 0, (variant & 2) != 0};
    if ((variant & 4) != 0) {
      if (costs.size() == 0) continue;
      p.start = costs.size() / 2;
    }
    body(p);
  }
}
void is_valid(const TourProblem& p, const Tour& t) {
  CHECK(is_tour(p, t.order));
  const double scale = 1e-9 * (1.0 + std::abs(t.length));
  CHECK_NEAR(t.length, tour_length(p, t.order), scale);
  CHECK(p.maximize ? t.bound >= t.length : t.bound <= t.length);
  CHECK(t.gap() >= 0.0);
}
template <TourSolver S>
void solver_laws(const S& solver, bool optimal) {
  Random random(11);
  for (int trial = 0; trial < 24; ++trial) {
    for_all_variants(random_costs(random, trial % 8, trial % 3), [&](const TourProblem& p) {
      const Tour t = solver(p);
      is_valid(p, t);
      const double best = p.costs.size() == 0 ? 0.0 : brute_force(p);
      const double scale = 1e-9 * (1.0 + std::abs(best));
      if (optimal) CHECK_NEAR(t.length, best, scale);
      CHECK(p.maximize ? t.length <= best + scale : t.length >= best - scale);
      CHECK(p.maximize ? t.bound >= best - scale : t.bound <= best + scale);
    });
  }
  TourProblem p{CostMatrix(4, 1.0)};
  p.start = 4;
  CHECK_THROWS(Error, solver(p));
  p.start = -1;
  CHECK_THROWS(Error, solver(p));
  p.start.reset();
  p.costs(1, 2) = std::nan("");
  CHECK_THROWS(Error, solver(p));
  p.costs(1, 2) = std::numeric_limits<double>::infinity();
  CHECK_THROWS(Error, solver(p));
  p.costs(1, 2) = 1.0;
  p.costs(1, 1) = std::nan("");  // never read
  CHECK_NEAR(solver(p).length, 4.0, 1e-12);
}
}  // namespace

TEST(solvers_hold_against_all_permutations) {
  solver_laws(ExactTour{}, true);
  solver_laws(LinKernighan{}, true);
  solver_laws(ThreeOpt{}, false);
  solver_laws(ArchetypeSolver{}, false);
}

TEST(lin_kernighan_finds_the_optimum_of_small_problems) {
  Random random(5);
  for (int trial = 0; trial < 12; ++trial) {
    for_all_variants(random_costs(random, 9 + trial % 5, trial % 3), [&](const TourProblem& p) {
      const Tour exact = ExactTour{}(p), t = LinKernighan{}(p);
      is_valid(p, t);
      CHECK_NEAR(t.length, exact.length, 1e-9 * (1.0 + std::abs(exact.length)));
      CHECK_NEAR(exact.bound, exact.length, 0.0);
    });
  }
}

TEST(three_opt_leaves_no_improving_exchange) {
  Random random(6);
  for (int trial = 0; trial < 6; ++trial) {
    const CostMatrix c = random_costs(random, 9, trial % 3);
    std::vector<int> cycle = detail::nearest_neighbour_cycle(c, 0);
    detail::three_opt_descent(c, cycle, detail::SearchClock(1e9));
    const double length = detail::cycle_length(c, cycle);
    // Segment exchange, segments turned or not, applied plainly to every triple of cuts.
    for (std::size_t i = 0; i < 9; ++i)
      for (std::size_t j = i + 1; j <= 9; ++j)
        for (std::size_t k = j; k <= 9; ++k)
          for (int turned = 0; turned < 4; ++turned)
            for (int swapped = 0; swapped < 2; ++swapped) {
              if (turned == 3 && swapped == 1) continue;  // one reversal of both: four arcs' price
              std::vector<int> a(cycle.begin() + static_cast<std::ptrdiff_t>(i),
                                 cycle.begin() + static_cast<std::ptrdiff_t>(j));
              std::vector<int> b(cycle.begin() + static_cast<std::ptrdiff_t>(j),
                                 cycle.begin() + static_cast<std::ptrdiff_t>(k));
              if ((turned & 1) != 0) std::reverse(a.begin(), a.end());
              if ((turned & 2) != 0) std::reverse(b.begin(), b.end());
              if (swapped != 0) std::swap(a, b);
              std::vector<int> other(cycle.begin(), cycle.begin() + static_cast<std::ptrdiff_t>(i));
              other.insert(other.end(), a.begin(), a.end());
              other.insert(other.end(), b.begin(), b.end());
              other.insert(other.end(), cycle.begin() + static_cast<std::ptrdiff_t>(k),
                           cycle.end());
              CHECK(detail::cycle_length(c, other) >= length - 1e-6 * (1.0 + std::abs(length)));
            }
  }
}

TEST(lin_kernighan_proves_a_planted_tour) {
  Random random(8);
  for (const int n : {40, 150}) {
    std::vector<int> planted(n);
    std::iota(planted.begin(), planted.end(), 0);
    random.shuffle(planted);
    CostMatrix c = random_costs(random, n, 2);
    for (int k = 0; k < n; ++k) c(planted[k], planted[(k + 1) % n]) = 0.5;
    const Tour t = LinKernighan{}(TourProblem{c});
    CHECK_NEAR(t.length, 0.5 * n, 1e-9);
    CHECK_NEAR(t.bound, 0.5 * n, 1e-6);
  }
}

TEST(lin_kernighan_on_a_circle_and_a_grid) {
  const int n = 60;
  CostMatrix circle(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      circle(i * 7 % n, j * 7 % n) = 2.0 * std::abs(std::sin(3.14159265358979 * (i - j) / n));
  CHECK_NEAR(LinKernighan{}(TourProblem{circle}).length, n * circle(0, 7), 1e-9);
  CostMatrix grid(64);
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) grid(i, j) = std::hypot(i % 8 - j % 8, i / 8 - j / 8);
  CHECK_NEAR(LinKernighan{}(TourProblem{grid}).length, 64.0, 1e-9);
  TourProblem open{grid, false, true};
  CHECK_NEAR(LinKernighan{}(open).length, 63.0, 1e-9);
  TourProblem all_equal{CostMatrix(50, 3.0)};
  CHECK_NEAR(LinKernighan{}(all_equal).length, 150.0, 1e-9);
  TourProblem all_zero{CostMatrix(50)};
  CHECK_NEAR(LinKernighan{}(all_zero).length, 0.0, 1e-12);
}

TEST(warm_starts_never_get_worse_and_seeds_repeat) {
  Random random(9);
  for (int trial = 0; trial < 3; ++trial) {
    for_all_variants(random_costs(random, 30, trial), [&](const TourProblem& p) {
      std::vector<int> order(30);
      std::iota(order.begin(), order.end(), 0);
      if (p.start) std::swap(order[0], order[*p.start]);
      const double before = tour_length(p, order);
      LinKernighan brief;
      brief.search.max_iterations = 0;
      const auto check_one = [&](const Tour& t) {
        is_valid(p, t);
        CHECK(p.maximize ? t.length >= before : t.length <= before);
      };
      check_one(brief(p, order));
      check_one(ThreeOpt{}(p, order));
      LinKernighan longer;
      longer.search.max_iterations = 200;
      const Tour a = longer(p), b = longer(p);
      CHECK(a.order == b.order && a.length == b.length);
      const Tour again = longer(p, a.order);
      CHECK(p.maximize ? again.length >= a.length : again.length <= a.length);
    });
  }
  TourProblem p{CostMatrix(12, 1.0)};
  const std::vector<int> not_a_tour(12, 3);
  CHECK_THROWS(Error, LinKernighan{}(p, not_a_tour));
  CHECK_THROWS(Error, ThreeOpt{}(p, not_a_tour));
}

TEST(time_limits_end_a_search) {
  Random random(10);
  TourProblem p{random_costs(random, 120, 2)};
  LinKernighan solve;
  solve.search.max_iterations = std::numeric_limits<std::int64_t>::max();
  solve.search.time_limit_s = 0.02;
  is_valid(p, solve(p));
  ThreeOpt three;
  three.search = solve.search;
  is_valid(p, three(p));
}

TEST(exact_tour_refuses_what_is_too_large) {
  CHECK_THROWS(Error, ExactTour{}(TourProblem{CostMatrix(16)}));
  CHECK_THROWS(Error, ExactTour{25}(TourProblem{CostMatrix(3)}));
}

TEST(hamiltonian_path_through_points_on_a_line) {
  for (const int n : {1, 2, 6, 20}) {
    CostMatrix d(n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) d(i, j) = std::abs(i - j);
    const HamiltonianPath from_end = shortest_hamiltonian_path(d, 0);
    CHECK_NEAR(from_end.length, n - 1.0, 1e-9);
    CHECK(static_cast<int>(from_end.order.size()) == n && from_end.order.front() == 0);
    const int middle = n / 3;
    const HamiltonianPath from_middle = shortest_hamiltonian_path(d, middle);
    CHECK(from_middle.order.front() == middle);
    CHECK_NEAR(from_middle.length, n - 1.0 + std::min(middle, n - 1 - middle), 1e-9);
  }
}
