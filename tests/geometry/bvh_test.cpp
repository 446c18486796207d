// SPDX-License-Identifier: MIT
#include <surfleet/geometry/bvh.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
Point3 draw(Random& random, double scale) {
  return {random.uniform(-scale, scale), random.uniform(-scale, scale),
          random.uniform(-scale, scale)};
}

TriangleMesh soup(Random& random, int n, double size) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    const Point3 p = draw(random, 5.0);
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(p + draw(random, size));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

void compare(const TriangleMesh& mesh, Random& random, int queries) {
  const Bvh bvh(mesh);
  CHECK(bvh.triangle_count() == mesh.triangles.size());
  for (int i = 0; i < queries; ++i) {
    const Point3 p = draw(random, 8.0);
    const Eigen::Vector3d d =
        i % 7 == 0 ? Eigen::Vector3d(0, 0, i % 2 == 0 ? 1 : -1) : draw(random, 1.0);
    double best_t = std::numeric_limits<double>::infinity(), best_d = best_t;
    int hits = 0, found_hits = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
      if (const auto hit = intersect_triangle(p, d, a, b, c, 1e30)) {
        best_t = std::min(best_t, *hit);
        ++hits;
      }
      best_d = std::min(best_d, (closest_on_triangle(p, a, b, c) - p).norm());
    }
    const auto hit = bvh.cast(p, d);
    CHECK(hit.has_value() == (hits > 0));
    if (hit) CHECK_NEAR(hit->t, best_t, 1e-12 * (1 + best_t));
    if (hit) CHECK(!bvh.cast(p, d, hit->t * 0.999) && bvh.cast(p, d, hit->t).has_value());
    bvh.for_each_hit(p, d, 1e30, [&](double, std::int32_t) { ++found_hits; });
    CHECK(found_hits == hits);
    const auto near = bvh.closest_point(p);
    CHECK(near.has_value());
    if (!near) continue;
    CHECK_NEAR(near->distance, best_d, 1e-12 * (1 + best_d));
    CHECK_NEAR((near->point - p).norm(), near->distance, 1e-12 * (1 + best_d));
    CHECK(!bvh.closest_point(p, 0.999 * best_d));
  }
}
}  // namespace

/// Casts bundles itself, and counts them.
struct CountedBundles {
  const Bvh* bvh;
  mutable int bundles = 0;
  std::optional<RayHit> cast(const Point3& p, const Eigen::Vector3d& d, double t_max) const {
    return bvh->cast(p, d, t_max);
  }
  void cast_bundle(const Point3& p, std::span<const Eigen::Vector3d> directions, double t_max,
                   std::span<double> t) const {
    ++bundles;
    surfleet::cast_bundle(*bvh, p, directions, t_max, t);
  }
};
static_assert(BundleRayCaster<CountedBundles> && !BundleRayCaster<Bvh>);

TEST(a_caster_that_is_faster_with_bundles_is_given_them) {
  Random random(4);
  const TriangleMesh mesh = soup(random, 30, 2.0);
  const Bvh bvh(mesh);
  const CountedBundles counted{&bvh};
  std::vector<Eigen::Vector3d> directions(40);
  for (Eigen::Vector3d& d : directions) d = draw(random, 1.0);
  std::vector<double> one_by_one(directions.size()), together(directions.size());
  cast_bundle(bvh, Point3::Zero(), directions, 9.0, one_by_one);
  cast_bundle(counted, Point3::Zero(), directions, 9.0, together);
  CHECK(counted.bundles == 1 && together == one_by_one);
}

TEST(bvh_agrees_with_brute_force) {
  Random random(1);
  for (const int n : {1, 3, 5, 50, 800}) compare(soup(random, n, 0.8), random, 150);
  compare(make_sphere({0, 0, 0}, 4.0, 2), random, 200);
  compare(make_box({-3, -2, -1}, {3, 2, 1}), random, 300);
}

TEST(bvh_takes_degenerate_triangles) {
  Random random(2);
  TriangleMesh mesh = soup(random, 60, 0.5);
  for (int i = 0; i < 20; ++i) mesh.triangles.push_back({i, i, i + 1});  // needles
  for (int i = 0; i < 20; ++i) mesh.triangles.push_back({i, i, i});      // points
  for (int i = 0; i < 200; ++i) mesh.triangles.push_back({0, 1, 2});     // many equal ones
  compare(mesh, random, 200);
}

TEST(bvh_finds_the_nearest_of_those_that_are_accepted) {
  Random random(3);
  TriangleMesh mesh = soup(random, 400, 0.8);
  for (int i = 0; i < 50; ++i)
    mesh.triangles.push_back({0, 1, 2});  // equal ones: the lowest counts
  const Bvh bvh(mesh);
  for (int i = 0; i < 300; ++i) {
    const Point3 p = draw(random, 8.0);
    const Eigen::Vector3d side = draw(random, 1.0);
    const double reach = random.uniform(0.1, 4.0);
    const auto accept = [&](std::int32_t t) {
      return mesh.area_vector(static_cast<std::size_t>(t)).dot(side) > 0.0;
    };
    double best = std::numeric_limits<double>::infinity();
    std::int32_t which = -1;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t) {
      const auto k = static_cast<std::size_t>(t);
      const double d =
          (closest_on_triangle(p, mesh.corner(k, 0), mesh.corner(k, 1), mesh.corner(k, 2)) - p)
              .norm();
      if (accept(t) && d <= reach && d < best) {
        best = d;
        which = t;
      }
    }
    const auto near = bvh.closest_point_where(p, reach, accept);
    CHECK(near.has_value() == (which >= 0));
    if (near) CHECK_NEAR(near->distance, best, 1e-12 * (1 + best));
    if (near) CHECK(near->triangle == which);
  }
  CHECK(!bvh.closest_point_where({0, 0, 0}, 100.0, [](std::int32_t) { return false; }));
}

TEST(bvh_of_nothing_finds_nothing) {
  for (const Bvh& bvh : {Bvh(), Bvh(TriangleMesh{})}) {
    CHECK(!bvh.cast({0, 0, 0}, {0, 0, 1}) && !bvh.closest_point({0, 0, 0}));
    CHECK(std::isinf(bvh.distance({0, 0, 0})) && bvh.bounds().isEmpty());
  }
}

TEST(bvh_is_tight_against_a_sphere_and_no_ray_escapes) {
  const TriangleMesh sphere = make_sphere({10, -4, 2}, 2.0, 4);
  const Bvh bvh(sphere);
  Random random(7);
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d d =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const auto hit = bvh.cast({10, -4, 2}, d);
    CHECK(hit && std::abs(hit->t - 2.0) < 0.01);
    CHECK_NEAR(bvh.distance(Point3(10, -4, 2) + 3.5 * d), 1.5, 0.01);
  }
  for (const Point3& v : sphere.vertices) CHECK(bvh.cast({10, -4, 2}, v - Point3(10, -4, 2), 1.5));
}

TEST(bvh_holds_far_from_the_origin) {
  const Point3 far(5e5, 4.5e6, 120.0);
  TriangleMesh mesh = make_box({-1, -1, -1}, {1, 1, 1});
  for (Point3& v : mesh.vertices) v += far;
  const Bvh bvh(mesh);
  CHECK_NEAR(bvh.distance(far + Point3(0, 0, 3)), 2.0, 1e-6);
  const auto hit = bvh.cast(far + Point3(-5, 0.3, 0.2), {2, 0, 0});
  CHECK(hit && std::abs(hit->t - 2.0) < 1e-6);
}

TEST(winding_counts_closed_parts) {
  TriangleMesh mesh = make_box({0, 0, 0}, {2, 2, 2});
  append(mesh, make_sphere({2, 1, 1}, 1.0));
  const Bvh bvh(mesh);
  CHECK(winding_number(bvh, mesh, {0.5, 0.5, 0.5}) == 1);
  CHECK(winding_number(bvh, mesh, {1.7, 1.1, 1.05}) == 2);
  CHECK(winding_number(bvh, mesh, {2.5, 1.1, 1.05}) == 1);
  CHECK(winding_number(bvh, mesh, {3.5, 1, 1}) == 0);
}
