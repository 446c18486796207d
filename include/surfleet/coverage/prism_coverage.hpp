// SPDX-License-Identifier: MIT
/// @file
/// @brief Voronoi coverage of a prism by flying robots: any polygon as ground plan, convex in the
/// vertical [004 Fig. 5.7].
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/centroid.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>
#include <surfleet/geometry/polygon_clipping.hpp>
#include <surfleet/geometry/prism.hpp>
#include <surfleet/motion/tangent_bug.hpp>

namespace surfleet {
/// Volume and centroid of every robot's part of a prism, and the cost with h = d².
struct PrismCells {
  std::vector<double> volume;
  std::vector<Point3> centroid;  ///< The robot itself where its part is empty.
  double cost = 0.0;
};

/// A level slice of a spatial Voronoi cell is a cell of the slice's power diagram, so integrals are
/// exact in the plane and summed by the midpoint rule over `slices` levels. O(slices · n (n + m)).
inline PrismCells prism_cells(const Prism& prism, std::span<const Point3> robots, int slices = 32) {
  require(prism.high > prism.low && slices > 0,
          "prism: its height and the slices must be positive");
  PrismCells cells{std::vector<double>(robots.size(), 0.0),
                   std::vector<Point3>(robots.size(), Point3::Zero()), 0.0};
  const double thick = (prism.high - prism.low) / slices;
  PolygonClipper clipper;
  for (int s = 0; s < slices; ++s) {
    const double z = prism.low + (s + 0.5) * thick;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      const Point2 p = robots[i].head<2>();
      const double dz = z - robots[i].z();
      clipper.load(prism.ground);
      for (std::size_t j = 0; j < robots.size() && !clipper.empty(); ++j) {
        if (j == i) continue;
        const Point2 other = robots[j].head<2>();
        const double other_dz = z - robots[j].z();
        const Point2 n = other - p;
        clipper.cut(
            {n, 0.5 * (other.squaredNorm() + other_dz * other_dz - p.squaredNorm() - dz * dz)});
      }
      RegionMoments m{p, 0.0, Point2::Zero(), 0.0};
      clipper.for_each_tagged_edge(
          [&](const Point2& a, const Point2& b, std::int32_t) { m.add_edge(a, b); });
      cells.volume[i] += thick * m.mass;
      cells.centroid[i] +=
          thick * (m.mass * Point3(p.x(), p.y(), z) + Point3(m.first.x(), m.first.y(), 0.0));
      cells.cost += thick * (m.second + m.mass * (dz * dz + thick * thick / 12.0));
    }
  }
  for (std::size_t i = 0; i < robots.size(); ++i)
    if (cells.volume[i] > 0.0)
      cells.centroid[i] /= cells.volume[i];
    else
      cells.centroid[i] = robots[i];
  return cells;
}

struct PrismOptions {
  double speed = 0.05;  ///< Horizontal and vertical [m/s].
  double dt = 0.1;      ///< [s]
  int slices = 32;
  double tolerance = 1e-3;  ///< [m]
  TangentBugOptions sensor = {};
};

/// Non-convex coverage [004 Alg. 4, 5] of a prism: virtual robots fly straight, real ones go round
/// the walls by TangentBug in the plane and climb as they go.
class PrismCoverage {
 public:
  struct Robot {
    Point3 real, virtual_position, virtual_goal;
  };
  PrismCoverage(Prism prism, std::span<const Point3> start, PrismOptions options = {})
      : prism_(std::make_shared<Prism>(std::move(prism))), options_(options) {
    require(!start.empty(), "there is no robot; at least one is needed");
    for (std::size_t i = 0; i < start.size(); ++i) {
      require(contains(prism_->ground, Point2(start[i].head<2>())) && start[i].z() >= prism_->low &&
                  start[i].z() <= prism_->high,
              "robot " + std::to_string(i) + " stands outside the prism");
      for (std::size_t j = 0; j < i; ++j)
        require(start[i] != start[j],
                "robots " + std::to_string(j) + " and " + std::to_string(i) +
                    " stand on the same place; each needs a place of its own");
      robots_.push_back({start[i], start[i], start[i]});
    }
    motions_.resize(start.size());
    settled_.assign(start.size(), false);
  }
  const std::vector<Robot>& robots() const { return robots_; }
  bool converged() const {
    return std::all_of(settled_.begin(), settled_.end(), [](bool s) { return s; });
  }
  PrismCells cells() const {
    std::vector<Point3> p;
    for (const Robot& r : robots_) p.push_back(r.real);
    return prism_cells(*prism_, p, options_.slices);
  }
  void step() {
    const auto done = [&](std::size_t i) {
      return !motions_[i] ||
             (motions_[i]->arrived() && robots_[i].real.z() == robots_[i].virtual_goal.z());
    };
    bool any = false;
    for (std::size_t i = 0; i < robots_.size(); ++i) any = any || done(i);
    if (any) {
      std::vector<Point3> places;
      for (const Robot& r : robots_) places.push_back(r.virtual_position);
      const PrismCells next = prism_cells(*prism_, places, options_.slices);
      for (std::size_t i = 0; i < robots_.size(); ++i) {
        if (!done(i)) continue;
        Robot& r = robots_[i];
        const bool same = motions_[i].has_value() &&
                          (next.centroid[i] - r.virtual_goal).norm() <= options_.tolerance;
        settled_[i] = same && (r.virtual_position - r.virtual_goal).norm() <= options_.tolerance;
        if (same) continue;
        r.virtual_goal = next.centroid[i];
        motions_[i].emplace(prism_->ground, Point2(r.real.head<2>()),
                            Point2(r.virtual_goal.head<2>()), options_.sensor);
      }
    }
    const double reach = options_.speed * options_.dt;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      Robot& r = robots_[i];
      motions_[i]->advance(reach);
      r.real.head<2>() = motions_[i]->position();
      r.real.z() += std::clamp(r.virtual_goal.z() - r.real.z(), -reach, reach);
      const Point3 offset = r.virtual_goal - r.virtual_position;
      const double length = offset.norm();
      r.virtual_position =
          length <= reach ? r.virtual_goal : Point3(r.virtual_position + reach / length * offset);
    }
  }

 private:
  std::shared_ptr<Prism> prism_;
  PrismOptions options_;
  std::vector<Robot> robots_;
  std::vector<std::optional<TangentBug>> motions_;
  std::vector<bool> settled_;
};
}  // namespace surfleet
