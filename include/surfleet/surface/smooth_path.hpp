// SPDX-License-Identifier: MIT
/// @file
/// @brief A dense planner's path moved onto the tokens' sheet and shortened by string pulling,
/// square to every edge it crosses.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/surface/cloud_tokens.hpp>
#include <surfleet/surface/dense_planner.hpp>
#include <surfleet/surface/tracking_control.hpp>

namespace surfleet {
struct SmoothPathOptions {
  double reach = 0.06;     ///< Tokens that make the sheet at a point [m].
  double spacing = 0.035;  ///< Between points of the path [m].
  double square = 0.05;    ///< Length of the straight pieces before and after an edge [m].
  int rounds = 300;        ///< Of smoothing.
};

/// Where a path meets an edge.
struct EdgeCrossing {
  std::size_t point = 0;                               ///< Of the path: the place on the edge.
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< Of the edge.
  double attack = 0.0;  ///< Greatest angle off the square, before and after the edge [rad].
};

/// Points with normals to one side, and the crossings of edges.
struct SmoothPath {
  std::vector<OrientedPoint> points;
  std::vector<EdgeCrossing> crossings;
  double length() const {
    double sum = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i)
      sum += (points[i].position - points[i - 1].position).norm();
    return sum;
  }
  double worst_attack() const {
    double worst = 0.0;
    for (const EdgeCrossing& c : crossings) worst = std::max(worst, c.attack);
    return worst;
  }
};

/// The sheet through tokens: points move along the mean normal onto the mean plane.
class TokenSheet {
 public:
  TokenSheet(const CloudTokens& cloud, double reach) : cloud_(cloud), reach_(reach) {
    std::vector<Point3> at;
    for (const Token& t : cloud.tokens) at.push_back(t.position);
    tree_ = KdTree(at);
  }
  /// The point moved, with the normal nearest in direction to `side`; as it is where no token is in
  /// reach.
  OrientedPoint operator()(const Point3& p, const Eigen::Vector3d& side) const {
    OrientedPoint result{p, side};
    for (int round = 0; round < 2; ++round) {
      Eigen::Vector3d normal = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
      double weight = 0.0;
      tree_.for_each_within(result.position, reach_, [&](const Neighbor& n) {
        const Token& t = cloud_.tokens[static_cast<std::size_t>(n.index)];
        const double inside = 1.0 - n.distance2 / (reach_ * reach_), w = inside * inside;
        normal += (t.normal.dot(result.normal) < 0.0 ? -w : w) * t.normal;
        sum += w * t.position;
        weight += w;
      });
      if (!(weight > 0.0) || !(normal.norm() > 0.0)) return result;
      normal.normalize();
      result.position -= normal.dot(result.position - sum / weight) * normal;
      result.normal = normal;
    }
    return result;
  }

 private:
  const CloudTokens& cloud_;
  double reach_;
  KdTree tree_;
};

namespace detail {
/// A run of edge cells on a path: the middle, where it crosses, with the edge's tangent there.
struct EdgeRun {
  std::size_t first, last;
};
inline std::vector<EdgeRun> edge_runs(const FeatureMaps& maps,
                                      const std::vector<std::int32_t>& cells) {
  std::vector<EdgeRun> runs;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!maps[cells[i]].edge) continue;
    if (!runs.empty() && runs.back().last + 1 >= i)
      runs.back().last = i;
    else
      runs.push_back({i, i});
  }
  return runs;
}
/// Where a run of edge cells crosses edges, in order, all in one plane square to the tangent in the
/// run's middle: edge points of about that direction so near that they make its cells edge cells,
/// gathered within a reach of one another. One at least, as is where none lies near.
inline std::vector<EdgePoint> edges_in_run(const FeatureMaps& maps, const CloudTokens& cloud,
                                           const std::vector<std::int32_t>& cells, EdgeRun run,
                                           const Point3& before, const Point3& after,
                                           double reach) {
  const FeatureCell& middle = maps[cells[(run.first + run.last) / 2]];
  const Eigen::Vector3d t = middle.tangent;
  const double marked = FeatureMaps::kEdgeVoxels * maps.voxel();
  const auto level = [&](const Point3& p) -> Point3 {  // beside the middle
    return p + t * t.dot(middle.position - p);
  };
  std::vector<Point3> points{level(before)};
  for (std::size_t i = run.first; i <= run.last; ++i)
    points.push_back(level(maps[cells[i]].position));
  points.push_back(level(after));
  struct Group {
    Point3 sum;
    double count;
    Point3 mean() const { return sum / count; }
  };
  std::vector<Group> groups;
  Point3 nearest = middle.position;
  double least = 1e300;
  for (const EdgePoint& e : cloud.edge_points) {
    const double d = (e.position - middle.position).squaredNorm();
    if (d < least) {
      least = d;
      nearest = level(e.position);
    }
    if (std::abs(t.dot(e.position - middle.position)) > reach ||
        std::abs(t.dot(e.tangent)) < std::cos(radians(30.0)))
      continue;
    const Point3 at = level(e.position);
    if (!std::any_of(points.begin(), points.end(),
                     [&](const Point3& p) { return (p - at).norm() < marked; }))
      continue;
    const auto same =
        std::min_element(groups.begin(), groups.end(), [&](const auto& a, const auto& b) {
          return (a.mean() - at).norm() < (b.mean() - at).norm();
        });
    if (same != groups.end() && (same->mean() - at).norm() < reach) {
      same->sum += at;
      same->count += 1.0;
    } else {
      groups.push_back({at, 1.0});
    }
  }
  if (groups.size() < 2) return {{nearest, t}};
  const Eigen::Vector3d chord = points.back() - points.front();
  std::stable_sort(groups.begin(), groups.end(), [&](const Group& a, const Group& b) {
    return chord.dot(a.mean()) < chord.dot(b.mean());
  });
  std::vector<EdgePoint> edges;
  for (const Group& g : groups) edges.push_back({g.mean(), t});
  return edges;
}
/// Points along a polyline at most `spacing` apart, the corners included.
inline std::vector<Point3> divided(const std::vector<Point3>& line, double spacing) {
  std::vector<Point3> points{line.front()};
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector3d step = line[i] - line[i - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(step.norm() / spacing - 1e-9)));
    for (int k = 1; k <= parts; ++k) points.push_back(line[i - 1] + step * k / parts);
  }
  return points;
}
}  // namespace detail

/// Smooths a path: between edges each point moves to the middle of its neighbours and back onto the
/// sheet, as long as its cell stays a surface cell; over an edge the path is straight and square to
/// it on either side. Start and goal stay where they are but for the step onto the sheet. Where an
/// edge begins or ends the path, it is not crossed. O(rounds · points).
inline SmoothPath smoothed(const DensePlanner& planner, const CloudTokens& cloud,
                           const DensePath& path, const SmoothPathOptions& options = {}) {
  require(
      options.reach > 0.0 && options.spacing > 0.0 && options.square > 0.0 && options.rounds >= 0,
      "smooth path: expected positive lengths and 0 rounds or more");
  SmoothPath result;
  if (path.cells.empty()) return result;
  const FeatureMaps& maps = planner.maps();
  const TokenSheet sheet(cloud, options.reach);
  Eigen::Vector3d side = maps[path.cells.front()].normal;
  std::vector<OrientedPoint> line;
  for (const std::int32_t c : path.cells) {
    if (maps[c].normal.dot(side) > 0.0) side = maps[c].normal;
    line.push_back(sheet(maps[c].position, side));
    side = line.back().normal;
  }
  const auto runs = detail::edge_runs(maps, path.cells);
  // Anchors: before, on and after each edge that is crossed.
  struct Piece {
    std::vector<Point3> points;
    Eigen::Vector3d side;
  };
  std::vector<Piece> pieces;
  std::size_t from = 0;
  std::vector<Point3> begun{line.front().position};
  std::vector<EdgePoint> edges;
  for (const detail::EdgeRun& run : runs) {
    if (run.first == 0 || run.last + 1 >= path.cells.size()) continue;  // starts or ends on it
    const OrientedPoint &before = line[run.first - 1], &after = line[run.last + 1];
    const std::vector<EdgePoint> met = detail::edges_in_run(
        maps, cloud, path.cells, run, before.position, after.position, options.reach);
    // Square directions: in the sheets before and after, across the tangent.
    const auto across = [](const OrientedPoint& p, const EdgePoint& e) -> Eigen::Vector3d {
      Eigen::Vector3d d = p.position - e.position;
      d -= d.dot(e.tangent) * e.tangent;
      return d.norm() > 1e-9 ? Eigen::Vector3d(d.normalized()) : Eigen::Vector3d::Zero();
    };
    const Eigen::Vector3d back = across(before, met.front()), ahead = across(after, met.back());
    if (back.isZero() || ahead.isZero()) continue;
    if (met.size() == 1 && back.dot(ahead) > 0.8) continue;  // it turned around
    for (std::size_t i = from + 1; i < run.first; ++i) begun.push_back(line[i].position);
    begun.push_back(met.front().position + options.square * back);
    pieces.push_back({begun, line[from].normal});
    for (std::size_t k = 0; k < met.size(); ++k) {
      if (k > 0) pieces.push_back({{}, line[from].normal});  // straight from edge to edge
      edges.push_back(met[k]);
    }
    begun = {met.back().position + options.square * ahead};
    from = run.last;
  }
  for (std::size_t i = from + 1; i < line.size(); ++i) begun.push_back(line[i].position);
  pieces.push_back({begun, line[from].normal});

  Eigen::Vector3d facing = line.front().normal;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    std::vector<Point3> points;
    if (!pieces[k].points.empty()) points = detail::divided(pieces[k].points, options.spacing);
    std::vector<Eigen::Vector3d> normal(points.size(), facing);
    for (std::size_t i = 0; i < points.size(); ++i)
      normal[i] = sheet(points[i], i > 0 ? normal[i - 1] : facing).normal;
    for (int round = 0; round < options.rounds; ++round) {
      double moved = 0.0;
      for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        const OrientedPoint to = sheet(0.5 * (points[i - 1] + points[i + 1]), normal[i]);
        if (!planner.cell_at(to.position, 0.87 * maps.voxel())) continue;
        moved = std::max(moved, (to.position - points[i]).norm());
        points[i] = to.position;
        normal[i] = to.normal;
      }
      if (moved < 1e-4 * options.spacing) break;
    }
    for (std::size_t i = 0; i < points.size(); ++i) result.points.push_back({points[i], normal[i]});
    if (!normal.empty()) facing = normal.back();
    if (k < edges.size()) {
      EdgeCrossing crossing;
      crossing.point = result.points.size();
      crossing.tangent = edges[k].tangent;
      result.points.push_back({edges[k].position, facing});
      result.crossings.push_back(crossing);
    }
  }
  for (EdgeCrossing& c : result.crossings) {
    // The pieces beside the edge, and the direction of the path where they begin and end.
    const auto off = [&](const Point3& a, const Point3& b) {
      const Eigen::Vector3d step = b - a;
      return std::asin(
          std::clamp(std::abs(step.dot(c.tangent)) / std::max(step.norm(), 1e-12), 0.0, 1.0));
    };
    const std::size_t i = c.point;
    result.points[i].normal =
        (result.points[i - 1].normal + result.points[i + 1].normal).normalized();
    c.attack = std::max(off(result.points[i - 1].position, result.points[i].position),
                        off(result.points[i].position, result.points[i + 1].position));
  }
  return result;
}
}  // namespace surfleet
