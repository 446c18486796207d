// SPDX-License-Identifier: MIT
/// @file
/// @brief A steam chest after [004 §2.1.1]: tubes of 20 to 70 cm, seven openings, 5 m long.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// A straight tube about the axis from `a` to `b`, its radius linear between the ends.
struct Tube {
  Point3 a, b;
  double radius_a, radius_b;  ///< [m]
  bool open_a = false;        ///< An opening at `a`.
  bool open_b = false;        ///< An opening at `b`.
};

/// The tubes of the steam chest: a main vessel with a tapered end and five branches.
inline std::vector<Tube> steam_chest_tubes() {
  return {{{0.0, 0.0, 0.0}, {3.2, 0.0, 0.0}, 0.35, 0.35, true, false},
          {{3.2, 0.0, 0.0}, {4.0, 0.0, 0.0}, 0.35, 0.20, false, false},
          {{4.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, 0.20, 0.20, false, true},
          {{0.8, 0.0, 0.0}, {0.8, 1.2, 0.0}, 0.20, 0.20, false, true},
          {{1.6, 0.0, 0.0}, {1.6, 0.0, 1.1}, 0.25, 0.25, false, true},
          {{1.7, 0.0, 0.0}, {1.7, -1.1, 0.0}, 0.10, 0.10, false, true},
          {{2.6, 0.0, 0.0}, {2.6, 1.0, 0.0}, 0.15, 0.15, false, true},
          {{3.6, 0.0, 0.0}, {4.1, 0.0, -0.9}, 0.12, 0.12, false, true}};
}

/// The wall of a union of tubes, blended over `blend` [m] where they meet and cut off square at
/// the openings. Naive surface nets on a grid of `edge` [m]. O(volume / edge³).
inline TriangleMesh tube_surface(const std::vector<Tube>& tubes, double edge, double blend) {
  require(edge > 0.0 && !tubes.empty(), "tubes: need at least one tube and a positive edge");
  struct Axis {
    Eigen::Vector3d unit;
    double length;
  };
  std::vector<Axis> axes;
  Box3 box;
  for (const Tube& t : tubes) {
    const Eigen::Vector3d d = t.b - t.a;
    require(d.norm() > 0.0 && t.radius_a > 0.0 && t.radius_b > 0.0,
            "tubes: every tube needs a length and positive radii");
    axes.push_back({d.normalized(), d.norm()});
    const double r = std::max(t.radius_a, t.radius_b) + 4.0 * edge;
    box.extend(t.a - Point3::Constant(r));
    box.extend(t.a + Point3::Constant(r));
    box.extend(t.b - Point3::Constant(r));
    box.extend(t.b + Point3::Constant(r));
  }
  const auto position = [&](std::size_t k, const Point3& p, double& along) {
    along = (p - tubes[k].a).dot(axes[k].unit);
    return (p - tubes[k].a - along * axes[k].unit).norm();
  };
  // Negative inside. A tube runs on past its openings and is cut there afterwards.
  const auto distance = [&](const Point3& p) {
    double result = 1e9;
    for (std::size_t k = 0; k < tubes.size(); ++k) {
      double along = 0.0;
      const double radial = position(k, p, along);
      const double before = tubes[k].open_a ? 0.0 : std::max(0.0, -along);
      const double after = tubes[k].open_b ? 0.0 : std::max(0.0, along - axes[k].length);
      const double s = std::clamp(along / axes[k].length, 0.0, 1.0);
      const double radius = tubes[k].radius_a + s * (tubes[k].radius_b - tubes[k].radius_a);
      const double d = std::hypot(radial, before + after) - radius;
      const double h = std::max(blend - std::abs(result - d), 0.0);
      result = std::min(result, d) - (blend > 0.0 ? h * h / (4.0 * blend) : 0.0);
    }
    return result;
  };
  const auto beyond_opening = [&](const Point3& p) {
    for (std::size_t k = 0; k < tubes.size(); ++k) {
      double along = 0.0;
      if (position(k, p, along) > 1.5 * std::max(tubes[k].radius_a, tubes[k].radius_b)) continue;
      if ((tubes[k].open_a && along < 0.0) || (tubes[k].open_b && along > axes[k].length))
        return true;
    }
    return false;
  };
  std::array<std::int64_t, 3> n{};
  for (std::size_t k = 0; k < 3; ++k)
    n[k] = static_cast<std::int64_t>(std::ceil(box.sizes()[static_cast<int>(k)] / edge)) + 1;
  require(static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]) < 2e8,
          "tubes: the edge is too small for the size; at most 2e8 grid points");
  const auto point = [&](std::int64_t i, std::int64_t j, std::int64_t k) -> Point3 {
    return box.min() +
           edge * Point3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  };
  const auto index = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return static_cast<std::size_t>((k * n[1] + j) * n[0] + i);
  };
  std::vector<float> value(static_cast<std::size_t>(n[0] * n[1] * n[2]));
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i)
        value[index(i, j, k)] = static_cast<float>(distance(point(i, j, k)));

  TriangleMesh mesh;
  std::vector<std::int32_t> cell(value.size(), -1);
  for (std::int64_t k = 0; k + 1 < n[2]; ++k) {
    for (std::int64_t j = 0; j + 1 < n[1]; ++j) {
      for (std::int64_t i = 0; i + 1 < n[0]; ++i) {
        std::array<double, 8> f{};
        int inside = 0;
        for (std::size_t c = 0; c < 8; ++c) {
          const auto b = static_cast<std::int64_t>(c);
          f[c] = static_cast<double>(value[index(i + (b & 1), j + ((b >> 1) & 1), k + (b >> 2))]);
          inside += f[c] < 0.0 ? 1 : 0;
        }
        if (inside == 0 || inside == 8) continue;
        Point3 sum = Point3::Zero();
        int count = 0;
        for (std::size_t c = 0; c < 8; ++c) {
          for (std::size_t bit = 1; bit < 8; bit *= 2) {
            const std::size_t d = c | bit;
            if (d == c || (f[c] < 0.0) == (f[d] < 0.0)) continue;
            const double s = f[c] / (f[c] - f[d]);
            Point3 at(double(c & 1), double((c >> 1) & 1), double(c >> 2));
            at[bit == 1 ? 0 : bit == 2 ? 1 : 2] += s;
            sum += at;
            ++count;
          }
        }
        Point3 p = point(i, j, k) + edge * sum / count;
        for (int newton = 0; newton < 3; ++newton) {
          const double h = 1e-3 * edge, here = distance(p);
          Eigen::Vector3d g;
          for (int axis = 0; axis < 3; ++axis)
            g[axis] = (distance(p + h * Point3::Unit(axis)) - here) / h;
          if (g.squaredNorm() > 0.1) p -= here * g / g.squaredNorm();
        }
        cell[index(i, j, k)] = static_cast<std::int32_t>(mesh.vertices.size());
        mesh.vertices.push_back(p);
      }
    }
  }
  const auto quad = [&](std::array<std::int32_t, 4> v, bool flip) {
    if (flip) std::swap(v[1], v[3]);
    const auto at = [&](std::size_t c) -> const Point3& {
      return mesh.vertices[static_cast<std::size_t>(v[c])];
    };
    const bool other = (at(0) - at(2)).squaredNorm() > (at(1) - at(3)).squaredNorm();
    if (other)
      mesh.triangles.insert(mesh.triangles.end(), {{v[0], v[1], v[3]}, {v[1], v[2], v[3]}});
    else
      mesh.triangles.insert(mesh.triangles.end(), {{v[0], v[1], v[2]}, {v[0], v[2], v[3]}});
  };
  for (std::int64_t k = 1; k + 1 < n[2]; ++k) {
    for (std::int64_t j = 1; j + 1 < n[1]; ++j) {
      for (std::int64_t i = 1; i + 1 < n[0]; ++i) {
        const bool here = value[index(i, j, k)] < 0.0F;
        if (here != (value[index(i + 1, j, k)] < 0.0F))
          quad({cell[index(i, j - 1, k - 1)], cell[index(i, j, k - 1)], cell[index(i, j, k)],
                cell[index(i, j - 1, k)]},
               !here);
        if (here != (value[index(i, j + 1, k)] < 0.0F))
          quad({cell[index(i - 1, j, k - 1)], cell[index(i - 1, j, k)], cell[index(i, j, k)],
                cell[index(i, j, k - 1)]},
               !here);
        if (here != (value[index(i, j, k + 1)] < 0.0F))
          quad({cell[index(i - 1, j - 1, k)], cell[index(i, j - 1, k)], cell[index(i, j, k)],
                cell[index(i - 1, j, k)]},
               !here);
      }
    }
  }
  return selected(mesh, [&](std::size_t t) { return !beyond_opening(mesh.centroid(t)); });
}

/// The bundled steam chest at a given edge length [m]; about 8 m² of wall, outward normals.
inline TriangleMesh steam_chest(double edge = 0.04) {
  require(edge >= 0.01 && edge <= 0.08, "steam chest: edge must be 0.01 to 0.08 m");
  return tube_surface(steam_chest_tubes(), edge, 0.05);
}
}  // namespace surfleet
