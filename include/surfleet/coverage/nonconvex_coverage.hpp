// SPDX-License-Identifier: MIT
/// @file
/// @brief Voronoi coverage of polygons with notches and obstacles: Lloyd's algorithm on virtual
/// robots that pass through everything, real robots that follow by path planning [004 Alg. 4, 5].
///
/// ```cpp
/// NonconvexCoverage<> cover{domain, start};        // TangentBug with an unlimited sensor
/// while (!cover.converged()) cover.step();
/// const VoronoiTessellation regions = cover.final_tessellation();
/// ```
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/lloyd.hpp>
#include <surfleet/geometry/polygon_geodesic.hpp>
#include <surfleet/motion/tangent_bug.hpp>

namespace surfleet {
/// What non-convex coverage asks of a path planner: `plan(domain, from, goal)` gives a motion that
/// can `advance(metres)`, knows its `position()` and has `arrived()` at the goal or, if that is out
/// of reach, at its projection into the domain. The goal may lie anywhere.
template <typename P>
concept CoveragePlanner = requires(P& plan, const Polygon& domain, const Point2& p) {
  { plan(domain, p, p).arrived() } -> std::convertible_to<bool>;
  { plan(domain, p, p).position() } -> std::convertible_to<Point2>;
  plan(domain, p, p).advance(0.1);
};

/// Local planning by a range sensor; explores the boundary of an obstacle that holds the goal.
struct TangentBugPlanner {
  TangentBugOptions options = {};
  TangentBug operator()(const Polygon& domain, const Point2& from, const Point2& goal) const {
    return {domain, from, goal, options};
  }
};

/// Global planning on a known map: along the shortest path to the projected goal.
class ShortestPathPlanner {
 public:
  class Motion {
   public:
    explicit Motion(std::vector<Point2> path) : path_(std::move(path)), position_(path_.at(0)) {}
    void advance(double distance) {
      while (next_ < path_.size() && distance > 0.0) {
        const Point2 offset = path_[next_] - position_;
        const double length = offset.norm();
        if (length > distance) {
          position_ += distance / length * offset;
          return;
        }
        position_ = path_[next_++];
        distance -= length;
      }
    }
    const Point2& position() const { return position_; }
    bool arrived() const { return next_ >= path_.size(); }

   private:
    std::vector<Point2> path_;
    Point2 position_;
    std::size_t next_ = 1;
  };
  Motion operator()(const Polygon& domain, const Point2& from, const Point2& goal) {
    if (!geodesics_) geodesics_ = std::make_shared<PolygonGeodesics>(domain);
    std::vector<Point2> path = geodesics_->from(from).path(project_into(domain, goal));
    if (path.empty()) path.push_back(from);
    return Motion(std::move(path));
  }

 private:
  std::shared_ptr<PolygonGeodesics> geodesics_;
};
static_assert(CoveragePlanner<TangentBugPlanner> && CoveragePlanner<ShortestPathPlanner>);

struct NonconvexOptions {
  double speed = 0.05;  ///< Of real and virtual robots [m/s].
  double dt = 0.1;      ///< [s]
  /// A goal nearer than this is reached [m]; nothing: 1e-4 of the domain.
  std::optional<double> tolerance{};
};

template <CoveragePlanner Planner = TangentBugPlanner, PlanarDensity Density = UniformDensity>
class NonconvexCoverage {
 public:
  struct Robot {
    Point2 real, virtual_position, virtual_goal;
    bool constrained = false;  ///< The virtual goal lies outside the free space.
  };

  /// Throws `Error` unless the robots stand in the domain, apart from one another.
  NonconvexCoverage(Polygon domain, std::span<const Point2> start, NonconvexOptions settings = {},
                    Planner plan = {}, Density rho = {})
      : options(settings),
        planner(std::move(plan)),
        domain_(std::make_shared<Polygon>(std::move(domain))),
        lloyd_(*domain_, {}, std::move(rho)) {
    require_placed(*domain_, start);
    require(settings.speed > 0.0 && settings.dt > 0.0,
            "non-convex coverage: speed and time step must be positive");
    for (const Point2& p : start) robots_.push_back({p, p, p, false});
    motions_.resize(start.size());
    settled_.assign(start.size(), false);
  }

  const std::vector<Robot>& robots() const { return robots_; }
  const Polygon& domain() const { return *domain_; }
  double time() const { return time_; }  ///< [s]
  /// Every robot has arrived, and its next goal is the one it has.
  bool converged() const {
    return std::all_of(settled_.begin(), settled_.end(), [](bool s) { return s; });
  }
  std::vector<Point2> real_positions() const {
    std::vector<Point2> p;
    for (const Robot& r : robots_) p.push_back(r.real);
    return p;
  }
  std::vector<Point2> virtual_positions() const {
    std::vector<Point2> p;
    for (const Robot& r : robots_) p.push_back(r.virtual_position);
    return p;
  }
  /// H of the tessellations of the real and of the virtual generators [004 Fig. 5.3].
  double real_cost() const { return lloyd_.cost(real_positions()); }
  double virtual_cost() const { return lloyd_.cost(virtual_positions()); }
  /// The last tessellation, of the positions where the robots really are [004 Alg. 4, line 8].
  VoronoiTessellation final_tessellation() const {
    return voronoi_tessellation(*domain_, real_positions());
  }

  /// One time step: robots that have arrived take the centroid of the region of their virtual
  /// generator as their next virtual goal (loop 1); all move (loop 2).
  void step() {
    if (std::any_of(motions_.begin(), motions_.end(),
                    [](const auto& m) { return !m || m->arrived(); })) {
      const std::vector<Point2> centroids = goals();
      const double tolerance =
          options.tolerance.value_or(1e-4 * domain_->bounds().diagonal().norm());
      for (std::size_t i = 0; i < robots_.size(); ++i) {
        if (motions_[i] && !motions_[i]->arrived()) continue;
        Robot& r = robots_[i];
        const bool same =
            motions_[i].has_value() && (centroids[i] - r.virtual_goal).norm() <= tolerance;
        settled_[i] = same && (r.virtual_position - r.virtual_goal).norm() <= tolerance;
        if (same) continue;
        r.virtual_goal = centroids[i];
        r.constrained = !surfleet::contains(*domain_, r.virtual_goal);
        motions_[i].emplace(planner(*domain_, r.real, r.virtual_goal));
      }
    }
    const double reach = options.speed * options.dt;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      Robot& r = robots_[i];
      motions_[i]->advance(reach);
      r.real = motions_[i]->position();
      const Point2 offset = r.virtual_goal - r.virtual_position;
      const double length = offset.norm();
      r.virtual_position =
          length <= reach ? r.virtual_goal : Point2(r.virtual_position + reach / length * offset);
    }
    time_ += options.dt;
  }

  NonconvexOptions options;
  Planner planner;

 private:
  using Motion = decltype(std::declval<Planner&>()(std::declval<const Polygon&>(),
                                                   std::declval<const Point2&>(),
                                                   std::declval<const Point2&>()));
  /// Virtual robots can meet; one that shares its place waits for the next step.
  std::vector<Point2> goals() const {
    std::vector<Point2> own = virtual_positions();
    std::vector<std::size_t> apart;
    std::vector<Point2> places;
    for (std::size_t i = 0; i < own.size(); ++i)
      if (std::find(places.begin(), places.end(), own[i]) == places.end()) {
        apart.push_back(i);
        places.push_back(own[i]);
      }
    const CoverageState state = lloyd_.evaluate(places);
    for (std::size_t k = 0; k < apart.size(); ++k) own[apart[k]] = state.centroids[k];
    return own;
  }

  std::shared_ptr<Polygon> domain_;  // motions hold on to it
  LloydCoverage<Density> lloyd_;
  std::vector<Robot> robots_;
  std::vector<std::optional<Motion>> motions_;
  std::vector<bool> settled_;
  double time_ = 0.0;
};
}  // namespace surfleet
