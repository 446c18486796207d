// SPDX-License-Identifier: MIT
#include <surfleet/localization/target_design.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(the_printed_target_has_the_printed_figures) {
  const std::vector<MarkerTarget> printed{printed_target()};
  const TargetQuality q = target_quality(printed);
  CHECK_NEAR(q.similarity, 0.0298, 5e-5);
  CHECK_NEAR(q.objective(2.0 / 3.0), 0.04315, 5e-5);
  CHECK_NEAR(q.longest, 0.3001, 1e-4);
  CHECK_NEAR(q.shortest, 0.1506, 1e-4);
  CHECK_NEAR(q.least_height, 0.1263, 1e-4);
}
TEST(quality_is_that_of_all_pairs) {
  Random random(23);
  std::vector<MarkerTarget> targets(2);
  for (auto& t : targets)
    for (int i = 0; i < 5; ++i)
      t.markers.emplace_back(random.normal(), random.normal(), random.normal());
  std::vector<double> d;
  for (const auto& t : targets)
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t k = 0; k < i; ++k) d.push_back((t.markers[i] - t.markers[k]).norm());
  double least = 1e9, sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < d.size(); ++i)
    for (std::size_t k = 0; k < i; ++k, ++count) {
      least = std::min(least, std::abs(d[i] - d[k]));
      sum += std::abs(d[i] - d[k]);
    }
  const TargetQuality q = target_quality(targets);
  CHECK_NEAR(q.similarity, least, 1e-12);
  CHECK_NEAR(q.mean_difference, sum / count, 1e-12);
}
TEST(designs_keep_the_bounds_and_reach_them) {
  TargetDesignOptions options;
  options.starts = 40;
  const TargetDesign one = design_targets(options);
  CHECK(one.quality.similarity > 0.0299 && one.quality.similarity <= 0.03 + 1e-9);
  CHECK(one.objective > 0.0432);
  CHECK(one.quality.shortest >= 0.15 - 1e-9 && one.quality.longest <= 0.30 + 1e-9);
  CHECK(one.quality.least_height >= 0.12 - 1e-9);
  CHECK(check_target(one.targets[0]).empty());
  options.threads = 2;
  const TargetDesign again = design_targets(options);
  for (std::size_t m = 0; m < 4; ++m)
    CHECK(again.targets[0].markers[m] == one.targets[0].markers[m]);
  options.targets = 2;
  const TargetDesign two = design_targets(options);
  CHECK(two.targets.size() == 2 && two.quality.similarity > 0.010);
  CHECK(two.quality.least_height >= 0.12 - 1e-9);
  TargetDesignOptions five;
  five.markers = 5;
  five.min_height = 0.0;
  five.starts = 20;
  CHECK(design_targets(five).quality.similarity > 0.004);
}
TEST(a_turn_changes_the_view_and_not_the_target) {
  const MarkerTarget t = printed_target();
  const MarkerTarget turned = turned_for_view_from_above(t, {}, 40);
  const std::vector<MarkerTarget> before{t}, after{turned};
  CHECK_NEAR(target_quality(before).objective(0.5), target_quality(after).objective(0.5), 1e-12);
  const auto flat = [](MarkerTarget f) {
    for (Point3& p : f.markers) p.z() = 0.0;
    return target_quality(std::vector<MarkerTarget>{f}).objective(2.0 / 3.0);
  };
  CHECK(flat(turned) > flat(t));
  double lowest = 1.0;
  for (const Point3& p : turned.markers) lowest = std::min(lowest, p.z());
  CHECK_NEAR(lowest, 0.0, 1e-12);
}
TEST(nelder_mead_finds_the_least) {
  const auto rosenbrock = [](const std::vector<double>& x) {
    return 100.0 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1.0 - x[0], 2);
  };
  const auto r = nelder_mead(rosenbrock, {-1.2, 1.0}, {.step = 0.5, .tolerance = 1e-14});
  CHECK_NEAR(r.x[0], 1.0, 1e-4);
  CHECK_NEAR(r.x[1], 1.0, 1e-4);
  const auto bowl = [](const std::vector<double>& x) {
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += static_cast<double>(i + 1) * x[i] * x[i];
    return sum;
  };
  const auto b = nelder_mead(bowl, std::vector<double>(8, 1.0), {.step = 0.5, .max_values = 20000});
  CHECK(b.value < 1e-6 && b.values <= 20000 + 8);
  CHECK_THROWS(Error, nelder_mead(bowl, {}));
}
TEST(impossible_designs_are_refused) {
  TargetDesignOptions options;
  options.starts = 2;
  options.min_height = 0.29;
  CHECK_THROWS(Error, design_targets(options));
  options = {};
  options.max_distance = 0.1;
  CHECK_THROWS(Error, design_targets(options));
  options = {};
  options.markers = 3;
  CHECK_THROWS(Error, design_targets(options));
  options = {};
  options.weight = 1.5;
  CHECK_THROWS(Error, design_targets(options));
}
}  // namespace
