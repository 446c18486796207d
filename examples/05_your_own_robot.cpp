// SPDX-License-Identifier: MIT
// A robot that is not the library's: give it images and poses, and fly the paths it gives.
#include <cstdio>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/fleet/single_agent.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/depth_camera.hpp>

using namespace surfleet;

/// Your driver writes `image` and `here`, and reads `path` and `yaw`.
struct MyRobot {
  DepthImage image;
  Configuration here;
  std::vector<Point3> path;
  double yaw = 0.0;

  DepthImage sense() { return image; }
  const Configuration& estimate() const { return here; }
  std::vector<SeenRobot> neighbours() const { return {}; }
  void follow(std::span<const Point3> points, double heading, std::optional<double> /*watch*/) {
    path.assign(points.begin() + (points.size() > 1 ? 1 : 0), points.end());
    yaw = heading;
  }
  void watch(double /*heading*/) {}  // this one turns at the end of its path only
  std::vector<Point3> path_onto(std::span<const Point3> points) const {
    return {points.begin(), points.end()};
  }
  void stop() { path.clear(); }
  void resume() {}
  std::vector<Point3> remaining() const {
    std::vector<Point3> points{here.position};
    points.insert(points.end(), path.begin(), path.end());
    return points;
  }
  double stopping_distance() const { return 0.1; }
  Eigen::Vector3d velocity() const { return Eigen::Vector3d::Zero(); }
  bool standing() const { return path.empty(); }
  bool braking() const { return false; }
  bool finished() const { return path.empty() && std::abs(wrap_angle(yaw - here.yaw)) < 1e-6; }
  void advance(double /*dt*/) {}
};

int main() {
  const Bvh world(make_box({Point3(-1.5, -1, 0), Point3(1.5, 1, 2)}));
  RobotKind kind;
  kind.camera = PinholeCamera::from_fov(radians(90.0), radians(60.0), 96, 55, 0.5, 4.0);
  kind.body_radius = 0.4;
  kind.bounds = Box3(Point3(-5, -5, -3), Point3(5, 5, 5));
  MyRobot robot;
  robot.here = {{-3.5, 0.0, 1.0}, 0.0};
  SingleAgent<MyRobot> agent(
      robot, kind, {.voxel_size = 0.2, .region = Box3(Point3(-2, -1.5, -0.3), Point3(2, 1.5, 2.3))},
      make_planner("surfleet", {.standoff = 2.0}), 1.9);

  const DepthCamera<NoNoise> camera(kind.camera);  // stands for yours
  double metres = 0.0, now = 0.0;
  for (; !agent.finished() && now < 600.0; now += 0.25) {
    robot.image = camera.capture(world, robot.here.pose() * kind.T_body_camera);
    agent.step(now);
    if (robot.path.empty()) {
      robot.here.yaw = robot.yaw;  // stands for your controller: 0.2 m a step, then a turn
      continue;
    }
    const Eigen::Vector3d leg = robot.path.front() - robot.here.position;
    const double step = std::min(0.2, leg.norm());
    metres += step;
    if (step < leg.norm()) {
      robot.here.position += leg * (step / leg.norm());
    } else {
      robot.here.position = robot.path.front();
      robot.path.erase(robot.path.begin());
    }
  }
  const double share = agent.belief().estimate_coverage().share();
  std::printf("%s after %.0f m, %.1f %% by its own account\n",
              agent.finished() ? "finished" : "out of time", metres, 100.0 * share);
  return agent.finished() && share > 0.95 ? 0 : 1;
}
