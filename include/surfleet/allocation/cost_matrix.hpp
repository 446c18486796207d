// SPDX-License-Identifier: MIT
/// @file
/// @brief A dense square matrix of arc costs, in general asymmetric.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <surfleet/core/assert.hpp>
#include <surfleet/core/error.hpp>

namespace surfleet {
/// `costs(i, j)` is the cost (or the utility) of going from node i to node j. The diagonal is
/// never read by the solvers. n² doubles.
class CostMatrix {
 public:
  CostMatrix() = default;
  /// n × n, every entry `value`. Throws `Error` if n is negative or beyond 30 000 (7 GB).
  explicit CostMatrix(int n, double value = 0.0) : size_(n) {
    require(n >= 0 && n <= 30000,
            "cost matrix: size " + std::to_string(n) + "; expected 0 to 30000");
    values_.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), value);
  }

  int size() const { return size_; }
  double& operator()(int from, int to) { return values_[index(from, to)]; }
  double operator()(int from, int to) const { return values_[index(from, to)]; }
  /// The costs of all arcs out of `from`.
  const double* row(int from) const { return values_.data() + index(from, 0); }

  /// True if c(i, j) = c(j, i) for all pairs. O(n²).
  bool symmetric() const {
    for (int i = 0; i < size_; ++i)
      for (int j = 0; j < i; ++j)
        if ((*this)(i, j) != (*this)(j, i)) return false;
    return true;
  }

 private:
  std::size_t index(int from, int to) const {
    SURFLEET_ASSERT(from >= 0 && from < size_ && to >= 0 && to < size_, "node out of range");
    return static_cast<std::size_t>(from) * static_cast<std::size_t>(size_) +
           static_cast<std::size_t>(to);
  }
  int size_ = 0;
  std::vector<double> values_;
};
}  // namespace surfleet
