// SPDX-License-Identifier: MIT
/// @file
/// @brief Robots that represent a picture: shape-based and goal-based pattern formation [004
/// §4.3.1].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/coverage/lloyd.hpp>
#include <surfleet/geometry/polygon_clipping.hpp>

namespace surfleet {
/// Goal assignment: an auction in which robots bid for goals until none is outbid, within
/// `robots · increment` of the least total squared distance. O(n² · rounds).
inline std::vector<std::size_t> auction_goals(std::span<const Point2> robots,
                                              std::span<const Point2> goals,
                                              double increment = 1e-4) {
  require(robots.size() <= goals.size(), "auction: there must be at least as many goals as robots");
  require(increment > 0.0, "auction: the bidding increment must be positive");
  constexpr auto kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> goal_of(robots.size(), kNone), winner(goals.size(), kNone), bidders;
  std::vector<double> price(goals.size(), 0.0);
  for (std::size_t i = robots.size(); i-- > 0;) bidders.push_back(i);
  while (!bidders.empty()) {
    const std::size_t i = bidders.back();
    bidders.pop_back();
    double best = -1e300, second = -1e300;
    std::size_t wanted = 0;
    for (std::size_t g = 0; g < goals.size(); ++g) {
      const double value = -(goals[g] - robots[i]).squaredNorm() - price[g];
      if (value > best) {
        second = best;
        best = value;
        wanted = g;
      } else {
        second = std::max(second, value);
      }
    }
    price[wanted] += (goals.size() > 1 ? best - second : 0.0) + increment;
    if (winner[wanted] != kNone) {
      goal_of[winner[wanted]] = kNone;
      bidders.push_back(winner[wanted]);
    }
    winner[wanted] = i;
    goal_of[i] = wanted;
  }
  return goal_of;
}

/// Goal positions that represent a shape, moved along from frame to frame.
///
/// Goals are a centroidal Voronoi tessellation of the shape. For the next frame they are carried by
/// the motion of the shape's centroid and by the rotation that best matches the outlines, which
/// keeps successive sets alike, and then relaxed again.
class GoalFormation {
 public:
  GoalFormation(const Polygon& shape, std::size_t count, Random random, int relaxations = 60)
      : shape_(shape), relaxations_(relaxations) {
    require(count > 0, "pattern: at least one robot is needed");
    goals_ = random_places(shape, count, random);
    relax();
  }
  const std::vector<Point2>& goals() const { return goals_; }
  void next_frame(const Polygon& shape) {
    const Point2 from = centroid(shape_), to = centroid(shape);
    const double angle = matching_rotation(shape_, shape);
    const Eigen::Rotation2Dd turn_by(angle);
    for (Point2& g : goals_) g = project_into(shape, to + turn_by * (g - from));
    shape_ = shape;
    relax();
  }
  /// The rotation about the centroids under which the outlines' radii differ least [rad].
  static double matching_rotation(const Polygon& a, const Polygon& b) {
    constexpr std::size_t kRays = 180;
    const auto radii = [](const Polygon& p) {
      const Point2 c = centroid(p);
      std::vector<double> r(kRays, 0.0);
      for (std::size_t k = 0; k < kRays; ++k) {
        const double angle = 2.0 * kPi * static_cast<double>(k) / kRays;
        const Point2 u(std::cos(angle), std::sin(angle));
        for_each_edge(p.outer, [&](const Point2& e, const Point2& f) {
          const double se = cross2(u, e - c), sf = cross2(u, f - c);
          if ((se > 0.0) == (sf > 0.0)) return;
          r[k] = std::max(r[k], u.dot(e - c) + se / (se - sf) * u.dot(f - e));
        });
      }
      return r;
    };
    const std::vector<double> ra = radii(a), rb = radii(b);
    double best = std::numeric_limits<double>::infinity(), angle = 0.0;
    for (std::size_t s = 0; s < kRays; ++s) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kRays; ++k) {
        const double d = ra[k] - rb[(k + s) % kRays];
        sum += d * d;
      }
      const double candidate = wrap_angle(2.0 * kPi * static_cast<double>(s) / kRays);
      // Of equally good rotations, as of a symmetric shape, the smallest.
      if (sum < best * (1.0 - 1e-9) - 1e-15 ||
          (sum <= best * (1.0 + 1e-9) + 1e-15 && std::abs(candidate) < std::abs(angle))) {
        best = std::min(best, sum);
        angle = candidate;
      }
    }
    return angle;
  }

 private:
  void relax() {
    const LloydCoverage<> lloyd(shape_);
    for (std::size_t i = 0; i < goals_.size(); ++i)  // projections may coincide
      for (std::size_t j = 0; j < i; ++j)
        if (goals_[i] == goals_[j]) goals_[i] += 1e-6 * (centroid(shape_) - goals_[i]);
    for (int k = 0; k < relaxations_; ++k)
      if (lloyd.step(goals_).largest_move < 1e-4 * shape_.bounds().diagonal().norm()) break;
    for (Point2& g : goals_) g = project_into(shape_, g);
  }
  Polygon shape_;
  std::vector<Point2> goals_;
  int relaxations_;
};

struct ShapeFlockOptions {
  double spacing = 0.25;   ///< Distance at which robots neither attract nor repel [m].
  double range = 0.35;     ///< Of interaction [m].
  double disk = 0.3;       ///< Around a robot, intersected with the shape to steer by [m].
  double max_speed = 0.3;  ///< [m/s]
  double dt = 0.05;        ///< [s]
};
/// Flocking that takes the shape of an image area: gradient-based cohesion and separation and
/// velocity consensus between robots, and for each an attractor of its own: the nearest point of
/// the outline for a robot outside, the centroid of disk ∩ shape for one at the border.
class ShapeFlock {
 public:
  explicit ShapeFlock(std::span<const Point2> start, ShapeFlockOptions settings = {})
      : options(settings),
        positions_(start.begin(), start.end()),
        velocities_(start.size(), Point2::Zero()) {
    require_distinct(start);
  }
  const std::vector<Point2>& positions() const { return positions_; }
  void step(const Polygon& shape) {
    std::vector<Point2> force(positions_.size(), Point2::Zero());
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      for (std::size_t j = 0; j < positions_.size(); ++j) {
        const Point2 d = positions_[j] - positions_[i];
        const double length = d.norm();
        if (j == i || length >= options.range || length == 0.0) continue;
        const double near = 1.0 - length / options.range;
        const double pull = length < options.spacing
                                ? 8.0 * (length - options.spacing) / options.spacing
                                : 0.3 * (length - options.spacing) / options.range;
        force[i] += pull * d / length + 0.5 * near * (velocities_[j] - velocities_[i]);
      }
      force[i] += attraction(shape, positions_[i]) - 2.0 * velocities_[i];
    }
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      velocities_[i] += options.dt * force[i];
      const double speed = velocities_[i].norm();
      if (speed > options.max_speed) velocities_[i] *= options.max_speed / speed;
      positions_[i] += options.dt * velocities_[i];
    }
  }

  ShapeFlockOptions options;

 private:
  Point2 attraction(const Polygon& shape, const Point2& p) const {
    const BoundaryPoint border = closest_boundary_point(shape, p);
    const bool inside = contains(shape, p);
    if (!inside) return 4.0 * (border.point - p) / std::max(0.2, border.distance);
    if (border.distance >= options.disk) return Point2::Zero();
    Ring disk;
    for (int k = 0; k < 16; ++k)
      disk.emplace_back(p.x() + options.disk * std::cos(k * kPi / 8),
                        p.y() + options.disk * std::sin(k * kPi / 8));
    const Region part = clip(shape, disk);
    return 4.0 * (region_moments(part, p, UniformDensity{}, 0.0).centroid() - p);
  }
  std::vector<Point2> positions_, velocities_;
};
}  // namespace surfleet
