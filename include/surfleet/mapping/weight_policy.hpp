// SPDX-License-Identifier: MIT
/// @file
/// @brief Weighting rules for TSDF fusion: how much one observation of a voxel counts.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <utility>

namespace surfleet {
/// What TSDF fusion asks of a weighting rule.
///
/// `w(sdf, range)` is the weight, ≥ 0 and finite, of one observation of a voxel at signed distance
/// `sdf` [m] from the surface (positive in front), whose centre is `range` [m] from the sensor.
/// Pure: same input, same weight.
template <typename W>
concept WeightPolicy = std::copyable<W> && requires(const W& w, double sdf, double range) {
  { w(sdf, range) } -> std::convertible_to<double>;
};

/// A weighting rule with a fast variant: the same weight from the squared range, in single
/// precision. Integrators take it where it is offered.
template <typename W>
concept SquaredRangeWeightPolicy = WeightPolicy<W> &&
    requires(const W& w, float sdf, float squared_range) {
  { w.from_squared_range(sdf, squared_range) } -> std::same_as<float>;
};

/// Every observation counts the same.
struct ConstantWeight {
  double value = 1.0;
  double operator()(double /*sdf*/, double /*range*/) const noexcept { return value; }
  float from_squared_range(float /*sdf*/, float /*squared_range*/) const noexcept {
    return static_cast<float>(value);
  }
};

/// An observation from range z counts 1 / z² [000 §2.4.1], as the error of stereo depth grows.
struct InverseSquareWeight {
  double exponent = 2.0;  ///< The power of the range.
  double nearest = 0.1;   ///< Range below which the weight grows no further [m]; positive.

  double operator()(double /*sdf*/, double range) const noexcept {
    return std::pow(std::max(range, nearest), -exponent);
  }
  float from_squared_range(float /*sdf*/, float squared_range) const noexcept {
    const auto near = static_cast<float>(nearest);
    const float r2 = std::max(squared_range, near * near);
    return exponent == 2.0 ? 1.0F / r2 : std::pow(r2, static_cast<float>(-0.5 * exponent));
  }
};

/// Another rule's weight, falling linearly to nothing behind the surface, where what is seen says
/// less and less: spares the far side of thin walls.
template <WeightPolicy Inner = InverseSquareWeight>
struct DropOffWeight {
  double full = 0.05;  ///< Depth behind the surface up to which the weight is whole [m].
  double zero = 0.20;  ///< Depth at which it reaches 0 [m]; greater than `full`.
  [[no_unique_address]] Inner inner{};

  double operator()(double sdf, double range) const noexcept {
    return inner(sdf, range) * std::clamp((zero + sdf) / (zero - full), 0.0, 1.0);
  }
  float from_squared_range(float sdf, float squared_range) const noexcept requires
      SquaredRangeWeightPolicy<Inner> {
    const float share = (static_cast<float>(zero) + sdf) / static_cast<float>(zero - full);
    return inner.from_squared_range(sdf, squared_range) * std::clamp(share, 0.0F, 1.0F);
  }
};

/// A rule's weight, whole up to a voxel behind the surface and nothing from one and a half on: what
/// is seen of a wall says nothing of its other side.
template <WeightPolicy Inner = InverseSquareWeight>
DropOffWeight<Inner> drop_off_by_voxels(double voxel_size, Inner inner = {}) {
  return {.full = voxel_size, .zero = 1.5 * voxel_size, .inner = std::move(inner)};
}

static_assert(SquaredRangeWeightPolicy<ConstantWeight>);
static_assert(SquaredRangeWeightPolicy<InverseSquareWeight>);
static_assert(WeightPolicy<DropOffWeight<>>);

namespace detail {
template <WeightPolicy W>
inline float observation_weight(const W& weight, float sdf, float squared_range) {
  if constexpr (SquaredRangeWeightPolicy<W>)
    return weight.from_squared_range(sdf, squared_range);
  else
    return static_cast<float>(
        weight(static_cast<double>(sdf), std::sqrt(static_cast<double>(squared_range))));
}
}  // namespace detail
}  // namespace surfleet
