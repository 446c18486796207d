// SPDX-License-Identifier: MIT
#include <surfleet/surface/dense_planner.hpp>
#include <surfleet/surface/smooth_path.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Points by `place(u, v)` for a lattice of (u, v) in the unit square with a little jitter.
template <typename Place>
std::vector<Point3> dense_lattice(int nu, int nv, const Place& place) {
  Random random(9);
  std::vector<Point3> points;
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j)
      points.push_back(
          place((i + random.uniform(0.2, 0.8)) / nu, (j + random.uniform(0.2, 0.8)) / nv));
  return points;
}
/// A tube along x, Ø 0.5 × 0.9 m, with a hole of radius 0.12 m in its top.
std::vector<Point3> tube_with_hole() {
  auto points = dense_lattice(45, 78, [](double u, double v) {
    const double a = 2.0 * kPi * v;
    return Point3(0.9 * (u - 0.5), 0.25 * std::sin(a), 0.25 * std::cos(a));
  });
  std::erase_if(points, [](const Point3& p) {
    return std::hypot(p.x(), 0.25 * std::atan2(p.y(), p.z())) < 0.12;
  });
  return points;
}
std::vector<Point3> l_of_plates() {
  return dense_lattice(52, 36, [](double u, double v) {
    const double s = 1.0 * (u - 0.5), y = 0.7 * (v - 0.5);
    return s < 0.0 ? Point3(0, y, s) : Point3(s, y, 0);
  });
}
/// The weighted part of eq. 8.1 along a path.
double part(const FeatureMaps& maps, const DensePath& path, const DenseCosts& costs) {
  DensePlannerOptions options;
  options.costs = costs;
  options.most_turn = 10.0;
  const DensePlanner planner(maps, options);
  double sum = 0.0;
  for (std::size_t i = 1; i < path.cells.size(); ++i)
    sum += *planner.step_cost(maps[path.cells[i - 1]], planner.direction(path.headings[i - 1]),
                              maps[path.cells[i]]);
  return sum;
}

TEST(ninety_eight_headings) {
  const FeatureMaps none(CloudTokens{}, 0.06);
  const DensePlanner planner(none);
  std::vector<int> seen(DensePlanner::kHeadings, 0);
  for (int h = 0; h < DensePlanner::kHeadings; ++h) {
    CHECK(planner.snapped(planner.direction(h)) == h);
    ++seen[static_cast<std::size_t>(planner.snapped(-planner.direction(h)))];
  }
  for (const int s : seen) CHECK(s == 1);
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d d(random.normal(), random.normal(), random.normal());
    CHECK(planner.direction(planner.snapped(d)).dot(d.normalized()) > std::cos(radians(21.0)));
  }
  CHECK(!planner.cell_at({0, 0, 0}, 1.0));
}

TEST(curvature_cost_is_of_the_bend_across_the_path) {
  const Eigen::Vector3d n(0, 0, 1), bent = Eigen::Vector3d(0.3, 0, 1).normalized();
  // Along the bend the robot's y is its axis.
  CHECK_NEAR(DensePlanner::bend(n, bent, {0, 1, 0}), 0.0, 1e-9);
  CHECK_NEAR(DensePlanner::bend(n, bent, {0, -1, 0}), 0.0, 1e-9);
  CHECK_NEAR(DensePlanner::bend(n, bent, {1, 0, 0}), std::atan(0.3) * 0.5 * kPi, 1e-9);
  CHECK_NEAR(DensePlanner::bend(n, bent, {1, 1, 0}), std::atan(0.3) * 0.25 * kPi, 1e-9);
  CHECK(DensePlanner::bend(n, n, {1, 0, 0}) == 0.0);
}

TEST(dense_paths_over_a_plane) {
  const auto points = dense_lattice(
      50, 40, [](double u, double v) { return Point3(1.0 * u, 0.8 * v, 0.2 * u + 0.1 * v); });
  const CloudTokens cloud = cloud_tokens(points);
  const FeatureMaps maps(cloud, 0.06);
  DensePlannerOptions options;
  options.costs = {1.0, 0.0, 0.0, 0.0};
  const DensePlanner planner(maps, options);
  Random random(4);
  double sum = 0.0, smooth_sum = 0.0, straight_sum = 0.0;
  for (int k = 0; k < 6; ++k) {
    const auto at = [&](double u, double v) { return Point3(u, 0.8 * v, 0.2 * u + 0.1 * v); };
    const auto a = planner.cell_at(at(random.uniform(0.1, 0.3), random.uniform(0.1, 0.9)), 0.05);
    const auto b = planner.cell_at(at(random.uniform(0.7, 0.9), random.uniform(0.1, 0.9)), 0.05);
    CHECK(a && b);
    const auto path = planner(*a, *b);
    CHECK(path.has_value());
    CHECK_NEAR(path->cost, path->length, 1e-9);
    const double straight = (maps[*a].position - maps[*b].position).norm();
    sum += path->length;
    straight_sum += straight;
    CHECK(path->length >= straight - 1e-9);
    const SmoothPath smooth = smoothed(planner, cloud, *path);
    CHECK(smooth.crossings.empty() && smooth.points.size() > 10);
    smooth_sum += smooth.length();
    for (const OrientedPoint& p : smooth.points) {
      const Eigen::Vector3d n = Eigen::Vector3d(-0.2, -0.125, 1).normalized();
      CHECK(std::abs(n.dot(p.position)) < 0.004 && std::abs(n.dot(p.normal)) > 0.99);
    }
    const UnwrappedPath flat(smooth.points);  // a straight line in the plane as well
    CHECK_NEAR((flat.points().back() - flat.points().front()).norm(), smooth.length(),
               0.01 * straight);
  }
  CHECK(sum < 1.06 * straight_sum && smooth_sum < 1.01 * straight_sum);
}

TEST(a_star_agrees_with_dijkstra_and_with_relaxation) {
  const auto points = dense_lattice(24, 22, [](double u, double v) {
    return Point3(0.45 * u, 0.4 * v, 0.05 * std::sin(9.0 * u) * std::cos(7.0 * v));
  });
  const FeatureMaps maps(cloud_tokens(points), 0.06);
  const DensePlanner planner(maps);
  const auto start = planner.cell_at({0.08, 0.08, 0.0}, 0.1);
  const auto goal = planner.cell_at({0.38, 0.33, 0.0}, 0.1);
  CHECK(start && goal);
  const Eigen::Vector3d ahead(1, 0, 0);
  const auto path = planner(*start, *goal, ahead), plain = planner(*start, *goal, ahead, false);
  CHECK(path && plain);
  CHECK_NEAR(path->cost, plain->cost, 1e-12);
  CHECK(path->expanded <= plain->expanded);
  CHECK_NEAR(part(maps, *path, DenseCosts{}), path->cost, 1e-9);

  std::vector<double> cost(planner.size(), 1e300);  // relaxed until nothing changes
  cost[static_cast<std::size_t>(*start * DensePlanner::kHeadings + planner.snapped(ahead))] = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t v = 0; v < cost.size(); ++v) {
      if (cost[v] > 1e200) continue;
      for (const Arc& arc : planner.arcs(static_cast<std::int32_t>(v))) {
        double& to = cost[static_cast<std::size_t>(arc.to)];
        if (cost[v] + arc.length >= to - 1e-15) continue;
        to = cost[v] + arc.length;
        changed = true;
      }
    }
  }
  const auto first = cost.begin() + *goal * DensePlanner::kHeadings;
  CHECK_NEAR(*std::min_element(first, first + DensePlanner::kHeadings), path->cost, 1e-12);
}

// [004 Fig. 8.11]: each weight alone has its path around, or along, the hole.
TEST(each_cost_has_its_path_around_a_hole) {
  const CloudTokens cloud = cloud_tokens(tube_with_hole());
  const FeatureMaps maps(cloud, 0.06);
  const std::array<DenseCosts, 4> alone{
      {{1, 0, 0, 0}, {1e-3, 1, 0, 0}, {1e-3, 0, 1, 0}, {1e-3, 0, 0, 1}}};
  std::array<std::optional<DensePath>, 4> paths;
  const Point3 from(-0.25, 0.25 * std::sin(0.35), 0.25 * std::cos(0.35));
  const Point3 to(0.25, 0.25 * std::sin(-0.35), 0.25 * std::cos(-0.35));
  double clear[4] = {};
  for (std::size_t k = 0; k < 4; ++k) {
    DensePlannerOptions options;
    options.costs = alone[k];
    const DensePlanner planner(maps, options);
    const auto a = planner.cell_at(from, 0.06), b = planner.cell_at(to, 0.06);
    CHECK(a && b);
    paths[k] = planner(*a, *b);
    CHECK(paths[k].has_value());
    clear[k] = 1e9;
    for (const std::int32_t c : paths[k]->cells) {
      const Point3& p = maps[c].position;
      CHECK(planner.is_surface(c));
      clear[k] = std::min(clear[k], std::hypot(p.x(), 0.25 * std::atan2(p.y(), p.z())));
    }
    for (std::size_t i = 1; i < paths[k]->cells.size(); ++i)
      CHECK((maps[paths[k]->cells[i]].index - maps[paths[k]->cells[i - 1]].index)
                .cwiseAbs()
                .maxCoeff() == 2);
  }
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t other = 0; other < 4; ++other)
      CHECK(part(maps, *paths[k], alone[k]) <= part(maps, *paths[other], alone[k]) + 1e-9);
  CHECK(clear[0] > 0.07);             // the hole is not crossed
  CHECK(clear[1] > clear[0] + 0.02);  // salient surface lies farther from it
}

TEST(edges_are_crossed_squarely) {
  const CloudTokens cloud = cloud_tokens(l_of_plates());
  for (const double inflation : {0.0, 0.1}) {
    FeatureMapOptions map_options;
    map_options.inflation = inflation;
    const FeatureMaps maps(cloud, 0.06, map_options);
    const DensePlanner planner(maps);
    for (const double y : {-0.2, 0.0, 0.2}) {
      const auto a = planner.cell_at({0.0, -0.2, -0.3}, 0.06);
      const auto b = planner.cell_at({0.35, y, 0.0}, 0.06);
      CHECK(a && b);
      const auto path = planner(*a, *b);
      CHECK(path.has_value());
      int on_edge = 0;
      for (std::size_t i = 0; i + 1 < path->cells.size(); ++i) {
        if (!maps[path->cells[i]].edge) continue;
        ++on_edge;
        const Eigen::Vector3d step =
            (maps[path->cells[i + 1]].position - maps[path->cells[i]].position).normalized();
        CHECK(std::abs(step.y()) < std::sin(radians(18.0)));
      }
      CHECK(on_edge >= (inflation > 0.0 ? 2 : 1));
      const SmoothPath smooth = smoothed(planner, cloud, *path);
      CHECK(smooth.crossings.size() == 1 && smooth.worst_attack() < radians(8.0));
      const std::size_t at = smooth.crossings.at(0).point;
      const Point3 on = smooth.points[at].position;
      CHECK(std::hypot(on.x(), on.z()) < 0.03);
      for (const std::size_t side : {at - 1, at + 1}) {  // square in truth
        const Eigen::Vector3d step = (smooth.points[side].position - on).normalized();
        CHECK(std::abs(step.y()) < std::sin(radians(2.5)));
      }
      CHECK(smooth.length() < path->length * 1.08);
    }
  }
}

// Between two edges a riser of little more than a scale holds few votes; it is climbed anywhere.
TEST(steps_are_climbed_all_around) {
  auto points = dense_lattice(42, 105, [](double u, double v) {
    const double a = 2.0 * kPi * v, x = 0.7 * u, r = x < 0.3 ? 0.3 : x < 0.4 ? x : 0.4;
    return Point3(x < 0.3 ? x : x < 0.4 ? 0.3 : x - 0.1, r * std::cos(a), r * std::sin(a));
  });
  const CloudTokens cloud = cloud_tokens(points);
  const FeatureMaps maps(cloud, 0.06);
  DensePlannerOptions options;
  options.costs = {1.0, 0.0, 0.0, 0.0};
  const DensePlanner planner(maps, options);
  double sum = 0.0;
  for (int k = 0; k < 18; ++k) {
    const double c = std::cos(kPi * k / 9), s = std::sin(kPi * k / 9);
    const auto a = planner.cell_at({0.08, 0.3 * c, 0.3 * s}, 0.06);
    const auto b = planner.cell_at({0.52, 0.4 * c, 0.4 * s}, 0.06);
    CHECK(a && b);
    const auto path = planner(*a, *b);
    CHECK(path && path->length < 0.7);
    sum += path ? path->length : 1e9;
    // Both edges are known, in order, and square to the path there and back.
    for (const bool down : {false, true}) {
      const SmoothPath smooth = smoothed(planner, cloud, *(down ? planner(*b, *a) : path));
      CHECK(smooth.crossings.size() == 2 && smooth.worst_attack() < radians(8.0));
      if (smooth.crossings.size() != 2) continue;
      const auto radius = [&](std::size_t i) {
        return smooth.points[smooth.crossings[i].point].position.tail<2>().norm();
      };
      CHECK_NEAR(radius(down ? 1 : 0), 0.3, 0.025);
      CHECK_NEAR(radius(down ? 0 : 1), 0.4, 0.025);
      for (const EdgeCrossing& crossing : smooth.crossings)
        for (const std::size_t side : {crossing.point - 1, crossing.point + 1}) {
          const Eigen::Vector3d on = smooth.points[crossing.point].position,
                                step = (smooth.points[side].position - on).normalized();
          const Eigen::Vector3d round = on.cross(Eigen::Vector3d::UnitX()).normalized();
          CHECK(std::abs(step.dot(round)) < std::sin(radians(8.0)));
        }
    }
  }
  CHECK(sum / 18.0 < 0.58);  // straight up it is 0.54 m
  options.least_edge_saliency = 1.5;
  CHECK_THROWS(Error, DensePlanner(maps, options));
}

TEST(paths_that_cannot_be) {
  auto points =
      dense_lattice(20, 20, [](double u, double v) { return Point3(0.4 * u, 0.4 * v, 0); });
  const auto far =
      dense_lattice(20, 20, [](double u, double v) { return Point3(2 + 0.4 * u, 0.4 * v, 0); });
  points.insert(points.end(), far.begin(), far.end());
  const CloudTokens cloud = cloud_tokens(points);
  const FeatureMaps maps(cloud, 0.06);
  const DensePlanner planner(maps);
  const auto a = planner.cell_at({0.2, 0.2, 0}, 0.05), b = planner.cell_at({2.2, 0.2, 0}, 0.05);
  CHECK(a && b && !planner.cell_at({1.2, 0.2, 0}, 0.1));
  CHECK(!planner(*a, *b) && !planner(*a, *b, Eigen::Vector3d::Zero(), false));
  const auto here = planner(*a, *a);
  CHECK(here && here->cells.size() == 1 && here->cost == 0.0);
  CHECK(smoothed(planner, cloud, *here).length() == 0.0);
  CHECK(smoothed(planner, cloud, DensePath{}).points.empty());
  DensePlannerOptions options;
  options.costs.turn = -1.0;
  CHECK_THROWS(Error, DensePlanner(maps, options));
  CHECK_THROWS(Error, smoothed(planner, cloud, *here, {.spacing = 0.0}));
}
}  // namespace
