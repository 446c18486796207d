// SPDX-License-Identifier: MIT
/// @file
/// @brief The grid on which covered ground is counted.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/point_location.hpp>
#include <surfleet/geometry/polygon.hpp>

namespace surfleet {
/// Square cells over a domain; a cell belongs to the domain if its centre does, and is covered once
/// a footprint has reached its centre.
class CoverageGrid {
 public:
  /// `cell` is the side of a cell [m].
  CoverageGrid(const Polygon& domain, double cell) : cell_(cell) {
    require(cell > 0.0, "coverage grid: the cell size must be positive");
    const Box2 box = domain.bounds();
    require(box.sizes().x() / cell * (box.sizes().y() / cell) < 1e8,
            "coverage grid: more than 1e8 cells; choose larger ones");
    origin_ = box.min();
    columns_ = static_cast<std::int32_t>(std::ceil(box.sizes().x() / cell - 1e-9));
    rows_ = static_cast<std::int32_t>(std::ceil(box.sizes().y() / cell - 1e-9));
    state_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kOutside);
    visits_.assign(state_.size(), 0);
    const PointLocator locator(domain);
    for (std::size_t i = 0; i < state_.size(); ++i)
      if (locator.contains(centre(i))) {
        state_[i] = kOpen;
        ++size_;
      }
  }
  std::int32_t columns() const { return columns_; }
  std::int32_t rows() const { return rows_; }
  std::size_t cells() const { return state_.size(); }  ///< Outside ones included.
  std::size_t size() const { return size_; }           ///< Of the domain.
  std::size_t covered_count() const { return covered_; }
  double cell_size() const { return cell_; }
  double fraction() const {
    return size_ == 0 ? 1.0 : static_cast<double>(covered_) / static_cast<double>(size_);
  }
  bool inside(std::size_t i) const { return state_[i] != kOutside; }
  bool covered(std::size_t i) const { return state_[i] == kCovered; }
  /// How often footprints have come upon the cell anew.
  std::uint32_t visits(std::size_t i) const { return visits_[i]; }
  Point2 centre(std::size_t i) const {
    const auto c = static_cast<std::size_t>(columns_);
    return origin_ +
           cell_ * Point2(static_cast<double>(i % c) + 0.5, static_cast<double>(i / c) + 0.5);
  }
  /// The cell that holds `p`, clamped to the grid.
  std::size_t index(const Point2& p) const {
    return static_cast<std::size_t>(clamp_row(p.y()) * columns_ + clamp_column(p.x()));
  }
  /// Marks one cell of the domain; true if that is new.
  bool cover(std::size_t i) {
    if (state_[i] == kOutside) return false;
    ++visits_[i];
    if (state_[i] == kCovered) return false;
    state_[i] = kCovered;
    ++covered_;
    return true;
  }
  /// Covers the cells whose centres lie within `radius` [m] of the segment ab; calls `first(i)` for
  /// those covered for the first time.
  template <typename First>
  void cover(const Point2& a, const Point2& b, double radius, First&& first) {
    for_each_near(a, b, radius, [&](std::size_t i) {
      if (cover(i)) first(i);
    });
  }
  void cover(const Point2& a, const Point2& b, double radius) {
    cover(a, b, radius, [](std::size_t) {});
  }
  /// Calls `f(i)` for every cell of the grid whose centre lies within `radius` [m] of segment ab.
  template <typename F>
  void for_each_near(const Point2& a, const Point2& b, double radius, F&& f) const {
    const std::int32_t x0 = clamp_column(std::min(a.x(), b.x()) - radius),
                       x1 = clamp_column(std::max(a.x(), b.x()) + radius),
                       y0 = clamp_row(std::min(a.y(), b.y()) - radius),
                       y1 = clamp_row(std::max(a.y(), b.y()) + radius);
    for (std::int32_t y = y0; y <= y1; ++y)
      for (std::int32_t x = x0; x <= x1; ++x) {
        const auto i = static_cast<std::size_t>(y * columns_ + x);
        const Point2 c = centre(i);
        if ((closest_on_segment(a, b, c) - c).squaredNorm() <= radius * radius) f(i);
      }
  }

 private:
  enum : std::uint8_t { kOutside, kOpen, kCovered };
  std::int32_t clamp_column(double x) const {
    return static_cast<std::int32_t>(
        std::clamp(std::floor((x - origin_.x()) / cell_), 0.0, static_cast<double>(columns_ - 1)));
  }
  std::int32_t clamp_row(double y) const {
    return static_cast<std::int32_t>(
        std::clamp(std::floor((y - origin_.y()) / cell_), 0.0, static_cast<double>(rows_ - 1)));
  }
  Point2 origin_ = Point2::Zero();
  double cell_;
  std::int32_t columns_ = 0, rows_ = 0;
  std::size_t size_ = 0, covered_ = 0;
  std::vector<std::uint8_t> state_;
  std::vector<std::uint32_t> visits_;
};
}  // namespace surfleet
