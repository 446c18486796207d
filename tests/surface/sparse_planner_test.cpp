// SPDX-License-Identifier: MIT
#include <surfleet/surface/sparse_planner.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/surface/patch_drive.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Random points on a cylinder about x with normals outward, and on a sphere or plane likewise.
template <typename Place>
PointCloud sampled(int count, double noise, std::uint64_t seed, const Place& place) {
  Random random(seed);
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    Point3 p;
    Eigen::Vector3d n;
    place(random, p, n);
    cloud.points.push_back(p + noise * random.normal() * n);
    cloud.normals.push_back(n.cast<float>());
  }
  return cloud;
}
void on_sphere(Random& random, Point3& p, Eigen::Vector3d& n) {
  n = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  p = n;
}
void on_tube(Random& random, Point3& p, Eigen::Vector3d& n) {
  const double a = random.uniform(0.0, 2.0 * kPi);
  n = Eigen::Vector3d(0.0, std::cos(a), std::sin(a));
  p = Point3(random.uniform(0.0, 1.5), 0.0, 0.0) + 0.35 * n;
}
std::int32_t nearest_to(const PointCloud& cloud, const Point3& p) {
  return KdTree(cloud.points).nearest(p)->index;
}
}  // namespace

TEST(quadrics_find_the_surface_they_were_sampled_from) {
  const PointCloud ball = sampled(20000, 0.0, 1, on_sphere);
  const KdTree tree(ball.points);
  const Point3 at = ball.points[7];
  const auto patch = fit_quadric(ball, tree, at, {.noise = 1e-4});
  CHECK(patch.has_value());
  CHECK(patch->radius > 0.15);
  CHECK(patch->residual < 2e-4);
  // Outside positive, distances true, normals outward, on all of the patch.
  for (const Neighbor& n : tree.within(at, 0.15)) {
    const Point3& p = ball.points[static_cast<std::size_t>(n.index)];
    CHECK_NEAR(patch->distance(1.001 * p), 0.001, 2e-4);
    CHECK((patch->gradient(p).normalized() - p).norm() < 0.01);
    CHECK_NEAR(patch->projected(1.05 * p)->norm(), 1.0, 2e-4);
  }
  // The other side's normals turn it round.
  PointCloud hollow = ball;
  for (auto& n : hollow.normals) n = -n;
  CHECK(fit_quadric(hollow, tree, at, {.noise = 1e-4})->distance(1.001 * at) < 0.0);
  // Noise: within a fraction of it.
  const PointCloud rough = sampled(60000, 0.005, 2, on_sphere);
  const KdTree rough_tree(rough.points);
  const auto fitted = fit_quadric(rough, rough_tree, at, {.noise = 0.005});
  CHECK(fitted->residual > 0.004 && fitted->residual < 0.01);
  CHECK_NEAR(fitted->projected(at)->norm(), 1.0, 0.003);
  // Points that do not count pull at nothing.
  PointCloud stray = ball;
  std::vector<double> saliency(ball.size(), 1.0);
  for (std::size_t i = 0; i < stray.size(); i += 10) {
    stray.points[i] *= 1.05;
    saliency[i] = 0.0;
  }
  const KdTree stray_tree(stray.points);
  CHECK_NEAR(fit_quadric(stray, stray_tree, at, {.noise = 0.05}, saliency)->projected(at)->norm(),
             1.0, 1e-3);
  CHECK(std::abs(fit_quadric(stray, stray_tree, at, {.noise = 0.05})->projected(at)->norm() - 1.0) >
        3e-3);
}

// A saddle over turned axes: all of Q counts, the mixed term with it.
TEST(quadrics_know_a_saddle) {
  Random random(8);
  PointCloud saddle;
  for (int i = 0; i < 3000; ++i) {
    const double x = random.uniform(-0.3, 0.3), y = random.uniform(-0.3, 0.3);
    saddle.points.emplace_back(x, y, 0.8 * x * y + 0.5 * x * x);
    saddle.normals.push_back(
        Eigen::Vector3d(-0.8 * y - x, -0.8 * x, 1.0).normalized().cast<float>());
  }
  const KdTree tree(saddle.points);
  // No patch grows past what its noise allows, and this one's is of a size with the fourth order.
  const auto patch = fit_quadric(saddle, tree, Point3::Zero(), {.noise = 1e-3});
  CHECK(patch && patch->radius > 0.25);
  for (const double a : {0.0, 0.7, 1.9, 3.3, 5.0}) {
    const Point3 p(0.2 * std::cos(a), 0.2 * std::sin(a),
                   0.8 * 0.04 * std::cos(a) * std::sin(a) + 0.02 * std::cos(a) * std::cos(a));
    CHECK(std::abs(patch->distance(p)) < 2e-4);
  }
  // Points that do not count take no part in the residual.
  PointCloud stray = saddle;
  std::vector<double> saliency(saddle.size(), 1.0);
  for (std::size_t i = 0; i < stray.size(); i += 3) {
    stray.points[i].z() += 0.04;
    saliency[i] = 0.0;
  }
  const KdTree stray_tree(stray.points);
  const auto weighed = fit_quadric(stray, stray_tree, Point3::Zero(), {.noise = 1e-3}, saliency);
  CHECK(weighed && weighed->radius > 0.25 && weighed->residual < 1e-3);
}

TEST(quadrics_keep_to_one_sheet_and_ask_for_spread) {
  // The underside of a plate, 1 cm below, faces away from it.
  Random random(9);
  PointCloud plate;
  for (int i = 0; i < 3000; ++i) {
    const bool under = i % 3 == 0;
    plate.points.emplace_back(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3),
                              under ? -0.01 : 0.0);
    plate.normals.emplace_back(0.0F, 0.0F, under ? -1.0F : 1.0F);
  }
  const KdTree tree(plate.points);
  const auto patch = fit_quadric(plate, tree, Point3::Zero(), {.noise = 0.02});
  CHECK(patch && std::abs(patch->distance(Point3(0.05, 0.05, 0.0))) < 1e-9);
  // Points on two lines leave a curvature open.
  PointCloud lines;
  for (int i = -20; i <= 20; ++i)
    for (const double y : {-0.01, 0.01}) {
      lines.points.emplace_back(0.004 * i, y, 0.0);
      lines.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
  CHECK(!fit_quadric(lines, KdTree(lines.points), Point3::Zero()).has_value());
}

TEST(quadrics_end_where_the_surface_is_none) {
  // A ridge of two planes: a patch on one of them ends before the ridge, none lies across it.
  const PointCloud ridge =
      sampled(20000, 0.001, 3, [](Random& random, Point3& p, Eigen::Vector3d& n) {
        const double x = random.uniform(-0.5, 0.5), y = random.uniform(-0.5, 0.5);
        p = Point3(x, y, -std::abs(x));
        n = Eigen::Vector3d(x < 0.0 ? -1.0 : 1.0, 0.0, 1.0).normalized();
      });
  const KdTree tree(ridge.points);
  const auto side = fit_quadric(ridge, tree, Point3(0.1, 0.0, -0.1), {.noise = 0.001});
  CHECK(side && side->residual < 0.002 && side->radius < 0.25);
  PointCloud few;
  few.points.assign(5, Point3::Zero());
  few.normals.assign(5, Eigen::Vector3f::UnitZ());
  CHECK(!fit_quadric(few, KdTree(few.points), Point3::Zero()).has_value());
  few.normals.pop_back();
  CHECK_THROWS(Error, fit_quadric(few, KdTree(few.points), Point3::Zero()));
}

TEST(primitives_follow_great_and_small_circles) {
  const PointCloud ball = sampled(20000, 0.0, 4, on_sphere);
  const KdTree tree(ball.points);
  const auto patch = fit_quadric(ball, tree, Point3(1, 0, 0), {.noise = 5e-4, .most_radius = 0.5});
  const auto start = patch->pose(Point3(1, 0, 0), Eigen::Vector3d(0, 1, 0));
  const auto straight = patch->drive(*start, 0.0, 0.2);
  CHECK((straight->position - Point3(std::cos(0.2), std::sin(0.2), 0)).norm() < 1.5e-3);
  CHECK((straight->forward - Eigen::Vector3d(-std::sin(0.2), std::cos(0.2), 0)).norm() < 0.02);
  // Geodesic curvature k on a unit sphere: a circle whose angular radius has the cotangent k.
  const double k = 20.0, radius = std::atan(1.0 / k);
  const auto round = patch->drive(*start, k, 2.0 * kPi * std::sin(radius), 2e-4);
  CHECK(round.has_value());
  CHECK((round->position - start->position).norm() < 2e-3);
  const auto half = patch->drive(*start, k, kPi * std::sin(radius), 2e-4);
  CHECK_NEAR((half->position - start->position).norm(), 2.0 * std::sin(radius), 2e-3);
  CHECK(half->position.z() > 0.0);  // to the left of +y, seen from outside
  CHECK(!patch->drive(*start, 0.0, 3.0).has_value());
}

TEST(sparse_paths_are_near_the_shortest) {
  const PointCloud tube = sampled(6000, 0.002, 5, on_tube);
  const SparsePlanner plan(tube);
  const double a = 2.2;  // round and along: a helix
  const std::int32_t start = nearest_to(tube, Point3(0.1, 0.35, 0.0)),
                     goal = nearest_to(tube, Point3(1.3, 0.35 * std::cos(a), 0.35 * std::sin(a)));
  const auto path = plan(start, goal);
  CHECK(path.has_value());
  const double exact = std::hypot(1.2, 0.35 * a);
  CHECK(path->length < 1.12 * exact);
  CHECK(path->length > 0.97 * exact);
  CHECK(path->points.front() == start && path->points.back() == goal);
  for (std::size_t i = 1; i < path->points.size(); ++i)
    CHECK(plan.edge(path->points[i - 1], path->points[i]));
  CHECK(plan(start, goal)->points == path->points);
  CHECK(plan(start, start)->points == std::vector<std::int32_t>{start});
  SparsePlannerOptions other;
  other.seed = 2;
  CHECK(SparsePlanner(tube, other)(start, goal)->points != path->points);
  // More samples, no longer a path.
  other.longest_edge = 0.12;  // chords alike
  other.samples = 800;
  const auto less = SparsePlanner(tube, other)(start, goal);
  other.samples = 20000;
  CHECK(!less || SparsePlanner(tube, other)(start, goal)->length < less->length);

  // Driven over patches.
  std::vector<Point3> waypoints;
  for (const std::int32_t i : path->points)
    waypoints.push_back(tube.points[static_cast<std::size_t>(i)]);
  PatchDriveOptions options;
  options.quadric.noise = 0.002;
  const PatchDrive drive = drive_over_patches(tube, plan.tree(), waypoints, options);
  CHECK(drive.reached);
  CHECK(drive.length < 1.1 * path->length);
  CHECK(drive.off_path < 0.03);
  CHECK(drive.patches > 1);
  for (const PatchPose& p : drive.poses) {
    CHECK_NEAR(p.position.tail<2>().norm(), 0.35, 0.003);
    CHECK(p.normal.tail<2>().dot(p.position.tail<2>()) > 0.99 * 0.35);
    CHECK(std::abs(p.forward.dot(p.normal)) < 1e-9);
  }
}

// A tenth of the points stands 2 cm over a plate; where they do not count, the drive is on it.
TEST(drives_heed_saliency) {
  Random random(7);
  PointCloud plate;
  std::vector<double> saliency;
  for (int i = 0; i < 4000; ++i) {
    const bool stray = i % 10 == 0;
    plate.points.emplace_back(random.uniform(), random.uniform(0.0, 0.5), stray ? 0.02 : 0.0);
    plate.normals.push_back(Eigen::Vector3f::UnitZ());
    saliency.push_back(stray ? 0.0 : 1.0);
  }
  const KdTree tree(plate.points);
  const std::vector<Point3> waypoints{{0.2, 0.25, 0.0}, {0.5, 0.25, 0.0}, {0.8, 0.25, 0.0}};
  PatchDriveOptions options;
  options.quadric.noise = 0.02;
  options.quadric.most_radius = 0.15;  // two patches at least
  const auto highest = [&](std::span<const double> weights) {
    const PatchDrive drive = drive_over_patches(plate, tree, waypoints, options, weights);
    CHECK(drive.reached && drive.patches > 1);
    double most = 0.0;
    for (const PatchPose& p : drive.poses) most = std::max(most, std::abs(p.position.z()));
    return most;
  };
  CHECK(highest(saliency) < 1e-9);
  CHECK(highest({}) > 1e-3);
}

// On a lattice with every point a sample, the tree is the shortest path over its own edges.
TEST(trees_over_all_points_are_shortest) {
  PointCloud plate;
  const int side = 9;
  Random random(3);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double x = 0.1 * i + 0.03 * random.uniform();
      plate.points.emplace_back(x, 0.1 * j + 0.03 * random.uniform(), 0.0);
      plate.normals.push_back(Eigen::Vector3f::UnitZ());
    }
  SparsePlannerOptions options;
  options.samples = 20000;
  options.longest_edge = 0.17;
  options.gamma = 10.0;  // so that the reach is the longest edge
  options.gap = 0.2;
  const SparsePlanner plan(plate, options);
  const std::size_t n = plate.size();
  double excess = 0.0;
  int count = 0;
  for (const std::size_t start : {std::size_t{0}, n / 2, n - 3}) {
    std::vector<double> least(n, 1e300);  // relaxed until nothing changes
    least[start] = 0.0;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b) {
          if (!plan.edge(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b))) continue;
          const double through = least[a] + (plate.points[a] - plate.points[b]).norm();
          if (through >= least[b] - 1e-12) continue;
          least[b] = through;
          changed = true;
        }
    }
    for (const std::size_t goal : {n - 1, n / 3, std::size_t{8}}) {
      const auto path = plan(static_cast<std::int32_t>(start), static_cast<std::int32_t>(goal));
      CHECK(path.has_value());
      CHECK_NEAR(path->length, least[goal], 1e-9);
      CHECK_NEAR(path->cost, path->length, 1e-9);
      // With a few samples a point it is near: parents are the cheapest, and others are served.
      for (options.seed = 1; options.seed <= 20; ++options.seed) {
        options.samples = 3 * n;
        const auto few = SparsePlanner(plate, options)(static_cast<std::int32_t>(start),
                                                       static_cast<std::int32_t>(goal));
        CHECK(few.has_value());
        CHECK_NEAR(few->cost, few->length, 1e-9);
        excess += few->length / least[goal] - 1.0;
        ++count;
      }
    }
  }
  // 0.010 to 0.013 over eight plates; 0.029 and more without serving others.
  CHECK(excess / count < 0.018);
}

// A slit in a plate is wider than the gap that an edge may pass.
TEST(edges_do_not_span_a_slit) {
  Random random(5);
  PointCloud plates;
  for (int i = 0; i < 4000; ++i) {
    const double x = random.uniform(0.0, 1.0);
    if (std::abs(x - 0.5) < 0.06) continue;
    plates.points.emplace_back(x, random.uniform(0.0, 0.5), 0.0);
    plates.normals.push_back(Eigen::Vector3f::UnitZ());
  }
  SparsePlannerOptions options;
  options.longest_edge = 0.3;
  const std::int32_t here = nearest_to(plates, Point3(0.2, 0.25, 0.0)),
                     there = nearest_to(plates, Point3(0.8, 0.25, 0.0)),
                     left = nearest_to(plates, Point3(0.4, 0.25, 0.0)),
                     right = nearest_to(plates, Point3(0.6, 0.25, 0.0));
  const SparsePlanner plan(plates, options);
  CHECK(!plan.edge(left, right) && plan.edge(here, left));
  CHECK(!plan(here, there).has_value());
  options.gap = 0.2;
  CHECK(SparsePlanner(plates, options)(here, there).has_value());
}

TEST(sparse_paths_do_not_jump) {
  // Two plates 20 cm apart, and a lid 2 cm above one that faces the other way.
  PointCloud plates = sampled(4000, 0.0, 6, [](Random& random, Point3& p, Eigen::Vector3d& n) {
    n = Eigen::Vector3d::UnitZ();
    p = Point3(random.uniform(0, 0.5) + (random.uniform() < 0.5 ? 0.0 : 0.7),
               random.uniform(0, 0.5), 0);
  });
  const std::size_t floor = plates.size();
  for (std::size_t i = 0; i < floor; ++i) {
    plates.points.push_back(plates.points[i] + Point3(0.0, 0.0, 0.02));
    plates.normals.emplace_back(0.0F, 0.0F, -1.0F);
  }
  const SparsePlanner plan(plates);
  const std::int32_t here = nearest_to(plates, Point3(0.1, 0.1, 0));
  CHECK(!plan(here, nearest_to(plates, Point3(1.1, 0.3, 0))).has_value());
  CHECK(!plan(here, here + static_cast<std::int32_t>(floor)).has_value());
  CHECK(plan(here, nearest_to(plates, Point3(0.45, 0.4, 0))).has_value());
  CHECK_THROWS(Error, plan(here, -1));
  plates.normals.clear();
  CHECK_THROWS(Error, SparsePlanner(plates));
}
