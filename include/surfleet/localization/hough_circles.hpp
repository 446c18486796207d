// SPDX-License-Identifier: MIT
/// @file
/// @brief Discs that overlap, told apart by the circles of their outline [004 §9.4.2].
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/localization/connected_components.hpp>

namespace surfleet {
struct Circle {
  Point2 center = Point2::Zero();  ///< [px]
  double radius = 0.0;             ///< [px]
};

/// Where the outline of a component passes between its pixels and others: midpoints of the sides of
/// pixels, whose centres are at whole coordinates. O(pixels).
inline std::vector<Point2> outline_of(const PixelComponent& c) {
  const int width = c.box.right - c.box.left + 2, height = c.box.bottom - c.box.top + 2;
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(width * height), 0);
  const auto at = [&](int u, int v) -> std::uint8_t& {
    return mask[static_cast<std::size_t>((v - c.box.top + 1) * width + u - c.box.left + 1)];
  };
  for (const PixelRun& r : c.runs)
    for (int u = r.begin; u < r.end; ++u) at(u, r.v) = 1;
  std::vector<Point2> outline;
  for (const PixelRun& r : c.runs) {
    outline.emplace_back(r.begin - 0.5, r.v);
    outline.emplace_back(r.end - 0.5, r.v);
    for (int u = r.begin; u < r.end; ++u)
      for (const int side : {-1, 1})
        if (at(u, r.v + side) == 0) outline.emplace_back(u, r.v + 0.5 * side);
  }
  return outline;
}

/// The circle with the least algebraic error (Kåsa); nothing for points on a line. O(points).
inline std::optional<Circle> fit_circle(std::span<const Point2> points) {
  if (points.size() < 3) return std::nullopt;
  Point2 mean = Point2::Zero();
  for (const Point2& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Point2& p : points) {
    const Eigen::Vector3d row(p.x() - mean.x(), p.y() - mean.y(), 1.0);
    a += row * row.transpose();
    b += row * row.head<2>().squaredNorm();
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(a);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::Vector3d x = lu.solve(b);
  const Point2 half = 0.5 * x.head<2>();
  return Circle{mean + half, std::sqrt(std::max(0.0, x.z() + half.squaredNorm()))};
}

/// The circles of an outline, those with most of it first, with radii in [least, most] px and much
/// alike.
///
/// Every point of the outline votes for the centres of circles through it (Hough), a pixel each;
/// the winner is fitted to its points, which then vote no more. One counts with `share` of its
/// circumference in the outline. O(outline · (most − least) · most) for each circle.
inline std::vector<Circle> hough_circles(std::vector<Point2> outline, double least, double most,
                                         double share = 0.2) {
  constexpr double kNear = 1.0;  // of a point on a circle [px]
  struct Cell {
    int votes = 0;
    std::size_t last = static_cast<std::size_t>(-1);  // a point votes once for a centre
  };
  std::vector<Cell> cells;
  std::vector<Circle> found;
  least = std::max(least, 1.5);
  while (outline.size() >= 6) {
    Eigen::AlignedBox2d box;
    for (const Point2& p : outline) box.extend(p);
    const int width = static_cast<int>(box.sizes().x()) + 2;
    const int height = static_cast<int>(box.sizes().y()) + 2;
    Circle best;
    double best_share = 0.0;
    for (double r = least; r <= most; r += 0.5) {
      cells.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Cell{});
      const int steps = static_cast<int>(std::ceil(2.0 * kPi * r));
      for (std::size_t i = 0; i < outline.size(); ++i)
        for (int k = 0; k < steps; ++k) {
          const double angle = 2.0 * kPi * k / steps;
          const Point2 c = outline[i] + r * Point2(std::cos(angle), std::sin(angle)) - box.min();
          const int u = static_cast<int>(std::lround(c.x())),
                    v = static_cast<int>(std::lround(c.y()));
          if (u < 0 || v < 0 || u >= width || v >= height) continue;
          const auto cell = static_cast<std::size_t>(v * width + u);
          Cell& at = cells[cell];
          if (at.last == i) continue;
          at.last = i;
          if (const double s = ++at.votes / (8.0 * r); s > best_share) {
            best_share = s;
            best = {box.min() + Point2(u, v), r};
          }
        }
    }
    if (best_share == 0.0) break;
    std::vector<Point2> own;
    for (int round = 0; round < 3; ++round) {
      own.clear();
      for (const Point2& p : outline)
        if (std::abs((p - best.center).norm() - best.radius) <= kNear) own.push_back(p);
      const auto fitted = fit_circle(own);
      if (!fitted || fitted->radius < 0.7 * least || fitted->radius > 1.3 * most) break;
      best = *fitted;
    }
    // The outline of a disc on pixels has eight sides for a unit of its radius.
    if (static_cast<double>(own.size()) < share * 8.0 * best.radius) break;
    found.push_back(best);
    if (found.size() == 1) {
      least = std::max(least, 0.8 * best.radius);
      most = std::min(most, 1.2 * best.radius);
    }
    std::erase_if(outline, [&](const Point2& p) {
      return std::abs((p - best.center).norm() - best.radius) <= kNear;
    });
  }
  return found;
}
/// The share of an outline that lies on the circles. O(outline · circles).
inline double explained(std::span<const Point2> outline, std::span<const Circle> circles) {
  constexpr double kNear = 1.0;  // [px]
  if (outline.empty()) return 0.0;
  const auto on = std::count_if(outline.begin(), outline.end(), [&](const Point2& p) {
    return std::any_of(circles.begin(), circles.end(), [&](const Circle& c) {
      return std::abs((p - c.center).norm() - c.radius) <= kNear;
    });
  });
  return static_cast<double>(on) / static_cast<double>(outline.size());
}
}  // namespace surfleet
