// SPDX-License-Identifier: MIT
/// @file
/// @brief Stops that go over from one robot's open tour to another's.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace surfleet {
/// Moves stops between tours, and exchanges two of different tours, until neither makes the team's
/// tours cheaper: their lengths in all and, beside that, the longest of them `balance` times.
///
/// `length(t, i, j)` is the way of robot t from stop i, or from its start for i = -1, to stop j,
/// `permits(t, j)` says whether stop j may go over to t, and `most[t]` how many stops t can have.
/// First improvement in a fixed order. A pass is O(stops²).
struct ExchangeStops {
  double balance = 0.0;
  int max_passes = 20;

  /// The tours never get dearer, and stay what they are when no move pays. Says whether any did.
  template <typename Length, typename Permits>
  bool operator()(std::vector<std::vector<int>>& tours, std::span<const std::size_t> most,
                  Length&& length, Permits&& permits) const {
    std::vector<double> lengths;
    for (std::size_t t = 0; t < tours.size(); ++t) lengths.push_back(total(t, tours[t], length));
    bool any = false;
    for (int pass = 0; pass < max_passes; ++pass) {
      bool improved = false;
      for (std::size_t a = 0; a < tours.size(); ++a)
        for (std::size_t b = 0; b < tours.size(); ++b) {
          if (a == b) continue;
          improved = relocate(tours, lengths, a, b, most[b], length, permits) || improved;
          if (a < b) improved = swap(tours, lengths, a, b, length, permits) || improved;
        }
      if (!improved) break;
      any = true;
    }
    return any;
  }

  /// What the tours cost.
  template <typename Length>
  double cost(std::span<const std::vector<int>> tours, Length&& length) const {
    std::vector<double> lengths;
    for (std::size_t t = 0; t < tours.size(); ++t) lengths.push_back(total(t, tours[t], length));
    return cost(lengths);
  }

 private:
  static constexpr double kLeast = 1e-9;  ///< Of what a move has to save.

  template <typename Length>
  static double total(std::size_t t, const std::vector<int>& tour, Length&& length) {
    double sum = 0.0;
    int from = -1;
    for (const int stop : tour) sum += length(t, std::exchange(from, stop), stop);
    return sum;
  }
  double cost(std::span<const double> lengths) const {
    double sum = 0.0, longest = 0.0;
    for (const double l : lengths) sum += l, longest = std::max(longest, l);
    return sum + balance * longest;
  }
  bool pays(std::vector<double>& lengths, std::size_t a, double of_a, std::size_t b,
            double of_b) const {
    const double before = cost(lengths);
    const double old_a = std::exchange(lengths[a], of_a), old_b = std::exchange(lengths[b], of_b);
    if (cost(lengths) < before - kLeast * (1.0 + before)) return true;
    lengths[a] = old_a;
    lengths[b] = old_b;
    return false;
  }
  /// Stops of `a` go to where they cost `b` least.
  template <typename Length, typename Permits>
  bool relocate(std::vector<std::vector<int>>& tours, std::vector<double>& lengths, std::size_t a,
                std::size_t b, std::size_t most, Length&& length, Permits&& permits) const {
    bool improved = false;
    for (std::size_t k = 0; k < tours[a].size();) {
      const int stop = tours[a][k];
      bool moved = false;
      if (tours[b].size() < most && permits(b, stop)) {
        const double without = lengths[a] - detour(a, tours[a], k, stop, k + 1, length);
        std::size_t leg = 0;
        double least = 0.0;
        for (std::size_t j = 0; j <= tours[b].size(); ++j) {
          const double extra = detour(b, tours[b], j, stop, j, length);
          if (j == 0 || extra < least) least = extra, leg = j;
        }
        if (pays(lengths, a, without, b, lengths[b] + least)) {
          tours[a].erase(tours[a].begin() + static_cast<std::ptrdiff_t>(k));
          tours[b].insert(tours[b].begin() + static_cast<std::ptrdiff_t>(leg), stop);
          moved = improved = true;
        }
      }
      if (!moved) ++k;
    }
    return improved;
  }
  template <typename Length, typename Permits>
  bool swap(std::vector<std::vector<int>>& tours, std::vector<double>& lengths, std::size_t a,
            std::size_t b, Length&& length, Permits&& permits) const {
    bool improved = false;
    for (std::size_t i = 0; i < tours[a].size(); ++i)
      for (std::size_t j = 0; j < tours[b].size(); ++j) {
        const int x = tours[a][i], y = tours[b][j];
        tours[a][i] = y;
        tours[b][j] = x;
        if (permits(b, x) && permits(a, y) &&
            pays(lengths, a, total(a, tours[a], length), b, total(b, tours[b], length))) {
          improved = true;
        } else {
          tours[a][i] = x;
          tours[b][j] = y;
        }
      }
    return improved;
  }
  /// What a stop adds between the stop before index `k` and that at `next`.
  template <typename Length>
  static double detour(std::size_t t, const std::vector<int>& tour, std::size_t k, int stop,
                       std::size_t next, Length&& length) {
    const int before = k == 0 ? -1 : tour[k - 1];
    double extra = length(t, before, stop);
    if (next < tour.size()) extra += length(t, stop, tour[next]) - length(t, before, tour[next]);
    return extra;
  }
};
}  // namespace surfleet
