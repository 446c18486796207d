// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/m3c2.hpp>

#include <cmath>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
/// Points spread over a square of the given side at height z, with normal noise along z.
PointCloud noisy_plane(std::size_t n, double side, double z, double noise, std::uint64_t seed) {
  Random random(seed);
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i)
    cloud.points.emplace_back(side * (random.uniform() - 0.5), side * (random.uniform() - 0.5),
                              z + noise * random.normal());
  return cloud;
}
/// The definition, in the plainest words.
double brute_force_distance(const Point3& p, const Eigen::Vector3d& n, const PointCloud& a,
                            const PointCloud& b, double radius, double depth) {
  double mean[2] = {0, 0};
  const PointCloud* clouds[2] = {&a, &b};
  for (int k = 0; k < 2; ++k) {
    std::size_t count = 0;
    for (const Point3& x : clouds[k]->points) {
      const double s = (x - p).dot(n);
      if (std::abs(s) > depth || (x - p - s * n).norm() > radius) continue;
      mean[k] += s;
      ++count;
    }
    mean[k] /= static_cast<double>(count);
  }
  return mean[1] - mean[0];
}
}  // namespace

TEST(parallel_planes_at_known_offset) {
  const double offset = 0.07, noise = 0.02;
  const PointCloud a = noisy_plane(20000, 10.0, 0.0, noise, 1);
  const PointCloud b = noisy_plane(20000, 10.0, offset, noise, 2);
  PointCloud core = noisy_plane(500, 8.0, 0.0, 0.0, 3);
  core.normals.assign(core.size(), Eigen::Vector3f::UnitZ());
  const M3C2Result r = m3c2(core, a, b, {.projection_scale = 0.5, .max_depth = 0.5});
  // About 39 points a cylinder: each distance has deviation noise * sqrt(2 / 39).
  CHECK(r.statistics.count == core.size());
  CHECK_NEAR(r.statistics.mean, offset, 0.001);
  CHECK_NEAR(r.statistics.deviation, noise * std::sqrt(2.0 / 39.3), 0.0008);
  CHECK_NEAR(r.statistics.rmse, std::hypot(r.statistics.mean, r.statistics.deviation), 1e-12);
  double lod = 0.0;
  for (const double v : r.level_of_detection) lod += v / static_cast<double>(core.size());
  CHECK_NEAR(lod, 1.96 * noise * std::sqrt(2.0 / 39.3), 0.0006);
  CHECK(r.significant == core.size());
}

TEST(every_point_counts_once_wherever_the_cylinder_is_cut) {
  // A core point of the reference itself lies where two slabs meet.
  PointCloud reference, compared, core;
  reference.points = {{0, 0, 0}, {0.01, 0, 0.03}};
  compared.points = {{0, 0, 0.06}};
  core.points = {{0, 0, 0}};
  core.normals = {Eigen::Vector3f::UnitZ()};
  for (int d = 5; d <= 60; d += 5)
    for (int depth = 10; depth <= 200; depth += 5) {
      const M3C2Result r = m3c2(core, reference, compared,
                                {.projection_scale = d / 100.0, .max_depth = depth / 100.0});
      CHECK_NEAR(r.distance[0], 0.045, 1e-12);
    }
}

TEST(a_registration_error_widens_the_level_of_detection) {
  const PointCloud a = noisy_plane(2000, 2.0, 0.0, 0.02, 1),
                   b = noisy_plane(2000, 2.0, 0.1, 0.02, 2);
  PointCloud core = noisy_plane(5, 1.0, 0.0, 0.0, 3);
  core.normals.assign(core.size(), Eigen::Vector3f::UnitZ());
  const M3C2Options exact{.projection_scale = 0.5, .max_depth = 0.5};
  M3C2Options shifted = exact;
  shifted.registration_error = 0.02;
  const M3C2Result r = m3c2(core, a, b, exact), s = m3c2(core, a, b, shifted);
  for (std::size_t i = 0; i < core.size(); ++i)
    CHECK_NEAR(s.level_of_detection[i], r.level_of_detection[i] + 1.96 * 0.02, 1e-12);
}

TEST(level_of_detection_holds_in_95_of_100) {
  const PointCloud a = noisy_plane(30000, 10.0, 0.0, 0.03, 4);
  const PointCloud b = noisy_plane(30000, 10.0, 0.0, 0.03, 5);
  PointCloud core = noisy_plane(2000, 9.0, 0.0, 0.0, 6);
  core.normals.assign(core.size(), Eigen::Vector3f::UnitZ());
  const M3C2Result r = m3c2(core, a, b, {.projection_scale = 0.6, .max_depth = 0.5});
  CHECK_NEAR(static_cast<double>(r.significant) / 2000.0, 0.055, 0.025);
}

TEST(matches_the_definition_in_any_direction) {
  Random random(7);
  PointCloud a, b, core;
  for (int i = 0; i < 3000; ++i) {
    a.points.emplace_back(random.uniform(), random.uniform(), random.uniform());
    b.points.emplace_back(random.uniform(), random.uniform(), random.uniform());
  }
  for (int i = 0; i < 60; ++i) {
    core.points.emplace_back(random.uniform(), random.uniform(), random.uniform());
    core.normals.push_back(Eigen::Vector3f(static_cast<float>(random.normal()),
                                           static_cast<float>(random.normal()),
                                           static_cast<float>(random.normal()))
                               .normalized());
  }
  for (const double depth : {0.05, 0.3, 2.0}) {
    const M3C2Result r = m3c2(core, a, b, {.projection_scale = 0.24, .max_depth = depth});
    for (std::size_t i = 0; i < core.size(); ++i) {
      const double expected = brute_force_distance(
          core.points[i], core.normals[i].cast<double>().normalized(), a, b, 0.12, depth);
      if (std::isnan(expected))
        CHECK(std::isnan(r.distance[i]));
      else
        CHECK_NEAR(r.distance[i], expected, 1e-9);
    }
  }
}

TEST(sign_follows_the_normal_and_order) {
  const PointCloud a = noisy_plane(2000, 2.0, 0.0, 0.0, 8);
  const PointCloud b = noisy_plane(2000, 2.0, 0.1, 0.0, 9);
  PointCloud core;
  core.points = {Point3::Zero()};
  core.normals = {Eigen::Vector3f::UnitZ()};
  const M3C2Options o{.projection_scale = 0.5, .max_depth = 0.3};
  CHECK_NEAR(m3c2(core, a, b, o).distance[0], 0.1, 1e-9);
  CHECK_NEAR(m3c2(core, b, a, o).distance[0], -0.1, 1e-9);
  core.normals[0] = -core.normals[0];
  CHECK_NEAR(m3c2(core, a, b, o).distance[0], -0.1, 1e-9);
}

TEST(a_thin_walls_faces_are_told_apart_by_their_normals) {
  // A wall of 5 cm, and what was made of it: each face 1 cm further out.
  const auto wall = [](double half, std::uint64_t seed) {
    PointCloud cloud = noisy_plane(3000, 2.0, half, 0.0, seed);
    cloud.normals.assign(cloud.size(), Eigen::Vector3f::UnitZ());
    const PointCloud under = noisy_plane(2000, 2.0, -half, 0.0, seed + 1);
    cloud.points.insert(cloud.points.end(), under.points.begin(), under.points.end());
    cloud.normals.resize(cloud.size(), -Eigen::Vector3f::UnitZ());
    return cloud;
  };
  PointCloud core;
  core.points = {{0, 0, 0.025}, {0, 0, -0.025}};
  core.normals = {Eigen::Vector3f::UnitZ(), -Eigen::Vector3f::UnitZ()};
  M3C2Options o{.projection_scale = 0.5, .max_depth = 0.3};
  const PointCloud truth = wall(0.025, 1), made = wall(0.035, 3);
  for (const double d : m3c2(core, truth, made, o).distance) CHECK_NEAR(d, 0.01, 1e-6);
  // A reference that is a sheet has one normal and two sides.
  PointCloud sheet = noisy_plane(3000, 2.0, 0.0, 0.0, 5);
  sheet.normals.assign(sheet.size(), Eigen::Vector3f::UnitZ());
  for (const double d : m3c2(core, sheet, made, o).distance) CHECK_NEAR(d, 0.035, 1e-6);
  // What shows one face alone has no distance at the other.
  PointCloud upper = noisy_plane(3000, 2.0, 0.035, 0.0, 6);
  upper.normals.assign(upper.size(), Eigen::Vector3f::UnitZ());
  const M3C2Result half = m3c2(core, truth, upper, o);
  CHECK_NEAR(half.distance[0], 0.01, 1e-6);
  CHECK(std::isnan(half.distance[1]));
  // Without normals, or told to ignore them, all count.
  o.sided = false;
  CHECK(std::abs(m3c2(core, truth, made, o).distance[0]) < 0.005);
  o.sided = true;
  PointCloud bare = upper;
  bare.normals.clear();
  CHECK_NEAR(m3c2(core, sheet, bare, o).distance[1], -0.035, 1e-6);
}

TEST(median_shrugs_off_outliers) {
  const PointCloud a = noisy_plane(4000, 2.0, 0.0, 0.0, 8);
  PointCloud b = noisy_plane(4000, 2.0, 0.05, 0.0, 9);
  for (std::size_t i = 0; i < b.size(); i += 4) b.points[i].z() = 0.4;
  PointCloud core;
  core.points = {Point3::Zero()};
  core.normals = {Eigen::Vector3f::UnitZ()};
  CHECK_NEAR(
      m3c2(core, a, b, {.projection_scale = 0.5, .max_depth = 0.5, .median = true}).distance[0],
      0.05, 1e-9);
}

TEST(estimated_normals_of_a_slanted_plane_and_a_sphere) {
  Random random(11);
  const Eigen::Vector3d n = Eigen::Vector3d(1, 2, 3).normalized();
  const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  PointCloud plane;
  for (int i = 0; i < 5000; ++i)
    plane.points.push_back((random.uniform() - 0.5) * u + (random.uniform() - 0.5) * v +
                           0.002 * random.normal() * n + Point3(1000, -2000, 500));
  const std::vector<Point3> centre{Point3(1000, -2000, 500)};
  const auto normals = estimate_normals(centre, plane, 0.4);
  CHECK(normals[0].cast<double>().dot(n) > std::cos(radians(0.5)));
  // Nothing near, or a line of points: no normal, and then no distance.
  const auto none = estimate_normals(std::vector<Point3>{Point3::Zero()}, plane, 0.4);
  CHECK(none[0].norm() == 0.0F);
  PointCloud line;
  for (int i = 0; i < 50; ++i) line.points.emplace_back(0.01 * i, 0, 0);
  CHECK(estimate_normals(std::vector<Point3>{Point3(0.25, 0, 0)}, line, 0.4)[0].norm() == 0.0F);
  PointCloud core;
  core.points = {Point3(0.25, 0, 0)};
  CHECK(std::isnan(m3c2(core, line, line).distance[0]));
}

TEST(empty_clouds_and_bad_settings) {
  PointCloud core;
  core.points = {Point3::Zero()};
  core.normals = {Eigen::Vector3f::UnitZ()};
  const M3C2Result r = m3c2(core, {}, {});
  CHECK(r.statistics.count == 0 && std::isnan(r.distance[0]) && std::isnan(r.statistics.mean));
  CHECK(m3c2({}, core, core).distance.empty());
  CHECK_THROWS(Error, m3c2(core, core, core, {.projection_scale = 0.0}));
  CHECK_THROWS(Error, m3c2(core, core, core, {.max_depth = std::nan("")}));
  CHECK_THROWS(Error, estimate_normals(core.points, core, -1.0));
}

TEST(threads_change_nothing) {
  const PointCloud a = noisy_plane(5000, 4.0, 0.0, 0.03, 4);
  const PointCloud b = noisy_plane(5000, 4.0, 0.02, 0.03, 5);
  const M3C2Options one{.projection_scale = 0.4};
  M3C2Options two = one;
  two.threads = 2;
  const M3C2Result x = m3c2(a, a, b, one), y = m3c2(a, a, b, two);
  CHECK(x.statistics.mean == y.statistics.mean && x.significant == y.significant);
}
