// SPDX-License-Identifier: MIT
#include <surfleet/motion/kinematics.hpp>

#include <limits>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

double distance_to(const std::vector<Point3>& line, const Point3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector3d d = line[i] - line[i - 1];
    const double t = std::clamp((p - line[i - 1]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (line[i - 1] + t * d - p).norm());
  }
  return best;
}
std::vector<Point3> random_path(Random& random, bool planar) {
  std::vector<Point3> path{Point3::Zero()};
  const std::size_t n = 2 + random.below(6);
  for (std::size_t i = 0; i < n; ++i)
    path.push_back(path.back() + Point3(random.uniform(-3, 3), random.uniform(-3, 3),
                                        planar ? 0.0 : random.uniform(-3, 3)));
  return path;
}

/// Laws of every model: on the path, within the limits, at rest at the end.
template <KinematicModel M>
void laws(bool planar, double speed, double acceleration, double tolerance, double yaw_rate) {
  Random random(21);
  for (int trial = 0; trial < 30; ++trial) {
    const auto path = random_path(random, planar);
    const double goal_yaw = random.uniform(-3, 3);
    M robot{Configuration{}};
    robot.follow(path, goal_yaw);
    const double dt = 0.01;
    Configuration last = robot.configuration();
    Eigen::Vector3d v = robot.velocity();
    double worst = 0.0, fastest = 0.0, hardest = 0.0, turn = 0.0, time = 0.0;
    for (; !robot.finished() && time < 200.0; time += dt) {
      const Configuration q = robot.advance(dt);
      worst = std::max(worst, distance_to(path, q.position));
      fastest = std::max(fastest, (q.position - last.position).norm() / dt);
      hardest = std::max(hardest, (robot.velocity() - v).norm() / dt);
      turn = std::max(turn, std::abs(wrap_angle(q.yaw - last.yaw)) / dt);
      last = q;
      v = robot.velocity();
    }
    CHECK(robot.finished());
    CHECK((last.position - path.back()).norm() < 1e-6);
    CHECK(std::abs(wrap_angle(last.yaw - goal_yaw)) < 2e-3);
    CHECK(worst <= tolerance + 1e-6);
    CHECK(fastest <= speed * (1 + 1e-6));
    CHECK(hardest <= acceleration * 1.05);
    CHECK(turn <= yaw_rate * 1.05);
    CHECK(robot.remaining().size() == 1);
  }
}
}  // namespace

TEST(models_keep_to_path_and_limits) {
  laws<AerialMotion>(false, 0.6, 1.0, 0.1, 0.8);
  laws<UnicycleMotion>(true, 0.5, 0.8, 0.05, 1.0);
}

TEST(straight_run_takes_the_trapezoid_s_time) {
  AerialMotion robot{Configuration{}};
  robot.follow(std::vector<Point3>{{0, 0, 0}, {6, 0, 0}}, 0.0);
  double time = 0.0;
  while (!robot.finished()) {
    robot.advance(0.01);
    time += 0.01;
  }
  CHECK_NEAR(time, 6.0 / 0.6 + 0.6 / 1.0, 0.011);
}

TEST(motion_does_not_depend_on_the_step) {
  Random random(5);
  for (int trial = 0; trial < 10; ++trial) {
    const auto path = random_path(random, false);
    AerialMotion a{Configuration{}}, b{Configuration{}};
    a.follow(path, 1.0);
    b.follow(path, 1.0);
    for (int i = 0; i < 40; ++i) {
      a.advance(0.4);
      for (int k = 0; k < 8; ++k) b.advance(0.05);
      CHECK((a.configuration().position - b.configuration().position).norm() < 1e-6);
    }
  }
}

TEST(emergency_stop_within_the_stated_distance) {
  AerialMotion robot{Configuration{}};
  robot.follow(std::vector<Point3>{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}}, 0.0);
  Random random(6);
  for (double t = 0.1; t < 8.0; t += 0.37) {
    AerialMotion twin = robot;
    for (double s = 0.0; s < t; s += 0.05) twin.advance(0.05);
    const Point3 at = twin.configuration().position;
    const double braking = twin.stopping_distance();
    twin.stop();
    for (int i = 0; i < 100; ++i) twin.advance(0.05);
    CHECK(twin.standing());
    CHECK((twin.configuration().position - at).norm() <= braking + 1e-9);
    twin.resume();
    for (int i = 0; i < 600; ++i) twin.advance(0.05);
    CHECK(twin.finished());
  }
}

TEST(a_new_path_under_way_keeps_the_limits) {
  Random random(8);
  for (int trial = 0; trial < 30; ++trial) {
    AerialMotion robot{Configuration{}};
    robot.follow(std::vector<Point3>{{0, 0, 0}, {5, 0, 0}}, 0.0);
    for (int i = 0; i < 40; ++i) robot.advance(0.05);
    const Point3 here = robot.configuration().position;
    const Point3 goal =
        here + Point3(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3));
    robot.follow(std::vector<Point3>{here, goal}, 0.0);
    Eigen::Vector3d v = robot.velocity();
    double hardest = 0.0;
    for (int i = 0; i < 3000 && !robot.finished(); ++i) {
      robot.advance(0.01);
      hardest = std::max(hardest, (robot.velocity() - v).norm() / 0.01);
      v = robot.velocity();
    }
    CHECK(robot.finished());
    CHECK((robot.configuration().position - goal).norm() < 1e-6);
    CHECK(hardest <= 1.06);
  }
}

TEST(a_robot_that_turns_under_way_goes_straight_on_as_little_as_it_takes) {
  for (const double degrees : {5.0, 20.0, 45.0, 90.0, 150.0, 179.0}) {
    AerialMotion robot{Configuration{}};
    robot.follow(std::vector<Point3>{{0, 0, 0}, {5, 0, 0}}, 0.0);
    for (int i = 0; i < 40; ++i) robot.advance(0.05);
    const double v = robot.velocity().norm();
    CHECK_NEAR(v, 0.6, 1e-9);
    const Point3 here = robot.configuration().position;
    const double turn = radians(degrees);
    const Point3 goal = here + 2.0 * Point3(std::cos(turn), 0.0, std::sin(turn));
    const std::vector<Point3> path = robot.path_onto(std::vector<Point3>{here, goal});
    CHECK(path.size() == 3 && path.front() == here && path.back() == goal);
    const double leg = (path[1] - here).norm();
    CHECK_NEAR((path[1] - here).x(), leg, 1e-12);
    // Twice the stopping distance at the most, and next to nothing for a gentle turn.
    CHECK(leg <= v * v + 1e-9);
    if (degrees <= 20.0) CHECK(leg < 0.5 * v * v);
  }
}

TEST(faces_where_it_is_told_while_under_way) {
  AerialMotion robot{Configuration{}};
  const Point3 target(3, 5, 0);
  robot.follow(std::vector<Point3>{{0, 0, 0}, {6, 0, 0}}, 2.0,
               [&](const Point3& p, const Eigen::Vector3d&) {
                 return std::atan2(target.y() - p.y(), target.x() - p.x());
               });
  for (int i = 0; i < 60; ++i) robot.advance(0.1);
  const Configuration q = robot.configuration();
  CHECK_NEAR(
      wrap_angle(q.yaw - std::atan2(target.y() - q.position.y(), target.x() - q.position.x())), 0.0,
      0.05);
  for (int i = 0; i < 200; ++i) robot.advance(0.1);
  CHECK(robot.finished());
  CHECK_NEAR(robot.configuration().yaw, 2.0, 2e-3);
}

TEST(degenerate_paths) {
  AerialMotion robot{Configuration{{1, 2, 3}, 0.5}};
  CHECK(robot.finished());
  robot.follow(std::vector<Point3>{{1, 2, 3}}, 0.5);
  robot.advance(1.0);
  CHECK(robot.finished());
  robot.follow(std::vector<Point3>{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, 1.0);
  for (int i = 0; i < 50; ++i) robot.advance(0.1);
  CHECK(robot.finished());
  robot.follow(std::vector<Point3>{{1, 2, 3}, {2, 2, 3}, {1, 2, 3}}, 1.0);  // out and back
  for (int i = 0; i < 100; ++i) robot.advance(0.1);
  CHECK(robot.finished());
  CHECK((robot.configuration().position - Point3(1, 2, 3)).norm() < 1e-6);
  CHECK_THROWS(Error, AerialMotion({}, {.speed = 0.0}));
  UnicycleMotion ground{Configuration{}};
  ground.follow(std::vector<Point3>{}, 1.0);
  for (int i = 0; i < 50; ++i) ground.advance(0.1);
  CHECK(ground.finished());
}

/// Sent elsewhere in flight and stopped at once, a robot goes on to where it was sent last.
template <typename Motion>
void ends_where_it_was_sent_last() {
  Motion robot;
  robot.follow(std::vector<Point3>{{0, 0, 0}, {10, 0, 0}}, 0.0);
  for (int i = 0; i < 40; ++i) robot.advance(0.1);
  const Point3 at = robot.configuration().position, goal(at.x(), 5.0, 0.0);
  robot.follow(std::vector<Point3>{at, goal}, 0.0);
  robot.stop();
  for (int i = 0; i < 30; ++i) robot.advance(0.1);
  CHECK(robot.standing() && !robot.finished());
  CHECK((robot.configuration().position - at).norm() < 1.0);
  robot.resume();
  for (int i = 0; i < 600; ++i) robot.advance(0.1);
  CHECK(robot.finished());
  CHECK((robot.configuration().position - goal).norm() < 1e-6);
}
TEST(a_stop_forgets_no_goal) {
  ends_where_it_was_sent_last<AerialMotion>();
  ends_where_it_was_sent_last<UnicycleMotion>();
}
