// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/oriented_coverage.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/evaluation/surface_sampling.hpp>

#include "check.hpp"
#include "test_shapes.hpp"

using namespace surfleet;

namespace {
Eigen::Vector3d draw(Random& random, double scale) {
  return {random.uniform(-scale, scale), random.uniform(-scale, scale),
          random.uniform(-scale, scale)};
}
}  // namespace

TEST(coverage_of_a_soup_by_its_definition) {
  Random random(4);
  TriangleMesh mesh;
  for (int i = 0; i < 200; ++i) {
    const Point3 p = draw(random, 2.0);
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(p + draw(random, 0.4));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.triangles.push_back({0, 0, 1});  // faces nowhere
  PointCloud samples, points;
  for (int i = 0; i < 500; ++i) {
    samples.points.push_back(draw(random, 2.5));
    samples.normals.push_back(draw(random, 1.0).normalized().cast<float>());
    points.points.push_back(draw(random, 2.5));
    points.normals.push_back(draw(random, 1.0).normalized().cast<float>());
  }
  const double e_max = 0.35;
  std::size_t by_mesh = 0, by_points = 0, by_bare = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Point3& p = samples.points[i];
    const Eigen::Vector3d side = samples.normals[i].cast<double>();
    bool mesh_near = false, point_near = false, bare_near = false;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      mesh_near =
          mesh_near ||
          (mesh.area_vector(t).dot(side) > 0.0 &&
           (closest_on_triangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)) - p)
                   .norm() <= e_max);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if ((points.points[k] - p).norm() > e_max) continue;
      bare_near = true;
      point_near = point_near || points.normals[k].cast<double>().dot(side) > 0.0;
    }
    by_mesh += mesh_near ? 1 : 0;
    by_points += point_near ? 1 : 0;
    by_bare += bare_near ? 1 : 0;
  }
  PointCloud bare = points;
  bare.normals.clear();
  const OrientedCoverageOptions o{.e_max = e_max};
  CHECK(by_mesh > 50 && by_mesh < 450 && by_points > 50 && by_points < by_bare);
  CHECK(oriented_coverage(samples, OrientedSurface(mesh), o).covered == by_mesh);
  CHECK(oriented_coverage(samples, OrientedSurface(points), o).covered == by_points);
  CHECK(oriented_coverage(samples, OrientedSurface(bare), o).covered == by_bare);
  OrientedCoverageOptions two = o;
  two.threads = 2;
  two.reach = 2.0;
  const auto far = oriented_coverage(samples, OrientedSurface(mesh), two);
  CHECK(far.covered == by_mesh);
  CHECK(std::count_if(far.distance.begin(), far.distance.end(),
                      [](double d) { return d > 0.35 && d <= 2.0; }) > 100);
}

TEST(the_other_face_of_a_thin_wall_does_not_count) {
  // A wall of 10 cm of which only the upper face was reconstructed.
  const TriangleMesh wall = test_shapes::box({-2, -2, -0.05}, {2, 2, 0.05});
  const TriangleMesh upper = test_shapes::plane(4.0, 4, 0.05);
  const auto samples = sample_surface(wall, {.density = 60}).cloud;
  const auto c = oriented_coverage(samples, OrientedSurface(upper), {.e_max = 0.26});
  for (std::size_t i = 0; i < samples.size(); ++i)
    CHECK((c.distance[i] <= 0.26) == (samples.normals[i].z() > 0.5F));
  PointCloud bare = samples;
  bare.normals.clear();
  CHECK(oriented_coverage(bare, OrientedSurface(upper), {.e_max = 0.26}).share() == 1.0);
}

TEST(both_sides_of_a_sheet_are_two_samples) {
  const TriangleMesh sheet = test_shapes::plane(2.0, 2, 0.0);
  const auto samples = sample_surface(sheet, {.density = 40}).cloud;
  const PointCloud both = with_both_sides(samples);
  CHECK(both.size() == 2 * samples.size());
  const OrientedSurface front(sheet);
  CHECK(oriented_coverage(samples, front, {.e_max = 0.1}).share() == 1.0);
  CHECK(oriented_coverage(both, front, {.e_max = 0.1}).share() == 0.5);
}

TEST(nothing_covers_nothing_and_bad_settings_are_refused) {
  const auto samples = sample_surface(test_shapes::plane(2.0, 2, 0.0), {.density = 5}).cloud;
  for (const OrientedSurface& nothing :
       {OrientedSurface(), OrientedSurface(TriangleMesh{}), OrientedSurface(PointCloud{})}) {
    CHECK(oriented_coverage(samples, nothing).share() == 0.0);
    CHECK(std::isinf(nothing.distance(Point3::Zero())));
  }
  CHECK(oriented_coverage({}, OrientedSurface()).share() == 0.0);
  CHECK_THROWS(Error, oriented_coverage(samples, OrientedSurface(), {.e_max = 0.0}));
  PointCloud bare;
  bare.points = {Point3::Zero()};
  CHECK_THROWS(Error, with_both_sides(bare));
}
