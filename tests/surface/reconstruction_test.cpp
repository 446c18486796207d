// SPDX-License-Identifier: MIT
#include <surfleet/surface/moving_least_squares.hpp>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_borders.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/rotating_lidar.hpp>
#include <surfleet/surface/greedy_projection.hpp>
#include <surfleet/surface/scan_triangulation.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Random points on a tube about x, open at both ends.
std::vector<Point3> tube_points(double radius, double length, int count, double noise,
                                std::uint64_t seed) {
  Random random(seed);
  std::vector<Point3> points;
  for (int i = 0; i < count; ++i) {
    const double a = random.uniform(0.0, 2.0 * kPi), r = radius + noise * random.normal();
    points.emplace_back(random.uniform(0.0, length), r * std::cos(a), r * std::sin(a));
  }
  return points;
}
/// Vertices − edges + triangles.
long euler_characteristic(const TriangleMesh& mesh) {
  return static_cast<long>(mesh.vertices.size()) -
         static_cast<long>(MeshAdjacency(mesh).edge_count()) +
         static_cast<long>(mesh.triangles.size());
}
bool is_oriented(const TriangleMesh& mesh) {
  const MeshAdjacency adjacency(mesh);
  std::vector<int> balance(adjacency.edge_count(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      balance[static_cast<std::size_t>(
          adjacency.edges_of_triangle(static_cast<std::int32_t>(t))[k])] +=
          mesh.triangles[t][k] < mesh.triangles[t][(k + 1) % 3] ? 1 : -1;
  for (std::size_t e = 0; e < balance.size(); ++e)
    if (adjacency.triangles_of_edge(static_cast<std::int32_t>(e)).size() == 2 && balance[e] != 0)
      return false;
  return true;
}
std::vector<Point3> in_order(std::vector<Point3> points) {
  std::sort(points.begin(), points.end(), [](const Point3& a, const Point3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return points;
}
/// Nothing, one point, a line, one place many times: no mesh and no trouble. NaN: refused.
template <SurfaceReconstruction R>
void reconstruction_laws(const R& reconstruct) {
  const Point3 sensor(0, 0, 1);
  CHECK(reconstruct(std::vector<Scan>{}).empty());
  CHECK(reconstruct(std::vector<Scan>{{{}, sensor}}).empty());
  CHECK(reconstruct(std::vector<Scan>{{{Point3(0, 0, 0)}, sensor}}).empty());
  const std::vector<Point3> same(9, Point3(0.1, 0.2, 0.0));
  CHECK(reconstruct(std::vector<Scan>{{same, sensor}}).triangles.size() < 200);
  CHECK_THROWS(Error, reconstruct(std::vector<Scan>{{{Point3(0, std::nan(""), 0)}, sensor}}));
  // A flat plate seen from above: triangles face up, edges have two at most, all points are near.
  Random random(3);
  Scan plate{{}, sensor};
  for (int i = 0; i < 3000; ++i)
    plate.points.emplace_back(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0.0);
  const TriangleMesh mesh = reconstruct(std::vector<Scan>{plate});
  CHECK(mesh.area() > 0.9);
  CHECK(mesh.area() < 1.2);
  CHECK(MeshAdjacency(mesh).non_manifold_edges().empty());
  CHECK(is_oriented(mesh));
  bool up = true, flat = true;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) up = up && mesh.area_vector(t).z() > 0.0;
  for (const Point3& v : mesh.vertices) flat = flat && std::abs(v.z()) < 4e-5;
  CHECK(up);
  CHECK(flat);
}
}  // namespace

TEST(scan_triangulation_goes_round_and_keeps_the_points) {
  const Point3 sensor(0.3, -0.2, 0.1);
  RotatingLidar lidar;
  lidar.azimuths = 90;
  lidar.elevations = 46;
  lidar.lowest = radians(-45.0);
  lidar.highest = radians(45.0);
  Pose T = Pose::Identity();
  T.translation() = sensor;
  const TriangleMesh sphere = make_sphere(Point3::Zero(), 1.0, 4);
  const Bvh bvh(sphere);
  for (const double noise : {0.0, 0.002}) {
    lidar.noise = noise;
    const Scan scan{lidar.scan(bvh, T).points, sensor};
    const TriangleMesh mesh = ScanTriangulation{}(std::vector<Scan>{scan});
    // Every beam a vertex, every gap of four two triangles: a ring that is closed over the cut.
    CHECK(in_order(mesh.vertices) == in_order(scan.points));
    CHECK(mesh.triangles.size() == 2U * 90U * 45U);
    CHECK(euler_characteristic(mesh) == 0);
    CHECK(mesh_borders(mesh).size() == 2);
    CHECK(MeshAdjacency(mesh).non_manifold_edges().empty());
    CHECK(is_oriented(mesh));
    bool faces = true;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      faces = faces && mesh.area_vector(t).dot(sensor - mesh.centroid(t)) > 0.0;
    CHECK(faces);
  }
}

TEST(scan_triangulation_leaves_out_what_hides_what) {
  // A small plate before a wall: no triangle joins them.
  Scan scan{{}, Point3::Zero()};
  for (int i = -40; i <= 40; ++i)
    for (int j = -20; j <= 20; ++j) {
      const bool plate = std::abs(i) < 8 && std::abs(j) < 8;
      const Eigen::Vector3d beam(1.0, 0.01 * i, 0.01 * j);
      scan.points.push_back((plate ? 1.0 : 1.5) * beam);
    }
  const TriangleMesh mesh = ScanTriangulation{}(std::vector<Scan>{scan});
  CHECK(connected_components(mesh).count == 2);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    CHECK(std::abs(mesh.corner(t, 0).x() - mesh.corner(t, 1).x()) < 1e-9);
  ScanTriangulation all;
  all.longest_edge = 10.0;
  all.greatest_incidence = radians(90.0);
  CHECK(connected_components(all(std::vector<Scan>{scan})).count == 1);
  CHECK_THROWS(Error, all(std::vector<Scan>{{scan.points, std::nullopt}}));
}

TEST(reconstructions_agree_on_the_laws) {
  reconstruction_laws(ScanTriangulation{});
  reconstruction_laws(MovingLeastSquares<>{});
  reconstruction_laws(MovingLeastSquares<GaussianKernel>{});
  GreedyProjection greedy;
  greedy.options.cloud.spacing = 0.02;
  reconstruction_laws(greedy);
}

TEST(moving_least_squares_averages_noise_and_keeps_openings) {
  const double radius = 0.35, noise = 0.018;
  Scan scan{tube_points(radius, 0.9, 14400, noise, 4), std::nullopt};
  std::vector<Scan> scans;  // seen from three places on the axis
  for (int k = 0; k < 3; ++k) scans.push_back({{}, Point3(0.15 + 0.3 * k, 0, 0)});
  for (const Point3& p : scan.points)
    scans[static_cast<std::size_t>(std::min(2.0, p.x() / 0.3))].points.push_back(p);
  MovingLeastSquares<> reconstruct;
  const TriangleMesh mesh = reconstruct(scans);
  CHECK(euler_characteristic(mesh) == 0);
  CHECK(mesh_borders(mesh).size() == 2);
  CHECK(MeshAdjacency(mesh).non_manifold_edges().empty());
  CHECK(is_oriented(mesh));
  double error = 0.0;
  for (const Point3& v : mesh.vertices) error += std::abs(v.tail<2>().norm() - radius);
  CHECK(error / static_cast<double>(mesh.vertices.size()) < 0.008);
  bool inward = true;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (std::abs(mesh.centroid(t).x() - 0.45) < 0.4)  // at a border they may curl
      inward = inward && mesh.area_vector(t).tail<2>().dot(mesh.centroid(t).tail<2>()) < 0.0;
  CHECK(inward);
  // Nothing reaches far beyond the ends.
  CHECK(mesh.bounds().min().x() > -0.06);
  CHECK(mesh.bounds().max().x() < 0.96);
  reconstruct.options.threads = reconstruct.options.cloud.threads = 3;
  const TriangleMesh again = reconstruct(scans);
  CHECK(again.vertices == mesh.vertices);
  CHECK(again.triangles == mesh.triangles);
  // Without sensors the same surface, of either orientation.
  const TriangleMesh unsided = reconstruct(std::vector<Scan>{scan});
  CHECK(euler_characteristic(unsided) == 0);
  CHECK(is_oriented(unsided));
}

TEST(moving_least_squares_distance_is_a_plane_s) {
  PointCloud cloud;
  const Eigen::Vector3d n = Eigen::Vector3d(1, 2, -2) / 3.0;
  const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j) {
      cloud.points.push_back(Point3(5, 6, 7) + 0.02 * i * u + 0.02 * j * v);
      cloud.normals.push_back(n.cast<float>());
    }
  const KdTree tree(cloud.points);
  const MovingLeastSquares<GaussianKernel> field;
  for (const double d : {-0.07, 0.0, 0.03})
    CHECK_NEAR(field.distance(cloud, tree, Point3(5, 6, 7) + d * n + 0.11 * u), d, 1e-7);
  CHECK(std::isnan(field.distance(cloud, tree, Point3(5, 6, 7) + 0.2 * n)));
  MovingLeastSquares<> wrong;
  wrong.options.support = 0.05;
  CHECK_THROWS(Error, wrong(cloud));
  cloud.normals.pop_back();
  CHECK_THROWS(Error, field(cloud));
}

TEST(moving_least_squares_knows_where_it_knows_nothing) {
  // So few points that many corners have less than three in reach.
  for (std::uint64_t seed = 1; seed < 12; ++seed) {
    Random random(seed);
    PointCloud cloud;
    for (int i = 0; i < 60; ++i) {
      cloud.points.emplace_back(random.uniform(0, 0.8), random.uniform(0, 0.8),
                                0.05 * random.normal());
      cloud.normals.push_back(
          Eigen::Vector3f(static_cast<float>(random.normal()), 0.0F, 1.0F).normalized());
    }
    bool finite = true;
    MovingLeastSquares<> sparse;
    sparse.options.support = 0.08;
    for (const Point3& v : sparse(cloud).vertices) finite = finite && v.allFinite();
    CHECK(finite);
  }
  // A plate, and a patch of a hundredth of it, which goes unless all are wanted.
  PointCloud cloud;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) cloud.points.emplace_back(0.015 * i, 0.015 * j, 0.0);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) cloud.points.emplace_back(2.0 + 0.015 * i, 0.015 * j, 0.0);
  cloud.normals.assign(cloud.size(), Eigen::Vector3f::UnitZ());
  MovingLeastSquares<> reconstruct;
  CHECK(connected_components(reconstruct(cloud)).count == 1);
  reconstruct.options.least_part = 0.0;
  CHECK(connected_components(reconstruct(cloud)).count == 2);
  // The kernel ends flat, and so does what a point has to say: no step in f as it leaves reach.
  const WendlandKernel kernel;
  CHECK_NEAR(kernel(0.0), 1.0, 1e-12);
  CHECK_NEAR(kernel(0.5), 0.1875, 1e-12);
  CHECK(kernel(0.999) < 1e-10);
}

TEST(small_parts_go_by_their_share) {
  TriangleMesh mesh = make_sphere(Point3::Zero(), 1.0, 2);
  append(mesh, make_box(Box3(Point3(3, 0, 0), Point3(4, 1, 1))));
  const std::size_t big = make_sphere(Point3::Zero(), 1.0, 2).triangles.size();
  CHECK(without_small_parts(mesh, 0.5).triangles.size() == big);
  CHECK(without_small_parts(mesh, 12.0 / static_cast<double>(big)).triangles.size() == big + 12);
  CHECK(without_small_parts(TriangleMesh{}, 0.5).empty());
}

TEST(greedy_projection_closes_what_is_closed) {
  PointCloud cloud;
  for (int i = 0; i < 1500; ++i) {  // a spiral over the sphere
    const double z = 1.0 - (2.0 * i + 1.0) / 1500.0, r = std::sqrt(1.0 - z * z), a = 2.39996323 * i;
    cloud.points.emplace_back(r * std::cos(a), r * std::sin(a), z);
    cloud.normals.push_back(cloud.points.back().cast<float>());
  }
  const TriangleMesh sphere = GreedyProjection{}(cloud);
  CHECK(sphere.vertices.size() == 1500);
  CHECK(euler_characteristic(sphere) == 2);
  CHECK(is_closed_and_oriented(sphere));
  bool outward = true;
  for (std::size_t t = 0; t < sphere.triangles.size(); ++t)
    outward = outward && sphere.area_vector(t).dot(sphere.centroid(t)) > 0.0;
  CHECK(outward);
  cloud.normals.pop_back();
  CHECK_THROWS(Error, GreedyProjection{}(cloud));

  // A tube with a little noise: both ends stay open, nothing else does.
  const std::vector<Point3> points = tube_points(0.35, 1.5, 20000, 0.001, 8);
  GreedyProjection reconstruct;
  reconstruct.options.cloud.spacing = 0.04;
  const TriangleMesh tube = reconstruct(std::vector<Scan>{{points, std::nullopt}});
  CHECK(euler_characteristic(tube) == 0);
  CHECK(mesh_borders(tube).size() == 2);
  CHECK(MeshAdjacency(tube).non_manifold_edges().empty());
  CHECK(is_oriented(tube));
  CHECK_NEAR(tube.area(), 2.0 * kPi * 0.35 * 1.5, 0.2);
  for (std::size_t t = 0; t < tube.triangles.size(); ++t)
    CHECK(tube.area_vector(t).tail<2>().normalized().dot(tube.centroid(t).tail<2>().normalized()) *
              tube.area_vector(0).tail<2>().dot(tube.centroid(0).tail<2>()) >
          0.0);
}

TEST(greedy_projection_keeps_sheets_apart) {
  // Two plates closer than their spacing that face away from one another.
  PointCloud cloud;
  Random random(6);
  for (int i = 0; i < 25; ++i)
    for (int j = 0; j < 25; ++j)
      for (const double side : {-1.0, 1.0}) {
        cloud.points.emplace_back(0.04 * i + 0.01 * random.uniform(), 0.04 * j, 0.01 * side);
        cloud.normals.emplace_back(0.0F, 0.0F, static_cast<float>(side));
      }
  const TriangleMesh mesh = GreedyProjection{}(cloud);
  CHECK(connected_components(mesh).count == 2);
  CHECK(mesh.triangles.size() > 2U * 2U * 23U * 23U);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    CHECK(mesh.corner(t, 0).z() == mesh.corner(t, 1).z() &&
          mesh.corner(t, 1).z() == mesh.corner(t, 2).z());
}

TEST(greedy_projection_folds_nothing_over) {
  // Points of any density on a plate: triangles beside one another, so no more area than the plate.
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    Random random(seed);
    PointCloud cloud;
    for (int i = 0; i < 400; ++i) {
      const double x = random.uniform();
      cloud.points.emplace_back(x * x * x, random.uniform(), 0.0);
      cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
    GreedyProjection reconstruct;
    reconstruct.options.longest_edge = 0.3;
    const TriangleMesh mesh = reconstruct(cloud);
    CHECK(mesh.area() < 1.0);
    CHECK(mesh.area() > 0.8);
    bool up = true;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      up = up && mesh.area_vector(t).z() > 0.0;
    CHECK(up);
  }
}
