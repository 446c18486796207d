// SPDX-License-Identifier: MIT
#include <surfleet/geometry/matching.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;
using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;

Graph graph_of(std::size_t n, const Pairs& edges) {
  std::vector<std::pair<std::int32_t, Arc>> arcs;
  for (const auto& [a, b] : edges) {
    arcs.push_back({a, {b, 1.0}});
    arcs.push_back({b, {a, 1.0}});
  }
  return Graph(n, arcs);
}
/// The most pairs there can be, by trying all.
int most_pairs(std::size_t n, const Pairs& edges) {
  std::vector<int> best(std::size_t{1} << n, 0);
  for (std::size_t set = 1; set < best.size(); ++set)
    for (const auto& [a, b] : edges) {
      const std::size_t both = (std::size_t{1} << a) | (std::size_t{1} << b);
      if (a != b && (set & both) == both) best[set] = std::max(best[set], best[set & ~both] + 1);
    }
  return best.back();
}
int check_matching(std::size_t n, const Pairs& edges) {
  const auto mate = maximum_matching(graph_of(n, edges));
  int pairs = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (mate[i] < 0) continue;
    CHECK(mate[static_cast<std::size_t>(mate[i])] == static_cast<std::int32_t>(i));
    bool joined = false;
    for (const auto& [a, b] : edges)
      joined = joined ||
               (std::min(a, b) == std::min<std::int32_t>(static_cast<std::int32_t>(i), mate[i]) &&
                std::max(a, b) == std::max<std::int32_t>(static_cast<std::int32_t>(i), mate[i]));
    CHECK(joined);
    ++pairs;
  }
  return pairs / 2;
}
}  // namespace

TEST(matchings_are_as_large_as_can_be) {
  Random random(4);
  for (int round = 0; round < 300; ++round) {
    const std::size_t n = 4 + random.below(9);
    Pairs edges;
    const std::size_t m = 3 + random.below(2 * n);
    for (std::size_t k = 0; k < m; ++k)
      edges.push_back(
          {static_cast<std::int32_t>(random.below(n)), static_cast<std::int32_t>(random.below(n))});
    CHECK(check_matching(n, edges) == most_pairs(n, edges));
  }
  CHECK(maximum_matching(Graph()).empty());
  CHECK(check_matching(2, {}) == 0);
}

// Larger, against half the rank of a random skew-symmetric matrix over the edges (Tutte 1947,
// Lovász 1979), modulo a prime: rings of odd length on one another, where first choices go wrong.
TEST(matchings_have_half_the_rank_of_tutte_s_matrix) {
  constexpr std::uint64_t kPrime = 1000000007;
  const auto inverse = [](std::uint64_t a) {
    std::uint64_t result = 1;
    for (std::uint64_t e = kPrime - 2; e > 0; e /= 2, a = a * a % kPrime)
      if (e % 2 == 1) result = result * a % kPrime;
    return result;
  };
  Random random(12);
  for (int round = 0; round < 250; ++round) {
    Pairs edges;
    std::int32_t n = 0;
    while (n < 30 + round % 30) {
      const auto ring = static_cast<std::int32_t>(3 + 2 * random.below(3));
      for (std::int32_t k = 0; k < ring; ++k) edges.push_back({n + k, n + (k + 1) % ring});
      n += ring;
    }
    const std::size_t joined = random.below(static_cast<std::size_t>(n));
    for (std::size_t k = 0; k < joined; ++k) {
      const auto a = static_cast<std::int32_t>(random.below(static_cast<std::size_t>(n))),
                 b = static_cast<std::int32_t>(random.below(static_cast<std::size_t>(n)));
      if (a != b) edges.push_back({a, b});
    }
    std::vector<std::int32_t> name(static_cast<std::size_t>(n));  // no order to hold on to
    for (std::int32_t i = 0; i < n; ++i) name[static_cast<std::size_t>(i)] = i;
    random.shuffle(name);
    for (auto& [a, b] : edges) {
      a = name[static_cast<std::size_t>(a)];
      b = name[static_cast<std::size_t>(b)];
    }
    const auto size = static_cast<std::size_t>(n);
    std::vector<std::vector<std::uint64_t>> m(size, std::vector<std::uint64_t>(size, 0));
    for (const auto& [a, b] : edges) {
      const std::uint64_t x = 1 + random.below(kPrime - 1);
      m[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] = x;
      m[static_cast<std::size_t>(b)][static_cast<std::size_t>(a)] = kPrime - x;
    }
    std::size_t rank = 0;
    for (std::size_t column = 0; column < size; ++column) {
      std::size_t pivot = rank;
      while (pivot < size && m[pivot][column] == 0) ++pivot;
      if (pivot == size) continue;
      std::swap(m[pivot], m[rank]);
      for (std::size_t row = rank + 1; row < size; ++row) {
        if (m[row][column] == 0) continue;
        const std::uint64_t f = m[row][column] * inverse(m[rank][column]) % kPrime;
        for (std::size_t k = column; k < size; ++k)
          m[row][k] = (m[row][k] + (kPrime - f) * m[rank][k]) % kPrime;
      }
      ++rank;
    }
    CHECK(2 * static_cast<std::size_t>(check_matching(size, edges)) == rank);
  }
}

TEST(cubic_graphs_without_bridges_match_whole) {
  // Petersen's graph, and a large ring of odd circles joined by rungs.
  CHECK(check_matching(10, {{0, 1},
                            {1, 2},
                            {2, 3},
                            {3, 4},
                            {4, 0},
                            {0, 5},
                            {1, 6},
                            {2, 7},
                            {3, 8},
                            {4, 9},
                            {5, 7},
                            {7, 9},
                            {9, 6},
                            {6, 8},
                            {8, 5}}) == 5);
  Random random(7);
  for (int round = 0; round < 3; ++round) {
    const std::int32_t n = 600;
    std::vector<std::int32_t> at(static_cast<std::size_t>(n));
    for (std::int32_t i = 0; i < n; ++i) at[static_cast<std::size_t>(i)] = i;
    random.shuffle(at);
    Pairs edges;  // two rings of odd length crosswise: no bridge
    for (std::int32_t i = 0; i < 301; ++i)
      edges.push_back(
          {at[static_cast<std::size_t>(i)], at[static_cast<std::size_t>((i + 1) % 301)]});
    for (std::int32_t i = 0; i < 299; ++i)
      edges.push_back({at[static_cast<std::size_t>(301 + i)],
                       at[static_cast<std::size_t>(301 + (i + 1) % 299)]});
    for (std::int32_t i = 0; i < 299; i += 1)
      edges.push_back({at[static_cast<std::size_t>(i)], at[static_cast<std::size_t>(301 + i)]});
    CHECK(check_matching(static_cast<std::size_t>(n), edges) == n / 2);
  }
}
