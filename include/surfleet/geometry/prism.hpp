// SPDX-License-Identifier: MIT
/// @file
/// @brief A space of one ground plan at every height.
#pragma once

#include <surfleet/geometry/polygon.hpp>

namespace surfleet {
/// A polygon extruded from `low` to `high` [m].
struct Prism {
  Polygon ground;
  double low = 0.0, high = 1.0;
};
}  // namespace surfleet
