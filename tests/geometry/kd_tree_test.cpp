// SPDX-License-Identifier: MIT
#include <surfleet/geometry/kd_tree.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
std::vector<Neighbor> brute(const std::vector<Point3>& points, const Point3& p) {
  std::vector<Neighbor> all;
  for (std::size_t i = 0; i < points.size(); ++i)
    all.push_back({(points[i] - p).squaredNorm(), static_cast<std::int32_t>(i)});
  std::sort(all.begin(), all.end());
  return all;
}

void compare(const std::vector<Point3>& points, const std::vector<Point3>& queries) {
  const KdTree tree(points);
  CHECK(tree.size() == points.size());
  for (const Point3& p : queries) {
    const auto all = brute(points, p);
    CHECK(tree.nearest(p) == all.front());
    for (const std::size_t k : {1UL, 5UL, 17UL, points.size() + 3}) {
      auto expected = all;
      expected.resize(std::min(k, all.size()));
      CHECK(tree.k_nearest(p, k) == expected);
    }
    for (const double radius : {0.0, 0.3, 2.0, 1e6}) {
      std::vector<Neighbor> expected;
      for (const Neighbor& n : all)
        if (n.distance2 <= radius * radius) expected.push_back(n);
      CHECK(tree.within(p, radius) == expected);
      const auto found = tree.nearest(p, radius);
      CHECK(found.has_value() == !expected.empty());
    }
  }
}
}  // namespace

TEST(kd_tree_agrees_with_brute_force) {
  Random random(3);
  const auto draw = [&](double scale) {
    return Point3(random.uniform(-scale, scale), random.uniform(-scale, scale),
                  random.uniform(-scale, scale));
  };
  for (const std::size_t n : {1UL, 2UL, 12UL, 13UL, 100UL, 1500UL}) {
    std::vector<Point3> points, queries;
    for (std::size_t i = 0; i < n; ++i) points.push_back(draw(3.0));
    for (int i = 0; i < 20; ++i) queries.push_back(draw(5.0));
    compare(points, queries);
  }
}

TEST(kd_tree_ties_go_to_the_lower_index) {
  std::vector<Point3> lattice;
  for (int i = 0; i < 1000; ++i) lattice.emplace_back(i % 10, i / 10 % 10, i / 100);
  compare(lattice, {{4.5, 4.5, 4.5}, {0, 0, 0}, {3, 4.5, 2}, {-1, 20, 4.5}});
  const std::vector<Point3> same(100, Point3(1, 2, 3));
  compare(same, {{1, 2, 3}, {0, 0, 0}});
}

TEST(kd_tree_of_nothing_finds_nothing) {
  const KdTree tree(std::vector<Point3>{});
  CHECK(!tree.nearest({0, 0, 0}) && tree.k_nearest({0, 0, 0}, 3).empty());
  CHECK(tree.within({0, 0, 0}, 1.0).empty());
  CHECK(KdTree().size() == 0 && !KdTree().nearest({0, 0, 0}));
}
