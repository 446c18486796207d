// SPDX-License-Identifier: MIT
/// @file
/// @brief The parameters that published missions were flown with [000 Tables 2.1, 3.1].
#pragma once

#include <string>
#include <string_view>

#include <surfleet/core/error.hpp>

namespace surfleet {
/// Map, body, camera and planner of a mission; as it stands, at the power plant.
struct MissionPreset {
  double voxel = 0.3;                        ///< Edge of a voxel [m].
  double radius = 1.0;                       ///< Of a robot's body [m].
  double margin = 0.35;                      ///< Kept beyond the body [m].
  double unknown_margin = 0.35;              ///< The same from what is unknown [m].
  double nearest = 1.6, farthest = 8.0;      ///< Depths that the camera measures [m].
  double standoff = 4.7;                     ///< δ_pose, distance of a view [m].
  double cluster_radius = 2.0;               ///< d_ν [m].
  double lambda_tc = 0.3, lambda_ic = 0.03;  ///< Penalties of travel [1/m].
  double printed_share = 0.8;                ///< c_thres.
};

inline MissionPreset powerplant_preset() { return {}; }
inline MissionPreset statue_preset() {
  return {.voxel = 0.15,
          .margin = 0.4,  // its crown has spikes that such voxels know only in part
          .unknown_margin = 0.15,
          .nearest = 1.0,
          .farthest = 5.0,
          .standoff = 3.6,
          .cluster_radius = 2.5,
          .lambda_tc = 0.17,
          .lambda_ic = 0.15,
          .printed_share = 0.5};
}
/// powerplant or statue. Throws `Error` for another name, which says that and `others`.
inline MissionPreset published_preset(std::string_view name, std::string_view others = "") {
  if (name == "powerplant") return powerplant_preset();
  if (name == "statue") return statue_preset();
  throw Error("preset " + std::string(name) + ": not known; expected powerplant, statue" +
              (others.empty() ? "" : ", " + std::string(others)));
}
}  // namespace surfleet
