// SPDX-License-Identifier: MIT
/// @file
/// @brief Random clusters and robots for the tests of this room.
#pragma once

#include <cstdint>
#include <vector>

#include <surfleet/allocation/cluster_graph.hpp>
#include <surfleet/core/random.hpp>

namespace allocation_test {
using namespace surfleet;
using Clusters = std::vector<ConfigurationCluster<Point3>>;

inline Point3 random_point(Random& random, const Point3& extent) {
  return {random.uniform(0, extent.x()), random.uniform(0, extent.y()),
          random.uniform(0, extent.z())};
}

/// `count` clusters of one to `most` configurations, about centres in a box from 0 to `extent`.
inline Clusters random_clusters(Random& random, const Point3& extent, int count, int most) {
  Clusters clusters(count);
  for (auto& c : clusters) {
    c.gain = random.uniform(0.01, 0.3);
    const Point3 centre = random_point(random, extent);
    const int n = 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(most)));
    for (int k = 0; k < n; ++k)
      c.configurations.push_back(centre +
                                 Point3{random.normal(), random.normal(), random.normal()});
  }
  return clusters;
}

/// Robots on the floor of that box.
inline std::vector<Point3> random_starts(Random& random, const Point3& extent, int count) {
  std::vector<Point3> starts;
  for (int r = 0; r < count; ++r)
    starts.push_back(random_point(random, {extent.x(), extent.y(), 0.0}));
  return starts;
}
}  // namespace allocation_test
