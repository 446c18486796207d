// SPDX-License-Identifier: MIT
#include <surfleet/simulation/climbing_scenes.hpp>
#include <surfleet/simulation/rotating_lidar.hpp>

#include <surfleet/geometry/bvh.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

int boundary_loops(const TriangleMesh& mesh) {
  const MeshAdjacency adjacency(mesh);
  std::vector<std::vector<std::int32_t>> next(mesh.vertices.size());
  for (const std::int32_t e : adjacency.boundary_edges()) {
    const auto& v = adjacency.edges()[static_cast<std::size_t>(e)].vertices;
    next[static_cast<std::size_t>(v[0])].push_back(v[1]);
    next[static_cast<std::size_t>(v[1])].push_back(v[0]);
  }
  std::vector<std::uint8_t> seen(next.size(), 0);
  int loops = 0;
  for (std::size_t s = 0; s < next.size(); ++s) {
    if (next[s].empty() || seen[s] != 0) continue;
    ++loops;
    std::vector<std::size_t> stack{s};
    while (!stack.empty()) {
      const std::size_t v = stack.back();
      stack.pop_back();
      if (seen[v]++ != 0) continue;
      CHECK(next[v].size() == 2);
      for (const std::int32_t u : next[v]) stack.push_back(static_cast<std::size_t>(u));
    }
  }
  return loops;
}
bool orientable(const TriangleMesh& mesh) {  // no half-edge twice
  std::vector<std::pair<std::int32_t, std::int32_t>> sides;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) sides.emplace_back(t[k], t[(k + 1) % 3]);
  std::sort(sides.begin(), sides.end());
  return std::adjacent_find(sides.begin(), sides.end()) == sides.end();
}

TEST(climbing_scenes_have_their_sizes) {
  const TriangleMesh l = l_shape(0.05);
  CHECK_NEAR(l.area(), 1.6, 1e-9);
  CHECK(boundary_loops(l) == 1 && orientable(l) && connected_components(l).count == 1);
  for (std::size_t t = 0; t < l.triangles.size(); ++t)  // normals away from the quadrant inside
    CHECK(l.area_vector(t).dot(Eigen::Vector3d(-1, 0, 1)) > 0.0);

  const TriangleMesh tube = holed_tube({.edge = 0.03});
  CHECK(boundary_loops(tube) == 3 && orientable(tube));
  CHECK_NEAR(tube.area(), 2.0 * kPi * 0.35 * 1.6 - kPi * 0.15 * 0.15, 0.03);
  CHECK(boundary_loops(holed_tube({.hole_radius = 0.0})) == 2);
  for (std::size_t t = 0; t < tube.triangles.size(); ++t) {
    const Point3 c = tube.centroid(t);
    CHECK(tube.area_vector(t).dot(Eigen::Vector3d(0, c.y(), c.z())) > 0.0);
  }

  for (const double edge : {0.1, 0.05, 0.02}) {
    const TriangleMesh mock = mock_up(edge);
    CHECK(boundary_loops(mock) == 3 && orientable(mock) && connected_components(mock).count == 1);
    CHECK(MeshAdjacency(mock).non_manifold_edges().empty());
    const Box3 box = mock.bounds();
    for (std::size_t t = 0; t < mock.triangles.size(); ++t) {  // none turned over at the junction
      const Point3 c = mock.centroid(t);
      CHECK(mock.area(t) > 0.02 * edge * edge);
      if (c.z() < 0.42 && c.x() < 1.85) {
        CHECK(mock.area_vector(t).dot(Eigen::Vector3d(0, c.y(), c.z())) > 0.0 ||
              std::hypot(c.x() - 0.95, c.y()) < 0.21);
      }
    }
    CHECK_NEAR(box.max().z(), 1.0, 1e-9);
    CHECK_NEAR(box.max().x(), 2.4, 1e-9);
    CHECK_NEAR(box.min().z(), -0.5, 0.01);
    // Tube, ring of the step, wide section, and the branch with the mean height of its base, less
    // the tube's wall inside it (its area by the integral over the disc).
    double wall = 0.0, base = 0.0;
    for (int k = 0; k < 2000; ++k) {
      const double y = 0.2 * (2.0 * (k + 0.5) / 2000 - 1.0);
      wall += 2.0 * std::sqrt(0.04 - y * y) * 0.4 / std::sqrt(0.16 - y * y) * 0.4 / 2000;
      base += std::sqrt(0.16 - 0.04 * std::pow(std::sin(2.0 * kPi * k / 2000), 2)) / 2000;
    }
    const double area =
        2 * kPi * 0.4 * 1.9 + kPi * (0.25 - 0.16) + kPi * 0.5 + 2 * kPi * 0.2 * (1.0 - base) - wall;
    CHECK_NEAR(mock.area(), area, 0.6 * edge);
    if (edge < 0.03) CHECK_NEAR(mock.area(), area, 0.02);
  }
  CHECK_THROWS(Error, mock_up(0.5));
  CHECK_THROWS(Error, l_shape(0.0));
  CHECK_THROWS(Error, holed_tube({.radius = -1.0}));
}

TEST(lidar_points_lie_on_what_it_sees) {
  const TriangleMesh ball = make_sphere({0, 0, 0}, 2.0, 4);
  const Bvh bvh(ball);
  Pose T = Pose::Identity();
  T.translation() = Point3(0.3, -0.2, 0.1);
  T.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 0).normalized()).toRotationMatrix();
  RotatingLidar lidar;
  lidar.azimuths = 40;
  lidar.elevations = 21;
  const PointCloud exact = lidar.scan(bvh, T);
  CHECK(exact.size() == 40 * 21);
  for (const Point3& p : exact.points) CHECK(bvh.closest_point(p)->distance < 1e-9);
  lidar.noise = 0.02;
  const PointCloud noisy = lidar.scan(bvh, T);
  lidar.threads = 3;
  CHECK(lidar.scan(bvh, T).points == noisy.points);
  double squares = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Eigen::Vector3d off = noisy.points[i] - exact.points[i];
    const Eigen::Vector3d beam = exact.points[i] - T.translation();
    CHECK(off.cross(beam).norm() < 1e-9);
    squares += off.squaredNorm() / static_cast<double>(exact.size());
  }
  CHECK_NEAR(std::sqrt(squares), 0.02, 0.002);
  lidar.max_range = 1.9;
  CHECK(lidar.scan(bvh, T).size() < exact.size() && lidar.scan(bvh, T).size() > 10);
  lidar.lowest = 2.0;
  CHECK_THROWS(Error, lidar.scan(bvh, T));

  std::vector<Point3> points(4000, Point3(1, 2, 3));
  add_noise(points, 0.5, 3);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), square = Eigen::Vector3d::Zero();
  for (const Point3& p : points) {
    mean += p / 4000.0;
    square += (p - Point3(1, 2, 3)).cwiseAbs2() / 4000.0;
  }
  for (int k = 0; k < 3; ++k) {
    CHECK_NEAR(mean[k], k + 1.0, 0.03);
    CHECK_NEAR(std::sqrt(square[k]), 0.5, 0.02);
  }
}
}  // namespace
