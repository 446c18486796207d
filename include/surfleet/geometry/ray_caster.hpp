// SPDX-License-Identifier: MIT
/// @file
/// @brief What casting rays against a scene means; models are `Bvh` and, as an adapter, Embree.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// The first triangle that a ray meets.
struct RayHit {
  double t = 0.0;             ///< The point is `origin + t * direction`.
  std::int32_t triangle = 0;  ///< Index in the mesh.
};

/// Casts one ray against a fixed set of triangles, from both sides, with 0 <= t <= t_max. The
/// direction need not have unit length; `t` counts in its lengths. Safe from many threads at once.
template <typename C>
concept RayCaster = requires(const C& caster, const Point3& origin,
                             const Eigen::Vector3d& direction, double t_max) {
  { caster.cast(origin, direction, t_max) } -> std::convertible_to<std::optional<RayHit>>;
};

/// A ray caster that is faster with many rays from one origin. `t[i]` is infinite where ray i
/// meets nothing.
template <typename C>
concept BundleRayCaster = RayCaster<C> &&
    requires(const C& caster, const Point3& origin, std::span<const Eigen::Vector3d> directions,
             double t_max, std::span<double> t) {
  caster.cast_bundle(origin, directions, t_max, t);
};

/// Whether the segment between two different points meets no triangle.
template <RayCaster Caster>
bool is_clear_segment(const Caster& caster, const Point3& a, const Point3& b) {
  return !caster.cast(a, b - a, 1.0);
}

/// The parameters of the first hits of rays from one origin; infinite where there is none.
/// `t` has one entry a direction.
template <RayCaster Caster>
void cast_bundle(const Caster& caster, const Point3& origin,
                 std::span<const Eigen::Vector3d> directions, double t_max, std::span<double> t) {
  if constexpr (BundleRayCaster<Caster>) {
    caster.cast_bundle(origin, directions, t_max, t);
  } else {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const std::optional<RayHit> hit = caster.cast(origin, directions[i], t_max);
      t[i] = hit ? hit->t : std::numeric_limits<double>::infinity();
    }
  }
}
}  // namespace surfleet
