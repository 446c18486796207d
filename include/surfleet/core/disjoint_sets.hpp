// SPDX-License-Identifier: MIT
/// @file
/// @brief Which of numbered things hang together (union-find).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace surfleet {
/// Sets of the numbers 0 … n − 1, each told by the least of them. O(log n) amortised an operation.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n = 0) : up_(n) { std::iota(up_.begin(), up_.end(), 0); }

  std::size_t size() const { return up_.size(); }
  /// One more number, in a set of its own.
  void add() { up_.push_back(static_cast<std::int32_t>(up_.size())); }
  /// The least number of the set that `i` is in.
  std::int32_t find(std::int32_t i) {
    while (up(i) != i) i = up(i) = up(up(i));
    return i;
  }
  /// False if they are in one set already.
  bool unite(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) up(std::max(a, b)) = std::min(a, b);
    return a != b;
  }
  /// `find` of all numbers. O(n).
  const std::vector<std::int32_t>& flattened() {
    // Nothing points up to a larger number, so in ascending order one step reaches the least.
    for (std::int32_t& u : up_) u = up(u);
    return up_;
  }

 private:
  std::int32_t& up(std::int32_t i) { return up_[static_cast<std::size_t>(i)]; }
  std::vector<std::int32_t> up_;
};
}  // namespace surfleet
