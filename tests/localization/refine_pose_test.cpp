// SPDX-License-Identifier: MIT
#include <surfleet/localization/refine_pose.hpp>

#include <surfleet/localization/estimate_pose.hpp>
#include <surfleet/localization/p3p_kneip.hpp>

#include "check.hpp"
#include "scenes.hpp"

namespace {
using namespace surfleet;

template <CameraModel Camera>
void exact_projections_give_the_pose(const Camera& camera) {
  Random random(8);
  const MarkerTarget target = printed_target();
  for (int i = 0; i < 200; ++i) {
    const Pose T = scenes::random_view(camera, target, 0.7, 3.0, random);
    const auto seen = observe_all(camera, scenes::see(camera, target, T, 0.0, random));
    const auto found = estimate_pose(seen, target.markers);
    CHECK(found.has_value());
    if (found) CHECK_NEAR((found->T_camera_target.matrix() - T.matrix()).norm(), 0.0, 1e-9);
    const auto kneip = estimate_pose(seen, target.markers, {}, KneipP3p{});
    if (kneip) CHECK_NEAR((kneip->T_camera_target.matrix() - T.matrix()).norm(), 0.0, 1e-9);
    // From aside, too.
    Vector6 xi;
    for (int k = 0; k < 6; ++k) xi[k] = 0.05 * random.normal();
    const auto refined = refine_pose(seen, target.markers, perturbed(T, xi));
    if (refined.cost < 1e-6)
      CHECK_NEAR(scenes::distance_between(refined.T_camera_target, T), 0, 1e-7);
  }
}
TEST(exact_pixels_give_the_pose_through_any_lens) {
  exact_projections_give_the_pose(scenes::printed_camera());
  exact_projections_give_the_pose(EquidistantCamera::from_fov(radians(190), 752, 480));
  RadialTangentialCamera brown;
  brown.radial = {-0.28, 0.07, 0.0};
  exact_projections_give_the_pose(brown);
}

/// The least sum found by walking along the axes with ever shorter steps, without derivatives.
Pose walk_to_minimum(std::span<const Observation> seen, std::span<const Point3> points, Pose T) {
  double cost = detail::reprojection_cost(seen, points, T, 3.0);
  for (double step = 0.01; step > 1e-9; step *= 0.7)
    for (int again = 0; again < 60; ++again) {
      bool better = false;
      for (int k = 0; k < 6; ++k)
        for (const double sign : {-1.0, 1.0}) {
          Vector6 xi = Vector6::Zero();
          xi[k] = sign * step;
          const Pose next = perturbed(T, xi);
          const double c = detail::reprojection_cost(seen, points, next, 3.0);
          if (c < cost) {
            cost = c;
            T = next;
            better = true;
          }
        }
      if (!better) break;
    }
  return T;
}
TEST(refinement_reaches_the_minimum) {
  const auto camera = scenes::printed_camera();
  const MarkerTarget target = printed_target();
  Random random(9);
  for (int i = 0; i < 5; ++i) {
    const Pose T = scenes::random_view(camera, target, 0.7, 1.2, random);
    const auto seen = observe_all(camera, scenes::see(camera, target, T, 0.5, random));
    const auto refined = refine_pose(seen, target.markers, T);
    const Pose walked = walk_to_minimum(seen, target.markers, refined.T_camera_target);
    const double cost = detail::reprojection_cost(seen, target.markers, walked, 3.0);
    CHECK(refined.cost <= cost * (1.0 + 1e-7));
    CHECK(refined.cost <= detail::reprojection_cost(seen, target.markers, T, 3.0));
  }
}
TEST(covariance_is_the_spread_of_many_trials) {
  const auto camera = scenes::printed_camera();
  const MarkerTarget target = printed_target();
  Random random(10);
  const Pose T = scenes::random_view(camera, target, 1.0, 1.5, random);
  constexpr int kTrials = 4000;
  constexpr double kNoise = 0.1;
  Matrix6 spread = Matrix6::Zero(), spread_inverse = Matrix6::Zero();
  Matrix6 stated = Matrix6::Zero();
  double nees = 0.0, nees_inverse = 0.0;
  for (int i = 0; i < kTrials; ++i) {
    const auto seen = observe_all(camera, scenes::see(camera, target, T, kNoise, random));
    const auto refined = refine_pose(seen, target.markers, T);
    const UncertainPose found{refined.T_camera_target, refined.covariance(kNoise)};
    const Vector6 xi = difference(T, found.pose);
    const Vector6 back = difference(T.inverse(), found.inverse().pose);
    spread += xi * xi.transpose() / kTrials;
    spread_inverse += back * back.transpose() / kTrials;
    stated += found.covariance / kTrials;
    nees += found.normalized_error(T) / kTrials;
    nees_inverse += found.inverse().normalized_error(T.inverse()) / kTrials;
  }
  CHECK((spread - stated).norm() < 0.08 * stated.norm());
  const UncertainPose at_truth{T, stated};
  CHECK((spread_inverse - at_truth.inverse().covariance).norm() < 0.08 * spread_inverse.norm());
  CHECK_NEAR(nees, 6.0, 0.3);
  CHECK_NEAR(nees_inverse, 6.0, 0.3);
}
TEST(an_outlier_costs_its_distance_no_longer_its_square) {
  CHECK_NEAR(detail::huber_cost(4.0, 3.0), 4.0, 1e-12);
  CHECK_NEAR(detail::huber_cost(9.0, 3.0), 9.0, 1e-12);
  CHECK_NEAR(detail::huber_cost(10000.0, 3.0), 3.0 * 197.0, 1e-9);
}
TEST(chains_and_inverses_of_uncertain_poses_match_trials) {
  Random random(11);
  const auto random_pose = [&] {
    Pose T = Pose::Identity();
    T.linear() = scenes::random_rotation(random);
    T.translation() = Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    return T;
  };
  const auto random_covariance = [&] {
    Matrix6 a;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) a(i, j) = 1e-3 * random.normal();
    return Matrix6(a * a.transpose());
  };
  const UncertainPose ab{random_pose(), random_covariance()},
      bc{random_pose(), random_covariance()};
  const Eigen::Matrix<double, 6, 6> la = ab.covariance.llt().matrixL(),
                                    lb = bc.covariance.llt().matrixL();
  Matrix6 spread = Matrix6::Zero();
  constexpr int kTrials = 20000;
  for (int i = 0; i < kTrials; ++i) {
    Vector6 a, b;
    for (int k = 0; k < 6; ++k) {
      a[k] = random.normal();
      b[k] = random.normal();
    }
    const Pose T = perturbed(ab.pose, la * a) * perturbed(bc.pose, lb * b);
    const Vector6 xi = difference(ab.pose * bc.pose, T);
    spread += xi * xi.transpose() / kTrials;
  }
  const UncertainPose ac = ab * bc;
  CHECK((spread - ac.covariance).norm() < 0.05 * spread.norm());
  CHECK((ab.inverse().inverse().covariance - ab.covariance).norm() < 1e-12);
}
TEST(points_behind_and_too_few_are_refused) {
  const auto camera = scenes::printed_camera();
  const MarkerTarget target = printed_target();
  Random random(12);
  const Pose T = scenes::random_view(camera, target, 1.0, 1.5, random);
  const auto seen = observe_all(camera, scenes::see(camera, target, T, 0.0, random));
  Pose behind = T;
  behind.translation() *= -1.0;
  CHECK(!refine_pose(seen, target.markers, behind).valid());
  CHECK_THROWS(Error, estimate_pose(std::span(seen).first(3), std::span(target.markers).first(3)));
  CHECK_THROWS(Error, estimate_pose(seen, std::span(target.markers).first(3)));
}
}  // namespace
