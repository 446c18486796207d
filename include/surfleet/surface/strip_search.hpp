// SPDX-License-Identifier: MIT
/// @file
/// @brief Strips of triangles from a start to a goal by A* on the dual of a mesh [004 §7.2.3].
///
///     const StripSearch search(mesh, {.curvature = 0.2});
///     if (const auto strip = search(start, goal)) use(strip->triangles);
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/predicates.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/surface_point.hpp>

namespace surfleet {
/// Where the nodes of the search lie.
enum class StripNodes { centroids, edge_midpoints };

/// What makes a metre of a strip dearer than a metre: its cost is length · (1 + Σ wᵢ cᵢ).
struct StripCosts {
  double curvature = 0.0;  ///< [m]; c is the bend over the crossed edge per length [rad/m].
  double turn = 0.0;       ///< [m]; c is the turn from one piece to the next per length [rad/m].
  double slope = 0.0;      ///< c is the angle of a face to the horizontal over 90°, 0 to 2.
  /// One value for every triangle, 0 or more; infinite where a robot may not be. Or empty.
  std::vector<double> user = {};
};

/// A strip and its cost.
struct StripPath {
  std::vector<std::int32_t> triangles;
  double cost = 0.0;         ///< [m] where no weight is set.
  std::size_t expanded = 0;  ///< Nodes that the search closed.
};

/// The graph of a mesh's inner edges: a node is a crossing from one triangle into the next, which
/// knows where it came from. Edges of three or more triangles are walls.
///
/// Node h, a half-edge, says that its triangle is left over it. Costs come from the piece inside
/// the triangle entered, so that a strip's cost is the sum of its pieces'.
class StripSearch {
 public:
  /// The mesh must outlive it. Throws `Error` for a mesh that is not valid or weights below 0.
  /// O(n).
  explicit StripSearch(const TriangleMesh& mesh, StripCosts costs = {},
                       StripNodes nodes = StripNodes::centroids)
      : mesh_(&mesh), half_(mesh), costs_(std::move(costs)), nodes_(nodes) {
    require_valid_surface(mesh);
    for (const double w : {costs_.curvature, costs_.turn, costs_.slope})
      require(w >= 0.0 && std::isfinite(w), "strip costs: expected weights of 0 or more");
    require(costs_.user.empty() || costs_.user.size() == mesh.triangles.size(),
            "strip costs: expected one value for every triangle");
    for (const double c : costs_.user) require(c >= 0.0, "strip costs: expected 0 or more");
    const std::size_t m = 3 * mesh.triangles.size();
    over_.resize(m);
    for (std::size_t h = 0; h < m; ++h) {
      const std::int32_t g = twin(static_cast<std::int32_t>(h));
      const auto t = h / 3, k = h % 3;
      const Point3 middle = 0.5 * (mesh.corner(t, k) + mesh.corner(t, (k + 1) % 3));
      over_[h] = g >= 0 && nodes == StripNodes::centroids
                     ? crossing_point(mesh, t, static_cast<std::size_t>(g / 3), mesh.corner(t, k),
                                      mesh.corner(t, (k + 1) % 3))
                     : middle;
    }
  }

  const TriangleMesh& mesh() const { return *mesh_; }
  const StripCosts& costs() const { return costs_; }
  std::int32_t twin(std::int32_t h) const { return half_.twin(h); }
  bool blocked(std::int32_t triangle) const {
    return !costs_.user.empty() && !(costs_.user[static_cast<std::size_t>(triangle)] <
                                     std::numeric_limits<double>::infinity());
  }

  /// Changes one triangle's own cost, 0 or more; infinite blocks it.
  void set_user_cost(std::int32_t triangle, double cost) {
    require(triangle >= 0 && static_cast<std::size_t>(triangle) < mesh_->triangles.size() &&
                cost >= 0.0,
            "strip costs: expected a triangle of the mesh and a cost of 0 or more");
    if (costs_.user.empty()) costs_.user.assign(mesh_->triangles.size(), 0.0);
    costs_.user[static_cast<std::size_t>(triangle)] = cost;
  }

  // The graph, for `shortest_paths` and `IncrementalSearch`.
  std::size_t size() const { return over_.size(); }
  struct Arcs {
    std::array<Arc, 2> arc;
    std::size_t count = 0;
    const Arc* begin() const { return arc.data(); }
    const Arc* end() const { return arc.data() + count; }
  };
  Arcs arcs(std::int32_t h) const {
    Arcs arcs;
    const std::int32_t g = twin(h);
    if (g < 0 || blocked(g / 3)) return arcs;
    const std::int32_t t = 3 * (g / 3);
    for (std::int32_t side = 1; side <= 2; ++side) {
      const std::int32_t out = t + (g - t + side) % 3;
      const std::int32_t beyond = twin(out);
      if (beyond < 0 || blocked(beyond / 3)) continue;
      arcs.arc[arcs.count++] = {out, piece(h, out)};
    }
    return arcs;
  }

  /// The arcs that lead to `out`; `to` is where they come from.
  Arcs arcs_into(std::int32_t out) const {
    Arcs arcs;
    if (blocked(out / 3) || twin(out) < 0 || blocked(twin(out) / 3)) return arcs;
    for (const std::int32_t h : before(out))
      if (h >= 0) arcs.arc[arcs.count++] = {h, piece(h, out)};
    return arcs;
  }
  /// The nodes that come before `out`, −1 at a border, whether or not they are blocked.
  std::array<std::int32_t, 2> before(std::int32_t out) const {
    const std::int32_t t = 3 * (out / 3);
    return {twin(t + (out - t + 1) % 3), twin(t + (out - t + 2) % 3)};
  }
  /// The first nodes of every strip from `start`, with the cost to reach them; none where its
  /// triangle is blocked.
  std::vector<Source> sources(const SurfacePoint& start) const {
    std::vector<Source> sources;
    if (blocked(start.triangle)) return sources;
    const Point3 from = start.position(*mesh_);
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t h = 3 * start.triangle + k;
      if (twin(h) >= 0 && !blocked(twin(h) / 3))
        sources.push_back({h, factor(start.triangle) * (at(h) - from).norm()});
    }
    return sources;
  }
  /// What a strip costs that leads from `start` to `goal` in one triangle.
  double within_triangle(const SurfacePoint& start, const SurfacePoint& goal) const {
    return factor(start.triangle) * (goal.position(*mesh_) - start.position(*mesh_)).norm();
  }

  /// The cheapest strip from `start` to `goal`; nothing where none leads there. A* with the
  /// straight distance. O(n log n).
  std::optional<StripPath> operator()(const SurfacePoint& start, const SurfacePoint& goal) const {
    StripPath path;
    if (blocked(start.triangle) || blocked(goal.triangle)) return std::nullopt;
    if (start.triangle == goal.triangle) {
      path.triangles.push_back(start.triangle);
      path.cost = within_triangle(start, goal);
      return path;
    }
    const Point3 to = goal.position(*mesh_);
    const std::vector<Source> sources = this->sources(start);
    // The search ends when nothing open can still lead to a cheaper end.
    double best = ShortestPaths::kUnreached;
    std::int32_t last = -1;
    const auto heuristic = [&](std::int32_t h) { return (at(h) - to).norm(); };
    const auto found = shortest_paths(
        *this, std::span<const Source>(sources), heuristic, [&](std::int32_t h, double d) {
          ++path.expanded;
          if (d + heuristic(h) >= best) return true;
          if (twin(h) / 3 != goal.triangle) return false;
          const double whole = d + factor(goal.triangle) * (at(h) - to).norm();
          if (whole < best) {
            best = whole;
            last = h;
          }
          return false;
        });
    if (last < 0) return std::nullopt;
    path.cost = best;
    path.triangles.push_back(start.triangle);
    for (const std::int32_t h : found.path(last)) path.triangles.push_back(twin(h) / 3);
    return path;
  }

  /// Where a node lies: on its edge [m].
  const Point3& at(std::int32_t h) const { return over_[static_cast<std::size_t>(h)]; }
  /// 1 + Σ wᵢ cᵢ of what belongs to a triangle alone.
  double factor(std::int32_t triangle) const {
    const auto t = static_cast<std::size_t>(triangle);
    double f = 1.0;
    if (costs_.slope > 0.0) {
      const Eigen::Vector3d n = mesh_->area_vector(t);
      f += costs_.slope * std::atan2(n.head<2>().norm(), n.z()) / (0.5 * kPi);
    }
    if (!costs_.user.empty()) f += costs_.user[t];
    return f;
  }
  /// The cost of going on from crossing `h` to crossing `out` of the triangle behind it.
  double piece(std::int32_t h, std::int32_t out) const {
    const auto t = static_cast<std::size_t>(out / 3);
    double length;
    if (nodes_ == StripNodes::centroids) {
      const Point3 middle = mesh_->centroid(t);
      length = (middle - at(h)).norm() + (at(out) - middle).norm();
    } else {
      length = (at(out) - at(h)).norm();
    }
    double cost = factor(out / 3) * length;
    if (costs_.curvature > 0.0) cost += costs_.curvature * bend(out);
    if (costs_.turn > 0.0) cost += costs_.turn * turn(h, out);
    return cost;
  }

 private:
  /// Between the normals on either side of an edge [rad].
  double bend(std::int32_t h) const {
    const Eigen::Vector3d a = mesh_->area_vector(static_cast<std::size_t>(h / 3));
    Eigen::Vector3d b = mesh_->area_vector(static_cast<std::size_t>(twin(h) / 3));
    if (half_.from(twin(h)) == half_.from(h)) b = -b;
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }
  /// Between the lines from the centroid before `h` to the one behind and on to `out`, unfolded
  /// about the edge [rad].
  double turn(std::int32_t h, std::int32_t out) const {
    const auto before = static_cast<std::size_t>(h / 3), after = static_cast<std::size_t>(out / 3);
    const Point3 a = mesh_->corner(before, static_cast<std::size_t>(h % 3));
    const Eigen::Vector3d along =
        (mesh_->corner(before, static_cast<std::size_t>((h + 1) % 3)) - a).normalized();
    const auto flat = [&](const Point3& p) {
      const Eigen::Vector3d d = p - a;
      return Point2(d.dot(along), d.cross(along).norm());
    };
    Point2 last = flat(mesh_->centroid(before));
    last.y() = -last.y();
    const Point2 here = flat(mesh_->centroid(after)), next = flat(at(out));
    const Point2 u = here - last, v = next - here;
    return std::abs(std::atan2(cross2(u, v), u.dot(v)));
  }

  const TriangleMesh* mesh_;
  HalfEdges half_;
  StripCosts costs_;
  StripNodes nodes_;
  std::vector<Point3> over_;
};
static_assert(WeightedGraph<StripSearch>);
}  // namespace surfleet
