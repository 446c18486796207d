// SPDX-License-Identifier: MIT
/// @file
/// @brief How long the machine takes.
#pragma once

#include <chrono>

namespace surfleet::examples {
using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}
}  // namespace surfleet::examples
