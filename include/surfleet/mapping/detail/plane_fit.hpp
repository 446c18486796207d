// SPDX-License-Identifier: MIT
/// @file
/// @brief Planes through the points around pixels, fitted robustly, many pixels at a time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <surfleet/mapping/detail/vector_code.hpp>

namespace surfleet::detail {
/// Inverse depth at the centres of N pixels and its change a pixel.
template <std::size_t N>
struct InversePlanes {
  using Lanes = std::array<float, N>;
  Lanes inverse{}, slope_u{}, slope_v{};
};

/// What is known around N pixels, at most `kMost` points each.
template <std::size_t N, std::size_t kMost>
struct PixelPoints {
  using Lanes = std::array<float, N>;
  std::array<Lanes, kMost> u, v;     ///< From the pixel's centre [px].
  std::array<Lanes, kMost> inverse;  ///< 1 / depth; 0 for none.
  std::size_t count = 0;
  Lanes own{}, own_u{}, own_v{};  ///< The point that says which surface is the pixel's.
};

/// The plane (inverse depth affine in pixel coordinates) of each pixel's own surface: through the
/// points whose inverse depth differs from the own point's by at most `limit` times that, those
/// near the own point first. The own point's inverse depth, and no slope, where they do not tell or
/// the plane is off the own point by `steepest` times its inverse depth. Uses the points up.
///
/// Points that do not count have no weight, and conditions are factors of 0 or 1, so that the loops
/// over the pixels become vector code.
template <std::size_t N, std::size_t kMost>
InversePlanes<N> fit_planes(PixelPoints<N, kMost>& p, float limit, float steepest) {
  using Lanes = std::array<float, N>;
  constexpr int kRounds = 3;
  constexpr float kLeastSpread = 0.05F;  // of the points, or they are on one line
  constexpr float kGoodFit = 1e-3F;      // error beside the inverse depth that ends the rounds
  constexpr float kOutlier = 4.0F;       // how much a bad fit costs in weight
  constexpr float kTiny = 1e-20F;        // least divisor
  auto &dx = p.u, &dy = p.v, &dz = p.inverse;
  std::array<Lanes, kMost> weight;
  for (std::size_t k = 0; k < p.count; ++k)
    for (std::size_t i = 0; i < N; ++i) {
      const float x = p.u[k][i] - p.own_u[i], y = p.v[k][i] - p.own_v[i];
      const float rise = p.inverse[k][i] - p.own[i];
      const int counts = int(p.inverse[k][i] > 0.0F) & int(std::abs(rise) <= limit * p.own[i]);
      weight[k][i] = one_if(counts) / (0.25F + x * x + y * y);
      dx[k][i] = x;
      dy[k][i] = y;
      dz[k][i] = rise;
    }
  Lanes rise{}, slope_u{}, slope_v{}, active;
  active.fill(1.0F);
  // Most points around a pixel lie on its own surface: giving less weight to those that fit badly
  // finds it beside a crease.
  for (int round = 0; round < kRounds; ++round) {
    Lanes sw{}, sx{}, sy{}, sxx{}, sxy{}, syy{}, sz{}, sxz{}, syz{}, error{};
    for (std::size_t k = 0; k < p.count; ++k)
      for (std::size_t i = 0; i < N; ++i) {
        const float w = weight[k][i], wx = w * dx[k][i], wy = w * dy[k][i];
        sw[i] += w, sx[i] += wx, sy[i] += wy, sz[i] += w * dz[k][i];
        sxx[i] += wx * dx[k][i], sxy[i] += wx * dy[k][i], syy[i] += wy * dy[k][i];
        sxz[i] += wx * dz[k][i], syz[i] += wy * dz[k][i];
      }
    for (std::size_t i = 0; i < N; ++i) {
      const float per = 1.0F / (sw[i] + kTiny);
      const float cxx = sxx[i] - sx[i] * sx[i] * per, cxy = sxy[i] - sx[i] * sy[i] * per;
      const float cyy = syy[i] - sy[i] * sy[i] * per, cxz = sxz[i] - sx[i] * sz[i] * per;
      const float cyz = syz[i] - sy[i] * sz[i] * per;
      const float det = cxx * cyy - cxy * cxy;
      active[i] *= one_if(det > kLeastSpread * (cxx + cyy) * (cxx + cyy));
      const float per_det = 1.0F / (std::abs(det) + kTiny);
      const float to_u = (cxz * cyy - cyz * cxy) * per_det;
      const float to_v = (cyz * cxx - cxz * cxy) * per_det;
      const float to = (sz[i] - to_u * sx[i] - to_v * sy[i]) * per;
      slope_u[i] += active[i] * (to_u - slope_u[i]);
      slope_v[i] += active[i] * (to_v - slope_v[i]);
      rise[i] += active[i] * (to - rise[i]);
    }
    const auto misfit = [&](std::size_t k, std::size_t i) {
      return dz[k][i] - rise[i] - slope_u[i] * dx[k][i] - slope_v[i] * dy[k][i];
    };
    for (std::size_t k = 0; k < p.count; ++k)
      for (std::size_t i = 0; i < N; ++i)
        error[i] = larger(error[i], std::abs(misfit(k, i)) * one_if(weight[k][i] > 0.0F));
    float any = 0.0F;
    for (std::size_t i = 0; i < N; ++i) {
      active[i] *= one_if(error[i] >= kGoodFit * p.own[i]);
      any += active[i];
    }
    if (any == 0.0F) break;
    for (std::size_t k = 0; k < p.count; ++k)
      for (std::size_t i = 0; i < N; ++i) {
        const float off = misfit(k, i) * kOutlier / larger(error[i], kTiny);
        weight[k][i] /= 1.0F + off * off;
      }
  }
  InversePlanes<N> planes;
  for (std::size_t i = 0; i < N; ++i) {
    const float change = rise[i] - slope_u[i] * p.own_u[i] - slope_v[i] * p.own_v[i];
    const float sane =
        one_if(int(std::abs(change) < steepest * p.own[i]) & int(p.own[i] + change > 0.0F));
    planes.inverse[i] = p.own[i] + sane * change;
    planes.slope_u[i] = sane * slope_u[i];
    planes.slope_v[i] = sane * slope_v[i];
  }
  return planes;
}
}  // namespace surfleet::detail
