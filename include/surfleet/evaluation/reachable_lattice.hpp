// SPDX-License-Identifier: MIT
/// @file
/// @brief The positions of a lattice that a ball reaches from a start without touching anything.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/keep_out.hpp>

namespace surfleet {
/// Where a body may be.
struct FlightSpace {
  Box3 bounds;                          ///< Of the body's centre; world frame [m].
  Point3 start = Point3::Zero();        ///< A free position.
  double radius = 1.0;                  ///< Of the body [m].
  double margin = 0.0;                  ///< Kept on top of the radius [m].
  double spacing = 0.5;                 ///< Of the lattice [m].
  std::size_t max_nodes = 200'000'000;  ///< A lattice larger than this is refused.
  KeepOut keep_out{};                   ///< Closed to the body, and to nothing else.
};

/// The free positions of a lattice that can be reached from a start.
///
/// Only what the flood reaches is examined. O(reached nodes × log triangles).
class ReachableLattice {
 public:
  /// Throws `Error` on an empty box, lengths that are not positive, a lattice that is too large,
  /// or a start that is not free.
  ReachableLattice(const Bvh& obstacles, const FlightSpace& space)
      : spacing_(space.spacing), keep_out_(space.keep_out) {
    require(!space.bounds.isEmpty() && space.bounds.sizes().allFinite(),
            "flight space: expected a box with each minimum at most its maximum");
    require(space.spacing > 0.0 && space.radius > 0.0 && space.margin >= 0.0,
            "flight space: expected a positive spacing and radius and a margin of 0 or more");
    const Eigen::Array3d cells = (space.bounds.sizes().array() / spacing_ + 1e-9).floor() + 1.0;
    if (!(cells.prod() <= static_cast<double>(space.max_nodes)))
      throw Error("flight space: a lattice of " + std::to_string(cells.prod()) +
                  " positions; expected a larger spacing or a smaller box");
    size_ = cells.cast<std::int32_t>().matrix();
    // Centred in the box, so that both faces are treated alike.
    origin_ = space.bounds.min() + 0.5 * (space.bounds.sizes() - spacing_ * (cells - 1.0).matrix());
    reached_.assign(static_cast<std::size_t>(cells.prod()), 0);
    flood(obstacles, space);
  }

  double spacing() const { return spacing_; }
  const Eigen::Vector3i& size() const { return size_; }
  std::size_t count() const { return count_; }
  bool contains(const Eigen::Vector3i& n) const {
    return (n.array() >= 0).all() && (n.array() < size_.array()).all();
  }
  bool reached(const Eigen::Vector3i& n) const { return contains(n) && reached_[index(n)] != 0; }
  Point3 position(const Eigen::Vector3i& n) const { return origin_ + spacing_ * n.cast<double>(); }
  /// The node nearest to `p`, which may lie outside the lattice.
  Eigen::Vector3i nearest_node(const Point3& p) const {
    return ((p - origin_) / spacing_).array().round().cwiseMax(-1e9).cwiseMin(1e9).cast<int>();
  }
  std::vector<Point3> positions() const {
    std::vector<Point3> list;
    list.reserve(count_);
    for (std::int32_t z = 0; z < size_.z(); ++z)
      for (std::int32_t y = 0; y < size_.y(); ++y)
        for (std::int32_t x = 0; x < size_.x(); ++x)
          if (reached_[index({x, y, z})] != 0) list.push_back(position({x, y, z}));
    return list;
  }

 private:
  std::size_t index(const Eigen::Vector3i& n) const {
    return (static_cast<std::size_t>(n.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(n.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(n.x());
  }

  /// Whether a ball of `radius` can go straight from `a`, with `clear` metres to the nearest
  /// triangle, to `b`: steps as long as the clearance allows, and never shorter than 1 % of the
  /// spacing.
  bool passable(const Bvh& obstacles, const Point3& a, double clear, const Point3& b,
                double radius) const {
    const double length = (b - a).norm();
    double at = 0.0;
    while (clear >= radius) {
      at += std::max(clear - radius, 0.01 * spacing_);
      if (at >= length) return true;
      clear = clearance(obstacles, a + at / length * (b - a), radius + spacing_);
    }
    return false;
  }
  /// Distance to the nearest triangle or closed box, or `enough` if it is no nearer.
  double clearance(const Bvh& obstacles, const Point3& p, double enough) const {
    const auto nearest = obstacles.closest_point(p, enough);
    return std::min(nearest ? nearest->distance : enough, keep_out_.distance(p));
  }

  void flood(const Bvh& obstacles, const FlightSpace& space) {
    const double radius = space.radius + space.margin;
    const double enough = radius + 2.0 * spacing_;
    const double at_start = clearance(obstacles, space.start, enough);
    if (at_start < space.radius)
      throw Error("start: " + std::to_string(at_start) + " m from the surface; expected " +
                  std::to_string(space.radius) + " m or more");
    // A start nearer than radius + margin may still leave; the margin is demanded of the nodes.
    const double start_radius = std::min(radius, at_start);
    std::vector<float> clear(reached_.size(), -1.0F);  // −1: not examined yet
    std::vector<Eigen::Vector3i> frontier;
    const auto free = [&](const Eigen::Vector3i& n) {
      float& c = clear[index(n)];
      if (c < 0.0F) c = static_cast<float>(clearance(obstacles, position(n), enough));
      return c >= static_cast<float>(radius);
    };
    const auto reach = [&](const Eigen::Vector3i& n) {
      reached_[index(n)] = 1;
      ++count_;
      frontier.push_back(n);
    };
    const Eigen::Vector3i seed = nearest_node(space.start);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const Eigen::Vector3i n = seed + Eigen::Vector3i(dx, dy, dz);
          if (contains(n) && free(n) &&
              passable(obstacles, space.start, at_start, position(n), start_radius))
            reach(n);
        }
    while (!frontier.empty()) {
      const Eigen::Vector3i at = frontier.back();
      frontier.pop_back();
      const double here = clear[index(at)];
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const Eigen::Vector3i n = at + Eigen::Vector3i(dx, dy, dz);
            if (!contains(n) || reached_[index(n)] != 0) continue;
            const double step =
                spacing_ * std::sqrt(static_cast<double>(dx * dx + dy * dy + dz * dz));
            if (!free(n)) continue;
            // Two balls of clearance that overlap enough cover the step between their centres.
            const double there = clear[index(n)];
            if (here + there >= 2.0 * radius + step ||
                passable(obstacles, position(at), here, position(n), radius))
              reach(n);
          }
    }
  }

  double spacing_;
  KeepOut keep_out_;
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  Point3 origin_ = Point3::Zero();
  std::vector<std::uint8_t> reached_;
  std::size_t count_ = 0;
};
}  // namespace surfleet
