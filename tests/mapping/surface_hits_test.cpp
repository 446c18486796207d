// SPDX-License-Identifier: MIT
#include <surfleet/mapping/surface_hits.hpp>

#include <algorithm>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/mapping/map_file.hpp>
#include <surfleet/mapping/ray_traversal_update.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>

#include "check.hpp"
#include "seen_sheet.hpp"

using namespace surfleet;
using namespace surfleet::test;

namespace {
SurfaceHits random_hits(Random& random, int count) {
  SurfaceHits hits;
  for (int i = 0; i < count; ++i) {
    SurfaceHit h;
    h.weight = static_cast<std::int64_t>(random.below(1000)) + 1;
    h.passed = static_cast<std::int64_t>(random.below(100));
    for (std::size_t k = 0; k < 3; ++k) {
      h.position[k] = static_cast<std::int64_t>(random.below(1000)) - 500;
      h.normal[k] = static_cast<std::int64_t>(random.below(1000)) - 500;
    }
    hits.ensure(SurfaceHits::key_of(random.below(40), static_cast<int>(random.below(6)))).add(h, 1);
  }
  return hits;
}
bool same_hits(const TsdfMap& a, const TsdfMap& b) {
  bool same = true;
  const auto covers = [&](const TsdfMap& from, const TsdfMap& to) {
    from.for_each_block([&](const TsdfMap::Block& block) {
      const TsdfMap::Block* other = to.find_block(block.index);
      same = same && (other == nullptr ? block.layer.empty() : block.layer == other->layer);
    });
  };
  covers(a, b);
  covers(b, a);
  return same;
}
std::size_t hit_count(const TsdfMap& map) {
  std::size_t n = 0;
  map.for_each_block([&](const TsdfMap::Block& b) { n += b.layer.size(); });
  return n;
}
}  // namespace

TEST(hits_add_in_any_order_and_subtract_exactly) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<SurfaceHits> parts;
    for (int i = 0; i < 5; ++i) parts.push_back(random_hits(random, 30));
    SurfaceHits forward, backward;
    for (const SurfaceHits& p : parts) forward.add(p);
    for (auto it = parts.rbegin(); it != parts.rend(); ++it) backward.add(*it);
    CHECK(forward == backward);
    SurfaceHits without = forward;
    without.subtract(parts[2]);
    SurfaceHits expected;
    for (const std::size_t i : {std::size_t{4}, std::size_t{0}, std::size_t{3}, std::size_t{1}})
      expected.add(parts[i]);
    CHECK(without == expected);
    for (const SurfaceHit& h : expected.hits()) {
      CHECK(expected.find(h.key) != nullptr && *expected.find(h.key) == h);
      const auto own = expected.of_voxel(h.voxel());
      CHECK(std::any_of(own.begin(), own.end(), [&](const SurfaceHit& o) { return o == h; }));
    }
    for (const SurfaceHits& p : parts)
      if (&p != &parts[2]) without.subtract(p);
    CHECK(without.empty());
  }
}

TEST(a_wall_faced_squarely_weighs_as_much_as_its_distances) {
  // An image from z adds 1 / z² to a voxel whose whole face it sees.
  for (const double z : {1.5, 3.0, 6.0}) {
    TsdfMap map({.voxel_size = 0.25});
    TsdfIntegrator<> integrate({.truncation = 0.75});
    const Pose T = facing(Point3(-z, 0, 0), Eigen::Vector3d::UnitX());
    const auto wall = [](const Point3& o, const Eigen::Vector3d& d) -> std::optional<double> {
      return (0.11 - o.x()) / d.x();
    };
    integrate(render(sheet_camera(), T, wall), sheet_camera(), T, map);
    double sum = 0.0;
    int voxels = 0;
    for (int y = -2; y < 2; ++y)
      for (int k = -2; k < 2; ++k) {
        const VoxelIndex v = map.index_of(Point3(0.1, 0.25 * y + 0.1, 0.25 * k + 0.1));
        const TsdfMap::Block* block = map.find_block(TsdfMap::block_of(v));
        CHECK(block != nullptr);
        if (block == nullptr) continue;
        const auto hits = block->layer.of_voxel(TsdfMap::offset_of(v));
        CHECK(hits.size() == 1);
        if (hits.size() != 1) continue;
        CHECK(hits[0].side() == 1);
        CHECK_NEAR((hits[0].mean_normal() + Eigen::Vector3d::UnitX()).norm(), 0.0, 0.02);
        CHECK_NEAR((map.center(v) + hits[0].mean_offset(0.25)).x(), 0.11, 0.003);
        sum += hits[0].weight_value();
        ++voxels;
      }
    const double seen = (z + 0.11) * (z + 0.11);
    CHECK_NEAR(sum / voxels * seen, 1.0, 0.1);
  }
}

TEST(hits_are_the_same_on_any_number_of_threads) {
  const TsdfMap one = seen_from_around(sheet(0.05), 2.0, 12, 0.1, {.threads = 1});
  const TsdfMap four = seen_from_around(sheet(0.05), 2.0, 12, 0.1, {.threads = 4});
  CHECK(hit_count(one) > 0);
  CHECK(same_hits(one, four));
  CHECK(encode_map(one) == encode_map(four));
}

TEST(a_sheet_seen_from_both_sides_has_two_sides_and_stays_occupied) {
  for (const double at : {0.05, 0.0, 0.0999, -3.456}) {
    TsdfMap map({.voxel_size = 0.3});
    TsdfIntegrator<DropOffWeight<>> integrate({.truncation = 0.9}, {.full = 0.3, .zero = 0.45});
    for (int i = 0; i < 40; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0;
      const Pose T = facing(Point3(at - 2.5 * side, 0.01 * i, 0.1), Point3(side, 0, 0));
      integrate(render(sheet_camera(), T, sheet(at)), sheet_camera(), T, map);
    }
    const VoxelStateMap states(map, {.known_weight = 0.3});
    for (double y = -0.8; y <= 0.8; y += 0.1)
      for (double z = -0.8; z <= 0.8; z += 0.1) {
        // A sheet on the border of voxels may be in either.
        const bool here = states.at(Point3(at - 1e-3, y, z)) == VoxelState::occupied ||
                          states.at(Point3(at + 1e-3, y, z)) == VoxelState::occupied;
        CHECK(here);
        CHECK(states.at(Point3(at - 0.6, y, z)) == VoxelState::empty);
        CHECK(states.at(Point3(at + 0.6, y, z)) == VoxelState::empty);
      }
    int front = 0, back = 0;
    map.for_each_block([&](const TsdfMap::Block& b) {
      for (const SurfaceHit& h : b.layer.hits()) {
        front += h.side() == 1 ? 1 : 0;
        back += h.side() == 0 ? 1 : 0;
        if (h.side() > 1 || h.weight_value() < 0.05) continue;
        const Point3 p = map.center(TsdfMap::index_in(b, h.voxel())) + h.mean_offset(0.3);
        CHECK_NEAR(p.x(), at, 0.005);
      }
    });
    CHECK(front >= 40 && back >= 40);
  }
}

TEST(what_is_no_longer_there_is_passed_through_and_forgotten) {
  TsdfMap map({.voxel_size = 0.2});
  TsdfIntegrator<DropOffWeight<>> integrate({.truncation = 0.6}, {.full = 0.2, .zero = 0.3});
  const Pose T = facing(Point3(-1.5, 0, 0), Eigen::Vector3d::UnitX());
  const auto nothing = [](const Point3&, const Eigen::Vector3d&) {
    return std::optional<double>();
  };
  for (int i = 0; i < 10; ++i)
    integrate(render(sheet_camera(), T, sheet(0.1)), sheet_camera(), T, map);
  VoxelStateMap states(map, {.known_weight = 0.3});
  CHECK(states.at(Point3(0.1, 0.1, 0.1)) == VoxelState::occupied);
  // A glance does not do; as many as had seen it do.
  integrate(render(sheet_camera(), T, nothing), sheet_camera(), T, map);
  states.update(map);
  CHECK(states.at(Point3(0.1, 0.1, 0.1)) == VoxelState::occupied);
  for (int i = 0; i < 60; ++i)
    integrate(render(sheet_camera(), T, nothing), sheet_camera(), T, map);
  states.update(map);
  CHECK(states.at(Point3(0.1, 0.1, 0.1)) == VoxelState::empty);

  for (std::uint32_t s = 0; s < map.block_count(); ++s) map.forget(s);
  states.update(map);
  CHECK(states.at(Point3(0.1, 0.1, 0.1)) == VoxelState::unknown);
  CHECK(hit_count(map) == 0);
}

TEST(a_post_thinner_than_a_voxel_is_occupied_all_along) {
  for (const double radius : {0.02, 0.04}) {
    const TsdfMap map = seen_from_around(post(radius), 1.5, 60, 0.15);
    const VoxelStateMap states(map, {.known_weight = 0.3});
    for (double z = -0.5; z <= 0.5; z += 0.05) {
      bool any = false;
      for (int i = 0; i < 8; ++i)
        any = any || states.at(Point3(radius * std::cos(i * kPi / 4),
                                      radius * std::sin(i * kPi / 4), z)) == VoxelState::occupied;
      CHECK(any);
    }
    CHECK(states.at(Point3(0.5, 0.3, 0.0)) == VoxelState::empty);
  }
}

TEST(without_hits_nothing_is_kept) {
  CHECK(hit_count(seen_from_around(sheet(0.05), 2.0, 6, 0.1, {.keep_hits = false})) == 0);
}

TEST(single_rays_leave_hits_too_and_pass_through_them) {
  TsdfMap map({.voxel_size = 0.2});
  TsdfIntegrator<InverseSquareWeight, RayTraversalUpdate> integrate({.truncation = 0.6});
  std::vector<Point3> wall, beyond;
  for (double y = -0.5; y <= 0.5; y += 0.02)
    for (double z = -0.5; z <= 0.5; z += 0.02) {
      wall.emplace_back(1.5, y, z);
      beyond.emplace_back(3.0, 2.0 * y, 2.0 * z);
    }
  for (int i = 0; i < 6; ++i) integrate(wall, 0.1, 5.0, Pose::Identity(), map);
  VoxelStateMap states(map, {.known_weight = 0.3});
  CHECK(states.at(Point3(1.5, 0.1, 0.1)) == VoxelState::occupied);
  const TsdfMap::Block* b = map.find_block(TsdfMap::block_of(map.index_of(Point3(1.5, 0.1, 0.1))));
  const auto hits = b->layer.of_voxel(TsdfMap::offset_of(map.index_of(Point3(1.5, 0.1, 0.1))));
  CHECK(hits.size() == 1 && hits[0].side() == 1);
  CHECK_NEAR(hits[0].weight_value(), 6.0 / 2.3, 0.3);
  for (int i = 0; i < 40; ++i) integrate(beyond, 0.1, 5.0, Pose::Identity(), map);
  states.update(map);
  CHECK(states.at(Point3(1.5, 0.1, 0.1)) == VoxelState::empty);
}

TEST(maps_with_hits_merge_in_any_order_and_come_back_from_files) {
  const TsdfMap a = seen_from_around(sheet(0.05), 2.0, 7, 0.1);
  const TsdfMap b = seen_from_around(sheet(0.05), 2.6, 5, 0.1);
  const TsdfMap c = seen_from_around(post(0.3), 2.0, 6, 0.1);
  TsdfMap abc({.voxel_size = 0.1}), cba({.voxel_size = 0.1});
  for (const TsdfMap* m : {&a, &b, &c}) merge_maps(abc, *m);
  for (const TsdfMap* m : {&c, &b, &a}) merge_maps(cba, *m);
  CHECK(hit_count(abc) > 0);
  CHECK(same_hits(abc, cba));
  CHECK(same_hits(abc, decode_map(encode_map(abc))));
}
