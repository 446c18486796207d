// SPDX-License-Identifier: MIT
/// @file
/// @brief DisCoverage: exploration of an unknown domain by several robots, each viewing its share
/// of the frontier as if the explored ground were star-shaped around it [004 §5.4].
///
/// ```cpp
/// DisCoverage explore{floor_plan, start, {.range = 3.0}};
/// while (!explore.finished()) explore.step();
/// ```
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/coverage_grid.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/polygon_visibility.hpp>

namespace surfleet {
struct DisCoverageOptions {
  double range = 3.0;           ///< Of the sensor [m].
  double cell = 0.1;            ///< Of the explored map [m].
  double speed = 0.5;           ///< [m/s]
  double dt = 0.5;              ///< [s]
  double heading_spread = 0.6;  ///< How wide a heading gathers frontier around it [rad].
  double distance_scale = 4.0;  ///< Frontier this much farther than the nearest counts e⁻¹ [m].
};

/// For every cell of the domain, which of its eight neighbours its centre sees: bit (dy + 1) · 3 +
/// dx + 1. Walls thinner than a cell part neighbours. O(cells · n).
inline std::vector<std::uint16_t> cell_links(const Polygon& domain, const CoverageGrid& grid) {
  std::vector<std::uint16_t> links(grid.cells(), 0);
  const std::int32_t columns = grid.columns();
  for (std::int32_t y = 0; y < grid.rows(); ++y)
    for (std::int32_t x = 0; x < columns; ++x)
      for (int bit = 5; bit < 9;
           ++bit) {  // east and the three to the north; the others mirror them
        const std::int32_t dx = bit % 3 - 1, dy = bit / 3 - 1;
        if (x + dx < 0 || x + dx >= columns || y + dy >= grid.rows()) continue;
        const auto a = static_cast<std::size_t>(y * columns + x),
                   b = static_cast<std::size_t>((y + dy) * columns + x + dx);
        if (!grid.inside(a) || !grid.inside(b) || !sees(domain, grid.centre(a), grid.centre(b)))
          continue;
        links[a] = static_cast<std::uint16_t>(links[a] | (1U << bit));
        links[b] = static_cast<std::uint16_t>(links[b] | (1U << (8 - bit)));
      }
  return links;
}

/// The explored part 𝒮 of the domain is kept as cells, seen through the exact visible region of
/// each robot. Every robot transforms the frontier of its Voronoi region, under shortest paths
/// through explored ground, to the star-shaped domain around itself [004 Def. 5.1]: a frontier cell
/// then has a direction and a distance, and the robot heads where the directions agree best, near
/// ones counting more. A step costs O(robots · cells log cells + n²) for n vertices.
class DisCoverage {
 public:
  /// Throws `Error` unless the robots stand in the domain, apart from one another.
  DisCoverage(const Polygon& domain, std::span<const Point2> start,
              DisCoverageOptions settings = {})
      : options(settings),
        domain_(domain),
        grid_(domain_, settings.cell),
        robots_(start.begin(), start.end()),
        plans_(start.size()) {
    require_placed(domain_, start);
    require(settings.range > settings.cell,
            "DisCoverage: the sensor must reach farther than a cell");
    require(settings.speed > 0.0 && settings.dt > 0.0,
            "DisCoverage: speed and time step must be positive");
    owner_.assign(grid_.cells(), -1);
    links_ = cell_links(domain_, grid_);
    for (const Point2& p : robots_) observe(p);
  }
  const std::vector<Point2>& robots() const { return robots_; }
  const CoverageGrid& explored() const { return grid_; }
  /// The robot whose region a cell belongs to; −1 while unexplored or unreached.
  const std::vector<std::int32_t>& owner() const { return owner_; }
  double time() const { return time_; }
  bool finished() const { return finished_; }
  double travelled() const { return travelled_; }  ///< Of all robots [m].

  void step() {
    plan();
    if (finished_) return;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      double budget = options.speed * options.dt;
      std::vector<Point2>& path = plans_[i].path;  // last point first
      while (budget > 0.0 && !path.empty()) {
        const Point2 d = path.back() - robots_[i];
        const double length = d.norm(), move = std::min(length, budget);
        if (length > 0.0) robots_[i] += move / length * d;
        travelled_ += move;
        budget -= move;
        if (move == length) path.pop_back();
        observe(robots_[i]);
      }
    }
    time_ += options.dt;
  }

  DisCoverageOptions options;

 private:
  struct Plan {
    std::vector<Point2> path;
    std::int32_t target = -1;  ///< The frontier cell it leads to.
  };
  /// Explored cells, each joined to the eight around it.
  struct ExploredGraph {
    const CoverageGrid* grid;
    const std::vector<std::uint16_t>* links;
    struct Arcs {
      std::array<Arc, 8> list;
      std::size_t count = 0;
      const Arc* begin() const { return list.data(); }
      const Arc* end() const { return list.data() + count; }
    };
    std::size_t size() const { return grid->cells(); }
    Arcs arcs(std::int32_t node) const {
      Arcs result;
      const unsigned mask = (*links)[static_cast<std::size_t>(node)];
      for (int bit = 0; bit < 9; ++bit) {
        if ((mask >> bit & 1U) == 0) continue;
        const std::int32_t next = node + (bit / 3 - 1) * grid->columns() + bit % 3 - 1;
        if (grid->covered(static_cast<std::size_t>(next)))
          result.list[result.count++] = {next,
                                         (bit % 2 == 0 ? std::sqrt(2.0) : 1.0) * grid->cell_size()};
      }
      return result;
    }
  };

  void observe(const Point2& p) {
    const Ring seen = visibility_polygon(domain_, p, options.range);
    if (seen.size() < 3) return;
    const PointLocator inside(Polygon{seen, {}});
    grid_.for_each_near(p, p, options.range, [&](std::size_t c) {
      if (grid_.inside(c) && !grid_.covered(c) && inside.contains(grid_.centre(c))) grid_.cover(c);
    });
    const std::size_t own = grid_.index(p);
    if (grid_.inside(own) && !grid_.covered(own)) grid_.cover(own);
  }
  bool frontier(std::size_t c) const {
    if (!grid_.covered(c)) return false;
    for (const int bit : {1, 3, 5, 7})
      if ((links_[c] >> bit & 1) != 0 &&
          !grid_.covered(static_cast<std::size_t>(static_cast<std::int32_t>(c) +
                                                  (bit / 3 - 1) * grid_.columns() + bit % 3 - 1)))
        return true;
    return false;
  }
  std::size_t cell_of(const Point2& p) const {
    const std::size_t own = grid_.index(p);
    if (grid_.covered(own)) return own;
    std::size_t best = own;  // a robot at a wall: the nearest explored centre
    double nearest = std::numeric_limits<double>::infinity();
    grid_.for_each_near(p, p, 3.0 * options.cell, [&](std::size_t c) {
      const double d = (grid_.centre(c) - p).squaredNorm();
      if (grid_.covered(c) && d < nearest && sees(domain_, p, grid_.centre(c))) {
        nearest = d;
        best = c;
      }
    });
    return best;
  }

  void plan() {
    std::vector<std::size_t> edge;
    for (std::size_t c = 0; c < grid_.cells(); ++c)
      if (frontier(c)) edge.push_back(c);
    const ExploredGraph graph{&grid_, &links_};
    std::vector<ShortestPaths> paths;
    for (const Point2& p : robots_)
      paths.push_back(shortest_paths(graph, static_cast<std::int32_t>(cell_of(p))));
    // Voronoi regions of 𝒮 under shortest paths; ties go to the lower robot.
    for (std::size_t c = 0; c < grid_.cells(); ++c) {
      owner_[c] = -1;
      double nearest = ShortestPaths::kUnreached;
      for (std::size_t i = 0; i < robots_.size(); ++i)
        if (paths[i].distance[c] < nearest) {
          nearest = paths[i].distance[c];
          owner_[c] = static_cast<std::int32_t>(i);
        }
    }
    std::erase_if(edge, [&](std::size_t c) { return owner_[c] < 0; });
    finished_ = edge.empty();
    std::vector<bool> taken(grid_.cells(), false);
    for (std::size_t i = 0; i < robots_.size() && !finished_; ++i) {
      Plan& own = plans_[i];
      if (own.target >= 0 && !own.path.empty() && frontier(static_cast<std::size_t>(own.target)) &&
          owner_[static_cast<std::size_t>(own.target)] == static_cast<std::int32_t>(i))
        continue;  // its target still is one
      std::vector<std::size_t> mine;
      for (const std::size_t c : edge)
        if (owner_[c] == static_cast<std::int32_t>(i)) mine.push_back(c);
      // A robot without frontier of its own helps the others where none is going yet.
      if (mine.empty()) mine = edge;
      own.target = choose(i, mine, paths[i]);
      own.path.clear();
      if (own.target >= 0) own.path = path_to(i, own.target, paths[i]);
    }
  }
  /// The star-shaped image of a frontier cell, as direction and distance.
  struct Image {
    double angle, distance;
    std::size_t cell;
  };
  std::int32_t choose(std::size_t robot, const std::vector<std::size_t>& cells,
                      const ShortestPaths& paths) const {
    std::vector<Image> images;
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::size_t c : cells) {
      if (!paths.reached(static_cast<std::int32_t>(c))) continue;
      // The direction in which the path sets out: towards the path's node a few cells on.
      std::int32_t node = static_cast<std::int32_t>(c);
      const double ahead = std::min(paths.distance[c], 0.5 * options.range);
      while (paths.previous[static_cast<std::size_t>(node)] >= 0 &&
             paths.distance[static_cast<std::size_t>(node)] > ahead)
        node = paths.previous[static_cast<std::size_t>(node)];
      const Point2 w = grid_.centre(static_cast<std::size_t>(node)) - robots_[robot];
      images.push_back({std::atan2(w.y(), w.x()), paths.distance[c], c});
      nearest = std::min(nearest, paths.distance[c]);
    }
    if (images.empty()) return -1;
    constexpr int kHeadings = 36;
    double best = -1.0;
    std::int32_t target = -1;
    for (int h = 0; h < kHeadings; ++h) {
      const double heading = 2.0 * kPi * h / kHeadings;
      double gain = 0.0, first = -1.0;
      std::size_t goal = images[0].cell;
      for (const Image& image : images) {
        const double off = wrap_angle(image.angle - heading) / options.heading_spread;
        const double w =
            std::exp(-0.5 * off * off - (image.distance - nearest) / options.distance_scale);
        gain += w;
        // Where this heading leads: the image that counts most in it.
        const double pull =
            std::exp(-0.5 * off * off - 4.0 * (image.distance - nearest) / options.distance_scale);
        if (pull > first) {
          first = pull;
          goal = image.cell;
        }
      }
      if (gain > best) {
        best = gain;
        target = static_cast<std::int32_t>(goal);
      }
    }
    return target;
  }
  /// From the robot to a cell: the path over cells, pulled straight where the ground is explored.
  std::vector<Point2> path_to(std::size_t robot, std::int32_t target,
                              const ShortestPaths& paths) const {
    const std::vector<std::int32_t> cells = paths.path(target);
    std::vector<Point2> path;
    Point2 at = robots_[robot];
    for (std::size_t k = 0; k < cells.size();) {
      std::size_t far = k;
      for (std::size_t m = k + 1; m < cells.size() && clear(at, cells[m]); ++m) far = m;
      at = grid_.centre(static_cast<std::size_t>(cells[far]));
      path.push_back(at);
      k = far + 1;
    }
    std::reverse(path.begin(), path.end());
    return path;
  }
  /// Straight over explored ground, and free.
  bool clear(const Point2& from, std::int32_t cell) const {
    const Point2 to = grid_.centre(static_cast<std::size_t>(cell));
    const int steps =
        std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.5 * options.cell))));
    for (int s = 1; s <= steps; ++s)
      if (!grid_.covered(grid_.index(from + (to - from) * s / steps))) return false;
    return sees(domain_, from, to);
  }

  Polygon domain_;
  CoverageGrid grid_;
  std::vector<Point2> robots_;
  std::vector<Plan> plans_;
  std::vector<std::int32_t> owner_;
  std::vector<std::uint16_t> links_;
  double time_ = 0.0, travelled_ = 0.0;
  bool finished_ = false;
};

/// The number of cells that a robot can get to: those joined to a start by steps between neighbours
/// that see each other. The measure of what exploration can reach.
inline std::size_t reachable_cells(const Polygon& domain, const CoverageGrid& grid,
                                   std::span<const Point2> start) {
  const std::vector<std::uint16_t> links = cell_links(domain, grid);
  std::vector<bool> seen(grid.cells(), false);
  std::vector<std::size_t> open;
  const auto add = [&](std::size_t c) {
    if (!grid.inside(c) || seen[c]) return;
    seen[c] = true;
    open.push_back(c);
  };
  for (const Point2& p : start) add(grid.index(p));
  std::size_t count = 0;
  while (!open.empty()) {
    const std::size_t c = open.back();
    open.pop_back();
    ++count;
    for (int bit = 0; bit < 9; ++bit)
      if ((links[c] >> bit & 1) != 0)
        add(static_cast<std::size_t>(static_cast<std::int32_t>(c) + (bit / 3 - 1) * grid.columns() +
                                     bit % 3 - 1));
  }
  return count;
}
}  // namespace surfleet
