// SPDX-License-Identifier: MIT
#include <surfleet/surface/geodesic_strip.hpp>
#include <surfleet/surface/strip_path.hpp>
#include <surfleet/surface/strip_search.hpp>
#include <surfleet/surface/triangle_strip.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/clean_surface.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/steam_chest.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

SurfacePoint random_point(const TriangleMesh& mesh, Random& random) {
  const auto t = static_cast<std::int32_t>(random.below(mesh.triangles.size()));
  Eigen::Vector3d w(random.uniform(0.01, 1), random.uniform(0.01, 1), random.uniform(0.01, 1));
  return {t, w / w.sum()};
}

void check_path(const TriangleMesh& mesh, const SurfacePath& path) {
  CHECK(path.points.size() == path.triangles.size() + 1);
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i)  // every piece lies in its triangle
    for (const Point3& p : {path.points[i], path.points[i + 1]}) {
      const Point3 q = surface_point(mesh, path.triangles[i], p).position(mesh);
      CHECK_NEAR((p - q).norm(), 0.0, 1e-9);
    }
}

TEST(unfolding_keeps_every_length) {
  TriangleMesh mesh = make_torus(Point3::Zero(), 1.0, 0.4, 24, 12);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)  // some run the other way round
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const SurfaceWalk walk(mesh);
  Random random(2);
  std::vector<std::int32_t> triangles{5};
  while (triangles.size() < 60) {
    const std::int32_t in =
        walk.twin(3 * triangles.back() + static_cast<std::int32_t>(random.below(3)));
    if (triangles.size() < 2 || in / 3 != triangles[triangles.size() - 2])
      triangles.push_back(in / 3);
  }
  const UnfoldedStrip strip = unfold(mesh, triangles);
  for (std::size_t i = 0; i < strip.size(); ++i) {
    const auto t = static_cast<std::size_t>(triangles[i]);
    for (std::size_t k = 0; k < 3; ++k)
      CHECK_NEAR((strip.corners[i][k] - strip.corners[i][(k + 1) % 3]).norm(),
                 (mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm(), 1e-9);
    const auto& c = strip.corners[i];
    CHECK((cross2(c[1] - c[0], c[2] - c[0]) < 0.0) == (strip.mirrored[i] != 0));
    if (i + 1 == strip.size()) continue;
    const auto gate = strip.gate(mesh, i);  // this place behind it, the next in front
    const auto third = static_cast<std::size_t>((strip.exit[i] + 2) % 3);
    const auto beyond = static_cast<std::size_t>((strip.entry[i + 1] + 2) % 3);
    CHECK(cross2(gate.left - gate.right, c[third] - gate.right) > 0.0);
    CHECK(cross2(gate.left - gate.right, strip.corners[i + 1][beyond] - gate.right) < 0.0);
  }
  CHECK_THROWS(Error, unfold(mesh, std::vector<std::int32_t>{0, 100}));
}

// On a plane the shortened path of any strip that can be moved about is the straight line.
TEST(a_plane_gives_straight_lines) {
  const TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(3, 2)), 1.0, 17, 13);
  const SurfaceWalk walk(mesh);
  const StripShortener shortener(walk);
  const GeodesicStrips strips(walk);
  const StripSearch search(mesh), midpoints(mesh, {}, StripNodes::edge_midpoints);
  Random random(11);
  for (int i = 0; i < 150; ++i) {
    const SurfacePoint a = random_point(mesh, random), b = random_point(mesh, random);
    const double exact = (a.position(mesh) - b.position(mesh)).norm();
    for (const StripSearch* s : {&search, &midpoints}) {
      const auto strip = (*s)(a, b);
      CHECK(strip.has_value());
      if (!strip) continue;
      CHECK(strip->cost >= exact - 1e-12);
      const SurfacePath within = shortener.within(strip->triangles, a, b);
      CHECK(within.length() >= exact - 1e-12 && within.length() <= strip->cost + 1e-12);
      const SurfacePath path = shortener.shortened(strip->triangles, a, b);
      check_path(mesh, path);
      CHECK_NEAR(path.length(), exact, 1e-9);
    }
    const auto path = strips(a, b);
    CHECK(path.has_value());
    if (path) CHECK_NEAR(path->length(), exact, 1e-9);
  }
}

// A wandering strip is pulled to the shortest path inside it: brute force over its gates.
TEST(the_funnel_is_the_shortest_path_in_the_strip) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.15});
  const SurfaceWalk walk(mesh);
  const StripShortener shortener(walk);
  Random random(4);
  for (int run = 0; run < 40; ++run) {
    std::vector<std::int32_t> triangles{
        static_cast<std::int32_t>(random.below(mesh.triangles.size()))};
    for (int tries = 0; tries < 200 && triangles.size() < 14; ++tries) {
      const std::int32_t in =
          walk.twin(3 * triangles.back() + static_cast<std::int32_t>(random.below(3)));
      if (in >= 0 && (triangles.size() < 2 || in / 3 != triangles[triangles.size() - 2]))
        triangles.push_back(in / 3);
    }
    const SurfacePoint a{triangles.front(), {0.2, 0.5, 0.3}}, b{triangles.back(), {0.3, 0.3, 0.4}};
    const double length = shortener.within(triangles, a, b).length();
    // Dynamic programming over fine samples of every gate.
    constexpr int kSamples = 200;
    const UnfoldedStrip strip = unfold(mesh, triangles);
    std::vector<Point2> at(kSamples + 1, strip.flat(0, a.weights));
    std::vector<double> cost(kSamples + 1, 0.0);
    for (std::size_t i = 0; i + 1 < strip.size(); ++i) {
      const auto gate = strip.gate(mesh, i);
      std::vector<Point2> next(kSamples + 1);
      std::vector<double> next_cost(kSamples + 1, 1e9);
      for (int s = 0; s <= kSamples; ++s) {
        const auto j = static_cast<std::size_t>(s);
        next[j] = gate.left + s / double(kSamples) * (gate.right - gate.left);
        for (std::size_t r = 0; r <= kSamples; ++r)
          next_cost[j] = std::min(next_cost[j], cost[r] + (next[j] - at[r]).norm());
      }
      at = next;
      cost = next_cost;
    }
    double brute = 1e9;
    for (std::size_t r = 0; r <= kSamples; ++r)
      brute = std::min(brute, cost[r] + (strip.flat(strip.size() - 1, b.weights) - at[r]).norm());
    CHECK(length <= brute + 1e-9);
    CHECK(length >= brute * (1.0 - 1e-3));
  }
}

TEST(great_circles_cylinders_and_torus_equators) {
  {
    const TriangleMesh mesh = make_sphere(Point3::Zero(), 1.0, 5);
    const SurfaceWalk walk(mesh);
    const GeodesicStrips strips(walk);
    Random random(8);
    for (int i = 0; i < 60; ++i) {
      const SurfacePoint a = random_point(mesh, random), b = random_point(mesh, random);
      const Point3 p = a.position(mesh), q = b.position(mesh);
      const double exact = std::atan2(p.cross(q).norm(), p.dot(q));
      const auto path = strips(a, b);
      CHECK(path.has_value());
      if (!path) continue;
      check_path(mesh, *path);
      CHECK(path->length() < 1.003 * exact + 1e-9 && path->length() > 0.995 * exact);
    }
  }
  {  // A tube of flat facets unrolls exactly.
    const int sides = 24;
    TriangleMesh mesh;
    for (int j = 0; j <= 10; ++j)
      for (int i = 0; i < sides; ++i)
        mesh.vertices.push_back(
            {std::cos(2 * kPi * i / sides), std::sin(2 * kPi * i / sides), 0.3 * j});
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < sides; ++i) {
        const int a = j * sides + i, b = j * sides + (i + 1) % sides;
        mesh.triangles.push_back({a, b, a + sides});
        mesh.triangles.push_back({b, b + sides, a + sides});
      }
    const SurfaceWalk walk(mesh);
    const GeodesicStrips strips(walk);
    const double facet = 2.0 * std::sin(kPi / sides);
    Random random(3);
    for (int i = 0; i < 60; ++i) {
      const SurfacePoint a = random_point(mesh, random), b = random_point(mesh, random);
      const auto unrolled = [&](const SurfacePoint& s) {
        const int column = (s.triangle / 2) % sides;
        const Point3 p = s.position(mesh);
        const Point3 edge = mesh.vertices[static_cast<std::size_t>(column)];
        return Point2(facet * column + (p.head<2>() - edge.head<2>()).norm(), p.z());
      };
      const Point2 u = unrolled(a), v = unrolled(b);
      double around = std::abs(u.x() - v.x());
      around = std::min(around, facet * sides - around);
      const double exact = std::hypot(around, u.y() - v.y());
      const auto path = strips(a, b);
      CHECK(path.has_value());
      if (path) CHECK_NEAR(path->length(), exact, 1e-3 * exact);
    }
  }
  {
    const TriangleMesh mesh = make_torus(Point3::Zero(), 1.0, 0.4, 96, 48);
    const SurfaceWalk walk(mesh);
    const GeodesicStrips strips(walk);
    const auto path = strips({0, {1, 0, 0}}, {2 * 48 * 12, {1, 0, 0}});  // an eighth, outside
    CHECK(path.has_value());
    if (path) CHECK_NEAR(path->length(), 1.4 * kPi / 4, 0.01);
  }
}

TEST(weights_make_strips_keep_away) {
  const TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(4, 4)), 0.0, 20, 20);
  const Bvh bvh(mesh);
  const SurfacePoint a = *nearest_surface_point(mesh, bvh, {0.31, 2.02, 0});
  const SurfacePoint b = *nearest_surface_point(mesh, bvh, {3.71, 2.03, 0});
  StripCosts costs;
  costs.user.assign(mesh.triangles.size(), 0.0);
  const auto inside = [&](std::size_t t) {
    const Point3 c = mesh.centroid(t);
    return c.x() > 1.4 && c.x() < 2.6 && c.y() > 1.0 && c.y() < 3.2;
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (inside(t)) costs.user[t] = std::numeric_limits<double>::infinity();
  const auto strip = StripSearch(mesh, costs)(a, b);
  CHECK(strip.has_value());
  if (strip)
    for (const std::int32_t t : strip->triangles) CHECK(!inside(static_cast<std::size_t>(t)));
  // A* finds what Dijkstra's algorithm finds on the same graph.
  Random random(6);
  for (auto& c : costs.user) c = random.uniform(0.0, 3.0);
  costs.turn = 0.05;
  const TriangleMesh slope = bumpy_slope({.edge = 0.1});
  StripCosts bumps;
  bumps.curvature = 0.3;
  bumps.slope = 1.0;
  bumps.turn = 0.05;
  for (const auto& [surface, weights] : {std::pair{&mesh, &costs}, std::pair{&slope, &bumps}}) {
    const StripSearch search(*surface, *weights);
    for (int i = 0; i < 15; ++i) {
      const SurfacePoint s = random_point(*surface, random), g = random_point(*surface, random);
      const auto found = search(s, g);
      CHECK(found.has_value());
      if (!found || s.triangle == g.triangle) continue;
      std::vector<Source> sources;
      for (std::int32_t k = 0; k < 3; ++k) {
        const std::int32_t h = 3 * s.triangle + k;
        if (search.twin(h) >= 0)
          sources.push_back(
              {h, search.factor(s.triangle) * (search.at(h) - s.position(*surface)).norm()});
      }
      const auto all = shortest_paths(search, std::span<const Source>(sources));
      double best = 1e9;
      for (std::int32_t k = 0; k < 3; ++k) {
        const std::int32_t h = search.twin(3 * g.triangle + k);
        if (h >= 0 && all.reached(h))
          best = std::min(
              best, all.distance[static_cast<std::size_t>(h)] +
                        search.factor(g.triangle) * (search.at(h) - g.position(*surface)).norm());
      }
      CHECK_NEAR(found->cost, best, 1e-9);
    }
  }
}

TEST(ends_that_lie_on_corners_and_edges) {
  const TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(2, 2)), 0.0, 6, 6);
  const SurfaceWalk walk(mesh);
  const GeodesicStrips strips(walk);
  for (std::int32_t s = 0; s < 72; s += 5)
    for (std::int32_t g = 0; g < 72; g += 3)
      for (const Eigen::Vector3d& w :
           {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.5, 0.5, 0)}) {
        const SurfacePoint a{s, w}, b{g, {w.y(), w.z(), w.x()}};
        const auto path = strips(a, b);
        CHECK(path.has_value());
        if (!path) continue;
        CHECK_NEAR(path->length(), (a.position(mesh) - b.position(mesh)).norm(), 1e-9);
        check_path(mesh, *path);
      }
}

TEST(no_path_is_no_strip) {
  TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0, 3, 3);
  append(mesh, make_plane(Box2(Point2(2, 0), Point2(3, 1)), 0.0, 3, 3));
  const SurfaceWalk walk(mesh);
  const SurfacePoint a{0, {0.2, 0.3, 0.5}}, b{20, {0.2, 0.3, 0.5}};
  CHECK(!StripSearch(mesh)(a, b));
  CHECK(!GeodesicStrips(walk)(a, b));
  const auto same = GeodesicStrips(walk)(a, a);
  CHECK(same.has_value() && same->length() == 0.0);
  CHECK(StripSearch(mesh)(a, a)->triangles.size() == 1);
}

TEST(shortened_paths_on_a_rough_surface_are_not_longer_than_their_graph) {
  const TriangleMesh mesh = clean_surface(steam_chest(0.06));
  const SurfaceWalk walk(mesh);
  const GeodesicStrips strips(walk);
  const StripSearch search(mesh);
  Random random(9);
  int found = 0, straight = 0;
  for (int i = 0; i < 40; ++i) {
    const SurfacePoint a = random_point(mesh, random), b = random_point(mesh, random);
    const auto path = strips(a, b);
    const auto strip = search(a, b);
    CHECK(path.has_value() == strip.has_value());
    if (!path) continue;
    ++found;
    check_path(mesh, *path);
    CHECK(path->length() <= strip->cost);
    CHECK(path->length() >= (a.position(mesh) - b.position(mesh)).norm() - 1e-12);
    CHECK(strips.shortener().shortened(strip->triangles, a, b).length() <=
          strips.shortener().within(strip->triangles, a, b).length() + 1e-12);
    // A path that bends about no vertex is a straight walk.
    std::vector<StripCorner> corners;
    shortest_path_in_strip(mesh, unfold(mesh, path->triangles), path->start, path->goal, &corners);
    if (!corners.empty()) continue;
    ++straight;
    const SurfacePose pose = surface_pose(mesh, path->start, path->points[1] - path->points[0]);
    const SurfaceStep step = walk(pose, {path->length(), 0.0});
    CHECK_NEAR((step.pose.at.position(mesh) - path->points.back()).norm(), 0.0, 1e-6);
  }
  CHECK(found > 30 && straight > 5);
}
}  // namespace
