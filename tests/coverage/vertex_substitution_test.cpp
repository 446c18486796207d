// SPDX-License-Identifier: MIT
#include <surfleet/coverage/vertex_substitution.hpp>

#include <surfleet/coverage/p_median_bound.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"
#include "deployment_laws.hpp"

namespace {
using namespace surfleet;

TEST(substitution_beats_the_others_and_respects_the_bound) {
  const TriangleMesh slope = bumpy_slope({.edge = 0.1});
  const SurfaceGraph graph = MeshGraph{}(slope, EdgeGeodesic{});
  const PMedianProblem problem = p_median_problem(graph);
  const PMedianBound bound = bound_p_median(problem, 6, 2, 30, 3);
  CHECK(bound.lower > 0.8 * bound.best && bound.lower <= bound.best);
  CHECK_NEAR(surface_cost(graph, bound.chosen), bound.best, 1e-9);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SurfaceCoverageOptions options;
    options.seed = seed;
    const double ours = run<MeshGraph, EdgeGeodesic, VertexSubstitution>(slope, 6, options);
    const double wave = run<MeshGraph, EdgeGeodesic, WavefrontPropagation>(slope, 6, options);
    CHECK(ours >= bound.lower);
    CHECK(ours <= wave + 1e-12);
    CHECK(ours < 1.02 * bound.best);
  }
}

TEST(substitution_on_a_sampled_surface) {
  const TriangleMesh ball = make_sphere(Point3::Zero(), 1.0, 4);
  VertexSubstitution coordinator;
  coordinator.full = 400;
  coordinator.perturbations = 3;
  SurfaceCoverageOptions options;
  const double ours =
      run<MeshGraph, EdgeGeodesic, VertexSubstitution>(ball, 6, options, coordinator);
  CHECK(ours < run<MeshGraph, EdgeGeodesic, WavefrontPropagation>(ball, 6, options) * 1.01);
}

TEST(bounds_against_enumeration) {
  const SurfaceGraph graph = MeshGraph{}(bumpy_slope({.edge = 0.3}), EdgeGeodesic{});
  const PMedianProblem problem = p_median_problem(graph);
  const auto n = static_cast<std::int32_t>(graph.size());
  double best = 1e9;
  for (std::int32_t a = 0; a < n; ++a)
    for (std::int32_t b = 0; b < a; ++b)
      best = std::min(best, PMedianSolution(problem, {a, b}).cost());
  const PMedianBound bound = bound_p_median(problem, 2, 3, 10, 1);
  CHECK_NEAR(bound.best, best, 1e-12);
  CHECK(bound.lower <= best + 1e-12 && bound.lower > 0.9 * best);
}
}  // namespace
