// SPDX-License-Identifier: MIT
#include <set>
#include <surfleet/viewpoint/viewpoint_cover.hpp>

#include "check.hpp"

#include <surfleet/core/random.hpp>

namespace {
using namespace surfleet;

Viewpoint view(std::vector<std::int32_t> targets) { return {{}, Eigen::Vector3d::Zero(), targets}; }

TEST(one_broad_view_replaces_the_narrow_ones) {
  const std::vector<Viewpoint> views{view({0}), view({1}), view({2}), view({3})};
  const auto few = cover_viewpoints(views, {{0}, {0, 1, 2}, {2}, {3}});
  CHECK(few.size() == 2);
  CHECK(few[0].targets == std::vector<std::int32_t>({0, 1, 2}));
  CHECK(few[1].targets == std::vector<std::int32_t>({3}));
}
TEST(what_later_choices_make_useless_is_dropped) {
  // Greedy takes {0 1 2 3} first; the two that are needed for 4 and 5 then see all of it.
  const std::vector<Viewpoint> views{view({0}), view({4}), view({5})};
  const auto few = cover_viewpoints(views, {{0, 1, 2, 3}, {0, 1, 4}, {2, 3, 5}});
  CHECK(few.size() == 2);
  CHECK(few[0].targets == std::vector<std::int32_t>({0, 1, 4}));
  CHECK(few[1].targets == std::vector<std::int32_t>({2, 3, 5}));
}
TEST(every_element_is_the_target_of_one_view_that_sees_it) {
  Random random(11);
  for (int trial = 0; trial < 50; ++trial) {
    const std::size_t n = 1 + random.below(30);
    std::vector<Viewpoint> views;
    std::vector<std::vector<std::int32_t>> seen(n);
    std::set<std::int32_t> all;
    for (std::size_t i = 0; i < n; ++i) {
      views.push_back(view({static_cast<std::int32_t>(random.below(40))}));
      for (std::uint64_t k = random.below(12); k > 0; --k)
        seen[i].push_back(static_cast<std::int32_t>(random.below(40)));
      views[i].configuration.yaw = static_cast<double>(i);
      all.insert(views[i].targets[0]);
      all.insert(seen[i].begin(), seen[i].end());
    }
    std::set<std::int32_t> covered;
    for (const Viewpoint& v : cover_viewpoints(views, seen)) {
      const auto i = static_cast<std::size_t>(v.configuration.yaw);
      CHECK(!v.targets.empty());
      for (const std::int32_t t : v.targets) {
        CHECK(covered.insert(t).second);
        CHECK(t == views[i].targets[0] ||
              std::find(seen[i].begin(), seen[i].end(), t) != seen[i].end());
      }
    }
    CHECK(covered == all);
  }
}
TEST(nothing_to_cover_and_lists_that_do_not_match) {
  CHECK(cover_viewpoints({}, {}).empty());
  const std::vector<Viewpoint> views{view({0})};
  CHECK_THROWS(Error, cover_viewpoints(views, {}));
}
}  // namespace
