// SPDX-License-Identifier: MIT
#include <surfleet/coverage/metric_field.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include <surfleet/coverage/surface_coverage.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// How long a short piece is at a vertex.
double length(const MetricField& field, std::size_t vertex, const Eigen::Vector3d& piece) {
  const FieldMetric metric(field.tensor, field.norm);
  const auto v = static_cast<std::int32_t>(vertex);
  return metric(v, v, piece);
}
/// A plate of n × n squares of this edge.
TriangleMesh plate(int n, double edge) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(edge * i, edge * j, 0.0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const std::int32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}
/// Where robots settle, and how long their regions are along x against y.
struct Settled {
  std::vector<Point3> robots;
  double elongation = 0.0;
};
Settled settle(const TriangleMesh& mesh, std::vector<std::int32_t> sites,
               const MetricField& field) {
  SurfaceCoverageOptions options;
  options.field = field;
  SurfaceCoverage<MeshGraph, EdgeGeodesic, WavefrontPropagation> cover(mesh, std::move(sites),
                                                                       options);
  while (!cover.converged() && cover.steps() < 2000) cover.step();
  CHECK(cover.converged());
  Settled result{cover.positions(), 0.0};
  const auto& region = cover.partition().region;
  Eigen::Vector3d square = Eigen::Vector3d::Zero();
  for (std::size_t r = 0; r < result.robots.size(); ++r) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0.0;
    for (std::size_t v = 0; v < region.size(); ++v)
      if (region[v] == static_cast<std::int32_t>(r)) {
        sum += mesh.vertices[v];
        count += 1.0;
      }
    for (std::size_t v = 0; v < region.size(); ++v)
      if (region[v] == static_cast<std::int32_t>(r))
        square += (mesh.vertices[v] - sum / count).cwiseAbs2();
  }
  result.elongation = std::sqrt(square.x() / square.y());
  return result;
}
}  // namespace

TEST(a_directional_field_counts_what_lies_across) {
  const TriangleMesh mesh = plate(2, 1.0);
  const Eigen::Vector3d along = Eigen::Vector3d(1, 2, 2) / 3.0, across = along.unitOrthogonal();
  const MetricField field = DirectionalField{7.0 * along, 3.0}(mesh);
  CHECK(field.tensor.size() == mesh.vertices.size() && field.density.empty());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    CHECK_NEAR(length(field, v, 0.5 * along), 0.5, 1e-12);
    CHECK_NEAR(length(field, v, 0.5 * across), 1.5, 1e-12);
    CHECK_NEAR(length(field, v, 3.0 * along + 4.0 * across), std::hypot(3.0, 12.0), 1e-12);
  }
  CHECK_THROWS(Error, DirectionalField{Eigen::Vector3d::Zero(), 2.0}(mesh));
}

TEST(a_curvature_field_is_dense_where_a_torus_bends) {
  constexpr double kRing = 3.0, kTube = 1.0, kUnit = 2.0;
  const TriangleMesh torus = make_torus({0, 0, 0}, kRing, kTube, 96, 48);
  const MetricField field = CurvatureField{kUnit}(torus);
  CHECK(field.density.size() == torus.vertices.size() && field.tensor.empty());
  double worst = 0.0;
  for (std::size_t v = 0; v < torus.vertices.size(); ++v) {
    const Point3& p = torus.vertices[v];
    const double out = p.head<2>().norm();
    const double k1 = 1.0 / kTube, k2 = (out - kRing) / (kTube * out);
    worst = std::max(worst, std::abs(field.density[v] - (1.0 + kUnit * std::hypot(k1, k2))));
  }
  CHECK(worst < 0.1);
}

TEST(a_principal_direction_field_stretches_along_a_tube) {
  TriangleMesh fine;  // rings of vertices up the tube, so that there are some away from its ends
  for (int k = 0; k <= 40; ++k)
    for (int i = 0; i < 48; ++i) {
      const double a = 2.0 * kPi * i / 48;
      fine.vertices.emplace_back(std::cos(a), std::sin(a), 0.2 * k);
    }
  for (int k = 0; k < 40; ++k)
    for (int i = 0; i < 48; ++i) {
      const std::int32_t a = 48 * k + i, b = 48 * k + (i + 1) % 48, c = a + 48, d = b + 48;
      fine.triangles.push_back({a, b, d});
      fine.triangles.push_back({a, d, c});
    }
  const MetricField field = PrincipalDirectionField{3.0}(fine);
  CHECK(field.tensor.size() == fine.vertices.size());
  for (std::size_t v = 48 * 10; v < 48 * 30; ++v) {
    const Point3& p = fine.vertices[v];
    const Eigen::Vector3d round(-p.y(), p.x(), 0.0);
    CHECK_NEAR(length(field, v, round), 3.0, 0.05);
    CHECK_NEAR(length(field, v, Eigen::Vector3d::UnitZ()), 1.0, 0.02);
  }
  CHECK_THROWS(Error, PrincipalDirectionField{0.5}(fine));
}

TEST(other_norms_are_those_of_the_transformed_piece) {
  const TriangleMesh mesh = plate(1, 1.0);
  MetricField field = DirectionalField{Eigen::Vector3d::UnitX(), 2.0}(mesh);
  field.norm = 1.0;
  CHECK_NEAR(length(field, 0, {3, 4, 0}), 3.0 + 8.0, 1e-9);
  field.norm = 3.0;
  CHECK_NEAR(length(field, 0, {3, 4, 0}), std::cbrt(27.0 + 512.0), 1e-9);
  field.tensor.clear();
  CHECK_NEAR(length(field, 0, {3, 4, 0}), std::cbrt(27.0 + 64.0), 1e-9);
}

TEST(robots_settle_as_the_field_says) {
  const TriangleMesh mesh = plate(24, 0.25);
  const std::vector<std::int32_t> start{0, 5, 130, 200, 320, 400};
  const Settled even = settle(mesh, start, UniformField{}(mesh));
  const Settled wide = settle(mesh, start, DirectionalField{Eigen::Vector3d::UnitX(), 4.0}(mesh));
  const Settled high = settle(mesh, start, DirectionalField{Eigen::Vector3d::UnitY(), 4.0}(mesh));
  CHECK(even.elongation > 0.6 && even.elongation < 1.6);
  CHECK(wide.elongation > 2.0 && high.elongation < 0.5);
  // Dense on one half: most robots go there.
  MetricField left;
  for (const Point3& p : mesh.vertices) left.density.push_back(p.x() < 1.5 ? 40.0 : 1.0);
  const auto on_the_left = [](const Settled& s) {
    return std::count_if(s.robots.begin(), s.robots.end(),
                         [](const Point3& p) { return p.x() < 2.0; });
  };
  CHECK(on_the_left(settle(mesh, start, left)) > on_the_left(even) + 1);
}
