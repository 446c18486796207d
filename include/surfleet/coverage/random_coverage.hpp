// SPDX-License-Identifier: MIT
/// @file
/// @brief The baseline of [004 §4.4.1]: robots that go straight and turn at random.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/coverage/hybrid_coverage.hpp>
#include <surfleet/geometry/polygon_visibility.hpp>

namespace surfleet {
struct RandomCoverageOptions {
  double clearance = 0.1;   ///< Robots turn when another comes nearer than this [m].
  double share = 0.95;      ///< Stop once this share is covered.
  double max_time = 40000;  ///< [s]
  double dt = 0.5;          ///< [s]
};

/// Each robot keeps its direction until it meets the boundary or another robot comes too close, and
/// then takes a new one, uniformly.
inline std::vector<TimedPath> random_coverage(const Polygon& domain, std::span<const Point2> start,
                                              Random random, const HybridOptions& options = {},
                                              RandomCoverageOptions settings = {}) {
  require_valid(options);
  std::vector<TimedPath> paths;
  struct State {
    Point2 at, direction;
    double free;              // to the wall [m]
    std::vector<bool> close;  // others that are too close already
  };
  std::vector<State> robots;
  const auto turn_away = [&](State& r) {
    do {
      const double a = random.uniform(0.0, 2.0 * kPi);
      r.direction = Point2(std::cos(a), std::sin(a));
      r.free = free_distance(domain, r.at, r.direction);
    } while (r.free <= options.speed * 1e-3);
  };
  for (const Point2& p : start) {
    paths.emplace_back(p);
    robots.push_back({p, Point2::UnitX(), 0.0, std::vector<bool>(start.size(), true)});
    turn_away(robots.back());
  }
  CoverageGrid grid(domain, options.cell);
  for (double t = settings.dt; t <= settings.max_time && grid.fraction() < settings.share;
       t += settings.dt) {
    for (std::size_t i = 0; i < robots.size(); ++i) {
      State& r = robots[i];
      double budget = options.speed * settings.dt;
      while (budget > 0.0) {
        const double step = std::min(budget, r.free);
        const Point2 from = r.at;
        r.at += step * r.direction;
        if (!contains(domain, r.at)) r.at = project_into(domain, r.at);
        grid.cover(from, r.at, options.footprint);
        r.free -= step;
        budget -= step;
        if (r.free <= 1e-12) {
          paths[i].arrive(r.at, t - budget / options.speed);
          turn_away(r);
        }
      }
    }
    for (std::size_t i = 0; i < robots.size(); ++i) {
      bool meets = false;
      for (std::size_t j = 0; j < robots.size(); ++j) {
        if (j == i) continue;
        const bool close = (robots[i].at - robots[j].at).norm() < settings.clearance;
        meets = meets || (close && !robots[i].close[j]);
        robots[i].close[j] = close;
      }
      if (meets) {
        paths[i].arrive(robots[i].at, t);
        turn_away(robots[i]);
      }
    }
    if (grid.fraction() >= settings.share || t + settings.dt > settings.max_time)
      for (std::size_t i = 0; i < robots.size(); ++i) paths[i].arrive(robots[i].at, t);
  }
  return paths;
}
}  // namespace surfleet
