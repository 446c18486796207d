// SPDX-License-Identifier: MIT
/// @file
/// @brief Makes a clean mesh dirty as files from drawing programs are, without moving its surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene {
/// Duplicates (some of them turned over), slivers, triangles with three points on a line or a
/// corner twice, and sheets that stand on edges and make them non-manifold. Nothing reaches below
/// `floor`. O(n).
inline void make_dirty(TriangleMesh& mesh, const Draw& draw, double floor) {
  const std::size_t clean = mesh.triangles.size();
  const auto some = [&](double share) {
    return std::max(6, static_cast<int>(share * static_cast<double>(clean)));
  };
  // A clean triangle of some size, or the last one tried.
  const auto pick = [&](Draw& own) {
    std::size_t t = 0;
    for (int k = 0; k < 20; ++k) {
      t = static_cast<std::size_t>(own.whole(0, static_cast<int>(clean) - 1));
      if (mesh.area(t) > 1e-3) break;
    }
    return t;
  };
  const auto add_vertex = [&](const Point3& p) {
    mesh.vertices.push_back(p);
    return static_cast<std::int32_t>(mesh.vertices.size() - 1);
  };
  Draw duplicates = draw("duplicates");
  for (int k = some(0.02); k > 0; --k) {
    Triangle t = mesh.triangles[pick(duplicates)];
    if (duplicates.chance(0.4)) std::swap(t[0], t[1]);
    mesh.triangles.push_back(t);
  }
  Draw slivers = draw("slivers");
  for (int k = some(0.02); k > 0; --k) {
    const std::size_t t = pick(slivers);
    const auto [a, b, c] = mesh.triangles[t];
    const Point3 middle = 0.5 * (mesh.corner(t, 0) + mesh.corner(t, 1));
    const Eigen::Vector3d inward = mesh.corner(t, 2) - middle;
    const double height = std::pow(10.0, slivers.in(-7.0, -3.5));  // [m]
    const std::int32_t p = add_vertex(middle + height * inward.normalized());
    mesh.triangles[t] = {a, p, c};
    mesh.triangles.push_back({p, b, c});
    mesh.triangles.push_back({a, b, p});
  }
  Draw lines = draw("lines");
  for (int k = some(0.01); k > 0; --k) {
    const std::size_t t = pick(lines);
    const auto [a, b, c] = mesh.triangles[t];
    if (k % 5 == 0) {
      mesh.triangles.push_back({a, b, b});
      continue;
    }
    const double f = lines.chance(0.5) ? 0.5 : lines.in(0.1, 0.9);
    const Point3 &from = mesh.corner(t, 0), &to = mesh.corner(t, 1);
    const std::int32_t p = add_vertex(from + f * (to - from));
    mesh.triangles.push_back({a, p, b});
  }
  Draw fins = draw("fins");
  int left = 8;
  for (int k = 0; k < 400 && left > 0; ++k) {
    const std::size_t t = pick(fins);
    const auto [a, b, c] = mesh.triangles[t];
    const double height = fins.in(0.15, 0.5);
    const Point3 &from = mesh.corner(t, 0), &to = mesh.corner(t, 1);
    const Point3 tip = 0.5 * (from + to) + height * mesh.area_vector(t).normalized();
    const double length = (to - from).norm();
    if (!(length > 0.3) || length > 4.0 || tip.z() < floor + 0.05 || !tip.allFinite()) continue;
    mesh.triangles.push_back({a, b, add_vertex(tip)});
    --left;
  }
}
}  // namespace surfleet::detail::random_scene
