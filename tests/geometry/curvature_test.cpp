// SPDX-License-Identifier: MIT
#include <surfleet/geometry/curvature.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TriangleMesh ring_grid(int around, int across, double major, double minor) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * kPi * i / around, v = 2.0 * kPi * j / across;
      const double r = major + minor * std::cos(v);
      mesh.vertices.push_back({r * std::cos(u), r * std::sin(u), minor * std::sin(v)});
    }
  const auto id = [&](int i, int j) { return (i % around) * across + j % across; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j)
      mesh.triangles.insert(mesh.triangles.end(), {{id(i, j), id(i + 1, j), id(i + 1, j + 1)},
                                                   {id(i, j), id(i + 1, j + 1), id(i, j + 1)}});
  return mesh;
}

TEST(torus_has_the_curvature_of_its_formula) {
  const double major = 2.0, minor = 0.7;
  const TriangleMesh mesh = ring_grid(160, 80, major, minor);
  const auto curvature = principal_curvatures(mesh);
  double worst = 0.0, direction = 0.0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Point3& p = mesh.vertices[v];
    const double rho = std::hypot(p.x(), p.y());
    const double k_minor = 1.0 / minor, k_major = (rho - major) / minor / rho;
    worst =
        std::max({worst, std::abs(curvature[v].k1 - k_minor), std::abs(curvature[v].k2 - k_major)});
    const Eigen::Vector3d around = Eigen::Vector3d(-p.y(), p.x(), 0).normalized();
    direction = std::max(direction, std::abs(curvature[v].direction1.dot(around)));
  }
  CHECK(worst < 0.05);
  CHECK(direction < 0.1);
}

TEST(areas_sum_to_the_mesh) {
  TriangleMesh mesh = ring_grid(12, 7, 2.0, 0.9);
  mesh.vertices[5] += Point3(0.3, -0.2, 0.4);
  double sum = 0.0;
  for (const double a : mixed_vertex_areas(mesh)) {
    CHECK(a > 0.0);
    sum += a;
  }
  CHECK_NEAR(sum, mesh.area(), 1e-9);
}

TEST(borders_and_slivers_stay_finite) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {9, 9, 9}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 1, 2}};
  for (const Curvature& c : principal_curvatures(mesh)) {
    CHECK(std::isfinite(c.k1) && std::isfinite(c.k2) && c.direction1.allFinite());
    CHECK(c.k1 == 0.0 && c.k2 == 0.0);
  }
}
}  // namespace
