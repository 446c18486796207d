// SPDX-License-Identifier: MIT
/// @file
/// @brief The judge: collisions and clearances of the robots' true paths against the true scene and
/// against each other. It knows nothing of the robots' map.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/bvh.hpp>

namespace surfleet {
/// Measures the distance from a point to the true scene [m]. Models: `Bvh`; FCL as an adapter.
template <typename J>
concept DistanceJudge = requires(const J& judge, const Point3& p) {
  { judge.distance(p) } -> std::convertible_to<double>;
};
static_assert(DistanceJudge<Bvh>);

struct JudgeReport {
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  int collisions = 0;               ///< Both kinds below.
  int collisions_with_scene = 0;    ///< Times that a body came to overlap the scene.
  int collisions_of_robots = 0;     ///< Times that two bodies came to overlap each other.
  double min_distance_m = kNone;    ///< Least distance of a body's centre to the scene.
  double min_clearance_m = kNone;   ///< Least distance of a body's hull to the scene; < 0 overlaps.
  double min_separation_m = kNone;  ///< Least distance of two hulls; < 0 overlaps.
};

/// Watches a fleet of balls of one radius as the simulation moves them.
///
/// Between two calls every robot moves in a straight line at constant speed. Clearance to the
/// scene holds along the whole line: it is sampled as densely as needed to find the minimum to
/// within `tolerance`, where distances change by at most the distance flown. Separation is the
/// exact minimum over the lines. An overlap counts once until the bodies have parted.
template <DistanceJudge Distance>
class Judge {
 public:
  /// `distance` is referred to and must outlive the judge.
  Judge(const Distance& distance, double radius, double tolerance = 1e-3)
      : distance_(&distance), radius_(radius), tolerance_(tolerance) {
    require(radius > 0.0 && tolerance > 0.0, "judge: expected a positive radius and tolerance");
  }

  /// The robots' positions now, always for the same fleet in the same order; not finite for one
  /// that is gone, or not there yet: it comes from nowhere. O(robots²) and a few distance queries a
  /// robot.
  void observe(std::span<const Point3> positions) {
    const std::size_t n = positions.size();
    if (last_.empty()) {
      last_.assign(positions.begin(), positions.end());
      in_scene_.assign(n, false);
      in_pair_.assign(n * n, false);
    }
    require(last_.size() == n, "judge: expected the same fleet as before");
    for (std::size_t i = 0; i < n; ++i) {
      if (!positions[i].allFinite()) continue;
      if (!last_[i].allFinite()) last_[i] = positions[i];
      const double at_end = distance_->distance(positions[i]);
      const double least = least_distance(last_[i], positions[i], at_end);
      report_.min_distance_m = std::min(report_.min_distance_m, least);
      report_.min_clearance_m = std::min(report_.min_clearance_m, least - radius_);
      count(least < radius_, at_end < radius_, in_scene_, i, report_.collisions_with_scene);
      for (std::size_t j = 0; j < i; ++j) {
        if (!positions[j].allFinite()) continue;
        // The relative motion is a straight line too.
        const Eigen::Vector3d from = last_[i] - last_[j];
        const Eigen::Vector3d motion = (positions[i] - positions[j]) - from;
        const double length2 = motion.squaredNorm();
        const double s = length2 > 0.0 ? std::clamp(-from.dot(motion) / length2, 0.0, 1.0) : 0.0;
        const double gap = (from + s * motion).norm() - 2.0 * radius_;
        report_.min_separation_m = std::min(report_.min_separation_m, gap);
        const double end_gap = (from + motion).norm() - 2.0 * radius_;
        count(gap < 0.0, end_gap < 0.0, in_pair_, i * n + j, report_.collisions_of_robots);
      }
    }
    last_.assign(positions.begin(), positions.end());
    report_.collisions = report_.collisions_with_scene + report_.collisions_of_robots;
  }

  const JudgeReport& report() const { return report_; }

 private:
  static void count(bool between, bool at_end, std::vector<bool>& state, std::size_t at,
                    int& events) {
    if (between && !state[at]) ++events;
    state[at] = at_end;
  }

  /// The least distance to the scene along a segment if it may lower the fleet's minimum or touch
  /// the body; else some distance that does neither.
  double least_distance(const Point3& a, const Point3& b, double at_b) const {
    const double length = (b - a).norm();
    if (!(length > 0.0)) return at_b;
    const double at_a = distance_->distance(a);
    return refine(a, b, at_a, at_b, length, std::min(at_a, at_b), 0);
  }
  double refine(const Point3& a, const Point3& b, double at_a, double at_b, double length,
                double least, int depth) const {
    // Distance is 1-Lipschitz: between the ends it cannot fall below this.
    const double bound = 0.5 * (at_a + at_b - length);
    const double concern = std::min(least, std::max(report_.min_distance_m, radius_));
    if (bound >= concern - tolerance_ || depth >= 20) return least;
    const Point3 m = 0.5 * (a + b);
    const double at_m = distance_->distance(m);
    least = std::min(least, at_m);
    least = refine(a, m, at_a, at_m, 0.5 * length, least, depth + 1);
    return refine(m, b, at_m, at_b, 0.5 * length, least, depth + 1);
  }

  const Distance* distance_;
  double radius_, tolerance_;
  std::vector<Point3> last_;
  std::vector<bool> in_scene_, in_pair_;
  JudgeReport report_;
};

/// Judges whole paths, robot by robot: `paths[r][k]` is robot r's position at the k-th of the
/// common instants, not finite once it is gone.
template <DistanceJudge Distance>
JudgeReport judge_paths(const Distance& distance, std::span<const std::vector<Point3>> paths,
                        double radius) {
  Judge<Distance> judge(distance, radius);
  if (paths.empty()) return judge.report();
  std::vector<Point3> positions(paths.size());
  for (std::size_t k = 0; k < paths[0].size(); ++k) {
    for (std::size_t r = 0; r < paths.size(); ++r) {
      require(paths[r].size() == paths[0].size(), "judge: expected paths of equal length");
      positions[r] = paths[r][k];
    }
    judge.observe(positions);
  }
  return judge.report();
}
}  // namespace surfleet
