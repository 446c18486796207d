// SPDX-License-Identifier: MIT
/// @file
/// @brief What a free space is made with, and the lengths that follow from it.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/mapping/distance_transform.hpp>

namespace surfleet {
struct FreeSpaceOptions {
  double radius = 1.0;              ///< Of the body [m].
  bool unknown_is_obstacle = true;  ///< Whether what was never seen blocks the way.
  Box3 bounds{};                    ///< The body's centre stays inside; empty: no bounds.
  /// Kept between the body and the centre of an occupied voxel; one voxel edge if not given [m].
  std::optional<double> margin{};
  /// The same for an unknown voxel, `margin` at the most; that if not given [m].
  std::optional<double> unknown_margin{};
  /// Obstacles, whatever the map says of them.
  KeepOut keep_out{};
};

/// The lengths that a free space works with, from its settings.
struct FreeSpaceLengths {
  double margin = 0.0;                  ///< Of all obstacles, occupied voxels grown [m].
  double growth = 0.0;                  ///< Of occupied voxels [voxels].
  double step = 0.0;                    ///< Along segments [m].
  double required = 0.0, excess = 0.0;  ///< [m]
  int reach = 0;                        ///< Of the distances [voxels].

  /// Throws `Error` for a negative radius or margin, or a body of more than about 21 voxels.
  FreeSpaceLengths(double h, const FreeSpaceOptions& options) {
    constexpr int kMost = DistanceTransform::kMaxReach;
    require(options.radius >= 0.0 && std::isfinite(options.radius),
            "body radius " + std::to_string(options.radius) + " m: expected a length of 0 or more");
    const double wide = options.margin.value_or(h);
    require(wide >= 0.0 && std::isfinite(wide),
            "margin " + std::to_string(wide) + " m: expected a length of 0 or more");
    margin = options.unknown_is_obstacle ? options.unknown_margin.value_or(wide) : wide;
    require(margin >= 0.0 && margin <= wide, "margin " + std::to_string(margin) +
                                                 " m of what is unknown: expected 0 to " +
                                                 std::to_string(wide) + " m");
    growth = wide > margin ? (wide - margin) / h + 0.5 : 0.0;
    require(growth < kBitsSide, "margin " + std::to_string(wide) + " m: expected less than " +
                                    std::to_string(kBitsSide) +
                                    " voxels beyond that of what is unknown");
    step = h / 6.0;
    required = options.radius + margin + 0.5 * step;
    // A distance to one point, interpolated trilinearly, is too large by at most h²/(4ρ), with ρ
    // the least distance in the cell; the minimum over obstacles only lowers it.
    excess = h * h / (4.0 * std::max(required - std::sqrt(3.0) * h, 0.5 * h));
    const double far = (required + excess) / h + 2.0;
    require(far <= kMost, "body radius " + std::to_string(options.radius) + " m is " +
                              std::to_string(options.radius / h) + " voxels: expected at most " +
                              std::to_string(kMost - 4) + "; use larger voxels");
    reach = static_cast<int>(std::ceil(far));
  }
};
}  // namespace surfleet
