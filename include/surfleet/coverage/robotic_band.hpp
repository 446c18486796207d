// SPDX-License-Identifier: MIT
/// @file
/// @brief Coverage by a robotic band: a line of robots that advances and leaves one behind at every
/// critical point to sweep the cell just closed [004 §4.3.2, variant 2].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/coverage/hybrid_coverage.hpp>
#include <surfleet/coverage/reeb_graph.hpp>
#include <surfleet/coverage/sweep_paths.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>

namespace surfleet {
struct RoboticBandOptions {
  double direction = 0.0;  ///< Main sweep direction [rad] from +x.
  /// Area at which a MIDDLE point closes a cell [m²]. 0: chosen so that all robots finish together,
  /// which gives later cells less; 004 leaves the best value to the user.
  double cell_area = 0.0;
  /// Length of a cell along the sweep that closes it [m].
  double max_advance = std::numeric_limits<double>::infinity();
  double small = 0.15;  ///< A cell below this share of a full one becomes an open task.
};
struct RoboticBandPlan {
  ReebGraph graph;                    ///< With MIDDLE points; cells in the order of closing.
  std::vector<std::int32_t> sweeper;  ///< Of each cell.
  std::vector<TimedPath> paths;
};

namespace detail {
/// The band's motion; coordinates are turned so that it advances along +x.
class BandRun {
 public:
  BandRun(const Polygon& domain, const ReebGraph& skeleton, const PolygonGeodesics& geodesics,
          std::span<const Point2> start, const HybridOptions& options,
          const RoboticBandOptions& settings, double finish)
      : skeleton_(skeleton),
        geodesics_(geodesics),
        options_(options),
        settings_(settings),
        finish_(finish) {
    for (const Point2& p : start) plan.paths.emplace_back(p);
    plan.graph.points = skeleton.points;
    share_ = area(domain) / static_cast<double>(start.size());
  }

  void run() {
    incoming_.assign(skeleton_.points.size(), 0);
    for (const ReebCell& c : skeleton_.cells) ++incoming_[static_cast<std::size_t>(c.to)];
    std::vector<std::int32_t> all;
    for (std::size_t i = 0; i < plan.paths.size(); ++i) all.push_back(static_cast<std::int32_t>(i));
    // The nearest START; cells that only other STARTs lead to are left as open tasks.
    std::int32_t first = -1;
    for (std::size_t p = 0; p < skeleton_.points.size(); ++p)
      if (skeleton_.points[p].kind == CriticalKind::Start &&
          (first < 0 || distance(p) < distance(static_cast<std::size_t>(first))))
        first = static_cast<std::int32_t>(p);
    enter(first, all);
    while (!waiting_.empty()) {  // bands that wait where another never came
      auto it = waiting_.begin();
      const std::int32_t point = it->first;
      const std::vector<std::int32_t> band = it->second;
      waiting_.erase(it);
      leave(point, band);
    }
    for (std::size_t c = 0; c < skeleton_.cells.size(); ++c)
      if (done_.count(c) == 0)
        close_task(skeleton_.cells[c].region, skeleton_.cells[c].from, skeleton_.cells[c].to);
    work_off_tasks();
  }
  double end_time() const {
    double t = 0.0;
    for (const TimedPath& p : plan.paths) t = std::max(t, p.end_time());
    return t;
  }

  RoboticBandPlan plan;

 private:
  struct Task {
    std::size_t cell;
    double open_since;
  };
  double distance(std::size_t point) const {
    return (skeleton_.points[point].position - plan.paths[0].points()[0].point).norm();
  }
  TimedPath& path(std::int32_t robot) { return plan.paths[static_cast<std::size_t>(robot)]; }

  /// A band has come to a critical point.
  void enter(std::int32_t point, std::vector<std::int32_t> band) {
    auto& missing = incoming_[static_cast<std::size_t>(point)];
    --missing;
    if (missing > 0) {  // an OUT point: wait for those on the other side of the obstacle
      auto& group = waiting_[point];
      group.insert(group.end(), band.begin(), band.end());
      return;
    }
    const auto it = waiting_.find(point);
    if (it != waiting_.end()) {
      band.insert(band.end(), it->second.begin(), it->second.end());
      waiting_.erase(it);
    }
    leave(point, std::move(band));
  }
  void leave(std::int32_t point, std::vector<std::int32_t> band) {
    if (band.empty()) return;
    double now = 0.0;
    for (const std::int32_t r : band) now = std::max(now, path(r).end_time());
    for (const std::int32_t r : band) path(r).wait_until(now);
    std::vector<std::size_t> branches;
    for (std::size_t c = 0; c < skeleton_.cells.size(); ++c)
      if (skeleton_.cells[c].from == point) branches.push_back(c);
    if (branches.empty()) return;  // idle from here on
    std::sort(branches.begin(), branches.end(), [&](std::size_t a, std::size_t b) {
      return skeleton_.cells[a].region.outer[0].y() < skeleton_.cells[b].region.outer[0].y();
    });
    // The line keeps its order from one side to the other.
    std::sort(band.begin(), band.end(), [&](std::int32_t a, std::int32_t b) {
      const Point2 &p = path(a).end(), &q = path(b).end();
      return p.y() < q.y() || (p.y() == q.y() && a < b);
    });
    double ahead = 0.0;
    for (const std::size_t c : branches) ahead += area(skeleton_.cells[c].region);
    std::size_t given = 0;
    double passed = 0.0;
    for (std::size_t k = 0; k < branches.size(); ++k) {
      passed += area(skeleton_.cells[branches[k]].region);
      auto until =
          static_cast<std::size_t>(std::lround(static_cast<double>(band.size()) * passed / ahead));
      if (k + 1 == branches.size()) until = band.size();
      const std::vector<std::int32_t> part(band.begin() + static_cast<std::ptrdiff_t>(given),
                                           band.begin() + static_cast<std::ptrdiff_t>(until));
      given = until;
      if (!part.empty()) advance(branches[k], part);
      // A branch without robots stays in the list of open cells and becomes a task.
      if (part.empty()) --incoming_[static_cast<std::size_t>(skeleton_.cells[branches[k]].to)];
    }
  }

  static std::pair<double, double> section(const Polygon& cell, double x) {
    // Monotone: the lowest and highest place at x.
    double low = 1e300, high = -1e300;
    for_each_edge(cell, [&](const Point2& a, const Point2& b) {
      if (x < std::min(a.x(), b.x()) || x > std::max(a.x(), b.x())) return;
      for (const double y :
           {a.x() == b.x() ? a.y() : a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y()),
            a.x() == b.x() ? b.y() : a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y())}) {
        low = std::min(low, y);
        high = std::max(high, y);
      }
    });
    return {low, high};
  }
  static Region between(const Polygon& cell, double x0, double x1) {
    const std::vector<HalfPlane> halves{{Point2(-1, 0), -x0}, {Point2(1, 0), x1}};
    return clip(cell, halves);
  }
  /// Lines the band up across the cell at x; the outer two follow the sides.
  void line_up(const Polygon& cell, double x, std::span<const std::int32_t> band) {
    const auto [low, high] = section(cell, x);
    const double margin = std::min(options_.footprint, 0.5 * (high - low));
    double arrival = 0.0;
    std::vector<std::vector<Point2>> routes;
    for (std::size_t k = 0; k < band.size(); ++k) {
      const double s =
          band.size() == 1 ? 0.5 : static_cast<double>(k) / static_cast<double>(band.size() - 1);
      const Point2 goal(x, low + margin + s * (high - low - 2.0 * margin));
      std::vector<Point2> route{path(band[k]).end()};
      append_path(route, goal, geodesics_);
      arrival = std::max(arrival, path(band[k]).end_time() + path_length(route) / options_.speed);
      routes.push_back(std::move(route));
    }
    for (std::size_t k = 0; k < band.size(); ++k) {
      TimedPath& p = path(band[k]);
      for (std::size_t i = 1; i + 1 < routes[k].size(); ++i)
        p.move_to(routes[k][i], options_.speed);
      // The line advances as one: a robot with a shorter path goes slower.
      p.arrive(routes[k].back(), arrival);
    }
  }
  double now(std::span<const std::int32_t> band) {
    double t = 0.0;
    for (const std::int32_t r : band) t = std::max(t, path(r).end_time());
    return t;
  }
  void advance(std::size_t branch, std::vector<std::int32_t> band) {
    const ReebCell& cell = skeleton_.cells[branch];
    done_.insert(branch);
    const Box2 box = cell.region.bounds();
    const double end = box.max().x();
    double x = box.min().x();
    std::int32_t last_point = cell.from;
    line_up(cell.region, x, band);
    while (band.size() > 1) {
      // Where the ground behind the line reaches the size of a cell.
      const double begun = now(band);
      const auto wanted = [&](double to) {
        if (settings_.cell_area > 0.0) return settings_.cell_area;
        const double at = begun + (to - x) / options_.speed;
        return std::max(0.05 * share_, (finish_ - at) * options_.speed * options_.lane);
      };
      const auto full = [&](double to) { return area(between(cell.region, x, to)) >= wanted(to); };
      if (!full(end) && x + settings_.max_advance >= end) break;
      double low = x, high = end;
      if (full(end))
        for (int k = 0; k < 50; ++k) {
          const double middle = 0.5 * (low + high);
          (full(middle) ? high : low) = middle;
        }
      const double to = std::min(high, x + settings_.max_advance);
      if (area(between(cell.region, to, end)) < settings_.small * share_ && band.size() <= 2) break;
      drive(cell.region, x, to, band);
      const std::int32_t point = add_middle(cell.region, to);
      const std::size_t inner = band.size() / 2;
      const std::int32_t left = band[inner];
      band.erase(band.begin() + static_cast<std::ptrdiff_t>(inner));
      sweep(close(between(cell.region, x, to), last_point, point), left);
      last_point = point;
      x = to;
    }
    // What is left up to the end of the cell.
    const Region rest = between(cell.region, x, end);
    const double rest_area = area(rest);
    const CriticalKind kind = skeleton_.points[static_cast<std::size_t>(cell.to)].kind;
    if (band.size() == 1 && (kind == CriticalKind::End || settings_.cell_area <= 0.0 ||
                             rest_area <= 1.5 * settings_.cell_area)) {
      // The last robot sweeps on; what lies beyond becomes open tasks.
      if (settings_.cell_area > 0.0 && rest_area > 1.5 * settings_.cell_area)
        split_tasks(cell.region, x, end, last_point, cell.to);
      else
        sweep(close(rest, last_point, cell.to), band[0]);
      enter(cell.to, kind == CriticalKind::End ? std::vector<std::int32_t>{} : band);
      return;
    }
    if (band.size() == 1) {
      split_tasks(cell.region, x, end, last_point, cell.to);
      enter(cell.to, {});
      return;
    }
    drive(cell.region, x, end, band);
    if (rest_area < settings_.small * share_ && kind != CriticalKind::End) {
      tasks_.push_back({close(rest, last_point, cell.to), now(band)});
    } else if (kind == CriticalKind::End) {
      // No robot has anywhere else to go: those that are here share the rest.
      const double width = (end - x) / static_cast<double>(band.size());
      for (std::size_t k = 0; k < band.size(); ++k)
        sweep(close(between(cell.region, x + width * static_cast<double>(k),
                            x + width * static_cast<double>(k + 1)),
                    last_point, cell.to),
              band[k]);
    } else {
      const std::size_t inner = band.size() / 2;
      sweep(close(rest, last_point, cell.to), band[inner]);
      band.erase(band.begin() + static_cast<std::ptrdiff_t>(inner));
    }
    if (kind == CriticalKind::End) band.clear();
    enter(cell.to, band);
  }
  /// Moves the line from x to `to`, stopping at the corners of the cell in between.
  void drive(const Polygon& cell, double x, double to, std::span<const std::int32_t> band) {
    std::vector<double> stops{to};
    for (const Point2& p : cell.outer)
      if (p.x() > x && p.x() < to) stops.push_back(p.x());
    std::sort(stops.begin(), stops.end());
    stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
    for (const double s : stops) line_up(cell, s, band);
  }
  std::int32_t add_middle(const Polygon& cell, double x) {
    const auto [low, high] = section(cell, x);
    plan.graph.points.push_back({CriticalKind::Middle, {x, 0.5 * (low + high)}});
    return static_cast<std::int32_t>(plan.graph.points.size() - 1);
  }
  std::size_t close(const Region& region, std::int32_t from, std::int32_t to) {
    ReebCell cell;
    cell.from = from;
    cell.to = to;
    if (!region.empty()) cell.region = region[0];
    plan.graph.cells.push_back(std::move(cell));
    plan.sweeper.push_back(-1);
    return plan.graph.cells.size() - 1;
  }
  void close_task(const Polygon& region, std::int32_t from, std::int32_t to) {
    tasks_.push_back({close({region}, from, to), 0.0});
  }
  void split_tasks(const Polygon& cell, double x, double end, std::int32_t from, std::int32_t to) {
    const double whole = area(between(cell, x, end));
    const int parts = std::max(1, static_cast<int>(std::ceil(whole / settings_.cell_area)));
    for (int k = 0; k < parts; ++k) {
      const double a = x + (end - x) * k / parts, b = x + (end - x) * (k + 1) / parts;
      const std::int32_t next = k + 1 == parts ? to : add_middle(cell, b);
      tasks_.push_back({close(between(cell, a, b), from, next), 0.0});
      from = next;
    }
  }
  void sweep(std::size_t cell, std::int32_t robot) {
    ReebCell& c = plan.graph.cells[cell];
    plan.sweeper[cell] = robot;
    c.covered = true;
    if (c.region.outer.size() >= 3)
      path(robot).follow(
          sweep_region<BackAndForthSweep>({c.region}, path(robot).end(), geodesics_, options_),
          options_.speed);
  }
  /// Whoever is free first takes the nearest open task.
  void work_off_tasks() {
    while (!tasks_.empty()) {
      std::int32_t free = 0;
      for (std::size_t i = 1; i < plan.paths.size(); ++i)
        if (plan.paths[i].end_time() < path(free).end_time()) free = static_cast<std::int32_t>(i);
      std::size_t best = 0;
      double nearest = 1e300;
      for (std::size_t k = 0; k < tasks_.size(); ++k) {
        const Polygon& region = plan.graph.cells[tasks_[k].cell].region;
        const double d = (project_into(region, path(free).end()) - path(free).end()).norm();
        if (d < nearest) {
          nearest = d;
          best = k;
        }
      }
      const Task task = tasks_[best];
      tasks_.erase(tasks_.begin() + static_cast<std::ptrdiff_t>(best));
      path(free).wait_until(task.open_since);
      sweep(task.cell, free);
    }
  }

  const ReebGraph& skeleton_;
  const PolygonGeodesics& geodesics_;
  const HybridOptions& options_;
  const RoboticBandOptions& settings_;
  double finish_, share_ = 0.0;
  std::vector<int> incoming_;
  std::map<std::int32_t, std::vector<std::int32_t>> waiting_;
  std::set<std::size_t> done_;
  std::vector<Task> tasks_;
};
}  // namespace detail

/// The whole run of the band. Throws `Error` for bad placements or settings.
inline RoboticBandPlan robotic_band(const Polygon& domain, std::span<const Point2> start,
                                    const HybridOptions& options = {},
                                    RoboticBandOptions settings = {}) {
  require_valid(options);
  require_placed(domain, start);
  require(settings.cell_area >= 0.0 && settings.max_advance > 0.0,
          "robotic band: the area of cells must not be negative, their length positive");
  const Eigen::Rotation2Dd to_band(-settings.direction), back(settings.direction);
  Polygon turned = domain;
  for (std::size_t r = 0; r < turned.rings(); ++r)
    for (Point2& p : turned.ring(r)) p = to_band * p;
  std::vector<Point2> begin;
  for (const Point2& p : start) begin.push_back(to_band * p);
  const ReebGraph skeleton = reeb_graph(turned);
  const PolygonGeodesics geodesics(turned);
  const auto run = [&](double finish) {
    detail::BandRun band(turned, skeleton, geodesics, begin, options, settings, finish);
    band.run();
    return band;
  };
  const double alone =
      area(domain) / (options.speed * options.lane * static_cast<double>(start.size()));
  double best_finish = alone;
  if (settings.cell_area <= 0.0) {
    double best = std::numeric_limits<double>::infinity();
    for (double f = 0.9; f < 1.8; f += 0.02) {
      const double end = run(f * alone).end_time();
      if (end < best) {
        best = end;
        best_finish = f * alone;
      }
    }
  }
  RoboticBandPlan plan = run(best_finish).plan;
  for (CriticalPoint& p : plan.graph.points) p.position = back * p.position;
  for (ReebCell& c : plan.graph.cells)
    for (Point2& p : c.region.outer) p = back * p;
  for (TimedPath& p : plan.paths) p.rotate(settings.direction);
  return plan;
}
}  // namespace surfleet
