// SPDX-License-Identifier: MIT
/// @file
/// @brief Fewer triangles by collapsing edges at the least quadric error (Garland and Heckbert
/// 1997), as [004 §7.2.2] prepares meshes for driving.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
struct SimplifyOptions {
  std::size_t triangles = 1000;  ///< No more are wanted.
  double border = 10.0;          ///< Weight of the planes that stand on borders.
  double least_cosine = 0.2;     ///< Of the angle by which a triangle may turn in one collapse.
};

namespace detail {
/// vᵀ Q v over planes, about an origin near the mesh.
struct PlaneQuadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double c = 0.0;
  void add(const Eigen::Vector3d& unit, double offset, double weight) {
    a += weight * unit * unit.transpose();
    b += weight * offset * unit;
    c += weight * offset * offset;
  }
  void add(const PlaneQuadric& q) {
    a += q.a;
    b += q.b;
    c += q.c;
  }
  double operator()(const Point3& p) const {
    return std::max(0.0, p.dot(a * p) + 2.0 * b.dot(p) + c);
  }
};

class Simplifier {
 public:
  Simplifier(const TriangleMesh& mesh, const SimplifyOptions& options)
      : options_(options), origin_(mesh.bounds().center()), triangles_(mesh.triangles) {
    for (const Point3& p : mesh.vertices) at_.push_back(p - origin_);
    of_vertex_.resize(at_.size());
    alive_.assign(triangles_.size(), 1);
    border_.assign(at_.size(), 0);
    fixed_.assign(at_.size(), 0);
    version_.assign(at_.size(), 0);
    quadric_.resize(at_.size());
    count_ = triangles_.size();
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const Eigen::Vector3d n = normal(triangles_[t]);
      const double area = n.norm();
      for (const std::int32_t v : triangles_[t]) {
        of_vertex_[index(v)].push_back(static_cast<std::int32_t>(t));
        if (area > 0.0)
          quadric_[index(v)].add(n / area, -n.dot(at_[index(triangles_[t][0])]) / area, area);
      }
    }
    const MeshAdjacency adjacency(mesh);
    for (std::size_t e = 0; e < adjacency.edge_count(); ++e) {
      const auto sides = adjacency.triangles_of_edge(static_cast<std::int32_t>(e));
      const auto& v = adjacency.edges()[e].vertices;
      if (sides.size() > 2) fixed_[index(v[0])] = fixed_[index(v[1])] = 1;
      if (sides.size() != 1) continue;
      border_[index(v[0])] = border_[index(v[1])] = 1;
      const Eigen::Vector3d along = at_[index(v[1])] - at_[index(v[0])];
      const Eigen::Vector3d upright = along.cross(normal(triangles_[index(sides[0])]));
      if (!(upright.norm() > 0.0)) continue;
      const Eigen::Vector3d unit = upright.normalized();
      for (const std::int32_t end : v)
        quadric_[index(end)].add(unit, -unit.dot(at_[index(v[0])]),
                                 options.border * along.squaredNorm());
    }
    for (const MeshEdge& e : adjacency.edges()) push(e.vertices[0], e.vertices[1]);
  }

  TriangleMesh run() {
    while (count_ > options_.triangles && !queue_.empty()) {
      const Candidate best = queue_.top();
      queue_.pop();
      if (version_[index(best.a)] != best.version_a || version_[index(best.b)] != best.version_b)
        continue;
      const Placement to = place(best.a, best.b);
      if (!allowed(best.a, best.b, to.at)) continue;
      collapse(best.a, best.b, to.at);
    }
    TriangleMesh mesh;
    for (const Point3& p : at_) mesh.vertices.push_back(p + origin_);
    mesh.triangles = triangles_;
    return selected(mesh, [&](std::size_t t) { return alive_[t] != 0; });
  }

 private:
  struct Candidate {
    double cost;
    std::int32_t a, b;
    std::uint32_t version_a, version_b;
    bool operator>(const Candidate& o) const {
      return std::tie(cost, a, b) > std::tie(o.cost, o.a, o.b);
    }
  };
  struct Placement {
    Point3 at;
    double cost;
  };
  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  Eigen::Vector3d normal(const Triangle& t) const {
    const Point3& a = at_[index(t[0])];
    return (at_[index(t[1])] - a).cross(at_[index(t[2])] - a);
  }

  /// The place of least error: where the sum's gradient vanishes, unless that is ill-posed or far
  /// from the edge; then the better of the ends and the middle.
  Placement place(std::int32_t a, std::int32_t b) const {
    PlaneQuadric q = quadric_[index(a)];
    q.add(quadric_[index(b)]);
    const Point3 &p = at_[index(a)], &r = at_[index(b)];
    const Point3 middle = 0.5 * (p + r);
    Placement best{middle, q(middle)};
    for (const Point3& end : {p, r})
      if (q(end) < best.cost) best = {end, q(end)};
    const Eigen::FullPivLU<Eigen::Matrix3d> lu(q.a);
    if (lu.rcond() > 1e-3) {
      const Point3 free = lu.solve(-q.b);
      if ((free - middle).norm() <= 1.5 * (p - r).norm() && q(free) < best.cost)
        best = {free, q(free)};
    }
    return best;
  }
  void push(std::int32_t a, std::int32_t b) {
    if (fixed_[index(a)] != 0 || fixed_[index(b)] != 0) return;
    queue_.push({place(a, b).cost, std::min(a, b), std::max(a, b), version_[index(std::min(a, b))],
                 version_[index(std::max(a, b))]});
  }
  std::vector<std::int32_t> ring(std::int32_t v) const {
    std::vector<std::int32_t> found;
    for (const std::int32_t t : of_vertex_[index(v)])
      for (const std::int32_t u : triangles_[index(t)])
        if (u != v) found.push_back(u);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// The link condition, borders as borders, and no triangle turned over or drawn to a line.
  bool allowed(std::int32_t a, std::int32_t b, const Point3& to) const {
    std::size_t shared = 0;
    std::vector<std::int32_t> opposite;
    for (const std::int32_t t : of_vertex_[index(a)]) {
      const Triangle& v = triangles_[index(t)];
      if (std::find(v.begin(), v.end(), b) == v.end()) continue;
      ++shared;
      for (const std::int32_t u : v)
        if (u != a && u != b) opposite.push_back(u);
    }
    // An inner edge between two places of the border would pinch the surface or close a hole.
    const bool both = border_[index(a)] != 0 && border_[index(b)] != 0;
    if (shared == 0 || shared > 2 || (both && shared != 1)) return false;
    const std::vector<std::int32_t> of_a = ring(a), of_b = ring(b);
    std::vector<std::int32_t> common;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                          std::back_inserter(common));
    std::sort(opposite.begin(), opposite.end());
    if (common != opposite) return false;
    if (both && of_a.size() <= 2 && of_b.size() <= 2) return false;  // the last triangle
    if (of_vertex_[index(a)].size() + of_vertex_[index(b)].size() < 2 * shared + 2 && both)
      return false;
    // A border loop keeps three edges.
    if (both) {
      for (const std::int32_t u : common)
        if (border_[index(u)] != 0 && only_triangle(a, u) && only_triangle(b, u)) return false;
      if (short_loop(a, b)) return false;
    }
    if (!both && of_a.size() + of_b.size() - common.size() < 5) return false;  // a tetrahedron
    for (const auto& [moved, other] : {std::pair{a, b}, std::pair{b, a}})
      for (const std::int32_t t : of_vertex_[index(moved)]) {
        const Triangle& v = triangles_[index(t)];
        if (std::find(v.begin(), v.end(), other) != v.end()) continue;
        std::array<Point3, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) corner[k] = v[k] == moved ? to : at_[index(v[k])];
        const Eigen::Vector3d before = normal(v);
        const Eigen::Vector3d after = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        const double longest =
            std::max({(corner[1] - corner[0]).squaredNorm(), (corner[2] - corner[1]).squaredNorm(),
                      (corner[0] - corner[2]).squaredNorm()});
        if (!(after.norm() > 0.02 * longest)) return false;
        if (before.norm() > 0.0 &&
            before.dot(after) < options_.least_cosine * before.norm() * after.norm())
          return false;
      }
    return true;
  }
  bool only_triangle(std::int32_t a, std::int32_t b) const {
    int n = 0;
    for (const std::int32_t t : of_vertex_[index(a)]) {
      const Triangle& v = triangles_[index(t)];
      n += std::find(v.begin(), v.end(), b) != v.end() ? 1 : 0;
    }
    return n == 1;
  }
  /// Whether the border through the border edge ab has three edges: to collapse it would close it.
  bool short_loop(std::int32_t a, std::int32_t b) const {
    for (const std::int32_t u : ring(a))
      if (u != b && border_[index(u)] != 0 && only_triangle(a, u))
        for (const std::int32_t w : ring(b))
          if (w == u && only_triangle(b, w)) return true;
    return false;
  }

  void collapse(std::int32_t a, std::int32_t b, const Point3& to) {
    at_[index(a)] = to;
    quadric_[index(a)].add(quadric_[index(b)]);
    border_[index(a)] = border_[index(a)] | border_[index(b)];
    const std::vector<std::int32_t> of_b = of_vertex_[index(b)];
    for (const std::int32_t t : of_b) {
      Triangle& v = triangles_[index(t)];
      if (std::find(v.begin(), v.end(), a) != v.end()) {
        alive_[index(t)] = 0;
        --count_;
        for (const std::int32_t u : v) std::erase(of_vertex_[index(u)], t);
        continue;
      }
      std::replace(v.begin(), v.end(), b, a);
      of_vertex_[index(a)].push_back(t);
    }
    of_vertex_[index(b)].clear();
    ++version_[index(a)];
    ++version_[index(b)];
    for (const std::int32_t u : ring(a)) push(a, u);
  }

  SimplifyOptions options_;
  Point3 origin_;
  std::vector<Triangle> triangles_;
  std::vector<Point3> at_;
  std::vector<std::vector<std::int32_t>> of_vertex_;
  std::vector<std::uint8_t> alive_, border_, fixed_;
  std::vector<std::uint32_t> version_;
  std::vector<PlaneQuadric> quadric_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
  std::size_t count_ = 0;
};
}  // namespace detail

/// The mesh with at most so many triangles, or as few as can be had: a collapse that would turn a
/// triangle over, draw one to a line, break the link condition, pinch, or close an opening is
/// refused, and vertices of edges with three or more triangles stay. Openings keep their number.
/// Attributes are dropped. The same mesh gives the same result. O(n log n). Throws `Error` for
/// vertices that are not finite.
inline TriangleMesh simplified(const TriangleMesh& mesh, const SimplifyOptions& options = {}) {
  require(options.border >= 0.0 && options.least_cosine >= 0.0 && options.least_cosine < 1.0,
          "simplify: expected a border weight of 0 or more and a least cosine of 0 to 1");
  for (const Point3& p : mesh.vertices)
    require(p.allFinite(), "simplify: a vertex is not finite; expected finite coordinates");
  if (mesh.triangles.size() <= options.triangles)
    return selected(mesh, [](std::size_t) { return true; });
  return detail::Simplifier(mesh, options).run();
}
}  // namespace surfleet
