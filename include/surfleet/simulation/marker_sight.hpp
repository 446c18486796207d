// SPDX-License-Identifier: MIT
/// @file
/// @brief Robots that see each other by the lights they carry: relative localisation as the sense
/// of neighbours of a simulated fleet [004 ch. 9].
///
///     options.neighbours = MarkerSight(caster, starts.size());
///     options.announces = false;  // they keep apart by what they see alone
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/fleet/robot_body.hpp>
#include <surfleet/geometry/camera_models.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/localization/marker_target.hpp>
#include <surfleet/localization/target_tracker.hpp>
#include <surfleet/localization/uncertain_pose.hpp>

namespace surfleet {
struct MarkerSightOptions {
  MarkerTarget target = printed_target(4.0);  ///< Of every robot; all are alike.
  Pose T_body_target = Pose::Identity();      ///< Where robots carry it.
  /// Cameras of every robot; two fish-eyes, ahead and back, see all around.
  std::vector<Pose> T_body_camera{camera_facing(0.0), camera_facing(kPi)};
  EquidistantCamera camera = EquidistantCamera::from_fov(radians(190.0), 752, 752);
  double pixel_noise = 0.3;    ///< Of a marker's centre, along each axis [px].
  double max_distance = 10.0;  ///< Up to which lights are seen [m].
  double deviations = 3.0;     ///< `SeenRobot::error` in standard deviations.
  double period = 0.25;        ///< Between images [s].
  std::uint64_t seed = 1;

  /// The mount of a level camera at the body's centre, `yaw` to the left of ahead.
  static Pose camera_facing(double yaw) {
    Pose T = Pose::Identity();
    T.linear().col(0) = Eigen::Vector3d(std::sin(yaw), -std::cos(yaw), 0.0);
    T.linear().col(1) = -Eigen::Vector3d::UnitZ();
    T.linear().col(2) = Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
    return T;
  }
};

/// Models `NeighbourSense`: the images of lights, without names, and a tracker for every target
/// that a camera has found. An ambiguous one gives all the places that it may be at. Surfaces of
/// the scene hide lights, robots do not. The caster must outlive this object.
template <RayCaster Caster>
class MarkerSight {
 public:
  /// Throws `Error` on a target that poses cannot be told of, and without cameras or robots.
  MarkerSight(const Caster& caster, std::size_t robots, MarkerSightOptions options = {})
      : caster_(&caster), options_(std::move(options)), eyes_(robots) {
    check_target(options_.target);
    require(robots > 0 && !options_.T_body_camera.empty(),
            "sight by markers: expected robots and cameras");
    require(options_.period > 0.0 && options_.max_distance > 0.0 && options_.pixel_noise >= 0.0,
            "sight by markers: expected positive period and distance, and no negative noise");
    for (auto& cameras : eyes_) cameras.resize(options_.T_body_camera.size());
  }

  /// O(robots · markers) rays, and as `TargetTracker`.
  std::vector<SeenRobot> operator()(std::size_t robot, std::uint64_t shot,
                                    std::span<const Configuration> fleet) {
    require(robot < eyes_.size() && fleet.size() <= eyes_.size(),
            "sight by markers: more robots than it was made for");
    std::vector<SeenRobot> seen;
    for (std::size_t c = 0; c < options_.T_body_camera.size(); ++c) {
      const Pose T_world_camera = fleet[robot].pose() * options_.T_body_camera[c];
      Random random = Random(options_.seed).fork(robot).fork(shot).fork(c);
      track(eyes_[robot][c], lights(robot, T_world_camera, fleet, random),
            options_.period * static_cast<double>(shot), T_world_camera, seen);
    }
    return seen;
  }

 private:
  using Tracker = TargetTracker<EquidistantCamera>;

  /// In an order that tells nothing.
  std::vector<Observation> lights(std::size_t robot, const Pose& T_world_camera,
                                  std::span<const Configuration> fleet, Random& random) const {
    const Point3 eye = T_world_camera.translation();
    const Pose T_camera_world = T_world_camera.inverse();
    std::vector<Observation> all;
    for (std::size_t k = 0; k < fleet.size(); ++k) {
      if (k == robot) continue;
      const Pose T_world_target = fleet[k].pose() * options_.T_body_target;
      for (const Point3& marker : options_.target.markers) {
        const Point3 light = T_world_target * marker;
        const double distance = (light - eye).norm();
        if (distance > options_.max_distance) continue;
        const auto px = options_.camera.project(T_camera_world * light);
        if (!px || caster_->cast(eye, light - eye, 1.0 - 1e-9)) continue;
        const Eigen::Vector2d noise{random.normal(), random.normal()};
        all.push_back(observe(options_.camera, *px + options_.pixel_noise * noise));
      }
    }
    std::sort(all.begin(), all.end(),
              [](const Observation& a, const Observation& b) { return a.pixel.x() < b.pixel.x(); });
    return all;
  }
  /// What is known already takes its lights first; what is left may be a new robot.
  void track(std::vector<Tracker>& known, std::vector<Observation> left, double time,
             const Pose& T_world_camera, std::vector<SeenRobot>& seen) const {
    const auto take = [&](const TrackedFrame& frame) {
      for (const TargetFit& fit : frame.fits) seen.push_back(neighbour(fit, T_world_camera));
      if (frame.fits.empty()) return;
      std::vector<int> used = frame.fits.front().blob_of_marker;
      std::sort(used.begin(), used.end(), std::greater<>());
      for (const int b : used)
        if (b != TargetFit::kUnseen) left.erase(left.begin() + b);
    };
    std::erase_if(known, [&](Tracker& tracker) {
      const auto frame = tracker.update(time, left);
      take(*frame);
      return frame->fits.empty();
    });
    while (left.size() >= options_.target.markers.size()) {
      TrackerOptions o;
      o.identify.pixel_noise = std::max(options_.pixel_noise, 0.05);
      o.identify.max_distance = options_.max_distance;
      Tracker fresh(options_.camera, options_.target, o);
      const auto frame = fresh.update(time, left);
      if (frame->fits.empty()) break;
      take(*frame);
      known.push_back(std::move(fresh));
    }
  }
  SeenRobot neighbour(const TargetFit& fit, const Pose& T_world_camera) const {
    const UncertainPose body =
        fit.target_in_camera() * UncertainPose{options_.T_body_target.inverse()};
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(
        body.covariance.bottomRightCorner<3, 3>(), Eigen::EigenvaluesOnly);
    return {T_world_camera * body.pose.translation(),
            options_.deviations * std::sqrt(std::max(0.0, spread.eigenvalues().maxCoeff()))};
  }

  const Caster* caster_;
  MarkerSightOptions options_;
  std::vector<std::vector<std::vector<Tracker>>> eyes_;  // of every robot, of every camera
};
}  // namespace surfleet
