// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated aircraft, and the fins and propellers that ships have, too.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene::hull {
/// Blades of one sheet around a hub at `at`; its shaft runs along x, with a cone toward −x.
inline void add_propeller(TriangleMesh& mesh, const Point3& at, double radius, int blades,
                          double phase) {
  append(mesh, make_tube(std::array<Point3, 3>{at + Point3(0.5 * radius, 0, 0), at,
                                               at - Point3(0.35 * radius, 0, 0)},
                         std::array<double, 3>{0.2 * radius, 0.2 * radius, 0.06 * radius}, 16));
  for (int b = 0; b < blades; ++b) {
    const double a = phase + 2.0 * kPi * b / blades;
    std::array<std::vector<Point3>, 4> rows;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const double s = 0.17 + 0.83 * static_cast<double>(r) / 3.0,
                   chord = (r == 3 ? 0.16 : 0.3) * radius;
      const double pitch = 1.1 - 0.6 * s;  // of the section against the disc
      for (const double e : {-1.0, 1.0}) {
        const double turn = a + e * chord * std::cos(pitch) / (s * radius + chord);
        rows[r].push_back(at + Point3(e * chord * std::sin(pitch), s * radius * std::cos(turn),
                                      s * radius * std::sin(turn)));
      }
    }
    append(mesh, make_rows(rows));
  }
}

/// A thin wing or fin of diamond section between root and tip; both are (leading, trailing) edges.
inline TriangleMesh make_fin(const std::array<Point3, 2>& root, const std::array<Point3, 2>& tip,
                             const Eigen::Vector3d& normal, double thickness) {
  std::vector<std::vector<Point3>> rings;
  for (const auto& [from, to] : {root, tip}) {
    const double half = 0.5 * thickness * (rings.empty() ? 1.0 : 0.4);
    const Point3 thick = from + 0.35 * (to - from);
    rings.push_back({from, thick + half * normal, to, thick - half * normal});
  }
  TriangleMesh mesh = make_loft(rings, 0.5 * (root[0] + root[1]), 0.5 * (tip[0] + tip[1]));
  const Eigen::Vector3d axis = tip[0] - root[0],
                        turn = (rings[0][1] - rings[0][0]).cross(rings[0][2] - rings[0][1]);
  if (axis.dot(turn) < 0.0)
    for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

/// An aircraft on its wheels or jacks: low or high wings, engines in open cowls, T or low tail.
inline TriangleMesh aircraft(Draw draw) {
  TriangleMesh mesh;
  const double length = draw.in(18.0, 26.0), radius = draw.in(1.1, 1.5),
               z = radius + draw.in(1.8, 2.4);
  std::vector<Point3> axis;
  std::vector<double> radii;
  for (int k = 0; k <= 24; ++k) {
    const double s = k / 24.0, tail = std::max(0.0, (0.35 - s) / 0.35),
                 nose = std::max(0.0, (s - 0.86) / 0.14);
    axis.emplace_back(length * (s - 0.5), 0, z + 0.6 * radius * tail * tail);
    radii.push_back(std::max(0.1, radius * (1.0 - 0.85 * std::pow(tail, 1.5)) *
                                      std::sqrt(std::max(0.0, 1.0 - nose * nose))));
  }
  append(mesh, make_tube(axis, radii, 32));
  const bool high = draw.chance(0.4), tee = draw.chance(0.4), props = draw.chance(0.5);
  const double span = draw.in(0.42, 0.5) * length, chord = draw.in(2.6, 3.6),
               sweep = draw.in(0.0, 0.35) * span;
  const double root = z + (high ? 0.8 : -0.6) * radius, lift = (high ? -0.01 : 0.07) * span,
               at = 0.05 * length;
  const double ex = draw.in(0.3, 0.42), er = draw.in(0.55, 0.75),
               ez = root - (high || !props ? 0.9 : 0.1);
  for (const double side : {-1.0, 1.0}) {
    append(mesh, make_fin({Point3(at + 0.5 * chord, side * 0.3, root),
                           Point3(at - 0.5 * chord, side * 0.3, root)},
                          {Point3(at + 0.3 * chord - sweep, side * span, root + lift),
                           Point3(at - 0.2 * chord - sweep, side * span, root + lift)},
                          Eigen::Vector3d::UnitZ(), 0.35));
    append(mesh, make_wall_sheet({at - 0.2 * chord - sweep, side * span, root + lift},
                                 {at + 0.3 * chord - sweep, side * span, root + lift}, 0.9));
    const double tail = tee ? z + 3.1 : z + 0.7 * radius, tx = -0.46 * length;
    append(mesh, make_fin({Point3(tx + 0.8, 0, tail), Point3(tx - 0.8, 0, tail)},
                          {Point3(tx, side * 0.38 * span, tail),
                           Point3(tx - 0.8, side * 0.38 * span, tail)},
                          Eigen::Vector3d::UnitZ(), 0.14));
    const Point3 engine(at + 0.35 * chord - ex * sweep, side * ex * span, ez);
    if (props) {
      append(mesh,
             make_tube(std::array<Point3, 3>{engine + Point3(0.8, 0, 0), engine - Point3(0.8, 0, 0),
                                             engine - Point3(2.2, 0, 0)},
                       std::array<double, 3>{0.8 * er, er, 0.2}, 20));
      Pose T = Pose::Identity();
      T.linear() = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      T.translation() = engine + Point3(1.1, 0, 0);
      TriangleMesh screw;
      add_propeller(screw, Point3::Zero(), 1.3, 4, 0.4);
      append(mesh, transformed(screw, T));
    } else {  // an open cowl around a core
      const std::array<Point2, 3> cowl{Point2(-1.1, 0.95 * er), Point2(0.0, 1.1 * er),
                                       Point2(1.1, 0.95 * er)};
      append(mesh, make_cowl(engine, cowl, 28));
      append(mesh, make_tube(std::array<Point3, 3>{engine + Point3(0.5, 0, 0), engine,
                                                   engine - Point3(1.8, 0, 0)},
                             std::array<double, 3>{0.08, 0.6 * er, 0.15}, 16));
    }
    append(mesh, make_box({engine.x() - 0.8, engine.y() - 0.08, std::min(ez + 0.2, root - 0.15)},
                          {engine.x() + 0.2, engine.y() + 0.08, root + 0.1}));
    append(mesh, make_cylinder({at - 0.4, side * 1.3, 0.4},
                               {at - 0.4, side * 0.8, z - 0.5 * radius}, 0.09, 8));
    append(mesh,
           make_cylinder({at - 0.4, side * 1.15, 0.45}, {at - 0.4, side * 1.45, 0.45}, 0.45, 20));
  }
  append(mesh, make_fin({Point3(-0.36 * length, 0, z + 0.5 * radius),
                         Point3(-0.47 * length, 0, z + 0.5 * radius)},
                        {Point3(-0.45 * length, 0, z + 3.2), Point3(-0.5 * length, 0, z + 3.2)},
                        Eigen::Vector3d::UnitY(), 0.2));
  append(mesh,
         make_cylinder({0.4 * length, 0, 0.35}, {0.4 * length, 0, z - 0.6 * radius}, 0.08, 8));
  append(mesh, make_cylinder({0.4 * length, -0.15, 0.35}, {0.4 * length, 0.15, 0.35}, 0.35, 18));
  return mesh;
}
}  // namespace surfleet::detail::random_scene::hull
