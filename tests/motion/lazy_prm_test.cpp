// SPDX-License-Identifier: MIT
#include <surfleet/motion/lazy_prm.hpp>

#include <array>
#include <set>

#include "check.hpp"
#include "motion_scenes.hpp"

namespace {
using namespace surfleet;
using namespace motion_scenes;

/// Two rooms joined by a door in a wall at x = 0.
struct TwoRooms {
  TsdfMap tsdf{{.voxel_size = 0.3}};
  Boxes scene{{box(-0.3, -9, -4, 0.3, 2, 4), box(-0.3, 5.2, -4, 0.3, 9, 4)}};
  Box3 bounds = box(-8, -8, -3, 8, 8, 3);
  TwoRooms() { observe(tsdf, box(-9, -9, -4, 9, 9, 4), scene); }
};

bool path_is_free(const FreeSpace& space, const Path& path) {
  auto read = space.probe();
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const Point3 a = path.points[i - 1], b = path.points[i];
    const int n = static_cast<int>((b - a).norm() / 0.01) + 1;
    for (int k = 0; k <= n; ++k)
      if (read.slack(a + (b - a) * (static_cast<double>(k) / n)) < -0.026) return false;
  }
  return true;
}
}  // namespace

TEST(finds_the_door_and_a_short_path_through) {
  TwoRooms rooms;
  const VoxelStateMap states(rooms.tsdf);
  FreeSpace space(states, {.radius = 1.0, .bounds = rooms.bounds});
  LazyPrmStar roadmap(space);
  const Point3 a(-4, -5, 0), b(4, -5, 0);
  const auto path = roadmap.query(a, b);
  CHECK(path.has_value());
  if (!path) return;
  CHECK((path->points.front() - a).norm() < 1e-12 && (path->points.back() - b).norm() < 1e-12);
  CHECK_NEAR(path->length, polyline_length(path->points), 1e-9);
  CHECK(path_is_free(space, *path));
  // The shortest path bends round the door's edge at no less than radius from it.
  const double least = 2.0 * (Point3(-4, -5, 0) - Point3(0, 3.0, 0)).norm();
  CHECK(path->length > least);
  CHECK(path->length < 1.1 * least);
  // Straight when in sight; nothing where there is nothing.
  CHECK_NEAR(roadmap.query({-4, -5, 0}, {-4, 5, 0})->length, 10.0, 1e-12);
  CHECK(!roadmap.query(a, {0, -5, 0}));
  CHECK(!roadmap.query(a, {20, 0, 0}));
}

TEST(distances_bound_and_match_queries) {
  TwoRooms rooms;
  const VoxelStateMap states(rooms.tsdf);
  FreeSpace space(states, {.radius = 1.0, .bounds = rooms.bounds});
  LazyPrmStar roadmap(space);
  const Point3 from(-4, -5, 0);
  std::vector<Point3> targets{{-4, 5, 0}, {4, -5, 0}, {4, 5, 1}, {0, -5, 0}, {30, 0, 0}, from};
  const auto d = roadmap.distances(from, targets);
  CHECK_NEAR(d[0], 10.0, 1e-12);
  CHECK(std::isinf(d[3]) && std::isinf(d[4]));
  CHECK_NEAR(d[5], 0.0, 1e-12);
  for (const std::size_t i : {1U, 2U}) {
    const double exact = roadmap.query(from, targets[i])->length;
    CHECK(d[i] >= exact - 1e-9);
    CHECK(d[i] < 1.35 * exact);
  }
}

TEST(a_robot_leaves_a_place_too_narrow_for_the_lattice) {
  // A body so small that it fits diagonally between obstacles, where no row of voxel centres does.
  int pockets = 0, exits = 0;
  for (int round = 0; round < 8; ++round) {
    Random random(static_cast<std::uint64_t>(round));
    const double density = 0.06 + 0.01 * round;
    TsdfMap tsdf({.voxel_size = 0.3});
    observe(tsdf, box(-3, -3, -3, 3, 3, 3),
            [&](const Point3&) { return random.uniform() < density ? -0.1 : 0.3; });
    const VoxelStateMap states(tsdf);
    const FreeSpace space(states, {.radius = 0.2, .margin = 0.1});
    LazyPrmStar roadmap(space, {.spacing = 1.0, .escape_distance = 1.0});
    const ReachableSet& set = roadmap.reachable_set();
    const auto place = [&] {
      return Point3(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
    };
    for (int i = 0; i < 3000; ++i) {
      const Point3 p = place(), q = place();
      const auto own = set.component(p), home = set.component(q);
      if (!space.is_free(p) || !home) continue;
      // Brute force: a straight line to a larger piece of the lattice that leads to q?
      bool leads_out = false;
      if (own != home && (!own || set.size(*own) < set.size(*home))) {
        ++pockets;
        const VoxelIndex middle = space.grid().index_of(p);
        for_each_index(middle - VoxelIndex::Constant(5), middle + VoxelIndex::Constant(5),
                       [&](const VoxelIndex& v) {
                         const Point3 c = space.grid().center(v);
                         leads_out |= set.component(v) == home && (c - p).norm() <= 1.0 &&
                                      space.is_free_segment(p, c);
                       });
        exits += leads_out ? 1 : 0;
      }
      const auto path = roadmap.query(p, q);
      CHECK(path.has_value() == (own == home || leads_out || space.is_free_segment(p, q)));
      CHECK(roadmap.reachable(p, q) == path.has_value());
      CHECK(std::isfinite(roadmap.distances(p, std::array{q})[0]) == path.has_value());
      if (path)
        CHECK(path_is_free(space, *path) && (path->points.front() - p).norm() < 1e-12 &&
              (path->points.back() - q).norm() < 1e-12);
    }
  }
  CHECK(pockets > 50 && exits > 5);
}

TEST(repairs_itself_as_the_map_changes) {
  TwoRooms rooms;
  TsdfMap tsdf({.voxel_size = 0.3});
  observe(tsdf, box(-9, -9, -4, -2, 9, 4), rooms.scene);
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 1.0, .bounds = rooms.bounds});
  LazyPrmStar roadmap(space);
  const Point3 a(-5, -5, 0), b(5, -5, 0);
  CHECK(roadmap.query(a, {-5, 5, 0}).has_value());
  CHECK(!roadmap.query(a, b));
  CHECK(!roadmap.reachable(a, b));
  const auto follow = [&] {
    states.update(tsdf);
    space.update();
    roadmap.update();
  };
  observe(tsdf, box(-9, -9, -4, 9, 9, 4), rooms.scene);  // the rest comes into view
  follow();
  const auto open = roadmap.query(a, b);
  CHECK(open && path_is_free(space, *open));
  rooms.scene.boxes.push_back(box(-0.6, 2, -4, 0.6, 5.2, 4));  // the door closes
  observe(tsdf, box(-1, 1, -4, 1, 6, 4), rooms.scene);
  follow();
  CHECK(!roadmap.query(a, b));
  rooms.scene.boxes.pop_back();
  observe(tsdf, box(-1, 1, -4, 1, 6, 4), rooms.scene);  // and opens
  follow();
  const auto again = roadmap.query(a, b);
  CHECK(again && path_is_free(space, *again));
  CHECK(again && open && again->length < 1.1 * open->length);
}

TEST(random_growth_keeps_every_answer_valid_and_complete) {
  Random random(11);
  TsdfMap tsdf({.voxel_size = 0.3});
  Boxes scene;
  for (int i = 0; i < 12; ++i) {
    const Point3 c(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-4, 2));
    scene.boxes.push_back(
        Box3(c, c + Point3(random.uniform(0.4, 5), random.uniform(0.4, 5), random.uniform(1, 6))));
  }
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 0.7, .bounds = box(-10, -10, -4, 10, 10, 4)});
  LazyPrmStar roadmap(space), twin(space);
  int found = 0, none = 0, wrong = 0;
  for (int step = 0; step < 15; ++step) {
    const Point3 c(random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-3, 3));
    observe(tsdf, Box3(c - Point3::Constant(5), c + Point3::Constant(5)), scene);
    states.update(tsdf);
    space.update();
    roadmap.update();
    twin.update();
    ReachableSet fresh(space);
    for (int k = 0; k < 60; ++k) {
      const auto draw = [&] {
        return Point3(random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(-4, 4));
      };
      const Point3 a = draw(), b = draw();
      if (!space.is_free(a)) continue;
      const auto path = roadmap.query(a, b);
      const bool expected = fresh.connected(a, b) || space.is_free_segment(a, b);
      wrong += path.has_value() != expected ? 1 : 0;
      ++(path ? found : none);
      if (path) wrong += path_is_free(space, *path) ? 0 : 1;
      if (k % 7 != 0)
        continue;  // The same history of updates: the same answer, whatever was asked.
      const auto other = twin.query(a, b);
      wrong += path.has_value() != other.has_value() || (path && path->points != other->points);
    }
    for (std::size_t i = 0; i < roadmap.size(); ++i) {
      const auto node = static_cast<std::int32_t>(i);
      if (roadmap.alive(node)) wrong += space.is_free(roadmap.position(node)) ? 0 : 1;
      for (const auto& arc : roadmap.arcs(node)) wrong += roadmap.alive(arc.to) ? 0 : 1;
    }
  }
  CHECK(found > 100);
  CHECK(none > 10);
  CHECK(wrong == 0);
}

TEST(leaves_a_place_that_is_no_longer_free) {
  TwoRooms rooms;
  const VoxelStateMap states(rooms.tsdf);
  FreeSpace space(states, {.radius = 1.0, .bounds = rooms.bounds});
  LazyPrmStar roadmap(space);
  const Point3 stuck(-1.2, -4.9, 0.1);
  CHECK(!space.is_free(stuck));
  const auto path = roadmap.query(stuck, {-5, -5, 0});
  CHECK(path && path->points.size() >= 3 && (path->points.front() - stuck).norm() < 1e-12);
}

TEST(a_winding_slit_needs_the_lattice) {
  // Roadmap samples 6 m apart cannot see round the bends; the lattice can.
  TsdfMap tsdf({.voxel_size = 0.2});
  Boxes scene;
  for (int i = 0; i < 4; ++i)
    scene.boxes.push_back(i % 2 == 0 ? box(2.0 * i, -3, -2, 2.0 * i + 0.4, 2, 2)
                                     : box(2.0 * i, -2, -2, 2.0 * i + 0.4, 3, 2));
  observe(tsdf, box(-3, -3, -1, 10, 3, 1), scene);
  const VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 0.2});
  LazyPrmStar roadmap(space, {.spacing = 6.0});
  const Point3 a(-2, 0, 0), b(9, 0, 0);
  const auto path = roadmap.query(a, b);
  CHECK(path && path_is_free(space, *path));
  const auto size = roadmap.size();
  const auto again = roadmap.query(a, b);
  CHECK(again && path && again->points == path->points);
  CHECK(roadmap.size() == size);
}

TEST(paths_become_shorter_as_the_roadmap_grows) {
  Random random(5);
  Boxes scene;
  for (int i = 0; i < 60; ++i) {
    const Point3 c(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-4, 3));
    scene.boxes.push_back(Box3(c, c + Point3(random.uniform(0.4, 2), random.uniform(0.4, 2), 3)));
  }
  TsdfMap tsdf({.voxel_size = 0.2});
  observe(tsdf, box(-10, -10, -4, 10, 10, 4), scene);
  const VoxelStateMap states(tsdf);
  const FreeSpace space(states, {.radius = 0.4, .bounds = box(-10, -10, -4, 10, 10, 4)});
  LazyPrmStar roadmap(space, {.samples = 6});
  std::vector<std::pair<Point3, Point3>> pairs;
  while (pairs.size() < 150) {
    const auto draw = [&] {
      const double x = random.uniform(-10, 10), y = random.uniform(-10, 10);
      return Point3(x, y, random.uniform(-4, 4));
    };
    const Point3 a = draw(), b = draw();
    if (roadmap.reachable(a, b) && space.is_free(a) && !space.is_free_segment(a, b))
      pairs.emplace_back(a, b);
  }
  // Over the straight line, in the mean.
  const auto detour = [&] {
    double sum = 0.0;
    for (const auto& [a, b] : pairs) sum += roadmap.query(a, b)->length / (a - b).norm();
    return sum / static_cast<double>(pairs.size());
  };
  const double at_first = detour();
  const std::size_t size = roadmap.size();
  roadmap.update();  // nothing has changed
  CHECK(roadmap.size() == size);
  roadmap.densify();
  const double at_last = detour();
  CHECK(roadmap.size() > 2 * size);
  CHECK(at_last - 1.0 < 0.9 * (at_first - 1.0));
  const std::size_t whole = roadmap.size();
  roadmap.densify();  // nothing is left to add
  CHECK(roadmap.size() == whole);
}

TEST(with_every_change_the_roadmap_grows_by_so_many_samples_at_most) {
  TsdfMap tsdf({.voxel_size = 0.3});
  const Boxes scene{{box(-3, -3, -1, -2, 3, 1), box(1, -3, -1, 2, 3, 1)}};
  VoxelStateMap states(tsdf);
  FreeSpace space(states, {.radius = 0.3, .bounds = box(-9, -5, -3, 9, 5, 3)});
  LazyPrmStar sparse(space, {.samples = 1}), dense(space, {.growth = 3});
  std::ptrdiff_t more = 0;
  for (double x = -8.0; x < 8.0; x += 0.5) {
    observe(tsdf, box(x, -5, -3, x + 0.5, 5, 3), scene);
    states.update(tsdf);
    space.update();
    sparse.update();
    dense.update();
    const auto alive = [](const LazyPrmStar& roadmap) {
      std::ptrdiff_t count = 0;
      for (std::size_t i = 0; i < roadmap.size(); ++i)
        count += roadmap.alive(static_cast<std::int32_t>(i)) ? 1 : 0;
      return count;
    };
    const std::ptrdiff_t now = alive(dense) - alive(sparse);
    CHECK(now <= more + 3);
    more = now;
  }
  CHECK(more > 20);
}

TEST(roadmap_settings_are_checked) {
  TsdfMap tsdf({.voxel_size = 0.3});
  const VoxelStateMap states(tsdf);
  const FreeSpace space(states);
  CHECK_THROWS(Error, LazyPrmStar(space, {.spacing = 0.0}));
  CHECK_THROWS(Error, LazyPrmStar(space, {.samples = 0}));
  CHECK_THROWS(Error, LazyPrmStar(space, {.growth = 0}));
  LazyPrmStar roadmap(space);  // an empty map
  CHECK(!roadmap.query({0, 0, 0}, {1, 1, 1}));
  CHECK(roadmap.distances({0, 0, 0}, std::vector<Point3>{}).empty());
}
