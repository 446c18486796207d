// SPDX-License-Identifier: MIT
#include <surfleet/mapping/occupancy_integrator.hpp>

#include <cmath>
#include <map>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

constexpr double kVoxel = 0.2;

/// Beams in all directions; what they meet is up to the test.
LidarScan random_scan(Random& random, int beams, double longest) {
  LidarScan scan;
  for (int i = 0; i < beams; ++i) {
    const double x = random.normal(), y = random.normal();
    const Eigen::Vector3d d(x, y, random.normal());
    scan.points.push_back(random.uniform(0.05, longest) * d.normalized());
  }
  return scan;
}

/// By the box of every voxel: whether the segment runs through its inside.
bool runs_through(const Point3& a, const Point3& b, const VoxelIndex& v) {
  double enter = 0.0, leave = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double d = b[k] - a[k], lo = v[k] * kVoxel - a[k], hi = (v[k] + 1) * kVoxel - a[k];
    enter = std::max(enter, std::min(lo / d, hi / d));
    leave = std::min(leave, std::max(lo / d, hi / d));
  }
  return enter < leave;
}
VoxelIndex voxel_of(const Point3& p) { return (p / kVoxel).array().floor().cast<int>(); }
}  // namespace

TEST(every_voxel_hears_of_a_scan_once) {
  Random random(3);
  const LidarModel lidar{.min_range = 0.3, .max_range = 2.0};
  OccupancyMap map({.voxel_size = kVoxel});
  OccupancyIntegrator integrate;
  std::map<VoxelKey, double> expected;  // log odds
  const double hit = std::log(0.7 / 0.3), miss = std::log(0.4 / 0.6);
  std::size_t hits = 0, passes = 0;
  for (int scan = 0; scan < 6; ++scan) {
    Pose at = Pose::Identity();
    at.rotate(Eigen::AngleAxisd(0.7 * scan, Eigen::Vector3d(0.3, 0.2, 1.0).normalized()));
    at.pretranslate(Eigen::Vector3d(0.11 * scan, 0.07, -0.05 * scan));
    const LidarScan seen = random_scan(random, 60, 3.0);
    integrate(seen, lidar, at, map);
    const Point3 eye = at.translation();
    std::map<VoxelKey, bool> heard;  // whether it is a hit
    for (const Point3& p : seen.points) {
      const double range = p.norm();
      if (range < lidar.min_range) continue;
      const Point3 end = at * Point3(p * std::min(1.0, lidar.max_range / range));
      const VoxelIndex last = voxel_of(end);
      const VoxelIndex lo = voxel_of(eye.cwiseMin(end)), hi = voxel_of(eye.cwiseMax(end));
      for_each_index(lo, hi, [&](const VoxelIndex& v) {
        if (v != last && runs_through(eye, end, v)) heard.emplace(key_of(v), false);
      });
      if (range <= lidar.max_range) heard[key_of(last)] = true;
    }
    for (const auto& [voxel, is_hit] : heard) {
      double& odds = expected[voxel];
      odds = std::clamp(odds + (is_hit ? hit : miss), std::log(0.1192 / 0.8808),
                        std::log(0.971 / 0.029));
      ++(is_hit ? hits : passes);
    }
  }
  CHECK(hits > 100 && passes > 1000);
  std::size_t observed = 0, wrong = 0;
  map.for_each_block([&](const OccupancyMap::Block& b) {
    for (std::size_t i = 0; i < b.voxels.size(); ++i) {
      const auto it = expected.find(key_of(OccupancyMap::index_in(b, i)));
      wrong += b.voxels[i].observed == (it != expected.end()) ? 0 : 1;
      if (it == expected.end()) continue;
      ++observed;
      wrong += std::abs(b.voxels[i].log_odds - it->second) < 1e-5 ? 0 : 1;
    }
  });
  CHECK(wrong == 0 && observed == expected.size());
}

TEST(what_is_learned_can_be_unlearned) {
  OccupancyMap map({.voxel_size = kVoxel});
  OccupancyIntegrator integrate;
  const LidarModel lidar{.min_range = 0.1, .max_range = 5.0};
  const VoxelIndex wall = voxel_of(Point3(1.1, 0.1, 0.1));
  const auto odds = [&] { return static_cast<double>(map.find(wall)->log_odds); };
  Pose at = Pose::Identity();
  at.translate(Eigen::Vector3d(0.1, 0.1, 0.1));
  VoxelStateMap states(map);
  CHECK(states(wall) == VoxelState::unknown);
  for (int i = 1; i <= 20; ++i) {
    integrate({.points = {Point3(1.0, 0, 0)}}, lidar, at, map);
    CHECK_NEAR(odds(), std::min(i * std::log(0.7 / 0.3), std::log(0.971 / 0.029)), 1e-5);
  }
  // At the bounds nothing changes any more, and nothing has to be read again.
  const std::uint64_t before = map.revision();
  CHECK(integrate({.points = {Point3(1.0, 0, 0)}}, lidar, at, map) == 0);
  CHECK(map.revision() == before);
  CHECK(states.update(map) == 1 && states(wall) == VoxelState::occupied);
  int passes = 0;
  for (; odds() >= 0.0; ++passes) integrate({.points = {Point3(3.0, 0, 0)}}, lidar, at, map);
  CHECK(passes == 9);  // 3.51 by 0.405
  states.update(map);
  CHECK(states(wall) == VoxelState::empty);
  CHECK(states(voxel_of(Point3(3.1, 0.1, 0.1))) == VoxelState::occupied);
}

TEST(images_and_scans_of_the_same_points_make_the_same_map) {
  const PinholeCamera camera = PinholeCamera::from_fov(1.2, 0.9, 24, 18, 0.4, 3.0);
  const LidarModel lidar{.min_range = 0.0, .max_range = 100.0};
  Pose at = Pose::Identity();
  at.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()));
  DepthImage image(camera.width, camera.height);
  LidarScan scan;
  Random random(8);
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const double depth = random.uniform(0.2, 2.9);
    image.depth[i] = static_cast<float>(depth);
    if (depth < camera.min_range) continue;
    const auto u = static_cast<double>(i % 24), v = static_cast<double>(i / 24);
    scan.points.push_back(static_cast<double>(image.depth[i]) * camera.ray(u, v));
  }
  image.depth[7] = 0.0F;
  OccupancyMap a({.voxel_size = kVoxel}), b({.voxel_size = kVoxel});
  OccupancyIntegrator integrate;
  integrate(image, camera, at, a);
  image.depth[7] = 50.0F;  // beyond its range: free up to there
  integrate(image, camera, at, b);
  std::size_t more = 0, other = 0;
  b.for_each_block([&](const OccupancyMap::Block& block) {
    for (std::size_t i = 0; i < block.voxels.size(); ++i) {
      const OccupancyVoxel* v = a.find(OccupancyMap::index_in(block, i));
      const bool known = v != nullptr && v->observed;
      more += block.voxels[i].observed && !known ? 1 : 0;
      other += known && v->log_odds != block.voxels[i].log_odds ? 1 : 0;
    }
  });
  CHECK(more > 0 && more < 40 && other == 0);
  OccupancyMap c({.voxel_size = kVoxel});
  image.depth[7] = 0.0F;
  std::erase_if(scan.points, [&](const Point3& p) {
    const Eigen::Vector3d ray = camera.ray(7.0, 0.0);
    return (p.normalized() - ray.normalized()).norm() < 1e-9;
  });
  integrate(scan, lidar, at, c);
  CHECK(a.block_count() == c.block_count());
  a.for_each_block([&](const OccupancyMap::Block& block) {
    for (std::size_t i = 0; i < block.voxels.size(); ++i) {
      const OccupancyVoxel* v = c.find(OccupancyMap::index_in(block, i));
      CHECK(v != nullptr && v->observed == block.voxels[i].observed &&
            v->log_odds == block.voxels[i].log_odds);
    }
  });
}

TEST(occupancy_settings_are_checked) {
  CHECK_THROWS(Error, OccupancyIntegrator({.hit = 0.5}));
  CHECK_THROWS(Error, OccupancyIntegrator({.miss = 0.5}));
  CHECK_THROWS(Error, OccupancyIntegrator({.miss = 0.0}));
  CHECK_THROWS(Error, OccupancyIntegrator({.lowest = std::nan("")}));
  CHECK_THROWS(Error, OccupancyIntegrator({.highest = 1.0}));
  OccupancyMap map({.voxel_size = kVoxel});
  OccupancyIntegrator integrate;
  CHECK(integrate(LidarScan{}, LidarModel{}, Pose::Identity(), map) == 0);
  CHECK(map.block_count() == 0);
}
