// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/sight_targets.hpp>

#include "check.hpp"

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/bvh.hpp>

namespace {
using namespace surfleet;

static_assert(TargetSight<MapSight> && TargetSight<MeshSight<Bvh>>);

/// A cube of known empty voxels with a wall x = 5 … 6 m across its middle.
TsdfMap walled_room() {
  TsdfMap map({.voxel_size = 0.25});
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        const bool wall = x >= 20 && x < 24 && y < 20;
        map.ensure({x, y, z}) = {wall ? -0.2F : 0.2F, 1.0F};
      }
  for (std::uint32_t s = 0; s < map.block_count(); ++s) map.mark_changed(s);
  return map;
}
PinholeCamera camera() {
  return PinholeCamera::from_fov(radians(90.0), radians(60.0), 90, 52, 0.5, 6.0);
}

/// `range` is a distance or else a depth.
void check_by_brute_force(bool by_depth, double range, const std::vector<double>& pitches) {
  const TsdfMap map = walled_room();
  const VoxelStateMap states(map);
  const PinholeCamera c = camera();
  Random random(5);
  std::vector<SightTarget> targets;
  for (int i = 0; i < 400; ++i)
    targets.push_back(
        {Point3(random.uniform(0.1, 9.9), random.uniform(0.1, 9.9), random.uniform(0.1, 9.9)),
         i % 3 == 0
             ? Eigen::Vector3d::Zero()
             : Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized(),
         1.0, 0});
  const HeadingTable table(c, forward_camera_mount(0.2, Point3::Zero()), pitches);
  CHECK(table.views() == kHeadings * static_cast<int>(pitches.size()));
  const SightTargets sight(targets, MapSight(states), table,
                           {.max_range = range, .by_depth = by_depth});
  int borderline = 0, tilted = 0, too_deep = 0, farther = 0, seen_count = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Point3 p(random.uniform(0.5, 4.5), random.uniform(0.5, 9.5), random.uniform(0.5, 9.5));
    std::vector<ViewBits> views(targets.size(), 0);
    for (const Sighting& s : sight.seen_from(p)) {
      CHECK(views[static_cast<std::size_t>(s.target)] == 0 && s.views != 0);  // named once
      views[static_cast<std::size_t>(s.target)] = s.views;
    }
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const Eigen::Vector3d d = targets[i].position - p;
      bool clear = by_depth || d.norm() <= range;
      if (!targets[i].normal.isZero())
        clear = clear && -d.normalized().dot(targets[i].normal) >= std::cos(1.4);
      const VoxelIndex goal = map.index_of(targets[i].position);
      traverse_voxels(p, targets[i].position, 0.25, [&](const VoxelIndex& v) {
        if (v != goal && states(v) != VoxelState::empty) clear = false;
        return true;
      });
      for (int k = 0; k < kMostViews; ++k) {
        const auto pitch = static_cast<std::size_t>(k / kHeadings);
        if (pitch >= pitches.size()) {
          CHECK(!has_view(views[i], k));
          continue;
        }
        // A mount tilts the other way about its own x axis.
        Pose T = Configuration{p, heading_angle(k % kHeadings)}.pose() * forward_camera_mount();
        T.rotate(Eigen::AngleAxisd(-0.2 - pitches[pitch], Eigen::Vector3d::UnitX()));
        const Point3 q = T.inverse() * targets[i].position;
        const bool expected = clear && q.z() >= c.min_range && (!by_depth || q.z() <= range) &&
                              c.project(q).has_value();
        const bool got = has_view(views[i], k);
        tilted += got && k >= kHeadings ? 1 : 0;
        too_deep += got && by_depth && q.z() > 1.03 * range ? 1 : 0;
        farther += got && q.norm() > 1.2 * range ? 1 : 0;
        seen_count += expected ? 1 : 0;
        // Headings are tabulated by direction, so only targets near the image's edge may differ.
        if (expected != got) ++borderline;
      }
    }
  }
  CHECK(seen_count > 500 * static_cast<int>(pitches.size()) &&
        (tilted > 500) == (pitches.size() > 1));
  // By depth the last of a shell is left out, besides.
  CHECK(borderline < seen_count / (by_depth ? 6 : 12));
  CHECK(too_deep == 0 && (farther > 0) == by_depth);
}
TEST(agrees_with_brute_force) {
  for (const bool by_depth : {false, true}) {
    check_by_brute_force(by_depth, 5.0, {0.0});
    check_by_brute_force(by_depth, 5.0, {0.0, 0.9, -0.9});
    check_by_brute_force(by_depth, 5.0, {-1.2, 0.3, 0.0, 0.9});
  }
}
TEST(views_are_named_by_heading_and_pitch) {
  const HeadingTable level(camera(), forward_camera_mount());
  const HeadingTable table(camera(), forward_camera_mount(), {0.0, 0.9, -0.9});
  for (int v = 0; v < table.views(); ++v) {
    const Configuration q = table.at({1, 2, 3}, v);
    CHECK(table.nearest_view(q) == v && q.position == Point3(1, 2, 3));
    CHECK(table.nearest_view({q.position, q.yaw + 0.1, 0.9 * q.pitch + 0.02}) == v);
    CHECK(level.nearest_view(q) == v % kHeadings);
    // What is ahead of the camera is in this view.
    const Eigen::Vector3d ahead = camera_pose(q, forward_camera_mount()).linear().col(2);
    CHECK(has_view(table(ahead), v) && std::abs(ahead.z() + std::sin(q.pitch)) < 1e-12);
    CHECK(has_view(level(ahead), v) == (v < kHeadings));
  }
  for (const auto& wrong : {std::vector<double>{}, std::vector<double>(5, 0.0), {0.0, 1.7}})
    CHECK_THROWS(Error, HeadingTable(camera(), forward_camera_mount(), wrong));
}

TEST(nothing_is_seen_through_a_wall_and_little_through_the_unknown) {
  const TsdfMap map = walled_room();
  const VoxelStateMap states(map);
  const Point3 eye(3.0, 2.0, 5.0);
  const std::vector<SightTarget> targets{{Point3(7.0, 2.0, 5.0), Eigen::Vector3d::Zero(), 1.0, 0},
                                         {Point3(4.8, 2.0, 5.0), Eigen::Vector3d::Zero(), 1.0, 0},
                                         {Point3(-1.0, 2.0, 5.0), Eigen::Vector3d::Zero(), 1.0, 0},
                                         {Point3(-1.0, 2.0, 5.1), Eigen::Vector3d::Zero(), 1.0, 9}};
  const HeadingTable headings(camera(), forward_camera_mount());
  const SightTargets sight(targets, MapSight(states), headings, {});
  std::vector<std::int32_t> seen;
  for (const Sighting& s : sight.seen_from(eye)) seen.push_back(s.target);
  std::sort(seen.begin(), seen.end());
  CHECK(seen == std::vector<std::int32_t>({1, 3}));
}

TEST(lines_of_sight_are_those_of_a_walk_by_single_voxels) {
  Random random(12);
  TsdfMap map({.voxel_size = 0.25});
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) map.ensure({x, y, z}) = {0.2F, 1.0F};
  for (int i = 0; i < 60; ++i) {  // bars and holes
    const VoxelIndex at(static_cast<int>(random.below(36)), static_cast<int>(random.below(36)),
                        static_cast<int>(random.below(36)));
    const TsdfVoxel made = i % 2 == 0 ? TsdfVoxel{-0.2F, 1.0F} : TsdfVoxel{};
    for_each_index(at, at + VoxelIndex(3, i % 3, i % 4),
                   [&](const VoxelIndex& v) { map.ensure(v) = made; });
  }
  for (std::uint32_t s = 0; s < map.block_count(); ++s) map.mark_changed(s);
  const VoxelStateMap states(map);
  int seen = 0, hidden = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto any = [&] {
      return Point3(random.uniform(-1, 11), random.uniform(-1, 11), random.uniform(-1, 11));
    };
    Point3 p = any();
    SightTarget target{any(), Eigen::Vector3d::Zero(), 1.0, static_cast<int>(random.below(5))};
    if (i % 4 == 0) target.position = map.center(map.index_of(target.position));
    for (const bool past_unknown : {false, true}) {
      MapSight sight(states);
      if (past_unknown) sight.see_through_unknown();
      int unknown = 0;
      const bool expected = traverse_voxels(p, target.position, 0.25, [&](const VoxelIndex& v) {
        if (v == map.index_of(target.position)) return true;
        if (states(v) == VoxelState::unknown) ++unknown;
        return states(v) != VoxelState::occupied &&
               (past_unknown || unknown <= target.unknown_before);
      });
      CHECK(sight(p, target) == expected);
      ++(expected ? seen : hidden);
    }
  }
  CHECK(seen > 5000 && hidden > 5000);
}

TEST(gain_counts_what_is_not_done) {
  const TsdfMap map = walled_room();
  const VoxelStateMap states(map);
  const std::vector<SightTarget> targets{{Point3(4.5, 2.0, 5.0), Eigen::Vector3d::Zero(), 2.0, 0},
                                         {Point3(4.5, 2.2, 5.0), Eigen::Vector3d::Zero(), 3.0, 0}};
  const HeadingTable headings(camera(), forward_camera_mount());
  const SightTargets sight(targets, MapSight(states), headings, {});
  const auto seen = sight.seen_from({2.0, 2.1, 5.0});
  CHECK_NEAR(gain_by_view(sight, seen, std::vector<char>{0, 0})[0], 5.0, 1e-12);
  CHECK_NEAR(gain_by_view(sight, seen, std::vector<char>{0, 1})[0], 2.0, 1e-12);
  CHECK_NEAR(gain_by_view(sight, seen, std::vector<char>{0, 0})[8], 0.0, 1e-12);
}
TEST(no_targets_no_sightings) {
  const TsdfMap map({.voxel_size = 0.25});
  const VoxelStateMap states(map);
  const HeadingTable headings(camera(), forward_camera_mount());
  const SightTargets sight({}, MapSight(states), headings);
  CHECK(sight.seen_from({0, 0, 0}).empty());
}
}  // namespace
