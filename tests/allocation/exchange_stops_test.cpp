// SPDX-License-Identifier: MIT
#include <surfleet/allocation/exchange_stops.hpp>
//
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Stops in a square, dealt out at random.
struct Dealt {
  std::vector<Point2> starts, stops;
  std::vector<std::vector<int>> tours;

  Dealt(std::uint64_t seed, std::size_t robots, int count) : tours(robots) {
    Random random(seed);
    const auto place = [&] {
      const double x = random.uniform(0, 10), y = random.uniform(0, 10);
      return Point2(x, y);
    };
    for (std::size_t r = 0; r < robots; ++r) starts.push_back(place());
    for (int i = 0; i < count; ++i) {
      stops.push_back(place());
      tours[random.below(robots)].push_back(i);
    }
  }
  double length(std::size_t t, int i, int j) const {
    const Point2& from = i < 0 ? starts[t] : stops[static_cast<std::size_t>(i)];
    return (from - stops[static_cast<std::size_t>(j)]).norm();
  }
};

TEST(exchanges_make_tours_cheaper_until_none_does) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Dealt d(seed, 3, 12);
    const auto length = [&](std::size_t t, int i, int j) { return d.length(t, i, j); };
    const auto anything = [](std::size_t, int) { return true; };
    const std::vector<std::size_t> most(3, 6);
    std::vector<std::size_t> sizes;
    for (const auto& tour : d.tours) sizes.push_back(tour.size());
    const ExchangeStops exchange{.balance = seed % 2 == 0 ? 0.5 : 0.0, .max_passes = 1000};
    const double before = exchange.cost(d.tours, length);
    CHECK(exchange(d.tours, most, length, anything));
    const double after = exchange.cost(d.tours, length);
    CHECK(after < before);
    std::vector<int> all;
    for (std::size_t t = 0; t < 3; ++t) {
      CHECK(d.tours[t].size() <= std::max<std::size_t>(6, sizes[t]));
      all.insert(all.end(), d.tours[t].begin(), d.tours[t].end());
    }
    std::sort(all.begin(), all.end());
    for (int i = 0; i < 12; ++i) CHECK(all.at(static_cast<std::size_t>(i)) == i);
    // By brute force: no stop that goes elsewhere, and no two that change places, save anything.
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t k = 0; k < d.tours[a].size(); ++k)
        for (std::size_t b = 0; b < 3; ++b) {
          if (a == b) continue;
          for (std::size_t j = 0; j <= d.tours[b].size(); ++j) {
            auto tours = d.tours;
            const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
            if (j < tours[b].size()) {
              std::swap(tours[a][k], tours[b][j]);
              CHECK(exchange.cost(tours, length) > after - 1e-6);
              std::swap(tours[a][k], tours[b][j]);
            }
            if (tours[b].size() >= most[b]) continue;
            tours[b].insert(tours[b].begin() + at(j), tours[a][k]);
            tours[a].erase(tours[a].begin() + at(k));
            CHECK(exchange.cost(tours, length) > after - 1e-6);
          }
        }
    CHECK(!exchange(d.tours, most, length, anything));
    CHECK(exchange.cost(d.tours, length) == after);
  }
}

TEST(stops_stay_where_others_may_not_have_them) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Dealt d(seed, 2, 8);
    const auto length = [&](std::size_t t, int i, int j) {
      // Robot 1 has no way to the first three.
      return t == 1 && j < 3 ? std::numeric_limits<double>::infinity() : d.length(t, i, j);
    };
    for (int i = 0; i < 3; ++i) std::erase(d.tours[1], i);
    const std::vector<std::size_t> most{2, 8};
    const auto before = d.tours;
    ExchangeStops{}(d.tours, most, length,
                    [](std::size_t t, int stop) { return t == 0 ? stop != 5 : stop >= 3; });
    for (const int stop : d.tours[1]) CHECK(stop >= 3);
    CHECK(d.tours[0].size() <= std::max<std::size_t>(2, before[0].size()));
    const auto has = [](const std::vector<int>& tour, int stop) {
      return std::find(tour.begin(), tour.end(), stop) != tour.end();
    };
    CHECK(!has(d.tours[0], 5) || has(before[0], 5));
  }
  std::vector<std::vector<int>> none;
  const auto length = [](std::size_t, int, int) { return 1.0; };
  CHECK(!ExchangeStops{}(none, {}, length, [](std::size_t, int) { return true; }));
}
}  // namespace
