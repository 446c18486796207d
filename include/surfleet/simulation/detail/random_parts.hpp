// SPDX-License-Identifier: MIT
/// @file
/// @brief What the generated scenes share: named draws, sheets and what is made of them, railings.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>

namespace surfleet::detail::random_scene {
/// A stream of draws. Each feature of a scene draws from a branch of its own, by name or number, so
/// that one that draws more shifts no other. One draw a statement: C++ does not order arguments.
class Draw {
 public:
  explicit Draw(Random random) : root_(random), random_(random) {}

  /// The branch of a name, whatever was drawn before.
  Draw operator()(std::string_view name) const {
    std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return Draw(root_.fork(hash));
  }
  Draw operator()(std::string_view name, int number) const {
    return Draw((*this)(name).root_.fork(static_cast<std::uint64_t>(number)));
  }
  /// Uniform in [low, high).
  double in(double low, double high) { return random_.uniform(low, high); }
  /// One of low, …, high.
  int whole(int low, int high) {
    return low + static_cast<int>(random_.below(static_cast<std::uint64_t>(high - low + 1)));
  }
  bool chance(double share) { return random_.uniform() < share; }
  template <typename Range>
  void shuffle(Range& range) {
    random_.shuffle(range);
  }

 private:
  Random root_, random_;
};

/// Which of `count` forms a seed has. Neighbours differ, and so do every fifth and every seventh.
constexpr int next_form(std::uint64_t seed, int count) {
  const auto n = static_cast<std::uint64_t>(count);
  return static_cast<int>((seed + seed / n) % n);
}

/// A generated structure, before it is made a scene.
struct Structure {
  TriangleMesh mesh;
  bool indoors = false;  ///< Seen from within: no ground is added, and robots start inside.
};

inline TriangleMesh placed(TriangleMesh mesh, const Point3& at, double yaw = 0.0) {
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = at;
  return transformed(std::move(mesh), T);
}

inline Point3 on_circle(double radius, double angle, double z) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// A single sheet through rings of points: rows of equal length, the front where rows run to the
/// right and follow one another upward. `round` joins the last point of a row to its first.
inline TriangleMesh make_rows(std::span<const std::vector<Point3>> rows, bool round = false) {
  TriangleMesh mesh;
  const auto n = static_cast<std::int32_t>(rows[0].size());
  for (const auto& row : rows) mesh.vertices.insert(mesh.vertices.end(), row.begin(), row.end());
  for (std::int32_t r = 0; r + 1 < static_cast<std::int32_t>(rows.size()); ++r)
    for (std::int32_t k = 0; k + (round ? 0 : 1) < n; ++k) {
      const std::int32_t a = r * n + k, b = r * n + (k + 1) % n;
      mesh.triangles.push_back({a, b, a + n});
      mesh.triangles.push_back({b, b + n, a + n});
    }
  return mesh;
}

/// A single sheet of revolution about the vertical axis through the origin; `profile` as for
/// `make_lathe`, without ends. Less than a full turn leaves it open at its sides.
inline TriangleMesh make_revolved_sheet(std::span<const Point2> profile, int segments = 48,
                                        double from = 0.0, double to = 2.0 * kPi) {
  const bool round = to - from > 2.0 * kPi - 1e-9;
  std::vector<std::vector<Point3>> rows;
  for (const Point2& p : profile) {
    rows.emplace_back();
    for (int k = 0; k < segments + (round ? 0 : 1); ++k)
      rows.back().push_back(on_circle(p.x(), from + (to - from) * k / segments, p.y()));
  }
  return make_rows(rows, round);
}

/// The flat sheet a, b, c, d, seen anticlockwise from its front.
inline TriangleMesh make_panel(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  return make_rows(std::array<std::vector<Point3>, 2>{{{a, b}, {d, c}}});
}
/// An upright sheet from `a` to `b`, `height` high.
inline TriangleMesh make_wall_sheet(const Point3& a, const Point3& b, double height) {
  const Eigen::Vector3d up(0, 0, height);
  return make_panel(a, b, b + up, a + up);
}

/// A manifold sheet made a closed solid that reaches `thickness` behind it; the sheet itself for a
/// thickness of 0. O(n log n).
inline TriangleMesh thickened(const TriangleMesh& sheet, double thickness) {
  if (!(thickness > 0.0)) return sheet;
  TriangleMesh solid = sheet;
  std::vector<Eigen::Vector3d> normal(sheet.vertices.size(), Eigen::Vector3d::Zero());
  for (std::size_t t = 0; t < sheet.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {  // by angle: what counts is the shape, not its triangles
      const Eigen::Vector3d a = sheet.corner(t, (k + 1) % 3) - sheet.corner(t, k);
      const Eigen::Vector3d b = sheet.corner(t, (k + 2) % 3) - sheet.corner(t, k);
      normal[static_cast<std::size_t>(sheet.triangles[t][k])] +=
          std::atan2(a.cross(b).norm(), a.dot(b)) * sheet.area_vector(t).normalized();
    }
  for (std::size_t v = 0; v < sheet.vertices.size(); ++v)
    solid.vertices.push_back(sheet.vertices[v] - thickness * normal[v].normalized());
  const auto n = static_cast<std::int32_t>(sheet.vertices.size());
  const MeshAdjacency adjacency(sheet);
  for (std::size_t t = 0; t < sheet.triangles.size(); ++t) {
    const Triangle& f = sheet.triangles[t];
    solid.triangles.push_back({f[0] + n, f[2] + n, f[1] + n});
    for (std::size_t k = 0; k < 3; ++k)
      if (adjacency.is_boundary(adjacency.edges_of_triangle(static_cast<std::int32_t>(t))[k])) {
        const std::int32_t a = f[k], b = f[(k + 1) % 3];
        solid.triangles.push_back({b, a, a + n});
        solid.triangles.push_back({b, a + n, b + n});
      }
  }
  return solid;
}

/// A hollow upright vessel's wall or a platform's ring: a closed solid between two radii.
inline TriangleMesh make_ring(const Point3& base, double inner, double outer, double height,
                              int segments = 40) {
  const std::array<Point2, 5> profile{Point2(inner, 0), Point2(outer, 0), Point2(outer, height),
                                      Point2(inner, height), Point2(inner, 0)};
  return placed(make_revolved_sheet(profile, segments), base);
}

/// Posts and a handrail along a line of points; `radius` of the members.
inline void add_railing(TriangleMesh& mesh, std::span<const Point3> path, double height,
                        double radius, double pitch = 2.0) {
  const Eigen::Vector3d up(0, 0, height);
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Point3 &a = path[i], &b = path[i + 1];
    append(mesh, make_cylinder(a + up, b + up, radius, 6));
    append(mesh, make_cylinder(a + 0.5 * up, b + 0.5 * up, radius, 6));
    const int posts = std::max(1, static_cast<int>((b - a).norm() / pitch));
    for (int k = 0; k < posts; ++k) {
      const Point3 post = a + (b - a) * k / posts;
      append(mesh, make_cylinder(post, post + up, radius, 6));
    }
  }
  if (!path.empty()) append(mesh, make_cylinder(path.back(), path.back() + up, radius, 6));
}

/// Points on a level circle, the first again at the end.
inline std::vector<Point3> circle(const Point3& centre, double radius, int count) {
  std::vector<Point3> points;
  for (int k = 0; k <= count; ++k)
    points.push_back(centre + on_circle(radius, 2.0 * kPi * (k % count) / count, 0));
  return points;
}

/// A regular polygon's ring of corners, anticlockwise.
inline std::vector<Point3> polygon_ring(int corners, double radius, double z, double phase) {
  std::vector<Point3> ring;
  for (int k = 0; k < corners; ++k)
    ring.push_back(on_circle(radius, phase + 2.0 * kPi * k / corners, z));
  return ring;
}

/// The form that the seed has of several, turned about the vertical axis by a draw.
template <std::size_t N>
TriangleMesh turned_form(const std::array<TriangleMesh (*)(Draw), N>& forms, const Draw& draw,
                         Draw& site, std::uint64_t seed) {
  const auto form = static_cast<std::size_t>(next_form(seed, static_cast<int>(N)));
  return placed(forms[form](draw), Point3::Zero(), site.in(0.0, 2.0 * kPi));
}

/// An open cowl of one sheet about a line along x through `at`; `profile` is (x, radius).
inline TriangleMesh make_cowl(const Point3& at, std::span<const Point2> profile, int segments) {
  std::vector<std::vector<Point3>> rows(profile.size());
  for (int k = 0; k < segments; ++k)
    for (std::size_t e = 0; e < profile.size(); ++e) {
      const Point3 p = on_circle(profile[e].y(), 2.0 * kPi * k / segments, 0);
      rows[e].push_back(at + Point3(profile[e].x(), p.x(), p.y()));
    }
  return make_rows(rows, true);
}

/// Four upright legs of square section at (±x, ±y), from the floor up to `top`.
inline void add_legs(TriangleMesh& mesh, double x, double y, double top, double thickness) {
  for (const double at_x : {-x, x})
    for (const double at_y : {-y, y})
      append(mesh, make_beam({at_x, at_y, 0}, {at_x, at_y, top}, thickness, thickness));
}
}  // namespace surfleet::detail::random_scene
