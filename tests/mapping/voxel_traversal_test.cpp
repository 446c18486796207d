// SPDX-License-Identifier: MIT
#include <surfleet/mapping/voxel_traversal.hpp>

#include <cstdlib>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
std::vector<VoxelIndex> walk(const Point3& from, const Point3& to, double h) {
  std::vector<VoxelIndex> path;
  CHECK(traverse_voxels(from, to, h, [&](const VoxelIndex& v) {
    path.push_back(v);
    return path.size() < 100000;
  }));
  return path;
}
VoxelIndex voxel_of(const Point3& p, double h) {
  return (p / h).array().floor().matrix().cast<int>();
}
/// Length of the segment inside a voxel.
double length_inside(const Point3& from, const Point3& to, double h, const VoxelIndex& v) {
  const Eigen::Vector3d d = to - from;
  double enter = 0.0, leave = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double low = v[i] * h, high = (v[i] + 1) * h;
    if (d[i] == 0.0) {
      if (from[i] < low || from[i] > high) return 0.0;
      continue;
    }
    const double a = (low - from[i]) / d[i], b = (high - from[i]) / d[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return std::max(0.0, leave - enter) * d.norm();
}
}  // namespace

TEST(walks_are_connected_complete_and_end_where_they_should) {
  Random random(8);
  for (int i = 0; i < 2000; ++i) {
    const double h = random.uniform(0.05, 2.0), far = i % 3 == 0 ? 1e4 : 0.0;
    Point3 from = Point3::NullaryExpr([&] { return random.uniform(-8, 8) + far; });
    Point3 to = Point3::NullaryExpr([&] { return random.uniform(-8, 8) + far; });
    if (i % 5 == 0) to.x() = from.x();
    if (i % 7 == 0) to.y() = from.y();
    if (i % 35 == 0) to = from;
    const auto path = walk(from, to, h);
    CHECK(path.front() == voxel_of(from, h) && path.back() == voxel_of(to, h));
    double length = 0.0;
    for (std::size_t k = 0; k < path.size(); ++k) {
      if (k > 0) CHECK((path[k] - path[k - 1]).cwiseAbs().sum() == 1);
      length += length_inside(from, to, h, path[k]);
    }
    // Nothing is skipped: the pieces make the whole.
    CHECK_NEAR(length, (to - from).norm(), 1e-7);
    CHECK(static_cast<int>(path.size()) ==
          1 + (voxel_of(to, h) - voxel_of(from, h)).cwiseAbs().sum());
  }
}

TEST(walks_along_faces_and_through_corners_end) {
  CHECK(walk({0, 0, 0}, {4, 0, 0}, 1.0).size() == 5);
  CHECK(walk({0, 0, 0}, {-4, 0, 0}, 1.0).size() == 5);
  CHECK(walk({0, 0, 0}, {3, 3, 3}, 1.0).size() == 10);
  CHECK(walk({0, 0, 0}, {-3, -3, 3}, 1.0).size() == 10);
  CHECK(walk({0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, 1.0).size() == 1);
}

TEST(the_visitor_can_stop) {
  int seen = 0;
  CHECK(!traverse_voxels({0.5, 0.5, 0.5}, {9.5, 0.5, 0.5}, 1.0,
                         [&](const VoxelIndex&) { return ++seen < 3; }));
  CHECK(seen == 3);
}

TEST(cubes_are_left_at_once_and_nothing_else_is_missed) {
  Random random(9);
  for (int i = 0; i < 3000; ++i) {
    const double h = random.uniform(0.05, 2.0), far = i % 3 == 0 ? -1e3 : 0.0;
    Point3 from = Point3::NullaryExpr([&] { return random.uniform(-30, 30) * h + far; });
    Point3 to = Point3::NullaryExpr([&] { return random.uniform(-30, 30) * h + far; });
    if (i % 5 == 0) to.x() = from.x();
    if (i % 7 == 0) to.y() = from.y();
    if (i % 35 == 0) to = from;
    if (i % 2 == 0) {  // through edges and corners
      from = (2.0 / h * from).array().round() * 0.5 * h;
      to = (2.0 / h * to).array().round() * 0.5 * h;
    }
    const auto all = walk(from, to, h);
    // How large a cube is skipped follows from where it is.
    const auto side_of = [i](const VoxelIndex& v) {
      const VoxelIndex b(v.x() >> 3, v.y() >> 3, v.z() >> 3);
      return 1 << (std::abs(b.x() + 3 * b.y() + 5 * b.z() + i) % 4);
    };
    std::vector<VoxelIndex> expected;
    for (const VoxelIndex& v : all) {
      const int inside = ~(side_of(v) - 1);
      const bool skipped = !expected.empty() && side_of(v) == side_of(expected.back()) &&
                           ((v.array().unaryExpr([&](int c) { return c & inside; })) ==
                            (expected.back().array().unaryExpr([&](int c) { return c & inside; })))
                               .all();
      if (!skipped) expected.push_back(v);
    }
    std::vector<VoxelIndex> visited;
    CHECK(traverse_voxels(from, to, h, [&](const VoxelIndex& v) {
      visited.push_back(v);
      return side_of(v);
    }));
    CHECK(visited == expected);
  }
}

TEST(a_visitor_of_cubes_can_stop) {
  int seen = 0;
  CHECK(!traverse_voxels({0.5, 0.5, 0.5}, {90.5, 0.5, 0.5}, 1.0, [&](const VoxelIndex& v) {
    CHECK(v.x() == 8 * seen);
    return ++seen < 3 ? 8 : 0;
  }));
  CHECK(seen == 3);
}
