// SPDX-License-Identifier: MIT
/// @file
/// @brief Least value of a function of many variables without derivatives: the simplex of Nelder
/// and Mead.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>

namespace surfleet {
struct NelderMeadOptions {
  double step = 0.1;              ///< First edge of the simplex along each axis.
  double tolerance = 1e-9;        ///< Ends when the values of the simplex differ less …
  std::size_t max_values = 2000;  ///< … or after so many values of the function.
};
struct NelderMeadResult {
  std::vector<double> x;
  double value = 0.0;
  std::size_t values = 0;  ///< How often the function was asked.
};

/// A local minimum of `f(x)` from `start`. With coefficients that depend on the number of variables
/// n, which keeps the simplex from collapsing where there are many. O(n) beside each value and
/// O(n²) for each shrink; memory O(n²). Throws `Error` on an empty start.
template <typename Function>
NelderMeadResult nelder_mead(const Function& f, const std::vector<double>& start,
                             const NelderMeadOptions& options = {}) {
  require(!start.empty() && options.step > 0.0, "Nelder-Mead: expected variables and a step");
  const std::size_t n = start.size();
  const auto dim = static_cast<double>(std::max<std::size_t>(n, 2));
  const double expand = 1.0 + 2.0 / dim, contract = 0.75 - 0.5 / dim, shrink = 1.0 - 1.0 / dim;
  struct Corner {
    std::vector<double> x;
    double value;
  };
  NelderMeadResult result;
  const auto ask = [&](const std::vector<double>& x) {
    ++result.values;
    return f(x);
  };
  std::vector<Corner> simplex;
  simplex.push_back({start, ask(start)});
  for (std::size_t i = 0; i < n; ++i) {
    auto x = start;
    x[i] += options.step;
    const double value = ask(x);
    simplex.push_back({std::move(x), value});
  }
  const auto better = [](const Corner& a, const Corner& b) { return a.value < b.value; };
  std::stable_sort(simplex.begin(), simplex.end(), better);
  std::vector<double> middle(n), x(n), y(n);
  const auto place = [&](std::vector<double>& out, double along) {
    for (std::size_t k = 0; k < n; ++k)
      out[k] = middle[k] + along * (middle[k] - simplex.back().x[k]);
  };
  while (result.values < options.max_values &&
         simplex.back().value - simplex.front().value > options.tolerance) {
    std::fill(middle.begin(), middle.end(), 0.0);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < n; ++k) middle[k] += simplex[i].x[k] / static_cast<double>(n);
    place(x, 1.0);
    double value = ask(x);
    bool shrinks = false;
    if (value < simplex.front().value) {
      place(y, expand);
      if (const double further = ask(y); further < value) {
        value = further;
        std::swap(x, y);
      }
    } else if (!(value < simplex[n - 1].value)) {
      const bool outside = value < simplex.back().value;
      place(y, outside ? contract : -contract);
      const double nearer = ask(y);
      shrinks = !(nearer < (outside ? value : simplex.back().value));
      value = nearer;
      std::swap(x, y);
    }
    if (shrinks) {
      for (std::size_t i = 1; i <= n; ++i) {
        for (std::size_t k = 0; k < n; ++k)
          simplex[i].x[k] = simplex[0].x[k] + shrink * (simplex[i].x[k] - simplex[0].x[k]);
        simplex[i].value = ask(simplex[i].x);
      }
      std::stable_sort(simplex.begin(), simplex.end(), better);
    } else {
      Corner corner{x, value};
      simplex.pop_back();
      simplex.insert(std::upper_bound(simplex.begin(), simplex.end(), corner, better),
                     std::move(corner));
    }
  }
  result.x = simplex.front().x;
  result.value = simplex.front().value;
  return result;
}
}  // namespace surfleet
