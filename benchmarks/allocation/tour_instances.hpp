// SPDX-License-Identifier: MIT
/// @file
/// @brief Tour instances made by rule, in the kinds that public collections of asymmetric tours are
/// made of: the same on every machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/allocation/cost_matrix.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/graph.hpp>

namespace tour_instances {
using surfleet::CostMatrix;
using surfleet::Random;

template <typename Cost>
CostMatrix from_rule(int n, Cost&& cost) {
  CostMatrix c(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j) c(i, j) = cost(i, j);
  return c;
}
inline std::vector<double> draw(Random& random, int n, double high) {
  std::vector<double> x(n);
  for (double& v : x) v = std::floor(random.uniform(0.0, high));
  return x;
}

/// Independent costs.
inline CostMatrix random_costs(int n, std::uint64_t seed, double high) {
  Random random(seed);
  return from_rule(n, [&](int, int) { return 1.0 + std::floor(random.uniform(0.0, high)); });
}
/// Deliveries in a city of blocks of which a part has one-way streets: shortest paths.
inline CostMatrix city(int n, std::uint64_t seed, double one_way) {
  Random random(seed);
  const int side = static_cast<int>(std::ceil(std::sqrt(1.6 * n)));
  std::vector<std::pair<std::int32_t, surfleet::Arc>> arcs;
  const auto street = [&](int a, int b, bool forward) {
    const double length = 20.0 + std::floor(random.uniform(0.0, 60.0));
    const bool single = random.uniform() < one_way;
    if (!single || forward) arcs.push_back({a, {b, length}});
    if (!single || !forward) arcs.push_back({b, {a, length}});
  };
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      if (x + 1 < side) street(y * side + x, y * side + x + 1, y % 2 == 0);
      if (y + 1 < side) street(y * side + x, (y + 1) * side + x, x % 2 == 0);
    }
  }
  const surfleet::Graph graph(static_cast<std::size_t>(side * side), arcs);
  std::vector<int> place(side * side);
  for (int i = 0; i < side * side; ++i) place[i] = i;
  random.shuffle(place);
  CostMatrix c(n);
  for (int i = 0; i < n; ++i) {
    const auto paths = surfleet::shortest_paths(graph, place[i]);
    for (int j = 0; j < n; ++j)
      if (i != j) c(i, j) = paths.reached(place[j]) ? paths.distance[place[j]] : 5000.0;
  }
  return c;
}
/// Points in the plane; the way back is up to `noise` longer. 0: symmetric.
inline CostMatrix plane(int n, std::uint64_t seed, double noise) {
  Random random(seed);
  const auto x = draw(random, n, 4000.0), y = draw(random, n, 2000.0);
  return from_rule(n, [&](int i, int j) {
    return std::round(std::hypot(x[i] - x[j], y[i] - y[j]) *
                      (1.0 + (noise > 0.0 ? noise * random.uniform() : 0.0)));
  });
}
/// Jobs of a crane in a rack, each from one place to another: empty travel between jobs.
inline CostMatrix stacker_crane(int n, std::uint64_t seed) {
  Random random(seed);
  const auto from_x = draw(random, n, 40.0), from_y = draw(random, n, 8.0);
  const auto to_x = draw(random, n, 40.0), to_y = draw(random, n, 8.0);
  return from_rule(n, [&](int i, int j) {
    return std::max(std::abs(to_x[i] - from_x[j]), 3.0 * std::abs(to_y[i] - from_y[j]));
  });
}
/// Sectors of a turning disk: seek, then wait for the sector.
inline CostMatrix disk(int n, std::uint64_t seed) {
  Random random(seed);
  const auto track = draw(random, n, 300.0), angle = draw(random, n, 360.0);
  return from_rule(n, [&](int i, int j) {
    const double seek = std::round(12.0 * std::sqrt(std::abs(track[i] - track[j])));
    return seek + std::fmod(angle[j] - angle[i] - seek + 7200.0, 360.0);
  });
}
/// Coins on a slope: going down costs twice as much as going up.
inline CostMatrix coins(int n, std::uint64_t seed) {
  Random random(seed);
  const auto x = draw(random, n, 50.0), y = draw(random, n, 50.0);
  return from_rule(n, [&](int i, int j) {
    const double up = y[j] - y[i];
    return std::abs(x[j] - x[i]) + (up > 0.0 ? up : -2.0 * up);
  });
}
/// Gains discounted by distance: the utilities of viewpoint clusters, in millionths.
inline CostMatrix cluster_utility(int n, std::uint64_t seed) {
  Random random(seed);
  const auto x = draw(random, n, 650.0), y = draw(random, n, 420.0), g = draw(random, n, 1e6);
  return from_rule(n, [&](int i, int j) {
    return std::round((1e5 + g[j]) * std::exp(-0.017 * std::hypot(x[i] - x[j], y[i] - y[j])));
  });
}

using Named = std::pair<std::string, CostMatrix>;

/// 17 to 170 nodes.
inline std::vector<Named> medium() {
  std::vector<Named> all;
  const auto add = [&](const std::string& kind, CostMatrix c) {
    const int n = c.size();
    all.emplace_back(kind + "_" + std::to_string(n), std::move(c));
  };
  add("random", random_costs(17, 1, 100.0));
  add("random", random_costs(100, 2, 1e3));
  add("random", random_costs(170, 3, 1e4));
  for (const int n : {34, 45, 56, 71, 100, 130, 170}) add("city", city(n, n, 0.5));
  add("city_one_way", city(150, 9, 1.0));
  add("plane_2_percent", plane(48, 5, 0.02));
  add("plane_5_percent", plane(100, 6, 0.05));
  add("plane_20_percent", plane(170, 6, 0.2));
  add("stacker_crane", stacker_crane(70, 4));
  add("stacker_crane", stacker_crane(150, 1));
  add("disk", disk(120, 1));
  add("coins", coins(100, 1));
  add("coins", coins(170, 1));
  add("cluster_utility", cluster_utility(60, 2));
  add("cluster_utility", cluster_utility(100, 1));
  return all;
}
/// 300 to 450 nodes.
inline std::vector<Named> large() {
  std::vector<Named> all;
  const auto add = [&](const std::string& kind, CostMatrix c) {
    const int n = c.size();
    all.emplace_back(kind + "_" + std::to_string(n), std::move(c));
  };
  add("stacker_crane", stacker_crane(323, 2));
  add("stacker_crane", stacker_crane(443, 3));
  add("city", city(400, 5, 0.5));
  add("random", random_costs(400, 5, 1e5));
  add("coins", coins(350, 3));
  add("plane_10_percent", plane(300, 3, 0.1));
  add("disk", disk(450, 3));
  return all;
}
}  // namespace tour_instances
