// SPDX-License-Identifier: MIT
#include <surfleet/coverage/surface_coverage.hpp>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"
#include "deployment_laws.hpp"

namespace {
using namespace surfleet;

TEST(every_combination_deploys) {
  const TriangleMesh slope = bumpy_slope({.edge = 0.1});
  VertexExchange four_rounds;
  four_rounds.rounds = 4;
  VertexSubstitution few_perturbations;
  few_perturbations.perturbations = 5;
  for (const bool asynchronous : {false, true})
    for (const double sensing : {1e300 * 1e300, 0.5}) {
      SurfaceCoverageOptions options;
      options.asynchronous = asynchronous;
      options.sensing_range = sensing;
      options.seed = 5;
      run<MeshGraph, EdgeGeodesic, WavefrontPropagation>(slope, 5, options);
      run<MeshGraph, FaceGeodesic, WavefrontPropagation>(slope, 5, options);
      run<DualMeshGraph, EdgeGeodesic, VertexExchange>(slope, 5, options);
      run<MeshGraph, EdgeGeodesic, VertexExchange>(slope, 5, options, four_rounds);
      run<MeshGraph, EdgeGeodesic, VertexSubstitution>(slope, 5, options, few_perturbations);
    }
}

TEST(bad_robots_are_refused) {
  using Cover = SurfaceCoverage<MeshGraph, EdgeGeodesic, WavefrontPropagation>;
  const TriangleMesh slope = bumpy_slope({.edge = 0.6});
  const std::size_t n = slope.vertices.size();
  CHECK_THROWS(Error, Cover(slope, std::vector<std::int32_t>(n + 1, 0)));
  CHECK_THROWS(Error, Cover(slope, std::vector<std::int32_t>{}));
  CHECK_THROWS(Error, Cover(slope, std::vector<std::int32_t>{2, 2}));
  CHECK_THROWS(Error, random_robot_sites(MeshGraph{}(slope, EdgeGeodesic{}), n + 1, 1));
  const std::vector<Point3> far{{9, 9, 9}};
  CHECK_THROWS(Error, Cover(slope, std::span<const Point3>(far)));
  // One robot a vertex is the limit, and converges at once.
  std::vector<std::int32_t> all(n);
  for (std::size_t i = 0; i < n; ++i) all[i] = static_cast<std::int32_t>(i);
  Cover full(slope, all);
  full.step();
  CHECK(full.converged() && full.cost() == 0.0);
  TriangleMesh two = slope;
  append(two, transformed(slope, Pose(Eigen::Translation3d(5, 0, 0))));
  CHECK_THROWS(Error, Cover(two, std::vector<std::int32_t>{0}));
  SurfaceCoverageOptions lenient;
  lenient.allow_unreached = true;
  CHECK(Cover(two, std::vector<std::int32_t>{0}, lenient).partition().region[n] == -1);
}
}  // namespace
