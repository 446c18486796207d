// SPDX-License-Identifier: MIT
/// @file
/// @brief A body as a union of equal balls whose centres are a whole number of voxels apart.
///
/// Grown by the centres' offsets, obstacle voxels are to one ball what they are to the body, so a
/// distance transform serves bodies of any shape.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/mapping/grown_voxels.hpp>
#include <surfleet/motion/swept_body.hpp>

namespace surfleet {
struct BallCover {
  double radius = 0.0;  ///< Of every ball [m].
  VoxelKernel centers;  ///< Relative to the body's position [voxels].
  double excess = 0.0;  ///< About how far they reach beyond the body [m].
};

namespace detail {
/// How far a ball, centred `r` from the axis and `z` above the position, reaches beyond the body;
/// `most` if that is less [m].
inline double overhang(const SweptBody& body, double r, double z, double radius, double most) {
  constexpr int kDirections = 32;
  double beyond = 0.0;
  for (int d = 0; d < kDirections && beyond < most; ++d) {
    const double angle = 2.0 * kPi * d / kDirections;
    beyond = std::max(
        beyond, body.distance(r + radius * std::cos(angle), z + radius * std::sin(angle), most));
  }
  return beyond;
}

/// Chooses the balls of one radius that reach the least beyond the body and still hold it. By
/// symmetry it is enough to consider 0 ≤ y ≤ x.
class BallCoverSearch {
 public:
  BallCoverSearch(const SweptBody& body, double voxel, double radius)
      : body_(&body),
        h_(voxel),
        radius_(radius),
        side_(static_cast<int>(body.radius() / voxel) + 1) {
    for (int i = 0; i <= side_; ++i)
      for (int j = 0; j <= i; ++j)
        for (int k = -side_; k <= side_; ++k)
          if (const double beyond =
                  overhang(body, h_ * std::hypot(i, j), h_ * k, radius, kMost * h_);
              beyond < kMost * h_)
            centers_.push_back({{i, j, k}, beyond});
    std::stable_sort(centers_.begin(), centers_.end(),
                     [](const Center& a, const Center& b) { return a.beyond < b.beyond; });
  }

  /// The least by which balls that hold the body reach beyond it; infinite if that is more than
  /// `kMost` voxels, or `enough` or more [m].
  double best(double enough) {
    std::size_t lo = 0, hi = 0;  // too few, enough
    while (hi < centers_.size() && centers_[hi].beyond < enough) ++hi;
    if (!holds(hi)) return std::numeric_limits<double>::infinity();
    while (hi - lo > 1) {
      const std::size_t middle = (lo + hi) / 2;
      (holds(middle) ? hi : lo) = middle;
    }
    centers_.resize(hi);
    return centers_.back().beyond;
  }
  /// The centres that `best` has found, with those between them along x.
  VoxelKernel kernel() {
    keep(centers_.size());
    VoxelKernel kernel;  // with the position itself
    for (int z = -side_; z <= side_; ++z)
      for (int y = -side_; y <= side_; ++y)
        for (int x = side_; x >= 0; --x)
          if (const Column& c = column(x, y); z >= c.low && z <= c.high) {
            kernel.rows.push_back({y, z, x});
            break;
          }
    return kernel;
  }

 private:
  static constexpr double kMost = 4.0;    // that a ball may reach beyond the body [voxels]
  static constexpr double kFinest = 0.1;  // of the squares that are examined [voxels]
  struct Center {
    std::array<int, 3> at;
    double beyond;
  };
  struct Column {
    int low = 1, high = 0;
  };
  Column& column(int i, int j) {
    const int a = std::max(std::abs(i), std::abs(j)), b = std::min(std::abs(i), std::abs(j));
    return columns_[static_cast<std::size_t>(a * (side_ + 1) + b)];
  }
  void keep(std::size_t count) {
    columns_.assign(static_cast<std::size_t>((side_ + 1) * (side_ + 1)), Column{});
    for (std::size_t n = 0; n < count; ++n) {
      const auto& [i, j, k] = centers_[n].at;
      Column& c = column(i, j);
      c = c.low > c.high ? Column{k, k} : Column{std::min(c.low, k), std::max(c.high, k)};
    }
  }
  /// Whether the first `count` balls, and those between them in a column, hold the body.
  bool holds(std::size_t count) {
    keep(count);
    const double edge = 0.5 * h_;
    for (double x = 0.0; x < body_->radius(); x += edge)
      for (double y = 0.0; y <= x; y += edge)
        if (!holds_prism(x, y, edge)) return false;
    return true;
  }
  /// Whether they hold what of the body stands above and below a square; if that cannot be said at
  /// once, its quarters are examined.
  bool holds_prism(double x, double y, double edge) {
    const SweptBody::Ring need = body_->between(std::hypot(x, y), std::hypot(x + edge, y + edge));
    if (need.empty() || spans(x, y, edge, need)) return true;
    if (edge < kFinest * h_) return false;
    const double half = 0.5 * edge;
    return holds_prism(x, y, half) && holds_prism(x + half, y, half) &&
           holds_prism(x, y + half, half) && holds_prism(x + half, y + half, half);
  }
  /// Whether every height of `need` lies in a ball that holds the whole square there.
  bool spans(double x, double y, double edge, const SweptBody::Ring& need) {
    heights_.clear();
    const auto first = [&](double v) {
      return static_cast<int>(std::ceil((v + edge - radius_) / h_));
    };
    const auto last = [&](double v) { return static_cast<int>(std::floor((v + radius_) / h_)); };
    for (int i = std::max(first(x), -side_); i <= std::min(last(x), side_); ++i)
      for (int j = std::max(first(y), -side_); j <= std::min(last(y), side_); ++j) {
        const Column c = column(i, j);
        if (c.low > c.high) continue;
        const double dx = std::max(std::abs(x - i * h_), std::abs(x + edge - i * h_)),
                     dy = std::max(std::abs(y - j * h_), std::abs(y + edge - j * h_)),
                     rest = radius_ * radius_ - dx * dx - dy * dy;
        if (rest < 0.0) continue;
        const double half = std::sqrt(rest);
        // Balls one above the other may meet over the whole square.
        const int step = 2.0 * half >= h_ ? c.high - c.low + 1 : 1;
        for (int k = c.low; k <= c.high; k += step)
          heights_.emplace_back(k * h_ - half, (k + step - 1) * h_ + half);
      }
    std::sort(heights_.begin(), heights_.end());
    double reached = need.low;
    for (const auto& [low, high] : heights_) {
      if (low > reached) return false;
      if ((reached = std::max(reached, high)) >= need.high) return true;
    }
    return false;
  }

  const SweptBody* body_;
  double h_, radius_;
  int side_ = 0;  // of the octant [voxels]
  std::vector<Center> centers_;
  std::vector<Column> columns_;
  std::vector<std::pair<double, double>> heights_;
};
}  // namespace detail

/// Balls of at least the radius `least` that hold the body, for voxels of edge `voxel` [m]: those
/// for which the excess and `cost(radius)`, what balls of that size take up besides, are least in
/// sum. One ball where nothing is less. Some 30 ms for a body of ten voxels.
template <typename Cost>
BallCover cover_with_balls(const SweptBody& body, double voxel, double least, Cost&& cost) {
  constexpr int kSizes = 24;
  const double most = body.radius();
  least = std::max(least, std::sqrt(0.5) * voxel);
  BallCover best{most, {}, detail::overhang(body, 0.0, 0.0, most, most)};
  double price = best.excess + cost(most);
  for (int n = 0; n < kSizes && least < most; ++n) {
    const double radius = least + (most - least) * n * n / (kSizes * kSizes), own = cost(radius);
    if (own >= price) continue;
    detail::BallCoverSearch search(body, voxel, radius);
    const double excess = search.best(price - own);
    if (excess + own >= price) continue;
    price = excess + own;
    best = {radius, search.kernel(), excess};
  }
  return best;
}
}  // namespace surfleet
