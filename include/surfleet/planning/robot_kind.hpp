// SPDX-License-Identifier: MIT
/// @file
/// @brief What robots of one kind have in common: camera, body, limits, where they may be.
#pragma once

#include <cstdint>
#include <optional>

#include <surfleet/core/transport.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/motion/kinematics.hpp>

namespace surfleet {
using RobotKindId = std::uint32_t;  ///< Of a kind among those of a belief, from 0 on.

struct RobotKind {
  PinholeCamera camera;
  Pose T_body_camera = forward_camera_mount();
  double body_radius = 1.0;              ///< [m]
  std::optional<double> margin;          ///< Kept beyond the body [m]; nothing: one voxel.
  std::optional<double> unknown_margin;  ///< The same from what is unknown [m]; nothing: `margin`.
  AerialLimits limits;
  Box3 bounds;       ///< Where the robots' centres may be [m].
  KeepOut keep_out;  ///< Where in there their bodies may not be.
};
}  // namespace surfleet
