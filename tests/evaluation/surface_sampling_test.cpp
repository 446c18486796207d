// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/surface_sampling.hpp>

#include <limits>

#include "check.hpp"
#include "test_shapes.hpp"

using namespace surfleet;

TEST(samples_are_uniform_by_area) {
  // Two squares of 1 m² and 9 m², the larger cut into very unequal triangles.
  TriangleMesh mesh = test_shapes::plane(1.0, 1, 0.0);
  TriangleMesh large = test_shapes::plane(3.0, 7, 5.0);
  append(mesh, large);
  const SurfaceSamples s = sample_surface(mesh, {.density = 500.0, .seed = 3});
  CHECK(s.size() == 5000);
  CHECK_NEAR(s.area_per_sample * static_cast<double>(s.size()), mesh.area(), 1e-9);
  std::size_t low = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Point3& p = s.cloud.points[i];
    if (p.z() < 1.0)
      ++low;
    else
      mean += p;
    CHECK(std::abs(p.z()) < 1e-12 || std::abs(p.z() - 5.0) < 1e-12);
    CHECK_NEAR(s.cloud.normals[i].z(), 1.0, 1e-6);
  }
  CHECK(low >= 498 && low <= 502);
  mean /= static_cast<double>(s.size() - low);
  CHECK_NEAR(mean.x(), 0.0, 0.03);
  CHECK_NEAR(mean.y(), 0.0, 0.03);
}

TEST(samples_fill_without_large_gaps) {
  const TriangleMesh mesh = test_shapes::plane(1.0, 1, 0.0);
  const SurfaceSamples s = sample_surface(mesh, {.density = 400.0});
  // No empty cell in a grid of 8 x 8 with 6 samples a cell on average.
  std::vector<int> cells(64, 0);
  for (const Point3& p : s.cloud.points)
    ++cells[static_cast<std::size_t>(std::min(7.0, (p.x() + 0.5) * 8)) * 8 +
            static_cast<std::size_t>(std::min(7.0, (p.y() + 0.5) * 8))];
  for (const int n : cells) CHECK(n > 0);
}

TEST(samples_repeat_and_differ_by_seed) {
  const TriangleMesh mesh = test_shapes::sphere(1.0, 2);
  const auto a = sample_surface(mesh, {.density = 30, .seed = 5});
  const auto b = sample_surface(mesh, {.density = 30, .seed = 5});
  const auto c = sample_surface(mesh, {.density = 30, .seed = 6});
  CHECK(a.cloud.points == b.cloud.points && a.triangles == b.triangles);
  CHECK(a.cloud.points != c.cloud.points);
}

TEST(sampling_survives_what_has_no_area) {
  CHECK(sample_surface({}, {}).size() == 0);
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 0, 1}};
  CHECK(sample_surface(mesh, {}).size() == 0);
  mesh.triangles.push_back({0, 1, 3});
  const auto s = sample_surface(mesh, {.density = 0.1});
  CHECK(s.size() == 1 && s.triangles[0] == 2);
}

TEST(sampling_refuses_bad_densities) {
  const TriangleMesh mesh = test_shapes::plane(1.0, 1, 0.0);
  CHECK_THROWS(Error, sample_surface(mesh, {.density = 0.0}));
  CHECK_THROWS(Error, sample_surface(mesh, {.density = std::nan("")}));
  CHECK_THROWS(Error, sample_surface(mesh, {.density = 1e12}));
}

TEST(selection_keeps_what_is_marked) {
  const auto s = sample_surface(test_shapes::plane(1.0, 1, 0.0), {.density = 10});
  std::vector<std::uint8_t> keep(s.size(), 0);
  keep[3] = 1;
  const auto one = select(s, keep);
  CHECK(one.size() == 1 && one.cloud.points[0] == s.cloud.points[3]);
  CHECK_THROWS(Error, select(s, {}));
}
