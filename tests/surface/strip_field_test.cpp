// SPDX-License-Identifier: MIT
#include <surfleet/surface/follow_field.hpp>
#include <surfleet/surface/strip_field.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/coverage/covering_strip.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>
#include <surfleet/surface/geodesic_strip.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

SurfacePoint inner_point(std::int32_t t, Random& random, double least = 0.02) {
  Eigen::Vector3d w(random.uniform(least, 1), random.uniform(least, 1), random.uniform(least, 1));
  return {t, w / w.sum()};
}
/// A sheet whose vertices were pushed about: slivers and obtuse triangles, none turned over.
TriangleMesh crumpled(Random& random, int n) {
  TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(n, n)), 0.0, n, n);
  for (Point3& v : mesh.vertices)
    v +=
        Point3(random.uniform(-0.45, 0.45), random.uniform(-0.45, 0.45), random.uniform(-0.4, 0.4));
  return mesh;
}
/// A strip that wanders and winds about vertices, never turning back on the spot.
std::vector<std::int32_t> wandering(const SurfaceWalk& walk, Random& random, std::size_t length) {
  std::vector<std::int32_t> strip{
      static_cast<std::int32_t>(random.below(walk.mesh().triangles.size()))};
  for (std::size_t tries = 0; tries < 8 * length && strip.size() < length; ++tries) {
    const auto side = static_cast<std::int32_t>(random.below(3));
    const std::int32_t in = walk.twin(3 * strip.back() + side);
    if (in < 0 || (strip.size() > 1 && in / 3 == strip[strip.size() - 2])) continue;
    strip.push_back(in / 3);
  }
  return strip;
}

template <typename Policy>
void field_laws(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles,
                const SurfacePoint& goal, Random& random) {
  const StripField<Policy> field(mesh, triangles, goal);
  const UnfoldedStrip& strip = field.strip();
  const Point2 g = strip.flat(strip.size() - 1, goal.weights);
  for (std::size_t i = 0; i < strip.size(); ++i) {
    const auto& c = strip.corners[i];
    for (int sample = 0; sample < 12; ++sample) {
      const int side = sample % 3;
      Eigen::Vector3d w = inner_point(0, random).weights;
      w[(side + 2) % 3] = 0.0;  // on side `side`
      w /= w.sum();
      const Point2 u = field.field(i, w), a = c[static_cast<std::size_t>(side)];
      const Point2 along = (c[static_cast<std::size_t>((side + 1) % 3)] - a).normalized();
      Point2 inward(-along.y(), along.x());
      if (inward.dot(c[static_cast<std::size_t>((side + 2) % 3)] - a) < 0.0) inward = -inward;
      if (side == strip.exit[i])
        CHECK(u.dot(inward) < 0.0);
      else if (side == strip.entry[i])
        CHECK(u.dot(inward) > 0.0);
      else
        CHECK(u.dot(inward) >= -1e-9);
      // The field on the surface is the one in the plane.
      CHECK_NEAR(field(i, w).norm(), u.norm(), 1e-9);
      if constexpr (std::same_as<Policy, PerpendicularField>)
        if (side == strip.exit[i] || side == strip.entry[i]) {
          CHECK_NEAR(u.dot(along), 0.0, 1e-9);
        }
    }
  }
  CHECK(g.allFinite());
}

template <typename Policy>
void hostile_strips(std::uint64_t seed) {
  Random random(seed);
  int runs = 0, failed = 0;
  for (int s = 0; s < 120; ++s) {
    const TriangleMesh mesh = crumpled(random, 7);
    const SurfaceWalk walk(mesh);
    const auto strip = wandering(walk, random, 2 + random.below(30));
    const SurfacePoint goal = inner_point(strip.back(), random);
    field_laws<Policy>(mesh, strip, goal, random);
    const StripField<Policy> field(mesh, strip, goal);
    for (int r = 0; r < 5; ++r) {
      const FieldDrive drive = follow_field(walk, field, inner_point(strip.front(), random));
      ++runs;
      failed += drive.reached && drive.left_strip == 0 ? 0 : 1;
    }
  }
  CHECK(runs == 600);
  CHECK(failed == 0);
}

TEST(hostile_strips_are_driven_to_their_end) { hostile_strips<ContinuousField>(21); }
TEST(hostile_strips_are_driven_squarely) { hostile_strips<PerpendicularField>(22); }

TEST(the_field_is_continuous_where_vertices_are_shared) {
  Random random(5);
  for (int s = 0; s < 60; ++s) {
    const TriangleMesh mesh = crumpled(random, 7);
    const SurfaceWalk walk(mesh);
    const auto triangles = wandering(walk, random, 25);
    const StripField<> field(mesh, triangles, inner_point(triangles.back(), random));
    const UnfoldedStrip& strip = field.strip();
    std::size_t jumps = 0, runs = 0;
    std::vector<std::pair<std::int32_t, std::size_t>> last_of;  // (vertex, its last place)
    for (std::size_t i = 0; i + 1 < strip.size(); ++i) {
      const Triangle& here = mesh.triangles[static_cast<std::size_t>(triangles[i])];
      const Triangle& next = mesh.triangles[static_cast<std::size_t>(triangles[i + 1])];
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t j = 0; j < 3; ++j) {
          if (here[k] != next[j] || strip.corners[i][k] != strip.corners[i + 1][j]) continue;
          bool begins = true;
          if (i > 0) {
            const auto e = static_cast<std::size_t>(strip.entry[i]);
            begins = k != e && k != (e + 1) % 3;
          }
          runs += begins ? 1U : 0U;
          jumps +=
              (field.field.vector(i, k) - field.field.vector(i + 1, j)).norm() > 1e-12 ? 1U : 0U;
        }
    }
    CHECK(runs == field.field.breaks() + field.field.shared());
    CHECK((jumps == 0) == (field.field.breaks() == 0));
    CHECK(jumps >= field.field.breaks());
  }
}

TEST(paths_of_the_field_are_hardly_longer_than_shortest_ones) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.05});
  const SurfaceWalk walk(mesh);
  const GeodesicStrips strips(walk);
  Random random(12);
  double ratio = 0.0;
  std::size_t shared = 0, breaks = 0;
  int count = 0;
  for (int i = 0; i < 60; ++i) {
    const auto start =
        inner_point(static_cast<std::int32_t>(random.below(mesh.triangles.size())), random);
    const auto goal =
        inner_point(static_cast<std::int32_t>(random.below(mesh.triangles.size())), random);
    const auto path = strips(start, goal);
    if (!path || path->length() < 0.3) continue;
    const StripField<> field(mesh, path->triangles, path->goal);
    const FieldDrive drive = follow_field(walk, field, path->start);
    CHECK(drive.reached && drive.left_strip == 0);
    ratio += drive.length / path->length();
    shared += field.field.shared();
    breaks += field.field.breaks();
    ++count;
  }
  CHECK(ratio / count < 1.08);
  CHECK(static_cast<double>(shared) > 0.8 * static_cast<double>(shared + breaks));
}

TEST(covering_strips_are_driven_part_by_part) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.1, .hole = true});
  const SurfaceWalk walk(mesh);
  const SurfaceGraph dual = DualMeshGraph{}(mesh, EdgeGeodesic{});
  std::vector<std::int32_t> all(mesh.triangles.size());
  for (std::size_t t = 0; t < all.size(); ++t) all[t] = static_cast<std::int32_t>(t);
  const CoveringStrip cover = covering_strip(mesh, dual.links, all, 3);
  std::vector<int> seen(mesh.triangles.size(), 0);
  SurfacePoint at{3, Eigen::Vector3d::Constant(1.0 / 3.0)};
  for (const auto& part : split_at_turns(cover.triangles)) {
    const SurfacePoint goal{part.back(), Eigen::Vector3d::Constant(1.0 / 3.0)};
    const StripField<> field(mesh, part, goal);
    const FieldDrive drive = follow_field(walk, field, at);
    CHECK(drive.reached && drive.left_strip == 0);
    for (const std::int32_t t : drive.entered) seen[static_cast<std::size_t>(t)] = 1;
    at = drive.poses.back().at;
  }
  CHECK(std::count(seen.begin(), seen.end(), 1) == static_cast<std::ptrdiff_t>(seen.size()));
}

TEST(strips_that_turn_back_are_refused) {
  const TriangleMesh mesh = make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0, 2, 2);
  const std::vector<std::int32_t> back{0, 1, 0};
  CHECK_THROWS(Error, StripField<>(mesh, back, SurfacePoint{0}));
  const auto parts = split_at_turns(back);
  CHECK(parts.size() == 2 && parts[0].size() == 2 && parts[1].size() == 2);
  CHECK_THROWS(Error, StripField<>(mesh, parts[0], SurfacePoint{0}));
}
}  // namespace
