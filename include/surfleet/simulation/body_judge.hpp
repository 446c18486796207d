// SPDX-License-Identifier: MIT
/// @file
/// @brief The judge of bodies that are no balls: collisions and clearance of their true shape along
/// the robots' true paths.
///
///     const FclBodyJudge shape(mesh_judge, body);
///     judge_bodies(shape, configurations, body.bounding_radius(), report);
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/simulation/judge.hpp>

namespace surfleet {
/// Measures the distance from a robot's body at a configuration to the true scene [m], 0 where they
/// touch. FCL as an adapter.
template <typename J>
concept BodyDistanceJudge = requires(const J& judge, const Configuration& q) {
  { judge.distance(q) } -> std::convertible_to<double>;
};

namespace detail {
/// Follows one body from configuration to configuration.
template <BodyDistanceJudge Distance>
class BodyTrack {
 public:
  BodyTrack(const Distance& distance, double radius, double tolerance, double& least)
      : distance_(&distance), radius_(radius), tolerance_(tolerance), least_(&least) {}

  /// Whether the body has touched the scene from the last configuration to this one. It goes
  /// straight and turns evenly.
  bool touches_until(const Configuration& q) {
    const double at = distance_->distance(q);
    *least_ = std::min(*least_, at);
    bool touched = at <= 0.0;
    if (begun_) touched = refine(last_, q, last_at_, at, 0) || touched;
    begun_ = true;
    last_ = q;
    last_at_ = at;
    return touched;
  }
  bool touching() const { return last_at_ <= 0.0; }

 private:
  bool refine(const Configuration& a, const Configuration& b, double at_a, double at_b, int depth) {
    const double turn = wrap_angle(b.yaw - a.yaw);
    // No point of the body goes farther than this, and no distance changes by more.
    const double travel = (b.position - a.position).norm() + radius_ * std::abs(turn);
    const double bound = 0.5 * (at_a + at_b - travel);
    if (bound >= std::max(*least_ - tolerance_, 0.0) || travel < tolerance_ || depth >= 20)
      return false;
    const Configuration m{0.5 * (a.position + b.position), a.yaw + 0.5 * turn};
    const double at_m = distance_->distance(m);
    *least_ = std::min(*least_, at_m);
    const bool before = refine(a, m, at_a, at_m, depth + 1);
    return refine(m, b, at_m, at_b, depth + 1) || before || at_m <= 0.0;
  }

  const Distance* distance_;
  double radius_, tolerance_;
  double* least_;
  Configuration last_;
  double last_at_ = 0.0;
  bool begun_ = false;
};
}  // namespace detail

/// Puts the true shape's collisions with the scene and clearance of it in the place of the ball's
/// in `report`; robots are still kept apart as balls. `paths[r]` are robot r's configurations, one
/// after the other, to the end of its mission. Between two of them it goes straight and turns by
/// the smaller angle, evenly. A touch counts once until the body is clear again; the least
/// clearance holds to within `tolerance` along the whole path. `radius` is that of the ball that
/// holds the body [m]. Throws `Error` on a radius or tolerance that is not positive.
template <BodyDistanceJudge Distance>
void judge_bodies(const Distance& distance, std::span<const std::vector<Configuration>> paths,
                  double radius, JudgeReport& report, double tolerance = 1e-3) {
  require(radius > 0.0 && tolerance > 0.0, "judge: expected a positive radius and tolerance");
  report.collisions_with_scene = 0;
  report.min_clearance_m = JudgeReport::kNone;
  for (const std::vector<Configuration>& path : paths) {
    detail::BodyTrack track(distance, radius, tolerance, report.min_clearance_m);
    bool was_touching = false;
    for (const Configuration& q : path) {
      if (track.touches_until(q) && !was_touching) ++report.collisions_with_scene;
      was_touching = track.touching();
    }
  }
  report.collisions = report.collisions_with_scene + report.collisions_of_robots;
}
}  // namespace surfleet
