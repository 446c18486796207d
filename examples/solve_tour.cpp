// SPDX-License-Identifier: MIT
/// @file
/// @brief Solves a TSPLIB instance and prints the tour with its length and a proven bound.
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "support/cli.hpp"

#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/allocation/tsplib.hpp>

namespace {
using namespace surfleet;

int run(int argc, char** argv) {
  cli::Options app(
      "Finds a short (or long) tour through the nodes of a TSPLIB file, type TSP or ATSP.");
  std::string file;
  double time_limit_s = 1.0;
  std::int64_t iterations = 0;
  std::uint64_t seed = 1;
  std::optional<int> start;
  bool maximize = false, open = false;
  app.add("file", file, "TSPLIB file").required();
  app.begin_group("Search");
  app.add("--time-limit", time_limit_s, "Seconds to search");
  app.add("--iterations", iterations,
          "Search this many perturbations instead of a time: the same result everywhere");
  app.add("--seed", seed, "Seed of the search");
  app.add("--start", start, "First node of the tour, numbered from 1 as in the file");
  app.begin_group("Tour");
  app.add_flag("--maximize", maximize, "Search for the longest tour");
  app.add_flag("--open", open, "Search for a path that does not return to where it began");
  app.add_examples(
      "  solve_tour berlin52.tsp                               a second of search\n"
      "  solve_tour rbg323.atsp --iterations 100000 --seed 7   the same everywhere\n"
      "  solve_tour br17.atsp --open --start 1");
  app.parse(argc, argv);
  require(time_limit_s > 0.0 && time_limit_s <= 1e6,
          "--time-limit " + std::to_string(time_limit_s) + "; expected seconds in (0, 1e6]");
  require(iterations >= 0, "--iterations " + std::to_string(iterations) + "; expected 0 or more");
  TsplibInstance instance = read_tsplib(file);
  const int n = instance.costs.size();
  require(!start || (*start >= 1 && *start <= n),
          "--start " + std::to_string(start.value_or(0)) + "; expected 1 to " + std::to_string(n));
  TourProblem problem;
  problem.costs = std::move(instance.costs);
  problem.maximize = maximize;
  problem.open = open;
  if (start) problem.start = *start - 1;
  LinKernighan solve;
  solve.search.seed = seed;
  if (iterations > 0) {
    solve.search.max_iterations = iterations;
  } else {
    solve.search.max_iterations = std::numeric_limits<std::int64_t>::max();
    solve.search.time_limit_s = time_limit_s;
  }
  const Tour tour = solve(problem);
  std::printf("name    %s\nnodes   %d\nlength  %.10g\nbound   %.10g\ngap     %.4f %%%s\ntour   ",
              instance.name.c_str(), n, tour.length, tour.bound, 100.0 * tour.gap(),
              tour.gap() == 0.0 ? " (optimal)" : "");
  for (const int node : tour.order) std::printf(" %d", node + 1);
  std::printf("\n");
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("solve_tour", [&] { return run(argc, argv); });
}
