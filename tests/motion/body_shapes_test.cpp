// SPDX-License-Identifier: MIT
// Bodies that are no balls in a free space and on a roadmap.
#include <surfleet/motion/swept_body.hpp>

#include <surfleet/motion/ball_cover.hpp>
#include <surfleet/motion/body_check.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lazy_prm.hpp>

#include <vector>

#include <surfleet/core/random.hpp>

#include "body_scenes.hpp"
#include "check.hpp"
#include "motion_scenes.hpp"
#include "paint_states.hpp"

namespace {
using namespace surfleet;
using namespace motion_scenes;

/// A box beside the position, to show that nothing is taken for granted but the concept.
struct BoxBody {
  Box3 box;
  double inscribed_radius() const { return 0.0; }
  double bounding_radius() const {
    return box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).norm();
  }
  bool touches(const Configuration& q, const Sphere& ball) const {
    return box.squaredExteriorDistance(q.pose().inverse() * ball.center) <
           ball.radius * ball.radius;
  }
};
static_assert(CollisionBody<BoxBody>);

Point3 any_in(Random& random, const Box3& b) {
  const double x = random.uniform(b.min().x(), b.max().x());
  const double y = random.uniform(b.min().y(), b.max().y());
  return {x, y, random.uniform(b.min().z(), b.max().z())};
}

/// That the solid holds the body at any heading, and is not much larger than `height(r)` on both
/// sides says.
template <typename Body, typename Height>
void check_swept(const Body& body, const Height& height) {
  const SweptBody swept = SweptBody::of(body);
  const double bound = body.bounding_radius(), slop = 0.02 * bound;
  CHECK(swept.radius() <= bound);
  Random random(2);
  int missed = 0, in = 0;
  const Box3 around(Point3::Constant(-bound), Point3::Constant(bound));
  for (int i = 0; i < 20000; ++i) {
    const Point3 p = any_in(random, around);
    const Configuration q{Point3::Zero(), random.uniform(-kPi, kPi)};
    if (!body.touches(q, {p, 1e-6})) continue;
    ++in;
    missed += swept.distance(p.head<2>().norm(), p.z(), 1.0) > 1e-6 ? 1 : 0;
    missed += p.norm() > swept.radius() + 1e-6 ? 1 : 0;
  }
  CHECK(missed == 0 && in > 25);
  for (int i = 0; i < SweptBody::kRings; ++i) {
    // The highest and the lowest point within the slop of the ring.
    Box3 reach;
    for (double r = i * swept.ring_width() - slop; r <= (i + 1) * swept.ring_width() + slop;
         r += 0.1 * slop)
      if (const auto z = height(std::max(r, 0.0)); z.first <= z.second) {
        reach.extend(Point3(0, 0, z.first));
        reach.extend(Point3(0, 0, z.second));
      }
    const SweptBody::Ring& ring = swept.rings()[static_cast<std::size_t>(i)];
    if (ring.empty()) continue;
    CHECK(!reach.isEmpty());
    CHECK(ring.high <= reach.max().z() + slop && ring.low >= reach.min().z() - slop);
  }
}

/// Empty and unknown space with obstacles in it, at random.
TsdfMap clutter(std::uint64_t seed, double voxel) {
  TsdfMap tsdf({.voxel_size = voxel});
  Random random(seed);
  map_test::paint(tsdf, VoxelIndex::Constant(-24), VoxelIndex::Constant(23),
                  [&](const VoxelIndex&) { return VoxelState::empty; });
  for (int i = 0; i < 12; ++i) {
    VoxelIndex lo, size;
    for (int k = 0; k < 3; ++k) {
      lo[k] = static_cast<int>(random.below(48)) - 24;
      size[k] = static_cast<int>(random.below(7));
    }
    const VoxelState s = i % 3 == 0 ? VoxelState::unknown : VoxelState::occupied;
    map_test::paint(tsdf, lo, lo + size, [&](const VoxelIndex&) { return s; });
  }
  return tsdf;
}
}  // namespace

TEST(a_swept_body_holds_the_body_at_every_heading_and_little_more) {
  using Heights = std::pair<double, double>;
  const auto ellipsoid = [](double a, double c) {
    return [a, c](double r) {
      const double z = r < a ? c * std::sqrt(1.0 - r * r / (a * a)) : -1.0;
      return Heights(-z, z);
    };
  };
  check_swept(EllipsoidBody{{0.6, 0.6, 0.2}}, ellipsoid(0.6, 0.2));
  check_swept(EllipsoidBody{{0.3, 0.9, 0.2}}, ellipsoid(0.9, 0.2));
  check_swept(EllipsoidBody{{0.2, 0.2, 0.7}}, ellipsoid(0.2, 0.7));
  check_swept(SphereBody{0.5}, ellipsoid(0.5, 0.5));
  check_swept(BoxBody{box(-0.5, -0.2, -0.1, 0.5, 0.2, 0.3)}, [](double r) {
    return r <= std::hypot(0.5, 0.2) ? Heights(-0.1, 0.3) : Heights(1.0, -1.0);
  });
  // Ahead of the axis and above the position: a ring with a hole.
  check_swept(BoxBody{box(0.4, -0.1, 0.1, 0.6, 0.1, 0.2)}, [](double r) {
    return r >= 0.4 && r <= std::hypot(0.6, 0.1) ? Heights(0.1, 0.2) : Heights(1.0, -1.0);
  });
  CHECK_THROWS(Error, SweptBody::of(EllipsoidBody{{0.0, 0.0, 0.0}}));
}

TEST(balls_hold_the_body_and_reach_about_a_voxel_beyond_it) {
  Random random(4);
  for (const double voxel : {0.3, 0.15, 0.08})
    for (const Eigen::Vector3d& axes :
         {Eigen::Vector3d(0.6, 0.6, 0.2), Eigen::Vector3d(0.5, 0.3, 0.3),
          Eigen::Vector3d(0.2, 0.2, 0.6), Eigen::Vector3d(0.6, 0.5, 0.05)}) {
      const SweptBody body = SweptBody::of(EllipsoidBody{axes});
      const double least = 0.1;
      const BallCover cover = cover_with_balls(body, voxel, least, [](double) { return 0.0; });
      CHECK(cover.radius >= least && cover.excess <= 1.2 * voxel);
      std::vector<Point3> centers;
      for (const VoxelKernel::Row& row : cover.centers.rows)
        for (int x = -row.spread; x <= row.spread; ++x)
          centers.push_back(voxel * Point3(x, row.dy, row.dz));
      int missed = 0;
      const Box3 around(Point3::Constant(-0.6), Point3::Constant(0.6));
      for (int i = 0; i < 20000; ++i) {
        const Point3 p = any_in(random, around);
        if (body.distance(p.head<2>().norm(), p.z(), 1.0) > 0.0) continue;
        double nearest = 1e9;
        for (const Point3& c : centers) nearest = std::min(nearest, (p - c).norm());
        missed += nearest > cover.radius ? 1 : 0;
      }
      CHECK(missed == 0);
      for (const Point3& c : centers)
        for (int i = 0; i < 50; ++i) {
          const Point3 p = c + cover.radius * any_in(random, around).normalized();
          CHECK(body.distance(p.head<2>().norm(), p.z(), 1.0) <= 1.1 * cover.excess + 1e-9);
        }
    }
  // A ball is one.
  const SweptBody round = SweptBody::of(SphereBody{0.5});
  const BallCover one = cover_with_balls(round, 0.1, 0.0, [](double) { return 0.0; });
  CHECK(one.centers.rows.size() == 1 && one.centers.length() == 0.0 && one.radius == 0.5);
}

TEST(where_a_body_is_free_it_fits_with_every_heading) {
  const auto check = [](const auto& body, std::uint64_t seed, FreeSpaceOptions more) {
    const double voxel = 0.1;
    const TsdfMap tsdf = clutter(seed, voxel);
    const VoxelStateMap states(tsdf);
    more.shape = SweptBody::of(body);
    more.radius = more.shape->radius();
    FreeSpaceOptions ball = more;
    ball.shape.reset();
    const FreeSpace space(states, more), plain(states, ball);
    Random random(seed);
    int free = 0, wrong = 0, lost = 0, unneeded = 0;
    for (int i = 0; i < 1500; ++i) {
      const Point3 p = any_in(random, box(-1.6, -1.6, -1.6, 1.6, 1.6, 1.6));
      const bool says = space.is_free(p), fits = fits_turned(plain, body, p);
      free += fits ? 1 : 0;
      wrong += says && !fits ? 1 : 0;
      lost += fits && !says ? 1 : 0;
      // Lost are places that lack less than two voxels.
      unneeded += fits && !says && fits_turned(plain, body, p, 1.8 * voxel) ? 1 : 0;
      if (says) CHECK(is_body_free(space, body, {p, random.uniform(-kPi, kPi)}));
    }
    CHECK(wrong == 0);
    CHECK(unneeded == 0);
    CHECK(free > 200 && lost < 0.15 * free);
  };
  check(EllipsoidBody{{0.5, 0.5, 0.15}}, 1, {});
  check(EllipsoidBody{{0.5, 0.2, 0.2}}, 2, {.margin = 0.05});
  check(EllipsoidBody{{0.15, 0.15, 0.5}}, 3, {.unknown_is_obstacle = false});
  check(EllipsoidBody{{0.45, 0.3, 0.25}}, 4, {.margin = 0.25, .unknown_margin = 0.1});
  check(BoxBody{box(-0.4, -0.2, -0.1, 0.4, 0.2, 0.15)}, 5, {});
  check(BoxBody{box(-0.3, -0.3, -0.4, 0.1, 0.2, 0.0)}, 6, {});  // hangs below its position
}

TEST(a_body_s_free_space_follows_the_map) {
  for (const bool unknown : {true, false}) {
    TsdfMap tsdf({.voxel_size = 0.15});
    VoxelStateMap states(tsdf);
    FreeSpaceOptions o = options_for(EllipsoidBody{{0.7, 0.7, 0.2}}, box(-2, -2, -2, 2, 2, 2));
    o.unknown_is_obstacle = unknown;
    o.keep_out = {{box(0.4, 0.4, 0.4, 0.7, 0.7, 0.9)}};
    FreeSpace space(states, o);
    Random random(9);
    const Box3 all = box(-2, -2, -2, 2, 2, 2);
    for (int step = 0; step < 8; ++step) {
      const Point3 c = any_in(random, all);
      Boxes scene{{Box3(c, c + Point3::Constant(0.3))}};
      const Point3 e = Point3::Constant(random.uniform(0.5, 2.0));
      observe(tsdf, Box3(c - e, c + e), scene);
      states.update(tsdf);
      if (step == 4) space.add_known_free({Point3(0.5, 0, 0), 1.4});
      space.update();
      FreeSpace fresh(states, o);
      if (step >= 4) fresh.add_known_free({Point3(0.5, 0, 0), 1.4});
      fresh.update();
      auto a = space.probe(), b = fresh.probe();
      int differences = 0;
      for_each_index(VoxelIndex::Constant(-20), VoxelIndex::Constant(20), [&](const VoxelIndex& v) {
        differences += a.squared(v) != b.squared(v) ? 1 : 0;
        differences += space.is_obstacle(v) != fresh.is_obstacle(v) ? 1 : 0;
        differences += space.is_free_voxel(v) != fresh.is_free_voxel(v) ? 1 : 0;
      });
      CHECK(differences == 0);
    }
  }
}

TEST(a_body_keeps_out_of_boxes_and_starts_in_known_free_balls) {
  const EllipsoidBody body{{0.5, 0.5, 0.12}};
  TsdfMap tsdf({.voxel_size = 0.1});
  const Box3 closed = box(-2, -2, 0.35, 2, 2, 0.5);
  for (const double margin : {0.0, 0.1}) {
    observe(tsdf, box(-3, -3, -3, 3, 3, 3), Boxes{});
    VoxelStateMap states(tsdf);
    FreeSpaceOptions o = options_for(body, box(-2, -2, -2, 2, 2, 2));
    o.margin = margin;
    o.keep_out = {{closed}};
    const FreeSpace space(states, o);
    double highest = -2.0;
    for (double z = -1.0; z < 0.5; z += 0.01)
      if (space.is_free({0.03, 0.02, z})) highest = z;
    CHECK(highest <= 0.35 - 0.12 && highest > 0.35 - 0.12 - margin - 0.3);
    o.shape.reset();
    CHECK(!FreeSpace(states, o).is_free({0.03, 0.02, highest}));
  }
  TsdfMap nothing({.voxel_size = 0.1});
  const VoxelStateMap unknown(nothing);
  FreeSpace space(unknown, options_for(body, Box3()));
  space.add_known_free({Point3(1, 2, 3), space.required_distance() + 0.2});
  space.update();
  CHECK(space.is_free({1, 2, 3}) && !space.is_free({2, 2, 3}));
}

TEST(a_flat_body_goes_through_a_slot_that_its_ball_does_not_fit_into) {
  check_slot(EllipsoidBody{{0.6, 0.6, 0.15}}, 64, 0.05);
  check_slot(BoxBody{box(-0.5, -0.3, -0.12, 0.5, 0.3, 0.12)}, 64, 0.05);
}

TEST(shapes_are_checked) {
  TsdfMap tsdf({.voxel_size = 0.1});
  const VoxelStateMap states(tsdf);
  FreeSpaceOptions o = options_for(EllipsoidBody{{0.6, 0.6, 0.2}}, Box3());
  o.radius = 0.5;
  CHECK_THROWS(Error, FreeSpace(states, o));
  o = options_for(EllipsoidBody{{2.3, 2.3, 0.2}}, Box3());
  CHECK_THROWS(Error, FreeSpace(states, o));
}
