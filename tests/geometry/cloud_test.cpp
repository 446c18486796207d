// SPDX-License-Identifier: MIT
#include <surfleet/geometry/cloud_filters.hpp>
#include <surfleet/geometry/cloud_normals.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

std::vector<Point3> ball_surface(Random& random, std::size_t count, double noise) {
  std::vector<Point3> points;
  while (points.size() < count) {
    const Point3 p(random.normal(), random.normal(), random.normal());
    points.push_back(p.normalized() * (1.0 + noise * random.normal()));
  }
  return points;
}

TEST(even_spacing_is_even) {
  Random random(4);
  std::vector<Point3> points = ball_surface(random, 1500, 0.0);
  for (int i = 0; i < 800; ++i)
    points.push_back(Point3(1, 0.05 * random.normal(), 0.05 * random.normal()));
  const auto kept = evenly_spaced(points, 0.1);
  CHECK(std::is_sorted(kept.begin(), kept.end()) && kept.size() > 300);
  for (const std::size_t i : kept)
    for (const std::size_t j : kept) CHECK(i == j || (points[i] - points[j]).norm() >= 0.1);
  for (const Point3& p : points) {
    double nearest = 1e9;
    for (const std::size_t i : kept) nearest = std::min(nearest, (points[i] - p).norm());
    CHECK(nearest < 0.1);
  }
  CHECK(evenly_spaced(points, 0.1) == kept && evenly_spaced(points, 0.1, 7) != kept);
  CHECK(evenly_spaced(points, 0.0).size() == points.size());
}

TEST(outliers_go_and_the_rest_stays) {
  Random random(5);
  std::vector<Point3> points = ball_surface(random, 2000, 0.003);
  for (int i = 0; i < 20; ++i)
    points.push_back(Point3(3.0 + i, random.uniform(-1, 1), random.uniform(-1, 1)));
  const auto kept = inliers(points);
  std::size_t strays = 0;
  for (const std::size_t i : kept) strays += i >= 2000 ? 1 : 0;
  CHECK(strays == 0 && kept.size() > 1990);
  OutlierOptions many;
  many.threads = 3;
  CHECK(inliers(points, many) == kept);
  CHECK(inliers(std::vector<Point3>(5, Point3(1, 1, 1))).size() == 5);
  CHECK(inliers(std::vector<Point3>(50, Point3(1, 1, 1))).size() == 50);
}

TEST(median_spacing_of_a_lattice) {
  std::vector<Point3> points;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) points.push_back({0.2 * i, 0.2 * j, 0.0});
  points.push_back({50, 0, 0});
  CHECK_NEAR(median_spacing(points), 0.2, 1e-12);
  CHECK(median_spacing(std::vector<Point3>(1, Point3(0, 0, 0))) == 0.0);
}

TEST(normals_of_a_ball_have_one_side) {
  Random random(6);
  std::vector<Point3> points = ball_surface(random, 3000, 0.002);
  auto normals = plane_normals(points);
  for (std::size_t i = 0; i < points.size(); ++i)  // of either sign
    if (random.below(2) == 0) normals[i] = -normals[i];
  auto inward = normals;
  turn_to_sensor(points, Point3::Zero(), inward);
  turn_consistently(points, 12, normals);
  double worst = 1.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f out = points[i].normalized().cast<float>();
    CHECK(normals[i].dot(out) > 0.8F && inward[i].dot(out) < -0.8F);
    worst = std::min(worst, static_cast<double>(normals[i].dot(out)));
  }
  CHECK(worst < 1.0);
  CHECK(plane_normals(points, {20, 3}) == plane_normals(points, {20, 1}));
}

// Over a wedge of 60° with a rounded ridge the tree goes around the ridge, where normals agree, not
// from flank to flank, where they are nearly opposed.
TEST(normals_go_around_a_ridge) {
  std::vector<Point3> points;
  std::vector<Eigen::Vector3f> normals, outward;
  for (int k = 0; k < 60; ++k)  // those of a flank first
    for (int column = 0; column < 12; ++column)
      for (const double side : {-1.0, 1.0}) {
        const int row = (k + 3) % 60;
        const double along = 0.01 * row, arc = 0.015 * radians(60.0), y = 0.01 * column;
        const double a = side * (along < arc ? along / 0.015 : radians(60.0));
        const double down = std::max(0.0, along - arc);
        points.push_back({0.015 * std::sin(a) + side * down * 0.5, y,
                          0.015 * std::cos(a) - down * std::sqrt(0.75)});
        outward.push_back(Eigen::Vector3d(std::sin(a), 0.0, std::cos(a)).cast<float>());
        normals.push_back((row + column) % 2 == 0 ? outward.back() : -outward.back());
      }
  turn_consistently(points, 60, normals);
  int wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) wrong += normals[i] == outward[i] ? 0 : 1;
  CHECK(wrong == 0);
}

TEST(odd_clouds_are_filtered_or_refused) {
  CHECK(plane_normals(std::vector<Point3>{}).empty());
  CHECK(evenly_spaced(std::vector<Point3>{}, 1.0).empty() && inliers({}).empty());
  std::vector<Point3> line;
  for (int i = 0; i < 30; ++i) line.push_back({0.1 * i, 0, 0});
  for (const Eigen::Vector3f& n : plane_normals(line)) CHECK(std::abs(n.x()) < 1e-3F);
  auto same = plane_normals(std::vector<Point3>(4, Point3(2, 2, 2)));
  CHECK(same[0] == Eigen::Vector3f::UnitZ());
  turn_consistently(std::vector<Point3>(4, Point3(2, 2, 2)), 3, same);
  line.push_back({0, std::nan(""), 0});
  CHECK(finite_points(line).size() == 30);
  CHECK_THROWS(Error, plane_normals(line));
  CHECK_THROWS(Error, inliers(line));
  CHECK_THROWS(Error, evenly_spaced(line, 0.1));
  CHECK_THROWS(Error, turn_consistently(line, 3, same));
  PointCloud cloud;
  cloud.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  cloud.colors = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  const PointCloud part = selected(cloud, std::vector<std::size_t>{2, 0});
  CHECK(part.points[0].x() == 2.0 && part.colors[1][0] == 1 && part.normals.empty());
}
}  // namespace
