// SPDX-License-Identifier: MIT
/// @file
/// @brief What a body of any shape takes up when it turns about the vertical.
///
///     const SweptBody disc = SweptBody::of(EllipsoidBody{{0.6, 0.6, 0.2}});
///     FreeSpace free(states, {.radius = disc.radius(), .shape = disc});
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/motion/collision_body.hpp>

namespace surfleet {
/// The solid of revolution that holds a body, whatever its heading: a robot that turns as it likes
/// fits where this fits. Rings about the vertical through the configuration's position, each from
/// its lowest point to its highest.
///
/// Never smaller than the body. It is larger by about a fiftieth of the body's radius at the most,
/// and what is hollow between top and bottom counts as full.
class SweptBody {
 public:
  static constexpr int kRings = 128;
  /// Points at distances [i, i + 1] · `ring_width()` from the axis; none where `low` > `high` [m].
  struct Ring {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    bool empty() const { return low > high; }
  };

  /// Asks the body about balls alone. O(kRings²) of its checks. Throws `Error` for a body without
  /// size.
  template <CollisionBody Body>
  static SweptBody of(const Body& body) {
    SweptBody swept;
    const double bound = body.bounding_radius();
    require(bound > 0.0 && std::isfinite(bound) && body.inscribed_radius() >= 0.0,
            "body: expected a positive bounding radius, has " + std::to_string(bound) + " m");
    swept.inscribed_radius_ = body.inscribed_radius();
    swept.ring_width_ = bound / kRings;
    swept.add_cell(body, 0, 0, kRings);
    swept.add_cell(body, 0, -kRings, kRings);
    for (int i = 0; i < kRings; ++i)
      if (const Ring& ring = swept.rings_[static_cast<std::size_t>(i)]; !ring.empty())
        swept.radius_ = std::max(
            swept.radius_, std::hypot((i + 1) * swept.ring_width_, std::max(-ring.low, ring.high)));
    require(swept.radius_ > 0.0,
            "body: expected one that touches something within its bounding radius");
    swept.radius_ = std::min(swept.radius_, bound);
    return swept;
  }

  double radius() const { return radius_; }                      ///< Of the ball around it [m].
  double inscribed_radius() const { return inscribed_radius_; }  ///< Of the ball in it [m].
  double ring_width() const { return ring_width_; }              ///< [m]
  const std::array<Ring, kRings>& rings() const { return rings_; }
  /// The farthest that it reaches below the position [m].
  double depth() const {
    double low = 0.0;
    for (const Ring& r : rings_) low = std::min(low, r.low);
    return -low;
  }

  /// Distance from a point, `r` from the axis and `z` above the position, to it [m], 0 inside;
  /// `most` if that is less. O(rings within `most`).
  double distance(double r, double z, double most) const {
    const double w = ring_width();
    const int own = std::clamp(static_cast<int>(std::abs(r) / w), 0, kRings - 1);
    double best = most * most;
    for (int k = 0; k < kRings; ++k) {
      bool near = false;
      for (const int i : {own - k, own + k}) {
        if (i < 0 || i >= kRings) continue;
        const double dr = std::max({i * w - std::abs(r), std::abs(r) - (i + 1) * w, 0.0});
        if (dr * dr >= best) continue;
        near = true;
        const Ring& ring = rings_[static_cast<std::size_t>(i)];
        if (ring.empty()) continue;
        const double dz = std::max({ring.low - z, z - ring.high, 0.0});
        best = std::min(best, dr * dr + dz * dz);
      }
      if (!near) break;
    }
    return std::sqrt(best);
  }
  /// The lowest and the highest of all rings that reach into [from, to] from the axis [m].
  Ring between(double from, double to) const {
    const double w = ring_width();
    Ring all;
    for (int i = std::max(0, static_cast<int>(from / w) - 1);
         i < kRings && i * w <= to + 1e-9 * radius_; ++i) {
      const Ring& ring = rings_[static_cast<std::size_t>(i)];
      all.low = std::min(all.low, ring.low);
      all.high = std::max(all.high, ring.high);
    }
    return all;
  }

 private:
  SweptBody() = default;
  /// Examines the square of `n` rings from the `i`-th and as many heights from the `k`-th, `n` a
  /// power of two: at whole squares first, then at their quarters, the farther from the middle
  /// first.
  template <typename Body>
  void add_cell(const Body& body, int i, int k, int n) {
    const double w = ring_width();
    const double bottom = k * w, top = (k + n) * w;
    bool full = true;
    for (int j = i; j < i + n; ++j) {
      const Ring& ring = rings_[static_cast<std::size_t>(j)];
      full = full && ring.low <= bottom && ring.high >= top;
    }
    if (full || !is_met(body, i * w, bottom, n * w)) return;
    if (n == 1) {
      Ring& ring = rings_[static_cast<std::size_t>(i)];
      ring.low = std::min(ring.low, bottom);
      ring.high = std::max(ring.high, top);
      return;
    }
    const int half = n / 2;
    for (const int up : k >= 0 ? std::array{half, 0} : std::array{0, half})
      for (const int out : {0, half}) add_cell(body, i + out, k + up, half);
  }
  /// Whether the body, turned somehow, may meet the square of this edge in the half-plane.
  template <typename Body>
  bool is_met(const Body& body, double inner, double bottom, double edge) const {
    const double outer = inner + edge;
    const Sphere ball{Point3(inner + 0.5 * edge, 0.0, bottom + 0.5 * edge), 0.0};
    // Between two headings a point moves by half a step at the most.
    const int steps = std::max(8, static_cast<int>(std::ceil(4.0 * kPi * outer / edge)));
    const double step = 2.0 * kPi / steps;
    const double reach = (std::sqrt(0.5) * edge + 0.5 * step * outer) * (1.0 + 1e-9);
    if (ball.center.norm() > kRings * ring_width_ + reach) return false;
    for (int s = 0; s < steps; ++s)
      if (body.touches({Point3::Zero(), s * step}, {ball.center, reach})) return true;
    return false;
  }

  double radius_ = 0.0, inscribed_radius_ = 0.0, ring_width_ = 0.0;
  std::array<Ring, kRings> rings_{};
};
}  // namespace surfleet
