// SPDX-License-Identifier: MIT
/// @file
/// @brief What all methods of `surface_navigation` share: where to go, records of poses, the view.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>

namespace surfleet::examples {
template <typename Place>
struct RouteEnds {
  Place start;
  std::vector<Place> goals;
};
/// The point that three numbers of an option from the k-th on are. Throws Error if one is not
/// finite.
inline Point3 given_point(const std::vector<double>& xyz, std::size_t k, const char* option) {
  const Point3 p(xyz[k], xyz[k + 1], xyz[k + 2]);
  if (!p.allFinite()) {
    std::string why = option;
    why += ": expected finite numbers";
    throw Error(why);
  }
  return p;
}
/// `place(p, option)` is the place at a point that the user has given; `end(share)` one on the
/// diagonal of the scene's box, where none is. Three numbers are a point.
template <typename PlaceAt, typename End>
auto route_ends(const std::vector<double>& start, const std::vector<double>& goal,
                const PlaceAt& place, const End& end) {
  RouteEnds<decltype(end(0.0))> ends{
      start.empty() ? end(0.1) : place(given_point(start, 0, "--start"), "--start"), {}};
  for (std::size_t k = 0; k + 2 < goal.size(); k += 3)
    ends.goals.push_back(place(given_point(goal, k, "--goal"), "--goal"));
  if (ends.goals.empty()) ends.goals.push_back(end(0.9));
  return ends;
}

/// Adds a pose that is reached from the last one, straight and at a speed [m/s].
inline void append_pose(std::vector<StampedPose>& record, const Pose& T_world_body, double speed) {
  StampedPose pose;
  pose.T_world_body = T_world_body;
  if (!record.empty())
    pose.time =
        record.back().time +
        (T_world_body.translation() - record.back().T_world_body.translation()).norm() / speed;
  record.push_back(pose);
}

/// An empty picture that a box fits in; of what lies flat, from above.
inline Rasterizer navigation_picture(const Box3& box) {
  const bool flat = box.sizes().z() < 0.5 * box.sizes().x();
  RenderStyle style;
  style.shadows = false;
  return Rasterizer(frame_box(box, radians(-60.0), radians(flat ? 50.0 : 25.0), 1280, 860), style);
}
}  // namespace surfleet::examples
