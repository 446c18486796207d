// SPDX-License-Identifier: MIT
/// @file
/// @brief Vessels of generated plants: tanks with and without a lid, silos, holders, drums.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene::plant {
/// One upright tank: cone, dome, or no lid and a thin wall around a floating roof.
inline TriangleMesh tank(Draw draw, double radius, double height) {
  const int roof = draw.whole(0, 2);
  TriangleMesh mesh;
  if (roof == 2) {
    const std::array<Point2, 2> wall{Point2(radius, 0), Point2(radius, height)};
    mesh = thickened(make_revolved_sheet(wall, 48), draw.chance(0.5) ? 0.0 : 0.05);
    const double level = draw.in(0.45, 0.8) * height;
    append(mesh, make_cylinder({0, 0, level - 0.4}, {0, 0, level}, radius - 0.15, 48));
    append(mesh, make_ring({0, 0, height - 0.25}, radius, radius + 0.35, 0.25));
  } else {
    std::vector<Point2> profile{{radius, 0}, {radius, height}};
    const double rise = roof == 0 ? 0.25 * radius : 0.55 * radius;
    for (int k = 1; k <= 6; ++k) {
      const double r = std::max(0.05, radius * (1.0 - k / 6.0)), f = r / radius;
      profile.emplace_back(r, height + rise * (roof == 0 ? 1.0 - f : std::sqrt(1.0 - f * f)));
    }
    mesh = make_lathe(Point3::Zero(), profile, 48);
    add_railing(mesh, circle({0, 0, height + 0.02}, radius - 0.1, 16), 1.1, 0.04);
  }
  std::vector<Point3> stair;
  const double turn = draw.in(0.0, 2.0 * kPi);
  for (int k = 0; k <= 20; ++k)
    stair.push_back(on_circle(radius + 0.25, turn + 0.09 * k, 0.3 + (height - 0.4) * k / 20));
  append(mesh, make_tube(stair, 0.12, 8));
  return mesh;
}

inline TriangleMesh tank_farm(Draw draw, double room) {
  const bool four = draw.chance(0.4);
  TriangleMesh mesh;
  const double radius = four ? draw.in(0.15, 0.19) * room : draw.in(0.3, 0.42) * room;
  for (int k = 0; k < (four ? 4 : 1); ++k) {
    const double height = draw.in(4.0, 8.5);
    const Point3 at = four ? on_circle(0.35 * room, kPi * (0.25 + 0.5 * k), 0) : Point3::Zero();
    append(mesh, placed(tank(draw("tank", k), radius, height), at));
  }
  return mesh;
}

/// Silos on legs with hoppers below, two to four in a row.
inline TriangleMesh silos(Draw draw, double room) {
  TriangleMesh mesh;
  const int count = draw.whole(2, 4);
  const double radius = 0.40 * room / count, low = draw.in(2.6, 4.0),
               high = low + draw.in(4.0, 7.0);
  const std::array<Point2, 5> profile{Point2(0.2, low - 1.6), Point2(radius, low),
                                      Point2(radius, high), Point2(0.4 * radius, high + 0.9),
                                      Point2(0.1, high + 1.0)};
  for (int k = 0; k < count; ++k) {
    const double x = (k - 0.5 * (count - 1)) * (2.0 * radius + 0.35);
    append(mesh, make_lathe({x, 0, 0}, profile, 32));
    for (int leg = 0; leg < 4; ++leg) {
      const Point3 p = Point3(x, 0, 0) + on_circle(0.92 * radius, kPi * (0.25 + 0.5 * leg), 0);
      append(mesh, make_beam(p, p + Point3(0, 0, low + 0.3), 0.22, 0.22));
    }
  }
  const double reach = 0.5 * count * (2.0 * radius + 0.35);
  append(mesh, make_box({-reach, -0.6, high + 1.0}, {reach, 0.6, high + 1.12}));  // gangway
  for (const double y : {-0.6, 0.6})
    add_railing(mesh,
                std::array<Point3, 2>{Point3(-reach, y, high + 1.1), Point3(reach, y, high + 1.1)},
                1.1, 0.04);
  return mesh;
}

/// A spherical holder on legs, or vessels that lie on saddles.
inline TriangleMesh vessels(Draw draw, double room) {
  TriangleMesh mesh;
  if (draw.chance(0.5)) {
    const double r = draw.in(0.26, 0.36) * room;
    const Point3 c(0, 0, r + draw.in(1.6, 2.8));
    append(mesh, make_sphere(c, r, 3));
    append(mesh, make_torus(c, r + 0.25, 0.12, 48, 8));
    for (int k = 0; k < 7; ++k) {
      const Point3 p = on_circle(0.97 * r, 2.0 * kPi * k / 7, c.z());
      append(mesh, make_cylinder({p.x(), p.y(), 0}, p, 0.18, 10));
    }
    return mesh;
  }
  const int count = draw.whole(2, 3);
  for (int k = 0; k < count; ++k) {
    const double r = draw.in(0.9, 1.4), half = draw.in(0.3, 0.45) * room;
    const double y = (k - 0.5 * (count - 1)) * 0.36 * room, z = r + 0.9;
    const std::array<Point3, 6> path{Point3(-half, y, z),       Point3(-half + 0.4, y, z),
                                     Point3(-half + 1.0, y, z), Point3(half - 1.0, y, z),
                                     Point3(half - 0.4, y, z),  Point3(half, y, z)};
    append(mesh,
           make_tube(path, std::array<double, 6>{0.3 * r, 0.8 * r, r, r, 0.8 * r, 0.3 * r}, 28));
    for (const double x : {-0.55 * half, 0.55 * half})
      append(mesh, make_box({x - 0.25, y - 0.8 * r, 0}, {x + 0.25, y + 0.8 * r, 0.9 + 0.45 * r}));
    append(mesh, make_cylinder({0, y, z + 0.9 * r}, {0, y, z + r + 0.8}, 0.3, 14));
  }
  return mesh;
}
}  // namespace surfleet::detail::random_scene::plant
