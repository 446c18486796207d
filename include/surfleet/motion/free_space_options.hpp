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
#include <surfleet/motion/ball_cover.hpp>
#include <surfleet/motion/swept_body.hpp>

namespace surfleet {
struct FreeSpaceOptions {
  double radius = 1.0;              ///< Of the body, or of the ball that holds its shape [m].
  bool unknown_is_obstacle = true;  ///< Whether what was never seen is an obstacle.
  /// Where what was never seen is free: whether its blocks inside the bounds are there from the
  /// first, for those that go through all blocks, as roadmaps and `ReachableSet` do.
  bool all_blocks = true;
  Box3 bounds{};  ///< The body's centre stays inside; empty: no bounds.
  /// Kept between the body and the centre of an occupied voxel; one voxel edge if not given [m].
  std::optional<double> margin{};
  /// The same for an unknown voxel, `margin` at the most; that if not given [m]. What is occupied
  /// counts the same whether unknown voxels do or not.
  std::optional<double> unknown_margin{};
  /// Obstacles, whatever the map says of them.
  KeepOut keep_out{};
  /// What of that ball the body takes up, whatever its heading; nothing: all of it.
  std::optional<SweptBody> shape{};
};

/// A distance to one point, interpolated trilinearly in a grid of edge `h`, is too large by at most
/// h²/(4ρ), with ρ the least distance in the cell; the minimum over obstacles only lowers it [m].
inline double interpolation_excess(double distance, double h) {
  return h * h / (4.0 * std::max(distance - std::sqrt(3.0) * h, 0.5 * h));
}

/// The lengths that a free space works with, from its settings.
struct FreeSpaceLengths {
  double margin = 0.0;                  ///< Of all obstacles, occupied voxels grown [m].
  double growth = 0.0;                  ///< Of occupied voxels [voxels].
  double step = 0.0;                    ///< Along segments [m].
  BallCover body;                       ///< One ball, or those that hold its shape.
  double required = 0.0, excess = 0.0;  ///< From the centre of a ball to obstacles [m].
  double outer = 0.0;                   ///< The same from the body's position [m].
  int reach = 0;                        ///< Of the distances [voxels].

  /// Throws `Error` for a negative radius or margin, or a body of more than about 21 voxels.
  FreeSpaceLengths(double h, const FreeSpaceOptions& options) {
    constexpr int kMost = DistanceTransform::kMaxReach;
    require(options.radius >= 0.0 && std::isfinite(options.radius),
            "body radius " + std::to_string(options.radius) + " m: expected a length of 0 or more");
    const double wide = options.margin.value_or(h);
    require(wide >= 0.0 && std::isfinite(wide),
            "margin " + std::to_string(wide) + " m: expected a length of 0 or more");
    margin = options.unknown_margin.value_or(wide);
    require(margin >= 0.0 && margin <= wide, "margin " + std::to_string(margin) +
                                                 " m of what is unknown: expected 0 to " +
                                                 std::to_string(wide) + " m");
    growth = wide > margin ? (wide - margin) / h + 0.5 : 0.0;
    require(growth < kBitsSide, "margin " + std::to_string(wide) + " m: expected less than " +
                                    std::to_string(kBitsSide) +
                                    " voxels beyond that of what is unknown");
    step = h / 6.0;
    const auto required_by = [&](double radius) { return radius + margin + 0.5 * step; };
    body.radius = options.radius;
    if (options.shape) {
      require(options.radius >= options.shape->radius() && options.radius / h <= kMost - 3,
              "body radius " + std::to_string(options.radius) + " m: expected at least that of " +
                  "its shape and at most " + std::to_string(kMost - 3) + " voxels");
      // Keep-out boxes take every point within a ball's radius to have a centre that near.
      body = cover_with_balls(
          *options.shape, h, std::max(0.0, 0.5 * std::sqrt(3.0) * h - margin),
          [&](double radius) { return interpolation_excess(required_by(radius), h); });
    }
    required = required_by(body.radius);
    outer = required + h * body.centers.length();
    excess = interpolation_excess(required, h);
    const double far = (required + excess) / h + 2.0;
    require(far <= kMost, "body radius " + std::to_string(options.radius) + " m is " +
                              std::to_string(options.radius / h) + " voxels: expected at most " +
                              std::to_string(kMost - 4) + "; use larger voxels");
    reach = static_cast<int>(std::ceil(far));
  }
};
}  // namespace surfleet
