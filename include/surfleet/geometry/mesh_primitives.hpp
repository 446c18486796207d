// SPDX-License-Identifier: MIT
/// @file
/// @brief Builders of simple meshes: boxes, cylinders, spheres, tubes, terraced solids, sheets.
///
/// Solids come out closed, manifold and oriented outward, with shared vertices. Lengths in metres.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/rotation.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// Moves the vertices of a mesh, and turns its normals.
inline TriangleMesh transformed(TriangleMesh mesh, const Pose& T_target_source) {
  for (Point3& v : mesh.vertices) v = T_target_source * v;
  for (Eigen::Vector3f& n : mesh.normals) n = T_target_source.linear().cast<float>() * n;
  return mesh;
}

/// A box with 8 vertices.
inline TriangleMesh make_box(const Box3& box) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1) != 0 ? box.max().x() : box.min().x(),
                               (i & 2) != 0 ? box.max().y() : box.min().y(),
                               (i & 4) != 0 ? box.max().z() : box.min().z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}
inline TriangleMesh make_box(const Point3& low, const Point3& high) {
  return make_box(Box3(low, high));
}

namespace detail {
/// Two unit vectors that make a right-handed frame with unit `w`: u × v = w. For a horizontal w
/// v points up; for a vertical one u is x.
inline std::pair<Eigen::Vector3d, Eigen::Vector3d> frame_around(const Eigen::Vector3d& w) {
  const Eigen::Vector3d up =
      std::abs(w.z()) > 0.999 ? Eigen::Vector3d::UnitY().eval() : Eigen::Vector3d::UnitZ().eval();
  const Eigen::Vector3d u = up.cross(w).normalized();
  return {u, w.cross(u)};
}
}  // namespace detail

/// A straight beam from `a` to `b` of rectangular section: `width` across, `height` upward.
inline TriangleMesh make_beam(const Point3& a, const Point3& b, double width, double height) {
  const Eigen::Vector3d axis = b - a;
  const double length = axis.norm();
  require(length > 0.0, "beam: expected two different ends");
  const auto [u, v] = detail::frame_around(axis / length);
  Pose T = Pose::Identity();
  T.linear() << u, v, axis / length;
  T.translation() = a;
  return transformed(
      make_box(Point3(-0.5 * width, -0.5 * height, 0.0), Point3(0.5 * width, 0.5 * height, length)),
      T);
}

/// A closed stack of rings: ring i's vertices lie in order anticlockwise seen from the last ring
/// toward the first; all rings have equally many. Both ends are closed by fans about `bottom` and
/// `top`.
inline TriangleMesh make_loft(std::span<const std::vector<Point3>> rings, const Point3& bottom,
                              const Point3& top) {
  require(rings.size() >= 2 && rings[0].size() >= 3,
          "loft: expected two or more rings of three or more points");
  TriangleMesh mesh;
  const std::size_t n = rings[0].size();
  for (const auto& ring : rings) {
    require(ring.size() == n, "loft: expected rings of equal length");
    mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  }
  const auto at = [n](std::size_t ring, std::size_t k) {
    return static_cast<std::int32_t>(ring * n + k % n);
  };
  for (std::size_t r = 0; r + 1 < rings.size(); ++r)
    for (std::size_t k = 0; k < n; ++k) {
      mesh.triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k)});
      mesh.triangles.push_back({at(r, k + 1), at(r + 1, k + 1), at(r + 1, k)});
    }
  const auto low = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.push_back(bottom);
  mesh.vertices.push_back(top);
  for (std::size_t k = 0; k < n; ++k) {
    mesh.triangles.push_back({low, at(0, k + 1), at(0, k)});
    mesh.triangles.push_back({low + 1, at(rings.size() - 1, k), at(rings.size() - 1, k + 1)});
  }
  return mesh;
}

/// A solid of revolution about the vertical axis through `base`: `profile` holds (radius, height
/// above base) from the lower end on the axis to the upper one, all radii positive; the end discs
/// are closed. A profile that comes back down inside makes a hollow vessel.
inline TriangleMesh make_lathe(const Point3& base, std::span<const Point2> profile,
                               int segments = 48) {
  require(segments >= 3, "lathe: expected three or more segments");
  std::vector<std::vector<Point3>> rings;
  for (const Point2& p : profile) {
    require(p.x() > 0.0, "lathe: expected positive radii");
    std::vector<Point3> ring;
    for (int k = 0; k < segments; ++k) {
      const double angle = 2.0 * kPi * k / segments;
      ring.push_back(base + Point3(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y()));
    }
    rings.push_back(std::move(ring));
  }
  require(!profile.empty(), "lathe: expected a profile");
  return make_loft(rings, base + Point3(0, 0, profile.front().y()),
                   base + Point3(0, 0, profile.back().y()));
}

/// A tube along a polyline, mitred at its corners, with flat ends. `radius[i]` belongs to point i.
inline TriangleMesh make_tube(std::span<const Point3> path, std::span<const double> radius,
                              int segments = 12) {
  require(path.size() >= 2 && radius.size() == path.size() && segments >= 3,
          "tube: expected two or more points, a radius for each, three or more segments");
  std::vector<std::vector<Point3>> rings;
  const auto tangent = [&](std::size_t i) {  // of the leg that starts at i
    return (path[i + 1] - path[i]).normalized().eval();
  };
  Eigen::Vector3d w = tangent(0);
  Eigen::Vector3d u = detail::frame_around(w).first;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector3d in = tangent(i == 0 ? 0 : i - 1);
    const Eigen::Vector3d out = tangent(std::min(i, path.size() - 2));
    // Carry u along without twist, then lay the ring into the plane that halves the corner.
    u = rotation_between(w, in) * u;
    w = in;
    const Eigen::Vector3d v = w.cross(u);
    const Eigen::Vector3d normal = (in + out).normalized();
    std::vector<Point3> ring;
    for (int k = 0; k < segments; ++k) {
      const double angle = 2.0 * kPi * k / segments;
      Eigen::Vector3d d = radius[i] * (std::cos(angle) * u + std::sin(angle) * v);
      d -= in * (d.dot(normal) / in.dot(normal));
      ring.push_back(path[i] + d);
    }
    rings.push_back(std::move(ring));
  }
  return make_loft(rings, path.front(), path.back());
}
inline TriangleMesh make_tube(std::span<const Point3> path, double radius, int segments = 12) {
  return make_tube(path, std::vector<double>(path.size(), radius), segments);
}

/// A cylinder with end caps between two points.
inline TriangleMesh make_cylinder(const Point3& a, const Point3& b, double radius,
                                  int segments = 32) {
  return make_tube(std::array<Point3, 2>{a, b}, radius, segments);
}
/// A cone with a round base at `a`, narrowing to `tip_radius` > 0 at `b`.
inline TriangleMesh make_cone(const Point3& a, const Point3& b, double radius, double tip_radius,
                              int segments = 24) {
  return make_tube(std::array<Point3, 2>{a, b}, std::array<double, 2>{radius, tip_radius},
                   segments);
}

/// A sphere from an icosahedron split `subdivisions` times: 20·4^s nearly equal triangles.
inline TriangleMesh make_sphere(const Point3& centre, double radius, int subdivisions = 3) {
  TriangleMesh mesh;
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Point3& v : mesh.vertices) v.normalize();
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [at, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.vertices.size()));
      if (is_new)
        mesh.vertices.push_back((mesh.vertices[static_cast<std::size_t>(a)] +
                                 mesh.vertices[static_cast<std::size_t>(b)])
                                    .normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    finer.reserve(4 * mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Point3& v : mesh.vertices) v = centre + radius * v;
  return mesh;
}

/// A torus about the vertical axis through `centre`.
inline TriangleMesh make_torus(const Point3& centre, double ring_radius, double tube_radius,
                               int ring_segments = 48, int tube_segments = 16) {
  require(ring_segments >= 3 && tube_segments >= 3, "torus: expected three or more segments");
  TriangleMesh mesh;
  for (int i = 0; i < ring_segments; ++i)
    for (int j = 0; j < tube_segments; ++j) {
      const double a = 2.0 * kPi * i / ring_segments, b = 2.0 * kPi * j / tube_segments;
      const double r = ring_radius + tube_radius * std::cos(b);
      mesh.vertices.push_back(centre +
                              Point3(r * std::cos(a), r * std::sin(a), tube_radius * std::sin(b)));
    }
  const auto at = [&](int i, int j) {
    return (i % ring_segments) * tube_segments + j % tube_segments;
  };
  for (int i = 0; i < ring_segments; ++i)
    for (int j = 0; j < tube_segments; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// A sheet over the rectangle `area`, facing up, of `nx` × `ny` cells; `height(x, y)` gives z.
template <typename Height>
TriangleMesh make_sheet(const Box2& area, int nx, int ny, const Height& height) {
  require(nx >= 1 && ny >= 1, "sheet: expected one or more cells a side");
  TriangleMesh mesh;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const double x = area.min().x() + area.sizes().x() * i / nx;
      const double y = area.min().y() + area.sizes().y() * j / ny;
      mesh.vertices.emplace_back(x, y, height(x, y));
    }
  const auto at = [nx](int i, int j) { return j * (nx + 1) + i; };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}
/// A flat sheet at height `z`.
inline TriangleMesh make_plane(const Box2& area, double z, int nx = 1, int ny = 1) {
  return make_sheet(area, nx, ny, [z](double, double) { return z; });
}

/// An upright prism over a polygon that is star-shaped about its centroid and runs anticlockwise
/// seen from above.
inline TriangleMesh make_prism(std::span<const Point2> polygon, double low, double high) {
  require(polygon.size() >= 3, "prism: expected three or more corners");
  std::array<std::vector<Point3>, 2> rings;
  Point2 centre = Point2::Zero();
  double twice_area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double cross = a.x() * b.y() - a.y() * b.x();
    twice_area += cross;
    centre += cross * (a + b);
    rings[0].emplace_back(a.x(), a.y(), low);
    rings[1].emplace_back(a.x(), a.y(), high);
  }
  require(twice_area > 0.0, "prism: expected a polygon with area, anticlockwise");
  centre /= 3.0 * twice_area;
  return make_loft(rings, Point3(centre.x(), centre.y(), low),
                   Point3(centre.x(), centre.y(), high));
}

/// A solid of axis-aligned boxes, added and cut away one after another, as one closed shell:
/// buildings with rooms, doors and windows, frames of beams.
///
/// The shell has no inner walls where boxes meet. Cut rooms have walls of true thickness. Where
/// solid cells meet along an edge alone the shell touches itself there. O(k³) in the number k of
/// boxes.
class BoxSolid {
 public:
  BoxSolid& add(const Point3& low, const Point3& high) {
    steps_.push_back({Box3(low, high), true});
    return *this;
  }
  BoxSolid& cut(const Point3& low, const Point3& high) {
    steps_.push_back({Box3(low, high), false});
    return *this;
  }

  TriangleMesh mesh() const {
    std::array<std::vector<double>, 3> cuts;  // the planes of all faces, along each axis
    for (std::size_t k = 0; k < 3; ++k) {
      for (const Step& s : steps_) {
        cuts[k].push_back(s.box.min()[static_cast<int>(k)]);
        cuts[k].push_back(s.box.max()[static_cast<int>(k)]);
      }
      std::sort(cuts[k].begin(), cuts[k].end());
      cuts[k].erase(std::unique(cuts[k].begin(), cuts[k].end()), cuts[k].end());
    }
    using Cell = std::array<std::size_t, 3>;
    const auto count = [&](std::size_t k) { return std::max<std::size_t>(cuts[k].size(), 1) - 1; };
    const auto cell_index = [&](const Cell& c) {
      return (c[2] * count(1) + c[1]) * count(0) + c[0];
    };
    std::vector<bool> solid(count(0) * count(1) * count(2), false);
    for (const Step& s : steps_) {
      Cell first{}, last{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto place = [&](double x) {
          return static_cast<std::size_t>(std::lower_bound(cuts[k].begin(), cuts[k].end(), x) -
                                          cuts[k].begin());
        };
        first[k] = place(s.box.min()[static_cast<int>(k)]);
        last[k] = place(s.box.max()[static_cast<int>(k)]);
      }
      for (std::size_t z = first[2]; z < last[2]; ++z)
        for (std::size_t y = first[1]; y < last[1]; ++y)
          for (std::size_t x = first[0]; x < last[0]; ++x) solid[cell_index({x, y, z})] = s.add;
    }
    TriangleMesh mesh;
    std::map<Cell, std::int32_t> vertices;
    const auto vertex = [&](const Cell& c) {
      const auto [at, is_new] =
          vertices.try_emplace(c, static_cast<std::int32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.emplace_back(cuts[0][c[0]], cuts[1][c[1]], cuts[2][c[2]]);
      return at->second;
    };
    Cell c{};
    for (c[2] = 0; c[2] < count(2); ++c[2])
      for (c[1] = 0; c[1] < count(1); ++c[1])
        for (c[0] = 0; c[0] < count(0); ++c[0]) {
          if (!solid[cell_index(c)]) continue;
          for (std::size_t k = 0; k < 3; ++k)
            for (const bool upper : {false, true}) {
              Cell beside = c;
              const bool outermost = upper ? c[k] + 1 == count(k) : c[k] == 0;
              if (!outermost) {
                beside[k] = upper ? c[k] + 1 : c[k] - 1;
                if (solid[cell_index(beside)]) continue;
              }
              const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
              std::array<std::int32_t, 4> q{};
              for (std::size_t n = 0; n < 4; ++n) {
                Cell corner = c;
                corner[k] += upper ? 1 : 0;
                corner[i] += n == 1 || n == 2 ? 1 : 0;
                corner[j] += n >= 2 ? 1 : 0;
                q[n] = vertex(corner);
              }
              if (!upper) std::swap(q[1], q[3]);
              mesh.triangles.push_back({q[0], q[1], q[2]});
              mesh.triangles.push_back({q[0], q[2], q[3]});
            }
        }
    return mesh;
  }

 private:
  struct Step {
    Box3 box;
    bool add;
  };
  std::vector<Step> steps_;
};
}  // namespace surfleet
