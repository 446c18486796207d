// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/statistics.hpp>

#include <limits>
#include <vector>

#include "check.hpp"

using namespace surfleet;

TEST(moments_of_known_values) {
  const std::vector<double> v{2, 4, 4, 4, 5, 5, 7, 9};
  const Moments m = moments(v);
  CHECK_NEAR(m.mean(), 5.0, 1e-15);
  CHECK_NEAR(m.population_deviation(), 2.0, 1e-15);
  CHECK_NEAR(m.sample_deviation(), std::sqrt(32.0 / 7.0), 1e-15);
  CHECK_NEAR(m.root_mean_square(), std::sqrt(29.0), 1e-14);
  CHECK(std::isnan(Moments{}.mean()) && std::isnan(Moments{}.root_mean_square()));
  CHECK(moments(std::vector<double>{3.0}).sample_deviation() == 0.0);
}

TEST(moments_far_from_zero) {
  std::vector<double> v;
  for (int i = 0; i < 1000; ++i) v.push_back(1e9 + (i % 2));
  CHECK_NEAR(moments(v).population_deviation(), 0.5, 1e-6);
}

TEST(percentiles_interpolate) {
  const std::vector<double> v{40, 10, 30, 20};
  CHECK(percentile(v, 0.0) == 10 && percentile(v, 1.0) == 40);
  CHECK_NEAR(percentile(v, 0.5), 25.0, 1e-12);
  CHECK_NEAR(percentile(v, 0.95), 38.5, 1e-12);
  CHECK(std::isnan(percentile({}, 0.5)));
}

TEST(summary_leaves_out_what_is_not_finite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Summary s = summarize(std::vector<double>{1, nan, 3, HUGE_VAL, 2});
  CHECK(s.count == 3 && s.minimum == 1 && s.maximum == 3 && s.median == 2);
  CHECK_NEAR(s.deviation, 1.0, 1e-15);
  CHECK(summarize({}).count == 0 && std::isnan(summarize({}).mean));
}

TEST(numbers_as_text) {
  CHECK(format_number(3.14159, 2) == "3.14");
  CHECK(format_number(-0.001, 1) == "0.0");
  CHECK(format_number(std::nan(""), 1) == "–");
  CHECK(format_minutes(620.4) == "10:20" && format_minutes(59.7) == "1:00");
  CHECK(format_spread(summarize(std::vector<double>{1, 2, 3}), 1) == "2.0 ± 1.0");
}
