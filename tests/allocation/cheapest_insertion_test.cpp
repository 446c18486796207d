// SPDX-License-Identifier: MIT
#include <surfleet/allocation/cheapest_insertion.hpp>
//
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include <surfleet/allocation/hamiltonian_path.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(cheapest_insertion_is_that_of_brute_force_while_the_path_grows) {
  Random random(5);
  const auto place = [&] { return Point2(random.uniform(0.0, 10.0), random.uniform(0.0, 10.0)); };
  for (int round = 0; round < 20; ++round) {
    std::vector<Point2> path{place()}, candidates;
    for (int c = 0; c < 30; ++c) candidates.push_back(place());
    if (round == 0) candidates.clear();
    std::vector<double> legs;
    // The distance from the start is longer than the straight one.
    const auto distance = [&](std::size_t k, std::size_t c) {
      return (k == 0 ? 1.3 : 1.0) * (path[k] - candidates[c]).norm();
    };
    CheapestInsertion insertion(candidates.size(), legs, distance);
    for (int step = 0; step < 12; ++step) {
      for (std::size_t c = 0; c < candidates.size(); ++c) {
        double least = std::numeric_limits<double>::infinity();
        const auto extra = [&](std::size_t k) {
          return distance(k, c) + (k < legs.size() ? distance(k + 1, c) - legs[k] : 0.0);
        };
        for (std::size_t k = 0; k <= legs.size(); ++k) least = std::min(least, extra(k));
        CHECK(insertion[c].extra == least && extra(insertion[c].leg) == least);
      }
      const auto k = static_cast<std::size_t>(random.uniform(0.0, 1.0) *
                                              (static_cast<double>(legs.size()) + 0.999));
      path.insert(path.begin() + static_cast<std::ptrdiff_t>(k) + 1, place());
      legs.clear();
      for (std::size_t i = 1; i < path.size(); ++i) legs.push_back((path[i] - path[i - 1]).norm());
      insertion.inserted(k, legs, distance);
    }
  }
}

TEST(shortest_path_by_a_function_is_that_by_a_matrix) {
  Random random(6);
  for (const int n : {1, 2, 5, 14}) {
    std::vector<Point2> places;
    for (int i = 0; i < n; ++i) places.push_back({random.uniform(0, 1), random.uniform(0, 1)});
    CostMatrix lengths(n);
    const auto length = [&](int i, int j) {
      CHECK(i > j);
      return (places[static_cast<std::size_t>(i)] - places[static_cast<std::size_t>(j)]).norm();
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < i; ++j) lengths(i, j) = lengths(j, i) = length(i, j);
    const HamiltonianPath a = shortest_hamiltonian_path(lengths, 0);
    const HamiltonianPath b = shortest_hamiltonian_path(n, length);
    CHECK(a.order == b.order && a.length == b.length);
  }
}
}  // namespace
