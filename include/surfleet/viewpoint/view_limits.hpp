// SPDX-License-Identifier: MIT
/// @file
/// @brief How far views reach, and how often they are repeated.
#pragma once

namespace surfleet {
/// Views count as far as this share of the camera's range: what lies farther off is out of it with
/// the next turn of the surface.
inline constexpr double kUsefulRange = 0.85;

/// Views of a piece of unknown space that stay in vain before it is given up.
inline constexpr int kViewsInVain = 3;
}  // namespace surfleet
