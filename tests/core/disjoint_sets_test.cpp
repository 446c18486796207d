// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <vector>

#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(sets_are_what_labels_carried_along_say) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const std::int32_t n = 40;
    DisjointSets sets;
    std::vector<std::int32_t> label;
    for (std::int32_t i = 0; i < n; ++i) {
      sets.add();
      label.push_back(i);
    }
    for (int link = 0; link < 30; ++link) {
      const auto a = static_cast<std::int32_t>(random() % n);
      const auto b = static_cast<std::int32_t>(random() % n);
      const std::int32_t la = label[static_cast<std::size_t>(a)],
                         lb = label[static_cast<std::size_t>(b)];
      CHECK(sets.unite(a, b) == (la != lb));
      for (std::int32_t& l : label)
        if (l == la || l == lb) l = std::min(la, lb);
      for (std::int32_t i = 0; i < n; i += 7)
        CHECK(sets.find(i) == label[static_cast<std::size_t>(i)]);
    }
    CHECK(sets.size() == label.size());
    CHECK(sets.flattened() == label);
  }
}
}  // namespace
