// SPDX-License-Identifier: MIT
/// @file
/// @brief A drone of the simulator as its agent drives it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/fleet/robot_body.hpp>
#include <surfleet/geometry/sensor_reading.hpp>
#include <surfleet/motion/kinematics.hpp>
#include <surfleet/simulation/world_model.hpp>

namespace surfleet {
/// Models `GimballedBody` and `MeasuredBody`: it knows the truth, and says it. World and the
/// fleet's true configurations, in which it keeps its own up to date, and the sense of neighbours
/// must outlive it.
template <WorldModel World>
class SimulatedDrone {
 public:
  SimulatedDrone(World& world, std::size_t robot, std::vector<Configuration>& fleet,
                 const AerialLimits& limits, const NeighbourSense& neighbours)
      : world_(&world),
        robot_(robot),
        fleet_(&fleet),
        motion_(fleet[robot], limits),
        sense_neighbours_(&neighbours) {
    require(limits.pitch_rate > 0.0 && limits.pitch_acceleration > 0.0,
            "pitch limits: expected a positive rate and acceleration");
    gimbal_.rate_limit = limits.pitch_rate;
    gimbal_.acceleration_limit = limits.pitch_acceleration;
    gimbal_.yaw = goal_pitch_ = fleet[robot].pitch;
  }

  SensorReading sense() {
    neighbours_ = *sense_neighbours_ ? (*sense_neighbours_)(robot_, shot_, *fleet_) : mates();
    return world_->capture(robot_, shot_++, *fleet_);
  }
  const Configuration& estimate() const { return (*fleet_)[robot_]; }
  const std::vector<SeenRobot>& neighbours() const { return neighbours_; }
  void follow(std::span<const Point3> path, double yaw, std::optional<double> watch) {
    AerialMotion::YawLaw yaw_law;
    if (watch) {
      watch_yaw_ = *watch;
      yaw_law = [this](const Point3&, const Eigen::Vector3d&) { return watch_yaw_; };
    }
    motion_.follow(path, yaw, std::move(yaw_law));
  }
  void watch(double yaw) { watch_yaw_ = yaw; }
  void tilt(double pitch) { goal_pitch_ = pitch; }
  std::vector<Point3> path_onto(std::span<const Point3> path) const {
    return motion_.path_onto(path);
  }
  void stop() { motion_.stop(); }
  void resume() { motion_.resume(); }
  std::vector<Point3> remaining() const { return motion_.remaining(); }
  double stopping_distance() const { return motion_.stopping_distance(); }
  Eigen::Vector3d velocity() const { return motion_.velocity(); }
  bool standing() const { return motion_.standing(); }
  bool braking() const { return motion_.braking(); }
  bool finished() const { return motion_.finished(); }
  void advance(double dt) {
    gimbal_.advance(goal_pitch_, dt);
    Configuration& at = (*fleet_)[robot_];
    const Point3 last = at.position;
    at = motion_.advance(dt);
    at.pitch = gimbal_.yaw;
    travelled_ += (at.position - last).norm();
  }
  double travelled() const { return travelled_; }

  SimulatedDrone(const SimulatedDrone&) = delete;  // the law of its heading refers to it
  SimulatedDrone& operator=(const SimulatedDrone&) = delete;

 private:
  std::vector<SeenRobot> mates() const {
    std::vector<SeenRobot> all;
    for (std::size_t k = 0; k < fleet_->size(); ++k)
      if (k != robot_) all.push_back({(*fleet_)[k].position});
    return all;
  }

  World* world_;
  std::size_t robot_;
  std::vector<Configuration>* fleet_;
  AerialMotion motion_;
  HeadingControl gimbal_;  // its yaw is the pitch
  const NeighbourSense* sense_neighbours_;
  std::vector<SeenRobot> neighbours_;
  double watch_yaw_ = 0.0, goal_pitch_ = 0.0;
  double travelled_ = 0.0;  // [m]
  std::uint64_t shot_ = 0;
};
}  // namespace surfleet
