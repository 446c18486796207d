// SPDX-License-Identifier: MIT
/// @file
/// @brief Means, spreads and percentiles of samples and of repeated trials.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace surfleet {
/// Number, mean and spread of values, gathered one at a time without storing them (Welford).
class Moments {
 public:
  void add(double value) {
    ++count_;
    const double delta = value - mean_;
    mean_ += delta / static_cast<double>(count_);
    sum_squares_ += delta * (value - mean_);
  }
  std::size_t count() const { return count_; }
  /// NaN when nothing was added; so are the others.
  double mean() const { return count_ > 0 ? mean_ : kNone; }
  /// Square root of the mean squared deviation from the mean (divides by n).
  double population_deviation() const {
    return count_ > 0 ? std::sqrt(sum_squares_ / static_cast<double>(count_)) : kNone;
  }
  /// The unbiased estimate from a sample (divides by n − 1); zero for one value.
  double sample_deviation() const {
    if (count_ < 2) return count_ == 1 ? 0.0 : kNone;
    return std::sqrt(sum_squares_ / static_cast<double>(count_ - 1));
  }
  /// Root of the mean square: mean² + population deviation².
  double root_mean_square() const { return std::hypot(mean(), population_deviation()); }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::size_t count_ = 0;
  double mean_ = 0.0, sum_squares_ = 0.0;
};

inline Moments moments(std::span<const double> values) {
  Moments m;
  for (const double v : values) m.add(v);
  return m;
}

/// The value below which the share `fraction` ∈ [0, 1] of ascending `sorted` lies, with linear
/// interpolation between neighbours; NaN for no values.
inline double sorted_percentile(std::span<const double> sorted, double fraction) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double at = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}
inline double percentile(std::span<const double> values, double fraction) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted_percentile(sorted, fraction);
}

/// What a table tells of one quantity over repeated trials.
struct Summary {
  std::size_t count = 0;
  double mean = 0.0, deviation = 0.0;  ///< Sample deviation (n − 1).
  double minimum = 0.0, median = 0.0, percentile_95 = 0.0, maximum = 0.0;
};

/// Summary of finite values; the others are left out, and all is NaN if none is finite.
inline Summary summarize(std::span<const double> values) {
  std::vector<double> sorted;
  for (const double v : values)
    if (std::isfinite(v)) sorted.push_back(v);
  std::sort(sorted.begin(), sorted.end());
  const Moments m = moments(sorted);
  return {sorted.size(),
          m.mean(),
          m.sample_deviation(),
          sorted_percentile(sorted, 0.0),
          sorted_percentile(sorted, 0.5),
          sorted_percentile(sorted, 0.95),
          sorted_percentile(sorted, 1.0)};
}

/// `value` with a fixed number of decimals; a dash if it is not finite.
inline std::string format_number(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  char text[400];
  std::snprintf(text, sizeof text, "%.*f", std::clamp(decimals, 0, 17), value);
  const bool zero = std::all_of(text, text + std::char_traits<char>::length(text),
                                [](char c) { return c == '-' || c == '0' || c == '.'; });
  return zero && text[0] == '-' ? text + 1 : text;
}
/// Seconds as `min:s`, as the published tables print them.
inline std::string format_minutes(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  const auto whole = static_cast<long long>(std::llround(std::abs(seconds)));
  char text[64];
  std::snprintf(text, sizeof text, "%s%lld:%02lld", seconds < 0.0 ? "-" : "", whole / 60,
                whole % 60);
  return text;
}
/// "mean ± deviation".
inline std::string format_spread(const Summary& s, int decimals) {
  return format_number(s.mean, decimals) + " ± " + format_number(s.deviation, decimals);
}
}  // namespace surfleet
