// SPDX-License-Identifier: MIT
/// @file
/// @brief Values of ours as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include <surfleet/core/types.hpp>

namespace surfleet::examples {
inline nlohmann::json triple(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
}  // namespace surfleet::examples
