// SPDX-License-Identifier: MIT
/// @file
/// @brief A point robot (eq. 3.16 of [004]) that follows a strip's field over the surface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <surfleet/surface/strip_field.hpp>
#include <surfleet/surface/surface_point.hpp>
#include <surfleet/surface/surface_walk.hpp>

namespace surfleet {
/// The place of a strip that a robot is in, as it moves from triangle to triangle.
class StripPlace {
 public:
  explicit StripPlace(const UnfoldedStrip& strip, std::size_t place = 0)
      : strip_(&strip), place_(place) {}
  std::size_t operator*() const { return place_; }
  std::size_t left_strip() const { return left_; }
  bool lost() const { return lost_; }

  /// The robot has entered `triangle`. The next place with it counts, or one a few further where a
  /// line passed by a vertex, or the one before; anything else is to have left the strip, which
  /// goes on at the nearest place with that triangle, if there is one.
  void enter(std::int32_t triangle) {
    const std::size_t n = strip_->size();
    for (std::size_t ahead = 1; ahead <= kAhead && place_ + ahead < n; ++ahead)
      if (strip_->triangles[place_ + ahead] == triangle) {
        place_ += ahead;
        lost_ = false;
        return;
      }
    if (strip_->triangles[place_] == triangle) return;
    if (place_ > 0 && strip_->triangles[place_ - 1] == triangle) {
      --place_;
      return;
    }
    ++left_;
    lost_ = true;
    std::size_t nearest = n;
    for (std::size_t i = 0; i < n; ++i)
      if (strip_->triangles[i] == triangle && gap(i) < gap(nearest)) nearest = i;
    if (nearest == n) return;
    place_ = nearest;
    lost_ = false;
  }

 private:
  static constexpr std::size_t kAhead = 6;
  std::size_t gap(std::size_t i) const {
    if (i == strip_->size()) return std::numeric_limits<std::size_t>::max();
    return i > place_ ? i - place_ : place_ - i;
  }
  const UnfoldedStrip* strip_;
  std::size_t place_, left_ = 0;
  bool lost_ = false;
};

struct FollowOptions {
  double tolerance = 1e-3;  ///< The goal is reached at so far from it [m].
  double max_step = 0.05;   ///< [m]
  std::size_t max_steps = 100000;
};

/// A drive along a field.
struct FieldDrive {
  std::vector<SurfacePose> poses;     ///< After every step, the start first.
  std::vector<std::int32_t> entered;  ///< The triangles, the start's first.
  double length = 0.0;                ///< [m]
  bool reached = false;
  std::size_t left_strip = 0;  ///< Times that it entered a triangle that is not the strip's next.
};

/// Follows `field` from `start`, a point of the triangle of place `place`.
template <StripFieldPolicy Policy>
FieldDrive follow_field(const SurfaceWalk& walk, const StripField<Policy>& field,
                        const SurfacePoint& start, const FollowOptions& options = {},
                        std::size_t place = 0) {
  FieldDrive drive;
  StripPlace at(field.strip(), place);
  const Point3 goal = field.goal().position(walk.mesh());
  const auto& strip = field.strip();
  SurfacePose pose = surface_pose(walk.mesh(), start, field(place, start.weights));
  drive.poses.push_back(pose);
  drive.entered.push_back(start.triangle);
  for (std::size_t k = 0; k < options.max_steps; ++k) {
    if (*at + 1 == strip.size() &&
        (pose.at.position(walk.mesh()) - goal).norm() <= options.tolerance) {
      drive.reached = true;
      break;
    }
    const Eigen::Vector3d u = field(*at, pose.at.weights);
    const double speed = u.norm();
    if (!(speed > 0.0)) break;
    pose.forward = u / speed;
    double length = std::min(options.max_step, speed * field.field.step(*at, pose.at.weights));
    if (*at + 1 == strip.size())
      length = std::min(length, (pose.at.position(walk.mesh()) - goal).norm());
    const SurfaceStep step = walk(pose, {length, 0.0}, 1);  // the next place has its own field
    pose = step.pose;
    drive.length += step.length;
    for (const std::int32_t t : step.entered) at.enter(t);
    drive.entered.insert(drive.entered.end(), step.entered.begin(), step.entered.end());
    if (step.stopped) ++drive.left_strip;
    drive.poses.push_back(pose);
    if (at.lost() || (step.stopped && !(step.length > 0.0))) break;
  }
  drive.left_strip += at.left_strip();
  return drive;
}
}  // namespace surfleet
