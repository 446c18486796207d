// SPDX-License-Identifier: MIT
/// @file
/// @brief How a robot carries out its routes.
#pragma once

#include <optional>

#include <surfleet/core/types.hpp>
#include <surfleet/fleet/endurance.hpp>

namespace surfleet {
struct AgentOptions {
  double image_period = 0.25;  ///< Between images, and the step of the agent's clock [s].
  double max_dwell = 10.0;     ///< Longest stay at a stop [s].
  double utility_share = 0.2;  ///< Share of a route's elements whose completion asks for a new
                               ///< plan, unless the planner says another: c_thres.
  EnduranceLimits endurance{};
  std::optional<Configuration> home{};  ///< Where it goes back to; nothing: where it starts.
};
}  // namespace surfleet
