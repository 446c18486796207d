// SPDX-License-Identifier: MIT
#include <surfleet/motion/body_check.hpp>
#include <surfleet/motion/free_space.hpp>

#include <limits>

#include <surfleet/core/random.hpp>

#include "check.hpp"
#include "motion_scenes.hpp"

namespace {
using namespace surfleet;
using namespace motion_scenes;

/// Whether a voxel is an obstacle, by searching all voxels around for an occupied one within the
/// growth [voxels].
bool brute_obstacle(const FreeSpace& space, const VoxelIndex& v) {
  const FreeSpaceOptions& o = space.options();
  if (space.map()(v) == VoxelState::unknown && o.unknown_is_obstacle) return true;
  const double h = space.voxel_size(), margin = o.margin.value_or(h);
  const double more = margin - o.unknown_margin.value_or(margin);
  const double growth = more > 0.0 ? more / h + 0.5 : 0.0;
  const VoxelIndex most = VoxelIndex::Constant(static_cast<int>(growth));
  bool grown = false;
  for_each_index(v - most, v + most, [&](const VoxelIndex& w) {
    grown = grown ||
            (space.map()(w) == VoxelState::occupied && (w - v).cast<double>().norm() <= growth);
  });
  return grown;
}
/// Distance to the nearest obstacle voxel's centre by measuring all of them within `reach`.
double brute_distance(const FreeSpace& space, const Point3& p, double reach) {
  double best = reach;
  const VoxelIndex lo = space.grid().index_of(p - Point3::Constant(reach));
  const VoxelIndex hi = space.grid().index_of(p + Point3::Constant(reach));
  for_each_index(lo, hi, [&](const VoxelIndex& v) {
    const double distance = (space.grid().center(v) - p).norm();
    if (distance < best && brute_obstacle(space, v)) best = distance;
  });
  return best;
}

void grow_and_compare(const FreeSpaceOptions& options, double voxel) {
  TsdfMap tsdf({.voxel_size = voxel});
  VoxelStateMap states(tsdf);
  FreeSpace space(states, options);
  Random random(7);
  Boxes scene{{box(-1, -1, -1, 0.5, 0.4, 0.3)}};
  const double range = 10 * voxel;
  for (int step = 0; step < 12; ++step) {
    const Point3 c(random.uniform(-range, range), random.uniform(-range, range),
                   random.uniform(-range, range));
    const Point3 e(random.uniform(1, range), random.uniform(1, range), random.uniform(1, range));
    if (step == 8) scene.boxes.push_back(Box3(c, c + Point3::Constant(2 * voxel)));
    observe(tsdf, Box3(c - e, c + e), scene);
    states.update(tsdf);
    space.update();
    // What was kept up to date is what a new object would compute.
    const FreeSpace fresh(states, space.options());
    auto a = space.probe(), b = fresh.probe();
    int differences = 0, wrong = 0;
    for (int i = 0; i < 2000; ++i) {
      const VoxelIndex v(static_cast<int>(random.below(60)) - 30,
                         static_cast<int>(random.below(60)) - 30,
                         static_cast<int>(random.below(60)) - 30);
      differences += a.squared(v) != b.squared(v) ? 1 : 0;
      differences += space.is_free_voxel(v) != fresh.is_free_voxel(v) ? 1 : 0;
      wrong += space.is_obstacle(v) != brute_obstacle(space, v) ? 1 : 0;
    }
    const double reach = space.required_distance() + 3 * voxel;
    for (int i = 0; i < 60; ++i) {
      const Point3 p(random.uniform(-2 * range, 2 * range), random.uniform(-2 * range, 2 * range),
                     random.uniform(-2 * range, 2 * range));
      const double exact = brute_distance(space, p, reach);
      const double slack = a.slack(p);
      // Never too optimistic; not much too pessimistic where it matters.
      if (slack > exact - space.required_distance() + (slack < 0.0 ? 0.1 * voxel : 1e-9)) ++wrong;
      if (slack < 0.0 && exact > space.required_distance() + voxel) ++wrong;
      // And at centres exact up to the stated excess.
      const VoxelIndex v = space.grid().index_of(p);
      const double at_center = brute_distance(space, space.grid().center(v), reach + voxel);
      if (at_center < reach - 2 * voxel)
        wrong += std::abs(voxel * std::sqrt(static_cast<double>(a.squared(v))) - at_center) > 1e-6;
    }
    CHECK(differences == 0);
    CHECK(wrong == 0);
  }
}
}  // namespace

TEST(incremental_equals_fresh_and_bounds_hold) {
  grow_and_compare({.radius = 0.6}, 0.3);
  grow_and_compare({.radius = 0.6, .unknown_is_obstacle = false}, 0.3);
  grow_and_compare({.radius = 1.0}, 0.15);
  grow_and_compare({.radius = 0.9, .unknown_is_obstacle = false}, 0.15);
  // Nearer to what is unknown than to what is occupied.
  grow_and_compare({.radius = 0.4, .margin = 0.4, .unknown_margin = 0.15}, 0.15);
  grow_and_compare({.radius = 0.6, .margin = 0.4, .unknown_margin = 0.35}, 0.3);
  grow_and_compare(
      {.radius = 0.4, .unknown_is_obstacle = false, .margin = 0.4, .unknown_margin = 0.15}, 0.15);
  grow_and_compare({.radius = 0.3, .margin = 0.9, .unknown_margin = 0.0}, 0.15);
}

TEST(margins_of_what_is_occupied_and_of_what_is_unknown) {
  TsdfMap tsdf({.voxel_size = 0.15});
  const Boxes scene{{box(-4, -4, -2, 4, 4, 0)}};
  observe(tsdf, box(-3, -3, -2, 3, 3, 3), scene);
  VoxelStateMap states(tsdf);
  const FreeSpaceOptions wide{.radius = 0.5, .margin = 0.6};
  FreeSpaceOptions both = wide;
  both.unknown_margin = 0.15;
  const FreeSpace before(states, wide), space(states, both);
  // Over the ground the margin is the wide one, towards the sky the small one.
  const auto lowest = [](const FreeSpace& s) {
    double z = 0.0;
    while (!s.is_free({0, 0, z})) z += 0.01;
    return z;
  };
  const auto highest = [](const FreeSpace& s) {
    double z = 3.0;
    while (!s.is_free({0, 0, z})) z -= 0.01;
    return z;
  };
  CHECK(std::abs(lowest(space) - lowest(before)) <= 0.5 * 0.15 + 0.02);
  CHECK(highest(space) - highest(before) > 0.6 - 0.15 - 0.04);
  CHECK(highest(space) - highest(before) < 0.6 - 0.15 + 0.04);
}

TEST(free_positions_keep_the_radius_from_a_smooth_surface) {
  // A ball observed from outside: wherever the body is said to fit, it stays clear of the true
  // surface.
  for (const double voxel : {0.3, 0.2}) {
    TsdfMap tsdf({.voxel_size = voxel});
    const Point3 center(0.11, 0.23, 0.37);
    observe(tsdf, box(-6, -6, -6, 6, 6, 6),
            [&](const Point3& p) { return (p - center).norm() - 2.0; });
    VoxelStateMap states(tsdf);
    FreeSpace space(states, {.radius = 1.0, .unknown_is_obstacle = false});
    Random random(3);
    double nearest = 1e9;
    for (int i = 0; i < 20000; ++i) {
      const Point3 p(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5));
      if (space.is_free(p)) nearest = std::min(nearest, (p - center).norm() - 2.0);
    }
    CHECK(nearest >= 1.0);
    CHECK(nearest < 1.0 + 1.5 * voxel);
  }
}

TEST(segments_agree_with_points) {
  TsdfMap tsdf({.voxel_size = 0.3});
  observe(tsdf, box(-8, -8, -4, 8, 8, 4),
          Boxes{{box(-1, -1, -4, 1, 1, 4), box(3, 3, -4, 4, 8, 1)}});
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 0.8, .bounds = box(-7, -7, -3, 7, 7, 3)});
  Random random(5);
  int free = 0, blocked = 0, wrong = 0;
  const auto draw = [&] {
    return Point3(random.uniform(-7.2, 7.2), random.uniform(-7.2, 7.2), random.uniform(-3, 3));
  };
  auto read = space.probe();
  for (int i = 0; i < 3000; ++i) {
    const Point3 a = draw(), b = draw();
    double least = 1e9;
    for (int k = 0; k <= 500; ++k) {
      const Point3 p = a + (b - a) * (k / 500.0);
      least = std::min(least, space.in_bounds(p) ? read.slack(p) : -1.0);
    }
    const bool yes = space.is_free_segment(a, b);
    ++(yes ? free : blocked);
    if (yes && least < -0.026) ++wrong;  // half a step
    if (!yes && least > 0.001) ++wrong;
  }
  CHECK(free > 200 && blocked > 200);
  CHECK(wrong == 0);
  CHECK(space.free_length({-5, 0, 0}, {5, 0, 0}) > 1.0);
  CHECK(space.free_length({-5, 0, 0}, {5, 0, 0}) < 5.0);
}

TEST(lattice_edges_are_free_segments) {
  TsdfMap tsdf({.voxel_size = 0.25});
  observe(tsdf, box(-6, -6, -3, 6, 6, 3),
          Boxes{{box(-1, -1, -3, 1, 1, 3), box(2, -6, -3, 3, 2, 3)}});
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 0.5});
  int edges = 0, wrong = 0;
  for (int z = -12; z < 12; ++z)
    for (int y = -24; y < 24; ++y)
      for (int x = -24; x < 24; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          VoxelIndex v(x, y, z), w = v;
          ++w[axis];
          if (!space.is_free_voxel(v) || !space.is_free_voxel(w)) continue;
          ++edges;
          wrong += !space.is_free_segment(space.grid().center(v), space.grid().center(w));
        }
  CHECK(edges > 1000);
  CHECK(wrong == 0);
}

TEST(known_free_ball_makes_room_and_keeps_occupied) {
  TsdfMap tsdf({.voxel_size = 0.3});
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 1.0});
  CHECK(!space.is_free({0, 0, 2}));
  space.add_known_free({{0, 0, 2}, space.required_distance() + 0.6});
  CHECK(space.update() > 0);
  CHECK(space.is_free({0, 0, 2}));
  CHECK(!space.is_free({1.5, 0, 2}));
  observe(tsdf, box(0.9, -0.3, 1.7, 1.2, 0.3, 2.3), [](const Point3&) { return -0.1; });
  states.update(tsdf);
  space.update();
  CHECK(!space.is_free({0, 0, 2}));
}

TEST(escape_from_a_place_that_is_not_free) {
  TsdfMap tsdf({.voxel_size = 0.3});
  observe(tsdf, box(-6, -6, -4, 6, 6, 4), Boxes{{box(0, -6, -4, 1, 6, 4)}});
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 1.0});
  const Point3 stuck(-0.8, 0, 0);
  CHECK(!space.is_free(stuck));
  const auto out = space.nearest_free(stuck, 2.0);
  CHECK(out.has_value());
  CHECK(out && space.is_free(*out) && out->x() < stuck.x());
  CHECK(!space.nearest_free({0.5, 0, 0}, 0.5));
}

TEST(bodies_of_any_shape) {
  TsdfMap tsdf({.voxel_size = 0.1});
  observe(tsdf, box(-3, -3, -2, 3, 3, 2), Boxes{{box(0.5, -3, -2, 0.7, 3, 2)}});
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 0.55});
  const EllipsoidBody robot{{0.55, 0.25, 0.25}};
  // Along the wall it passes where across it does not.
  const Point3 p(0.05, 0, 0);
  CHECK(is_body_free(space, robot, {p, kPi / 2}));
  CHECK(!is_body_free(space, robot, {p, 0.0}));
  CHECK(!is_body_free(space, SphereBody{0.55}, {p, 0.0}));
  CHECK(is_body_free(space, SphereBody{0.25}, {p, 0.0}));
  CHECK(is_body_free(space, robot, {{-1, 0, 0}, 0.0}));
  // The ellipsoid against brute force over its surface.
  Random random(9);
  int wrong = 0;
  for (int i = 0; i < 200; ++i) {
    const Configuration q{Point3::Zero(), random.uniform(-3, 3)};
    const Sphere ball{Point3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)),
                      random.uniform(0.01, 0.3)};
    double nearest = 1e9;
    const Point3 c = Eigen::AngleAxisd(-q.yaw, Eigen::Vector3d::UnitZ()) * ball.center;
    if ((c.array() / robot.semi_axes.array()).matrix().norm() <= 1.0) nearest = 0.0;
    for (int a = 0; a < 120; ++a)
      for (int b = 0; b <= 60; ++b) {
        const double u = a * kPi / 60, v = b * kPi / 60;
        const Point3 s(0.55 * std::cos(u) * std::sin(v), 0.25 * std::sin(u) * std::sin(v),
                       0.25 * std::cos(v));
        nearest = std::min(nearest, (s - c).norm());
      }
    if (std::abs(nearest - ball.radius) > 0.01)
      wrong += robot.touches(q, ball) != (nearest < ball.radius);
  }
  CHECK(wrong == 0);
}

TEST(keep_out_boxes_block_paths_and_nothing_else) {
  const Box3 closed = box(-0.5, -0.4, -0.35, 0.55, 0.3, 0.6);
  for (const bool unknown : {true, false})
    for (const double margin : {0.0, 0.1, 0.2}) {
      TsdfMap tsdf({.voxel_size = 0.1});
      observe(tsdf, box(-3, -3, -3, 3, 3, 3), Boxes{});
      VoxelStateMap states(tsdf);
      FreeSpaceOptions o{.radius = 0.4,
                         .unknown_is_obstacle = unknown,
                         .bounds = box(-2, -2, -2, 2, 2, 2),
                         .margin = margin};
      const FreeSpace open(states, o);
      o.keep_out = {{closed, box(1e5, 1e5, 1e5, 2e5, 2e5, 2e5)}};
      FreeSpace space(states, o);
      const double most = 0.4 + margin + 0.4;  // what it takes at the most
      Random random(5);
      int in = 0, beside = 0;
      for (int i = 0; i < 4000; ++i) {
        const Point3 p(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
        const Point3 q(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
        const double d = closed.exteriorDistance(p);
        if (d < 0.4) CHECK(!space.is_free(p));
        if (d > most) CHECK(space.is_free(p) == open.is_free(p));
        (d < 0.4 ? in : beside) += open.is_free(p) ? 1 : 0;
        if (!space.is_free_segment(p, q)) continue;
        for (double t = 0.0; t <= 1.0; t += 0.05)
          CHECK(closed.exteriorDistance(p + t * (q - p)) >= 0.4 - 1e-9);
      }
      CHECK(in > 100 && beside > 100);
      // What the map or an operator says does not open it.
      space.add_known_free({Point3(0, 0, 0), 2.0});
      space.update();
      CHECK(!space.is_free({0, 0, 0}) && !space.nearest_free({0, 0, 0}, 0.3));
      CHECK(space.map()(VoxelIndex(0, 0, 0)) == VoxelState::empty);
    }
  // Where the map has nothing at all and unknown space is free.
  TsdfMap nothing({.voxel_size = 0.1});
  const VoxelStateMap unknown(nothing);
  const FreeSpace blind(unknown,
                        {.radius = 0.4, .unknown_is_obstacle = false, .keep_out = {{closed}}});
  CHECK(!blind.is_free({0, 0, 0}) && !blind.is_free({0, 0.65, 0}) && blind.is_free({0, 1.3, 0}));
  CHECK(!blind.is_free_segment({-2, 0, 0}, {2, 0, 0}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS(Error, FreeSpace(unknown, {.keep_out = {{box(nan, 0, 0, 1, 1, 1)}}}));
}

TEST(blocks_that_nothing_is_known_of_need_not_be_there) {
  TsdfMap tsdf({.voxel_size = 0.3});
  VoxelStateMap states(tsdf);
  FreeSpaceOptions o{
      .radius = 0.6, .unknown_is_obstacle = false, .bounds = box(-30, -30, -30, 30, 30, 30)};
  FreeSpace all(states, o);
  o.all_blocks = false;
  FreeSpace few(states, o);
  CHECK(100 * few.memory_bytes() < all.memory_bytes());
  Random random(11);
  const Boxes scene{{box(-2, -2, -2, 2, 2, 0), box(4, 4, -1, 5, 9, 6)}};
  for (int round = 0; round < 4; ++round) {
    const double r = 2.0 + 2.0 * round;
    observe(tsdf, box(-r, -r, -r, r, r, r), scene);
    states.update(tsdf);
    all.update();
    few.update();
    int blocked = 0;
    for (int i = 0; i < 3000; ++i) {
      const auto any = [&] {
        return Point3(random.uniform(-12, 12), random.uniform(-12, 12), random.uniform(-12, 12));
      };
      const Point3 p = any(), q = any();
      CHECK(few.is_free(p) == all.is_free(p) && few.free_length(p, q) == all.free_length(p, q));
      CHECK(few.is_free_voxel(few.grid().index_of(p)) == all.is_free_voxel(all.grid().index_of(p)));
      blocked += few.is_free(p) ? 0 : 1;
    }
    CHECK(blocked > 10);
  }
  CHECK(10 * few.memory_bytes() < all.memory_bytes());
}

TEST(free_space_settings_are_checked) {
  TsdfMap tsdf({.voxel_size = 0.1});
  VoxelStateMap states(tsdf);
  CHECK_THROWS(Error, FreeSpace(states, {.radius = -1.0}));
  CHECK_THROWS(Error, FreeSpace(states, {.radius = 5.0}));
  CHECK_THROWS(Error, FreeSpace(states, {.radius = 0.5, .margin = -0.1}));
  CHECK_THROWS(Error, FreeSpace(states, {.radius = 0.5, .margin = 0.1, .unknown_margin = 0.2}));
  CHECK_THROWS(Error, FreeSpace(states, {.radius = 0.5, .margin = 0.1, .unknown_margin = -0.1}));
  CHECK_THROWS(Error, FreeSpace(states, {.radius = 0.5, .margin = 0.9, .unknown_margin = 0.1}));
  FreeSpace space(states, {.radius = 0.5});
  CHECK(!space.is_free({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
  CHECK(!space.is_free({1e30, 0, 0}));
}
