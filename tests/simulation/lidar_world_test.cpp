// SPDX-License-Identifier: MIT
#include <surfleet/simulation/lidar_world.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <variant>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/geometry/teammate_mask.hpp>
#include <surfleet/planning/robot_kind.hpp>
#include <surfleet/simulation/drone_world.hpp>
#include <surfleet/simulation/fly_mission.hpp>

namespace {
using namespace surfleet;

const LidarModel kBoxLidar = box_world::lidar();
static_assert(SightWorld<LidarWorld<Bvh>> && SightWorld<DroneWorld<Bvh>> && SightWorld<AnyWorld>);
static_assert(WorldModel<LidarWorld<Bvh>> && WorldModel<DroneWorld<Bvh>>);

TEST(a_scan_is_what_beams_meet) {
  const box_world::World box;
  const RotatingLidar lidar(kBoxLidar);
  Pose T = Configuration{Point3(-3.0, 0.4, 1.1), 0.7}.pose();
  const Sphere mate{Point3(-3.0, -1.0, 1.0), 0.4};
  const LidarScan scan = lidar.sense(box.bvh, T, std::span(&mate, 1));
  CHECK(scan.points.size() == kBoxLidar.beams());  // nothing is too near
  std::size_t met = 0, mates = 0, nothing = 0, i = 0;
  for (int a = 0; a < kBoxLidar.azimuths; ++a)
    for (int e = 0; e < kBoxLidar.elevations; ++e) {
      const Point3& p = scan.points[i++];
      CHECK((p.normalized() - kBoxLidar.beam(a, e)).norm() < 1e-9);
      const Point3 in_world = T * p;
      const auto hit = box.bvh.cast(T.translation(), T.linear() * kBoxLidar.beam(a, e), 7.5);
      if (std::abs((in_world - mate.center).norm() - mate.radius) < 1e-6) {
        ++mates;
      } else if (hit) {
        ++met;
        CHECK_NEAR(p.norm(), hit->t, 1e-6);
      } else {
        ++nothing;
        CHECK(p.norm() > kBoxLidar.max_range);
      }
    }
  CHECK(met > 200 && mates > 50 && nothing > 500);
  // From within half a metre of the wall beams are too short to measure.
  T.translation() = Point3(-1.7, 0.0, 1.0);
  const LidarScan near = lidar.sense(box.bvh, T);
  CHECK(near.points.size() < kBoxLidar.beams() && near.points.size() > kBoxLidar.beams() / 2);
  for (const Point3& p : near.points) CHECK(p.norm() >= kBoxLidar.min_range);
}
TEST(noise_is_along_the_beam_and_in_range_on_any_number_of_threads) {
  const box_world::World box;
  RotatingLidar lidar(kBoxLidar, 0.05);
  const Pose T = Configuration{Point3(-3.0, 0.4, 1.1), 0.7}.pose();
  const LidarScan exact = RotatingLidar(kBoxLidar).sense(box.bvh, T);
  const LidarScan noisy = lidar.sense(box.bvh, T, {}, Random(3));
  lidar.threads = 3;
  CHECK(lidar.sense(box.bvh, T, {}, Random(3)).points == noisy.points);
  CHECK(lidar.sense(box.bvh, T, {}, Random(4)).points != noisy.points);
  double squares = 0.0;
  std::size_t met = 0;
  for (std::size_t i = 0; i < exact.points.size(); ++i) {
    const double r = exact.points[i].norm(), off = noisy.points[i].norm() - r;
    if (r > kBoxLidar.max_range) {
      CHECK(noisy.points[i] == exact.points[i]);
      continue;
    }
    CHECK(noisy.points[i].norm() <= kBoxLidar.max_range);
    CHECK(noisy.points[i].cross(exact.points[i]).norm() < 1e-9);
    squares += off * off;
    ++met;
  }
  CHECK_NEAR(std::sqrt(squares / static_cast<double>(met)), 0.05, 0.01);
  lidar.azimuths = 0;
  CHECK_THROWS(Error, lidar.sense(box.bvh, T));
}
TEST(the_camera_that_is_planned_for_sees_no_more_than_the_lidar) {
  for (const auto& [lowest, highest] : {std::pair{-40.0, 40.0}, {-80.0, 10.0}, {-5.0, 60.0}}) {
    LidarModel lidar = kBoxLidar;
    lidar.lowest = radians(lowest);
    lidar.highest = radians(highest);
    const PinholeCamera c = camera_within(lidar);
    const Pose mount = forward_camera_mount();
    double farthest = 0.0, up = -90.0, down = 90.0;
    for (const double u : {-0.5, c.cx, c.width - 0.5})
      for (const double v : {-0.5, c.cy, c.height - 0.5}) {
        const Eigen::Vector3d d = mount.linear() * c.ray(u, v);
        const double elevation = degrees(std::asin(d.z() / d.norm()));
        farthest = std::max(farthest, c.max_range * d.norm());
        up = std::max(up, elevation);
        down = std::min(down, elevation);
      }
    CHECK(farthest <= lidar.max_range + 1e-9 && farthest > 0.99 * lidar.max_range);
    CHECK_NEAR(up, highest, 1e-6);
    CHECK_NEAR(down, lowest, 1e-6);
  }
  LidarModel blind = kBoxLidar;
  blind.lowest = blind.highest;
  CHECK_THROWS(Error, camera_within(blind));
}
TEST(kinds_with_and_without_a_lidar_are_two) {
  RobotKind camera, lidar;
  camera.camera = camera_within(kBoxLidar);
  carry(lidar, kBoxLidar, Point3(0.0, 0.0, 0.2));
  camera.T_body_camera = lidar.T_body_camera;
  CHECK(kind_number(camera) != kind_number(lidar));
  RobotKind longer = lidar;
  longer.lidar->max_range += 1.0;
  CHECK(kind_number(longer) != kind_number(lidar));
  const Configuration q{Point3(1.0, 2.0, 3.0), 0.5};
  CHECK((lidar.sensor_pose(q) * Point3(0, 0, 1) - Point3(1.0, 2.0, 4.2)).norm() < 1e-12);
  CHECK(camera.sensor_pose(q).matrix() == camera_pose(q, camera.T_body_camera).matrix());
}

TEST(teammates_are_left_out_of_scans_and_nothing_else) {
  const box_world::World box;
  const Pose T = Configuration{Point3(-3.0, 0.4, 1.1), 0.7}.pose();
  const Sphere mate{Point3(-3.0, -1.0, 1.0), 0.4};
  SensorReading seen = RotatingLidar(kBoxLidar).sense(box.bvh, T, std::span(&mate, 1));
  const LidarScan before = std::get<LidarScan>(seen);
  mask_teammates(seen, kBoxLidar, T, std::span(&mate.center, 1), 0.6);
  std::size_t others = 0;
  for (const Point3& p : before.points) others += (T * p - mate.center).norm() > 0.6 ? 1 : 0;
  const LidarScan& after = std::get<LidarScan>(seen);
  CHECK(after.points.size() == others && others < before.points.size() - 50);
  for (const Point3& p : after.points) CHECK((T * p - mate.center).norm() > 0.6);
  CHECK_THROWS(Error, mask_teammates(seen, PinholeCamera{}, T, std::span(&mate.center, 1), 0.6));
}
}  // namespace
