// SPDX-License-Identifier: MIT
/// @file
/// @brief How a depth camera errs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>

namespace surfleet {
/// Spoils an exact depth image in place, on up to `threads` threads, the same for any number of
/// them. Only depths within the camera's range are measurements; others must stay as they are.
template <typename N>
concept DepthNoise = std::copyable<N> &&
    requires(const N& noise, const PinholeCamera& camera, DepthImage& image, const Random& random,
             int threads) {
  noise(camera, image, random, threads);
};

/// A perfect camera.
struct NoNoise {
  void operator()(const PinholeCamera&, DepthImage&, const Random&, int) const {}
};

/// The error of a stereo pair: Gaussian along z with σ(z) = |e_d| z² / (f B), independent for each
/// pixel, then smoothed by the 3 × 3 kernel of binomial weights 1-2-1 [000 §2.6.1].
///
/// A pixel is averaged with those neighbours alone that may lie on its surface: measurements whose
/// depth differs by less than `same_surface` · z for a step of one pixel, plus three deviations of
/// the difference of two errors. So edges are not smeared into the free space before or behind
/// them. A depth that errs out of the camera's range stays at its limit.
struct StereoNoise {
  double disparity_error = 0.1;  ///< |e_d| [px].
  double focal = 376.0;          ///< f [px].
  double baseline = 0.11;        ///< B [m].
  bool smooth = true;
  double same_surface = 0.05;  ///< Relative change of depth between pixels of one surface.

  double deviation(double z) const {
    return std::abs(disparity_error) / (focal * baseline) * z * z;
  }

  void operator()(const PinholeCamera& camera, DepthImage& image, const Random& random,
                  int threads) const {
    const auto measured = [&](float d) {
      return DepthImage::is_measurement(d) && static_cast<double>(d) <= camera.max_range;
    };
    const auto rows = static_cast<std::size_t>(image.height);
    parallel_for(
        rows, threads,
        [&](std::size_t row) {
          Random stream = random.fork(row);
          for (int u = 0; u < image.width; ++u) {
            float& d = image(u, static_cast<int>(row));
            if (!measured(d)) continue;
            const double z = static_cast<double>(d);
            d = static_cast<float>(std::clamp(z + deviation(z) * stream.normal(),
                                              std::max(camera.min_range, 1e-3), camera.max_range));
          }
        },
        16);
    if (!smooth) return;
    const std::vector<float> raw = image.depth;
    parallel_for(
        rows, threads,
        [&](std::size_t row) {
          constexpr std::array<double, 3> kWeight{1.0, 2.0, 1.0};
          const int v = static_cast<int>(row);
          for (int u = 0; u < image.width; ++u) {
            const float centre = raw[image.index(u, v)];
            if (!measured(centre)) continue;
            const double z = static_cast<double>(centre);
            const double reach = same_surface * z + 3.0 * std::sqrt(2.0) * deviation(z);
            double sum = 0.0, weights = 0.0;
            for (int dv = -1; dv <= 1; ++dv)
              for (int du = -1; du <= 1; ++du) {
                if (u + du < 0 || u + du >= image.width || v + dv < 0 || v + dv >= image.height)
                  continue;
                const float d = raw[image.index(u + du, v + dv)];
                if (!measured(d) || std::abs(static_cast<double>(d) - z) > reach) continue;
                const double w = kWeight[static_cast<std::size_t>(du + 1)] *
                                 kWeight[static_cast<std::size_t>(dv + 1)];
                sum += w * static_cast<double>(d);
                weights += w;
              }
            // The float next below the limit, so that rounding cannot pass it.
            image(u, v) =
                std::min(static_cast<float>(sum / weights), static_cast<float>(camera.max_range));
          }
        },
        16);
  }
};
static_assert(DepthNoise<NoNoise> && DepthNoise<StereoNoise>);
}  // namespace surfleet
