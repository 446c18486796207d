// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated industrial plants: plots of halls, tanks, silos, chimneys, vessels, shelters.
///
/// Two rows of plots with an aisle between them that carries a pipe rack. Roofs of halls, shelters
/// and tanks without a lid are single sheets; each plot draws from its own stream.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>
#include <surfleet/simulation/detail/random_vessels.hpp>

namespace surfleet::detail::random_scene {
namespace plant {
/// A gable roof of two sheets that overhang the walls.
inline void add_gable(TriangleMesh& mesh, double w, double d, double z, double rise, double eaves) {
  const double drop = rise * eaves / (0.5 * d);
  const Point3 west(-0.5 * w - eaves, 0, z + rise), east(0.5 * w + eaves, 0, z + rise);
  const double y = 0.5 * d + eaves;
  append(mesh, make_panel({west.x(), -y, z - drop}, {east.x(), -y, z - drop}, east, west));
  append(mesh, make_panel(west, east, {east.x(), y, z - drop}, {west.x(), y, z - drop}));
}

/// A hall with niches for windows, gates, and a sheet roof above a gap or a flat roof with a
/// monitor.
inline TriangleMesh building(Draw draw, double room) {
  const double w = draw.in(0.7, 0.95) * room, d = draw.in(0.55, 0.85) * room;
  const double h = draw.in(4.0, 8.0);
  BoxSolid s;
  s.add({-0.5 * w, -0.5 * d, 0}, {0.5 * w, 0.5 * d, h});
  const double pitch = draw.in(1.8, 2.8), sill = draw.in(1.0, 2.0);
  for (double x = -0.5 * w + 0.6; x + 1.2 < 0.5 * w; x += pitch)
    for (const double y : {-0.5 * d, 0.5 * d - 0.35})
      s.cut({x, y, sill}, {x + 1.0, y + 0.35, h - 1});
  const double gate = draw.in(-0.2, 0.2) * d;
  s.cut({-0.5 * w, gate - 1.4, 0}, {-0.5 * w + 0.5, gate + 1.4, 3.2});
  const bool gabled = draw.chance(0.6);
  const double rise = draw.in(1.0, 2.2), eaves = draw.in(0.4, 1.2);
  if (!gabled) {
    s.cut({-0.5 * w + 0.3, -0.5 * d + 0.3, h - 0.5}, {0.5 * w - 0.3, 0.5 * d - 0.3, h});
    s.add({-0.3 * w, -0.15 * d, h - 0.5}, {0.3 * w, 0.15 * d, h + 1.2});
  }
  TriangleMesh mesh = s.mesh();
  if (gabled) {
    add_gable(mesh, w, d, h, rise, eaves);
    const std::array<Point2, 3> gable{Point2(-0.5 * d, h - 0.3), Point2(0.5 * d, h - 0.3),
                                      Point2(0, h + rise - 0.15)};
    Pose T = Pose::Identity();  // its plane is y-z
    T.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    append(mesh, transformed(make_prism(gable, -0.5 * w, 0.5 * w), T));
  }
  const double x = draw.in(-0.3, 0.1) * w;  // a sheet over the loading place
  append(mesh, make_panel({x, -0.5 * d - 1.8, 3.4}, {x + 3.5, -0.5 * d - 1.8, 3.4},
                          {x + 3.5, -0.5 * d, 3.8}, {x, -0.5 * d, 3.8}));
  return mesh;
}

/// Flues of one or several heights with platforms, some of them held by guys.
inline TriangleMesh chimneys(Draw draw, double room) {
  TriangleMesh mesh;
  const int count = draw.whole(1, 3);
  for (int k = 0; k < count; ++k) {
    const double h = draw.in(11.0, 19.0), base = draw.in(0.8, 1.5),
                 top = draw.in(0.55, 0.75) * base;
    const Point3 at((k - 0.5 * (count - 1)) * 0.34 * room, 0, 0);
    const std::array<Point2, 6> profile{
        Point2(base, 0),       Point2(top, h - 0.4),  Point2(1.15 * top, h - 0.3),
        Point2(1.15 * top, h), Point2(0.75 * top, h), Point2(0.7 * top, h - 1.5)};
    append(mesh, make_lathe(at, profile, 36));
    const double z = draw.in(0.55, 0.8) * h, r = base + (top - base) * z / h;
    append(mesh, make_ring(at + Point3(0, 0, z), 0.9 * r, r + 0.9, 0.12));
    add_railing(mesh, circle(at + Point3(0, 0, z + 0.1), r + 0.8, 10), 1.1, 0.05);
    if (draw.chance(0.4))
      for (int g = 0; g < 3; ++g)
        append(mesh, make_cylinder(at + on_circle(0.4 * room, kPi * (0.5 + 2.0 * g / 3), 0),
                                   at + Point3(0, 0, 0.9 * h), 0.05, 6));
  }
  return mesh;
}

/// A sheet roof on columns, flat, vaulted or folded, over heaps and crates.
inline TriangleMesh shelter(Draw draw, double room) {
  const double w = draw.in(0.7, 0.95) * room, d = draw.in(0.5, 0.8) * room, h = draw.in(4.0, 6.0);
  const double rise = draw.in(0.0, 1.8);
  const int waves = draw.chance(0.4) ? 3 : 1;
  TriangleMesh mesh = make_sheet(
      Box2(Point2(-0.5 * w - 0.8, -0.5 * d - 0.8), Point2(0.5 * w + 0.8, 0.5 * d + 0.8)), 12, 24,
      [&](double, double y) { return h + rise * std::abs(std::cos(waves * kPi * y / (d + 1.6))); });
  for (double x = -0.5 * w; x <= 0.5 * w + 1e-9; x += 0.5 * w)
    for (const double y : {-0.5 * d, 0.5 * d}) {
      append(mesh, make_beam({x, y, 0}, {x, y, h + 0.05}, 0.25, 0.25));
      append(mesh, make_beam({x, y, h - 1.2}, {x, 0.7 * y, h - 0.05}, 0.12, 0.12));
    }
  const double heap = draw.in(1.2, 2.2);
  append(mesh, make_cone({-0.22 * w, 0, 0}, {-0.22 * w, 0, heap}, 1.3 * heap, 0.1, 24));
  append(mesh, make_box({0.1 * w, -1, 0}, {0.1 * w + 2.0, 1, 1.4}));
  return mesh;
}

/// Cooling cells: a louvred box with open stacks on it.
inline TriangleMesh coolers(Draw draw, double room) {
  const double w = 0.45 * room, d = draw.in(0.2, 0.3) * room, h = draw.in(3.0, 5.0);
  BoxSolid s;
  s.add({-w, -d, 0}, {w, d, h});
  for (double x = -w + 0.5; x + 0.8 < w; x += 1.5)
    for (const double y : {-d, d - 0.6}) s.cut({x, y, 0.7}, {x + 0.9, y + 0.6, h - 0.7});
  TriangleMesh mesh = s.mesh();
  const int stacks = draw.whole(2, 3);
  const double r = std::min(0.75 * w / stacks, 0.85 * d);
  const std::array<Point2, 3> profile{Point2(r, 0), Point2(0.85 * r, 0.8), Point2(r, 1.7)};
  for (int k = 0; k < stacks; ++k)
    append(mesh, placed(make_revolved_sheet(profile, 32),
                        {(k - 0.5 * (stacks - 1)) * 2.0 * w / stacks, 0, h - 0.1}));
  return mesh;
}

/// Pipes on portals along the aisle, some of them with loops; free posts without pipes at an end.
inline void add_rack(TriangleMesh& mesh, Draw draw, double half) {
  const double height = draw.in(4.6, 6.2), wide = draw.in(0.8, 1.2);
  const int frames = static_cast<int>(half / 2.2);
  for (int k = 0; k <= frames; ++k) {
    const double x = half * (2.0 * k / frames - 1.0);
    for (const double y : {-wide, wide})
      append(mesh, make_beam({x, y, 0}, {x, y, height}, 0.24, 0.24));
    append(mesh, make_beam({x, -wide, height - 0.3}, {x, wide, height - 0.3}, 0.2, 0.2));
  }
  const int pipes = draw.whole(3, 5);
  for (int k = 0; k < pipes; ++k) {
    const double y = wide * (2.0 * (k + 0.5) / pipes - 1.0), r = draw.in(0.08, 0.2);
    const double z = height - 0.18 + r, at = draw.in(-0.6, 0.4) * half, up = draw.in(0.8, 1.6);
    if (draw.chance(0.4))
      append(mesh,
             make_tube(std::array<Point3, 6>{Point3(-half - 0.4, y, z), Point3(at, y, z),
                                             Point3(at, y, z + up), Point3(at + 1.5, y, z + up),
                                             Point3(at + 1.5, y, z), Point3(half, y, z)},
                       r, 12));
    else
      append(mesh, make_cylinder({-half - 0.4, y, z}, {half, y, z}, r, 12));
  }
}
}  // namespace plant

inline Structure make_plant(const Draw& draw, std::uint64_t /*seed*/) {
  using Plot = TriangleMesh (*)(Draw, double);
  std::array<Plot, 7> plots{plant::building, plant::tank_farm, plant::chimneys, plant::silos,
                            plant::vessels,  plant::shelter,   plant::coolers};
  Draw site = draw("site");
  site.shuffle(plots);
  const int columns = site.whole(2, 3);
  const double pitch = site.in(10.5, 12.5), aisle = site.in(5.0, 7.0);
  Structure made;
  for (int k = 0; k < 2 * columns; ++k) {
    const int column = k / 2, row = k % 2;
    const Point3 at((column - 0.5 * (columns - 1)) * pitch,
                    (row == 0 ? -0.5 : 0.5) * (aisle + 0.85 * pitch), 0);
    Draw own = draw("plot", k);
    const double yaw = own.chance(0.5) ? 0.0 : kPi;
    append(made.mesh,
           placed(plots[static_cast<std::size_t>(k)](own("equipment"), 0.8 * pitch), at, yaw));
  }
  plant::add_rack(made.mesh, draw("rack"), 0.5 * columns * pitch);
  Draw fence = draw("fence");  // free-standing sheets with a gap
  const double y = -0.5 * aisle - 0.95 * pitch - 1.0, x = 0.5 * columns * pitch;
  const double gap = fence.in(-0.5, 0.2) * x, height = fence.in(1.8, 2.6);
  append(made.mesh, make_wall_sheet({-x, y, 0}, {gap, y, 0}, height));
  append(made.mesh, make_wall_sheet({gap + 4.0, y, 0}, {x, y, 0}, height));
  return made;
}
}  // namespace surfleet::detail::random_scene
