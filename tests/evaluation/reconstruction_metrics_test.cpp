// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/reconstruction_metrics.hpp>

#include <cmath>

#include <surfleet/core/random.hpp>

#include "check.hpp"
#include "test_shapes.hpp"

using namespace surfleet;

namespace {
/// The part of a mesh whose triangles' centroids have positive z.
TriangleMesh upper_half(const TriangleMesh& mesh) {
  TriangleMesh half;
  half.vertices = mesh.vertices;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (mesh.centroid(t).z() > 0.0) half.triangles.push_back(mesh.triangles[t]);
  return half;
}
}  // namespace

TEST(a_mesh_against_itself) {
  const TriangleMesh mesh = test_shapes::sphere(1.0, 4);
  const auto e = evaluate(mesh, mesh, {.e_max = 0.1, .density = 300});
  CHECK(e.metrics.surface_coverage == 1.0);
  CHECK_NEAR(e.metrics.rmse_m, 0.0, 1e-9);
  CHECK_NEAR(e.metrics.completeness_mean_m, 0.0, 1e-9);
  CHECK_NEAR(e.metrics.accuracy_p95_m, 0.0, 1e-9);
}

TEST(half_a_sphere_covers_half_and_a_belt) {
  const double radius = 2.0, e_max = 0.1;
  const TriangleMesh sphere = test_shapes::sphere(radius, 5);
  const auto e = evaluate(sphere, upper_half(sphere), {.e_max = e_max, .density = 200});
  // Below the equator a belt is within e_max: chord e_max is an arc of 2 asin(e_max / 2r), and a
  // belt of height h has area 2πrh.
  const double belt = radius * std::sin(2.0 * std::asin(0.5 * e_max / radius));
  CHECK_NEAR(e.metrics.surface_coverage, 0.5 + belt / (2.0 * radius), 0.003);
  // The farthest missing point is the south pole, √2 r from the equator.
  CHECK_NEAR(*std::max_element(e.reference_distance.begin(), e.reference_distance.end()),
             std::sqrt(2.0) * radius, 0.06);
  CHECK_NEAR(e.metrics.accuracy_mean_m, 0.0, 1e-9);
}

TEST(concentric_spheres_differ_by_their_radii) {
  const TriangleMesh small = test_shapes::sphere(2.0, 5), large = test_shapes::sphere(2.05, 5);
  const EvaluationOptions o{.e_max = 0.1, .density = 700};
  const auto out = evaluate(small, large, o), in = evaluate(large, small, o);
  CHECK_NEAR(out.metrics.m3c2_mean_m, 0.05, 0.002);
  CHECK_NEAR(in.metrics.m3c2_mean_m, -0.05, 0.002);
  CHECK(out.metrics.m3c2_std_m < 0.002);
  CHECK_NEAR(out.metrics.completeness_mean_m, 0.05, 0.002);
  CHECK_NEAR(out.metrics.accuracy_p95_m, 0.05, 0.002);
  CHECK(out.metrics.surface_coverage == 1.0);
  EvaluationOptions strict = o;
  strict.e_max = 0.04;
  CHECK(evaluate(small, large, strict).metrics.surface_coverage == 0.0);
}

TEST(noise_of_vertices_shows_as_spread) {
  const TriangleMesh flat = test_shapes::plane(6.0, 60, 0.0);
  TriangleMesh rough = flat;
  Random random(5);
  for (Point3& v : rough.vertices) v.z() += 0.03 * random.normal();
  // A cylinder much narrower than a cell sees the interpolated noise itself, whose variance is on
  // average half that of the vertices on a triangle.
  const auto e = evaluate(
      flat, rough, {.e_max = 0.3, .density = 2500, .projection_scale = 0.04, .max_depth = 0.2});
  CHECK_NEAR(e.metrics.m3c2_mean_m, 0.0, 0.001);
  CHECK_NEAR(e.metrics.rmse_m, 0.03 * std::sqrt(0.5), 0.002);
}

TEST(pruning_cuts_outliers_as_the_seeds_do) {
  TriangleMesh truth = test_shapes::plane(4.0, 8, 0.0), wrong = test_shapes::plane(4.0, 8, 0.01);
  for (Point3& v : wrong.vertices)
    if (v.x() > 0.6) v.z() = 0.15;
  const auto e = evaluate(truth, wrong, {.e_max = 0.1, .density = 400, .max_depth = 0.3});
  CHECK(e.metrics.rmse_m < 0.05 && e.metrics.unpruned_rmse_m > 0.07);
  CHECK(e.metrics.surface_coverage > 0.5 && e.metrics.surface_coverage < 0.8);
}

TEST(empty_reconstruction_and_bad_settings) {
  const TriangleMesh plane = test_shapes::plane(2.0, 2, 0.0);
  const auto e = evaluate(plane, TriangleMesh{}, {.e_max = 0.1});
  CHECK(e.metrics.surface_coverage == 0.0 && std::isnan(e.metrics.rmse_m));
  CHECK(std::isnan(e.metrics.completeness_mean_m) && std::isnan(e.metrics.accuracy_mean_m));
  const auto capped = evaluate(plane, TriangleMesh{}, {.e_max = 0.1, .max_distance = 1.0});
  CHECK(capped.metrics.completeness_mean_m == 1.0);
  CHECK_THROWS(Error, evaluate(TriangleMesh{}, plane, {}));
  CHECK_THROWS(Error, evaluate(plane, plane, {.e_max = 0.0, .density = 10, .projection_scale = 1}));
}

TEST(clouds_are_measured_by_their_points) {
  const TriangleMesh plane = test_shapes::plane(2.0, 4, 0.0);
  const EvaluationOptions o{.e_max = 0.1, .density = 2000};
  PointCloud shifted = sample_surface(plane, {.density = 2000, .seed = 9}).cloud;
  for (Point3& p : shifted.points) p.z() += 0.02;
  const auto e = evaluate(sample_surface(plane, {.density = 100}).cloud,
                          MeasuredSurface::from(plane, o), MeasuredSurface::from(shifted), o);
  CHECK(e.metrics.surface_coverage == 1.0);
  CHECK_NEAR(e.metrics.m3c2_mean_m, 0.02, 1e-9);
}

TEST(a_sheet_has_two_sides_to_cover) {
  const TriangleMesh sheet = test_shapes::plane(4.0, 8, 0.0);
  TriangleMesh one_side = test_shapes::plane(4.0, 8, 0.02), both = one_side;
  TriangleMesh under = test_shapes::plane(4.0, 8, -0.02);
  for (Triangle& t : under.triangles) std::swap(t[1], t[2]);
  append(both, under);
  const EvaluationOptions o{.e_max = 0.1, .density = 1000};
  const PointCloud samples = with_both_sides(sample_surface(sheet, {.density = 50}).cloud);
  const MeasuredSurface truth = MeasuredSurface::from(sheet, o);
  const auto of = [&](const TriangleMesh& mesh) {
    return evaluate(samples, truth, MeasuredSurface::from(mesh, o), o);
  };
  CHECK(of(one_side).metrics.surface_coverage == 0.5);
  CHECK(of(one_side).metrics.unsided_coverage == 1.0);
  const auto e = of(both);
  CHECK(e.metrics.surface_coverage == 1.0);
  // Both faces stand 2 cm before the sheet, and are not averaged to nothing.
  CHECK_NEAR(e.metrics.m3c2_mean_m, 0.02, 1e-6);
  CHECK_NEAR(e.metrics.m3c2_std_m, 0.0, 1e-6);
  CHECK(e.metrics.m3c2_coverage() > 0.99);
  // What faces away covers nothing, unless sides are not asked for.
  EvaluationOptions any = o;
  any.sided = false;
  const PointCloud front = sample_surface(sheet, {.density = 50}).cloud;
  CHECK(evaluate(front, truth, MeasuredSurface::from(under, o), o).metrics.surface_coverage == 0.0);
  CHECK(evaluate(front, truth, MeasuredSurface::from(under, o), any).metrics.surface_coverage ==
        1.0);
}

TEST(signed_distances_know_inside_from_outside) {
  const TriangleMesh sphere = test_shapes::sphere(1.0, 5);
  const std::vector<Point3> p{{1.1, 0, 0}, {0.8, 0, 0}, {5, 0, 0}};
  const auto d = signed_distances(p, sphere, Bvh(sphere), 1.0);
  CHECK_NEAR(d[0], 0.1, 1e-3);
  CHECK_NEAR(d[1], -0.2, 1e-3);
  CHECK(std::isnan(d[2]));
}
