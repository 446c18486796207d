// SPDX-License-Identifier: MIT
/// @file
/// @brief Why a mission ends with surface that is still incomplete.
#pragma once

#include <cstdint>
#include <string_view>

namespace surfleet {
/// Why an incomplete element is left when a mission ends [000 Def. 2].
enum class LeftReason : std::uint8_t {
  hidden,           ///< No line of sight to what is unknown beside it.
  no_free_pose,     ///< No collision-free configuration has it in view.
  unreachable,      ///< Configurations see it, but none can be reached.
  seen_incomplete,  ///< Viewed as often as allowed, and still incomplete.
  not_attempted,    ///< The mission ended before its turn came, or its planner says nothing of it.
};
constexpr std::string_view name_of(LeftReason r) {
  switch (r) {
    case LeftReason::hidden:
      return "hidden";
    case LeftReason::no_free_pose:
      return "no_free_pose";
    case LeftReason::unreachable:
      return "unreachable";
    case LeftReason::seen_incomplete:
      return "seen_incomplete";
    case LeftReason::not_attempted:
      break;
  }
  return "not_attempted";
}
}  // namespace surfleet
