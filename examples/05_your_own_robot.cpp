// SPDX-License-Identifier: MIT
// A robot that is not the library's: give it images and poses, and fly the paths it gives.
#include <cstdio>

#include <surfleet/fleet/single_agent.hpp>
#include <surfleet/geometry.hpp>
#include <surfleet/planning/named_planners.hpp>
#include <surfleet/simulation/depth_camera.hpp>

using namespace surfleet;

/// Your driver writes `image` and `here`, and reads `path`, which begins there, and `yaw`.
struct MyRobot {
  DepthImage image;
  Configuration here;
  std::vector<Point3> path{here.position};
  double yaw = 0.0;
  DepthImage sense() { return image; }
  Configuration estimate() const { return here; }
  std::vector<SeenRobot> neighbours() const { return {}; }
  void follow(std::span<const Point3> points, double heading, std::optional<double> /*watch*/) {
    path.assign(points.begin(), points.end());
    yaw = heading;
  }
  void watch(double /*heading*/) {}  // this one turns at the end of its path only
  std::vector<Point3> path_onto(std::span<const Point3> p) const { return {p.begin(), p.end()}; }
  void stop() { path.resize(1); }
  void resume() {}
  std::vector<Point3> remaining() const { return path; }
  double stopping_distance() const { return 0.1; }
  Eigen::Vector3d velocity() const { return Eigen::Vector3d::Zero(); }
  bool standing() const { return path.size() < 2; }
  bool braking() const { return false; }
  bool finished() const { return standing() && std::abs(wrap_angle(yaw - here.yaw)) < 1e-6; }
  void advance(double /*dt*/) {}
};

int main() {
  const Bvh world(make_box({Point3(-1.5, -1, 0), Point3(1.5, 1, 2)}));
  const Box3 region(Point3(-2, -1.5, -0.3), Point3(2, 1.5, 2.3));
  RobotKind kind;
  kind.camera = PinholeCamera::from_fov(radians(90.0), radians(60.0), 96, 55, 0.5, 4.0);
  kind.body_radius = 0.4;
  kind.bounds = Box3(Point3(-5, -5, -3), Point3(5, 5, 5));
  const DepthCamera<NoNoise> camera(kind.camera);  // stands for yours
  MyRobot robot{.image = {}, .here = {{-3.5, 0.0, 1.0}, 0.0}};
  SingleAgent<MyRobot> agent(robot, kind, {.voxel_size = 0.2, .region = region},
                             make_planner("surfleet", {.standoff = 2.0}), 1.9);
  for (double now = 0.0; !agent.finished() && now < 600.0; now += 0.25) {
    robot.image = camera.capture(world, robot.here.pose() * kind.T_body_camera);
    agent.step(now);
    // Stands for your controller: 0.2 m a step, then a turn.
    if (robot.standing())
      robot.here.yaw = robot.yaw;
    else if ((robot.path[1] - robot.path[0]).norm() < 0.2)
      robot.path.erase(robot.path.begin());
    else
      robot.path[0] += 0.2 * (robot.path[1] - robot.path[0]).normalized();
    robot.here.position = robot.path[0];
  }
  const double share = agent.belief().estimate_coverage().share();
  std::printf("%.1f %% covered by its own account\n", 100.0 * share);
  return agent.finished() && share > 0.95 ? 0 : 1;
}
