// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated interiors: a hall with rooms beside it, galleries, columns, racks, partitions.
///
/// The air of all rooms is one closed shell that faces inward; what stands in them are closed
/// solids and single sheets. The middle of the hall stays free for robots to start.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene {
namespace hall {
struct Layout {
  double w = 14.0, d = 10.0, h = 5.0;  ///< Of the hall, about the origin [m].
  double free = 3.2;                   ///< Half side of the free square in its middle [m].
};

/// Racks of boards on posts, tables, crates, or a machine with a hood of one sheet, on a floor
/// place about the origin that is 2 m wide and 1.6 m deep.
inline TriangleMesh furniture(Draw draw, double height) {
  TriangleMesh mesh;
  const int form = draw.whole(0, 3);
  if (form == 0) {
    const double top = std::min(height - 1.0, draw.in(1.8, 3.2));
    for (double z = 0.3; z < top; z += 0.75)
      append(mesh, make_box({-1, -0.4, z}, {1, 0.4, z + 0.04}));
    add_legs(mesh, 0.97, 0.37, top, 0.06);
    append(mesh, make_box({-0.6, -0.3, 0.34}, {draw.in(-0.2, 0.7), 0.3, 0.8}));
  } else if (form == 1) {
    append(mesh, make_box({-0.9, -0.5, 0.72}, {0.9, 0.5, 0.77}));
    add_legs(mesh, 0.8, 0.4, 0.72, 0.07);
    append(mesh,
           make_panel({-0.3, 0.3, 0.78}, {0.4, 0.3, 0.78}, {0.4, 0.35, 1.25}, {-0.3, 0.35, 1.25}));
  } else if (form == 2) {
    const double a = draw.in(0.6, 1.1), b = draw.in(0.5, 0.9);
    append(mesh, make_box({-0.9, -0.6, 0}, {0.1, 0.5, a}));
    append(mesh, placed(make_box({-0.35, -0.35, 0}, {0.35, 0.35, b}), {-0.4, -0.05, a},
                        draw.in(0.0, 1.5)));
    append(mesh, make_cylinder({0.6, 0, 0}, {0.6, 0, 1.1}, 0.32, 20));
  } else {
    append(mesh, make_box({-0.8, -0.6, 0}, {0.8, 0.6, 1.1}));
    const double low = draw.in(1.7, 2.1);
    const std::array<std::vector<Point3>, 2> hood{polygon_ring(4, 1.1, low, 0.25 * kPi),
                                                  polygon_ring(4, 0.25, low + 0.6, 0.25 * kPi)};
    append(mesh, make_rows(hood, true));
    append(mesh, make_cylinder({0, 0, low + 0.55}, {0, 0, height - 0.05}, 0.16, 12));
  }
  return mesh;
}

/// Rooms along a side of the hall, joined to it by doorways through walls 20 cm thick.
inline void add_rooms(BoxSolid& air, TriangleMesh& mesh, Draw draw, const Layout& l, double side) {
  const int rooms = draw.whole(1, 3);
  const double deep = draw.in(3.6, 5.0), high = std::min(l.h, draw.in(2.8, 3.6));
  const auto wall = [&](int k) { return l.w * (static_cast<double>(k) / rooms - 0.5); };
  const double near = side * (0.5 * l.d + 0.2), far = near + side * deep;
  for (int k = 0; k < rooms; ++k) {
    Draw own = draw("room", k);
    const double west = wall(k) + 0.1, east = wall(k + 1) - 0.1;
    air.add({west, std::min(near, far), 0}, {east, std::max(near, far), high});
    const double door = own.in(1.7, 2.2), x = own.in(west + 0.4, east - door - 0.4);
    air.add({x, std::min(near, side * 0.5 * l.d), 0},
            {x + door, std::max(near, side * 0.5 * l.d), 2.4});
    const double y = 0.5 * (near + far) + side * (0.5 * deep - 0.9);
    append(mesh, placed(furniture(own("furniture"), high), {own.in(west + 1.3, east - 1.3), y, 0}));
    if (rooms > 1 && k > 0 && own.chance(0.5))  // from room to room
      air.add({wall(k) - 0.1, 0.5 * (near + far) - 0.9, 0}, {west, 0.5 * (near + far) + 0.9, 2.3});
  }
}

/// A slab along the north wall on columns, with a railing.
inline void add_gallery(TriangleMesh& mesh, Draw draw, const Layout& l) {
  const double z = draw.in(2.5, 2.9), deep = std::min(2.2, 0.5 * l.d - l.free);
  const double edge = 0.5 * l.d - deep, from = -0.5 * l.w + 0.02, to = draw.in(0.1, 0.48) * l.w;
  append(mesh, make_box({from, edge, z}, {to, 0.5 * l.d - 0.02, z + 0.15}));
  add_railing(mesh,
              std::array<Point3, 3>{Point3(from + 0.1, edge + 0.05, z + 0.1),
                                    Point3(to - 0.05, edge + 0.05, z + 0.1),
                                    Point3(to - 0.05, 0.5 * l.d - 0.1, z + 0.1)},
              1.0, 0.03, 1.2);
  for (double x = from + 0.5; x < to; x += 3.2)
    append(mesh, make_cylinder({x, edge + 0.2, 0}, {x, edge + 0.2, z}, 0.12, 12));
}

/// Beams under the ceiling, lamps that hang from it, and perhaps a crane's bridge.
inline void add_ceiling(TriangleMesh& mesh, Draw draw, const Layout& l) {
  const int beams = draw.whole(2, 4);
  const double deep = draw.in(0.2, 0.4);
  for (int k = 0; k < beams; ++k) {
    const double x = l.w * ((k + 0.5) / beams - 0.5);
    append(mesh, make_box({x - 0.1, -0.5 * l.d + 0.01, l.h - deep},
                          {x + 0.1, 0.5 * l.d - 0.01, l.h - 0.01}));
  }
  const int lamps = draw.whole(1, 4);
  for (int k = 0; k < lamps; ++k) {
    const double x = l.w * ((k + 1.0) / beams - 0.5), y = draw.in(-0.35, 0.35) * l.d;
    if (std::abs(x) > 0.45 * l.w || std::max(std::abs(x), std::abs(y)) < l.free) continue;
    append(mesh, make_cylinder({x, y, l.h - 0.9}, {x, y, l.h - 0.02}, 0.03, 6));
    const std::array<Point2, 3> shade{Point2(0.45, 0), Point2(0.3, 0.2), Point2(0.05, 0.28)};
    append(mesh, placed(make_revolved_sheet(shade, 20), {x, y, l.h - 1.15}));
  }
}
}  // namespace hall

inline Structure make_hall(const Draw& draw, std::uint64_t seed) {
  Draw site = draw("site");
  hall::Layout l;
  l.w = site.in(11.0, 16.0);
  l.d = site.in(8.5, 11.0);
  l.h = site.in(4.0, 6.0);
  Structure made;
  made.indoors = true;
  BoxSolid air;
  air.add({-0.5 * l.w, -0.5 * l.d, 0}, {0.5 * l.w, 0.5 * l.d, l.h});
  const int sides = next_form(seed, 3);  // with rooms beside them: none, one, both
  if (sides > 0) hall::add_rooms(air, made.mesh, draw("south"), l, -1.0);
  if (sides > 1) hall::add_rooms(air, made.mesh, draw("north"), l, 1.0);
  for (double x = -0.5 * l.w + site.in(1.0, 2.0); x < 0.5 * l.w - 0.8; x += 2.5) {  // wall recesses
    air.add({x, 0.5 * l.d, l.h - 1.2}, {x + 1.1, 0.5 * l.d + 0.15, l.h - 0.4});
  }
  const bool columns = site.chance(0.6), gallery = site.chance(0.5);
  if (columns)
    for (const double x : {-0.5 * l.w + 1.6, 0.5 * l.w - 1.6})
      for (const double y : {-l.free - 0.3, l.free + 0.3})
        append(made.mesh, make_cylinder({x, y, 0.01}, {x, y, l.h - 0.01}, 0.25, 16));
  if (gallery && sides < 2) hall::add_gallery(made.mesh, draw("gallery"), l);
  hall::add_ceiling(made.mesh, draw("ceiling"), l);
  Draw floor = draw("floor");
  for (const double side : {-1.0, 1.0}) {  // furniture at the ends, partitions of one sheet
    const double x = side * (0.5 * l.w - 1.1);
    const int pieces = floor.whole(1, 2);
    for (int k = 0; k < pieces; ++k)
      append(made.mesh, placed(hall::furniture(floor("piece", k + (side > 0 ? 10 : 0)), l.h),
                               {x, (k == 0 ? -0.2 : 0.22) * l.d, 0}, 0.5 * kPi));
    const double at = side * (l.free + floor.in(0.0, 0.3)), y = floor.in(-0.1, 0.1) * l.d;
    if (floor.chance(0.7) && 0.5 * l.w - std::abs(at) > 1.8)
      append(made.mesh,
             make_wall_sheet({at, y - 0.05, 0.05}, {at, y + 0.3 * l.d, 0.05}, floor.in(1.4, 2.6)));
  }
  TriangleMesh shell = air.mesh();
  for (Triangle& t : shell.triangles) std::swap(t[0], t[1]);
  append(made.mesh, shell);
  return made;
}
}  // namespace surfleet::detail::random_scene
