// SPDX-License-Identifier: MIT
#include <surfleet/coverage/hybrid_area_coverage.hpp>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(everything_is_swept_and_the_work_is_even) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.05});
  const auto result = hybrid_area_coverage(mesh, {3, 70, 400, 900, 1100});
  CHECK(result.complete && result.covered == 1.0 && result.iterations.size() == 1);
  CHECK(result.balance() < 1.12);
}

TEST(short_sweeps_are_repeated_until_done) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.1, .hole = true});
  HybridSurfaceOptions options;
  options.sweep_range = 2.0;
  double last = 0.0;
  const auto result =
      hybrid_area_coverage(mesh, {3, 70, 200}, options, VertexExchange{}, [&](double covered) {
        CHECK(covered > last);
        last = covered;
      });
  CHECK(result.complete && result.iterations.size() > 1);
  for (const auto& it : result.iterations)
    for (const CoveringStrip& s : it.strips) CHECK(s.length() <= 2.0 + 1e-9);
}

TEST(robots_relocate_over_covered_ground_where_they_can) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.1, .hole = true});
  double least_detour = 0.0;
  for (const double unknown_cost : {1.0, 5.0}) {
    HybridSurfaceOptions options;
    options.sweep_range = 2.0;
    options.unknown_cost = unknown_cost;
    const auto result = hybrid_area_coverage(mesh, {3, 70, 200}, options);
    CHECK(result.complete && result.iterations.size() > 2);
    std::vector<char> open(mesh.triangles.size(), 1);
    std::vector<std::int32_t> at{3, 70, 200};
    double detour = 0.0;
    for (const HybridSurfaceIteration& it : result.iterations) {
      const SurfaceGraph& ground = *it.regions.dual;
      const std::size_t n = ground.size();
      for (std::size_t r = 0; r < at.size(); ++r) {
        if (it.transfers[r].empty()) continue;
        // Bellman and Ford, until nothing gets shorter: by weight, and by length alone.
        const auto distances = [&](double cost) {
          std::vector<double> d(n, 1e300);
          d[static_cast<std::size_t>(at[r])] = 0.0;
          for (bool shorter = true; shorter;) {
            shorter = false;
            for (std::size_t t = 0; t < n; ++t)
              for (const Arc& arc : ground.links.arcs(static_cast<std::int32_t>(t))) {
                const auto to = static_cast<std::size_t>(arc.to);
                const double via = d[t] + arc.length * (open[to] != 0 ? cost : 1.0);
                if (via >= d[to] - 1e-12) continue;
                d[to] = via;
                shorter = true;
              }
          }
          return d;
        };
        double weight = 0.0, length = 0.0;
        std::int32_t from = at[r];
        for (std::size_t k = 1; k < it.transfers[r].size(); ++k) {
          bool linked = false;
          for (const Arc& arc : ground.links.arcs(from)) {
            const auto to = static_cast<std::size_t>(arc.to);
            if (linked || ground.position[to] != it.transfers[r][k]) continue;
            length += arc.length;
            weight += arc.length * (open[to] != 0 ? unknown_cost : 1.0);
            from = arc.to;
            linked = true;
          }
          CHECK(linked);
        }
        CHECK(from == it.regions.start[r]);
        const auto goal = static_cast<std::size_t>(from);
        CHECK_NEAR(weight, distances(unknown_cost)[goal], 1e-9);
        CHECK_NEAR(length, it.transfer_length[r], 1e-9);
        detour += length - distances(1.0)[goal];
      }
      for (std::size_t r = 0; r < at.size(); ++r)
        if (!it.strips[r].triangles.empty()) at[r] = it.strips[r].triangles.back();
      for (const CoveringStrip& strip : it.strips)
        for (const std::int32_t t : strip.triangles) open[static_cast<std::size_t>(t)] = 0;
    }
    if (unknown_cost == 1.0) {
      CHECK_NEAR(detour, 0.0, 1e-6);
    } else {
      least_detour = detour;
    }
  }
  CHECK(least_detour > 0.1);  // the weight makes a difference
  HybridSurfaceOptions cheap;
  cheap.unknown_cost = 0.5;
  CHECK_THROWS(Error, hybrid_area_coverage(mesh, {3}, cheap));
}

TEST(robots_fail_and_join) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.1});
  HybridSurfaceOptions options;
  options.sweep_range = 3.0;
  options.events = {{0, 1, 0}, {1, -1, 12}, {1, 2, 0}};
  const auto result = hybrid_area_coverage(mesh, {3, 70, 200}, options);
  CHECK(result.complete);
  CHECK(result.swept_length.size() == 4);
  CHECK(result.swept_length[3] > 0.0);
  for (std::size_t k = 1; k < result.iterations.size(); ++k)
    CHECK(result.iterations[k].strips[1].triangles.empty());
  // With every robot gone the rest stays open, and that is said.
  options.events = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}};
  const auto failed = hybrid_area_coverage(mesh, {3, 70, 200}, options);
  CHECK(!failed.complete && failed.covered > 0.1 && failed.covered < 0.9);
}

TEST(other_coordinators_and_separate_parts) {
  TriangleMesh two = bumpy_slope({.edge = 0.2});
  const auto half = static_cast<std::int32_t>(two.triangles.size());
  append(two, transformed(two, Pose(Eigen::Translation3d(5, 0, 0))));
  const auto result = hybrid_area_coverage(two, {3, half + 2, 20}, {}, WavefrontPropagation{});
  CHECK(result.complete);
  CHECK(!hybrid_area_coverage(two, {3, 20}).complete);  // no robot on the second part
  CHECK_THROWS(Error, hybrid_area_coverage(two, {3, 3}));
  CHECK_THROWS(Error, hybrid_area_coverage(two, {}));
  CHECK_THROWS(Error, hybrid_area_coverage(two, {100000}));
}
}  // namespace
