// SPDX-License-Identifier: MIT
/// @file
/// @brief An upper bound of a view's gain, from sums over boxes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

namespace surfleet {
/// No view from a node of a flight lattice has more gain than all targets in the box around it. The
/// boxes are aligned with the lattice, so a table of sums gives each in O(1): rays need be cast for
/// one view in some hundred only.
class GainBound {
 public:
  /// Views reach as far as `reach` [m]. O(targets + nodes).
  template <typename Free>
  GainBound(std::span<const SightTarget> targets, const FlightLattice<Free>& lattice,
            const HeadingTable& headings, double reach)
      : cell_(lattice.spacing()), boxes_(static_cast<std::size_t>(headings.views())) {
    any_ = {VoxelIndex::Zero(), VoxelIndex::Zero()};
    for (int k = 0; k < headings.views(); ++k) {
      // A target at distance d in [nearest, reach] is d times its direction away.
      const Box3& directions = headings.directions(k);
      Cells& box = boxes_[static_cast<std::size_t>(k)];
      for (int i = 0; i < 3; ++i) {
        const double least = directions.min()[i], most = directions.max()[i];
        const double from = least < 0.0 ? least * reach : least * headings.nearest();
        const double to = most > 0.0 ? most * reach : most * headings.nearest();
        box.low[i] = cell_at(from - kSlack * reach);
        box.high[i] = cell_at(to + kSlack * reach) + 1;
      }
      any_ = {any_.low.cwiseMin(box.low), any_.high.cwiseMax(box.high)};
    }
    const VoxelIndex last = lattice.count() - VoxelIndex::Ones();
    size_ = last + any_.high - any_.low + VoxelIndex::Ones();  // one more than cells
    shift_ = -any_.low;
    sums_.assign(static_cast<std::size_t>(size_.cast<double>().prod()), 0.0);
    const Point3 origin = lattice.position(VoxelIndex::Zero());
    for (const SightTarget& t : targets) {
      const Eigen::Vector3d d = t.position - origin;
      const VoxelIndex c =
          VoxelIndex(cell_at(d.x()), cell_at(d.y()), cell_at(d.z())) + shift_ + VoxelIndex::Ones();
      if ((c.array() < 1).any() || (c.array() >= size_.array()).any()) continue;
      sums_[at(c)] += t.gain;
    }
    for (int z = 1; z < size_.z(); ++z)
      for (int y = 1; y < size_.y(); ++y) {
        double* row = &sums_[at({0, y, z})];
        const double* before = &sums_[at({0, y - 1, z})];
        const double* below = &sums_[at({0, y, z - 1})];
        const double* both = &sums_[at({0, y - 1, z - 1})];
        double run = 0.0;
        for (int x = 1; x < size_.x(); ++x) {
          run += row[x];
          row[x] = run + before[x] + below[x] - both[x];
        }
      }
    slack_ = kRounding * sums_.back();
  }

  /// For every view at once. O(views).
  GainByView operator()(const VoxelIndex& node) const {
    GainByView most(static_cast<int>(boxes_.size()));
    for (std::size_t k = 0; k < boxes_.size(); ++k) most[k] = sum(node, boxes_[k]);
    return most;
  }
  /// Whatever the view is; looser. O(1).
  double in_any_view(const VoxelIndex& node) const { return sum(node, any_); }

 private:
  /// In cells from a node's.
  struct Cells {
    VoxelIndex low, high;  // to before `high`
  };
  static constexpr double kSlack = 0.01;     // that boxes are wider than views, of the reach
  static constexpr double kRounding = 1e-9;  // of all gain

  int cell_at(double offset) const { return static_cast<int>(std::floor(offset / cell_)); }
  std::size_t at(const VoxelIndex& c) const {
    return (static_cast<std::size_t>(c.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(c.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(c.x());
  }
  double sum(const VoxelIndex& node, const Cells& box) const {
    const VoxelIndex home = node + shift_;
    const VoxelIndex a = home + box.low, b = home + box.high;
    const auto s = [&](int x, int y, int z) { return sums_[at({x, y, z})]; };
    const double upper = s(b.x(), b.y(), b.z()) - s(a.x(), b.y(), b.z()) - s(b.x(), a.y(), b.z()) +
                         s(a.x(), a.y(), b.z());
    const double lower = s(b.x(), b.y(), a.z()) - s(a.x(), b.y(), a.z()) - s(b.x(), a.y(), a.z()) +
                         s(a.x(), a.y(), a.z());
    return upper - lower + slack_;
  }

  double cell_;
  std::vector<Cells> boxes_;  // by view
  Cells any_;
  VoxelIndex shift_, size_;
  std::vector<double> sums_;  // of all cells below, x fastest
  double slack_ = 0.0;
};
}  // namespace surfleet
