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
  CHECK(!hybrid_area_coverage(two, {3, 20}).complete);  // nobody on the second part
  CHECK_THROWS(Error, hybrid_area_coverage(two, {3, 3}));
  CHECK_THROWS(Error, hybrid_area_coverage(two, {}));
  CHECK_THROWS(Error, hybrid_area_coverage(two, {100000}));
}
}  // namespace
