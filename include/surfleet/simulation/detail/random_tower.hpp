// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated towers: tall buildings with balconies, twisted ones, pagodas, belfries.
///
/// Floors, roofs and sun blades that stand out are slabs of 10 to 25 cm or single sheets.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene {
namespace tower {
/// Boxes on a podium that step back, with balconies, niches, a crown that stands out and a mast.
inline TriangleMesh stepped(Draw draw) {
  TriangleMesh mesh;
  BoxSolid s;
  double w = draw.in(8.5, 11.0), d = draw.in(8.0, 10.5), z = 0.0;
  s.add({-0.5 * w - 1.5, -0.5 * d - 1.5, 0}, {0.5 * w + 1.5, 0.5 * d + 1.5, 2.6});
  const int blocks = draw.whole(2, 3);
  for (int b = 0; b < blocks; ++b) {
    Draw own = draw("block", b);
    const int floors = own.whole(2, blocks == 2 ? 4 : 3);
    const double storey = own.in(2.8, 3.4), top = z + 2.6 * (b == 0 ? 1.0 : 0.0) + floors * storey;
    const double base = top - floors * storey;
    s.add({-0.5 * w, -0.5 * d, z}, {0.5 * w, 0.5 * d, top});
    const int sides = own.whole(0, 3);
    for (int f = 0; f < floors; ++f) {
      const double low = base + f * storey;
      for (double x = -0.5 * w + 0.9; x + 1.2 < 0.5 * w; x += 2.1)
        for (const double y : {-0.5 * d, 0.5 * d - 0.3})
          s.cut({x, y, low + 0.9}, {x + 1.1, y + 0.3, low + 2.3});
      for (double y = -0.5 * d + 0.9; y + 1.2 < 0.5 * d; y += 2.1)
        for (const double x : {-0.5 * w, 0.5 * w - 0.3})
          s.cut({x, y, low + 0.9}, {x + 0.3, y + 1.1, low + 2.3});
      if (f == 0) continue;
      const double out = own.in(1.0, 1.9);
      const double y = sides % 2 == 0 ? -0.5 * d : 0.5 * d, far = y + (y < 0 ? -out : out);
      const double from = -0.35 * w, to = (sides < 2 ? 0.1 : 0.35) * w;
      append(mesh, make_box({from, std::min(y, far), low}, {to, std::max(y, far), low + 0.15}));
      add_railing(mesh,
                  std::array<Point3, 4>{Point3(from, y, low + 0.1), Point3(from, far, low + 0.1),
                                        Point3(to, far, low + 0.1), Point3(to, y, low + 0.1)},
                  1.1, 0.03, 1.4);
    }
    z = top;
    w *= own.in(0.7, 0.92);
    d *= own.in(0.7, 0.92);
  }
  const double out = draw.in(0.8, 1.8);
  const double x = 0.5 * w + out, y = 0.5 * d + out;
  s.add({-0.5 * w, -0.5 * d, z}, {0.5 * w, 0.5 * d, z + 1.6});
  append(mesh, s.mesh());
  append(mesh, make_box({-x, -y, z + 1.6}, {x, y, z + 1.8}));  // stands out on all sides
  append(mesh, make_cone({0, 0, z + 1.8}, {0, 0, z + draw.in(5.0, 8.0)}, 0.3, 0.06, 10));
  return mesh;
}

/// A shaft of a polygon that turns and tapers, with a slab at every storey and upright blades.
inline TriangleMesh twisted(Draw draw) {
  const int corners = draw.whole(3, 6), storeys = draw.whole(8, 12);
  const double height = 2.6, wide = draw.in(4.6, 5.8), taper = draw.in(0.55, 0.9);
  const double turn = draw.in(0.4, 2.2), bulge = draw.in(0.0, 0.2);
  const auto radius = [&](double f) {
    return wide * (1.0 - (1.0 - taper) * f + bulge * std::sin(kPi * f));
  };
  std::vector<std::vector<Point3>> rings;
  for (int k = 0; k <= storeys; ++k) {
    const double f = static_cast<double>(k) / storeys;
    rings.push_back(polygon_ring(corners, radius(f), height * k, turn * f));
  }
  const double top = height * storeys;
  TriangleMesh mesh = make_loft(rings, {0, 0, 0}, {0, 0, top});
  const double out = draw.in(0.6, 1.2);
  for (int k = 1; k <= storeys; ++k) {
    const double f = static_cast<double>(k) / storeys;
    const std::array<std::vector<Point3>, 2> slab{
        polygon_ring(corners, radius(f) + out, height * k - 0.18, turn * f),
        polygon_ring(corners, radius(f) + out, height * k, turn * f)};
    append(mesh, make_loft(slab, {0, 0, height * k - 0.18}, {0, 0, height * k}));
  }
  const int blades = draw.whole(0, 1) * corners;  // sheets before the corners of the lower half
  for (int k = 0; k < blades; ++k) {
    const double f = 0.5, angle = 2.0 * kPi * k / corners;
    append(mesh, make_wall_sheet(on_circle(radius(f) + out + 0.1, angle + 0.1, 2.6),
                                 on_circle(radius(f) + out + 0.1, angle + 0.5, 2.6), 0.4 * top));
  }
  std::vector<Point3> rim = polygon_ring(corners, radius(1.0) + 0.8 * out, top, turn);
  rim.push_back(rim.front());
  add_railing(mesh, rim, 1.1, 0.04, 1.6);
  append(mesh, make_cylinder({0, 0, top}, {0, 0, top + 3.5}, 0.12, 8));
  return mesh;
}

/// Storeys that shrink, each under a roof that overhangs and curls up: single sheets on posts.
inline TriangleMesh pagoda(Draw draw) {
  TriangleMesh mesh;
  const int storeys = draw.whole(3, 5), corners = draw.whole(4, 8);
  double radius = draw.in(3.8, 5.0), z = 1.4;
  append(mesh, make_lathe(Point3::Zero(),
                          std::array<Point2, 2>{Point2(radius + 3.5, 0), Point2(radius + 3.0, 1.4)},
                          corners));
  for (int k = 0; k < storeys; ++k) {
    const double body = draw.in(2.6, 3.4), rise = draw.in(0.9, 1.6), out = draw.in(1.5, 2.3);
    const std::array<Point2, 2> wall{Point2(radius, z), Point2(radius, z + body + rise)};
    append(mesh, make_lathe(Point3::Zero(), wall, corners));
    const double low = z + body - 0.2;
    const std::array<Point2, 4> roof{
        Point2(radius + out, low), Point2(radius + 0.6 * out, low + 0.1),
        Point2(radius + 0.2 * out, low + 0.45 * rise), Point2(0.8 * radius, low + 1.2 * rise)};
    append(mesh, make_revolved_sheet(roof, corners));
    for (int c = 0; c < corners; ++c) {
      const double angle = 2.0 * kPi * c / corners;
      append(mesh, make_cylinder(on_circle(radius + 0.7 * out, angle, z),
                                 on_circle(radius + 0.7 * out, angle, low + 0.1), 0.12, 8));
    }
    append(mesh, make_ring({0, 0, z}, 0.9 * radius, radius + 0.8 * out, 0.15, corners));
    z += body + rise;
    radius *= draw.in(0.78, 0.88);
  }
  const std::array<Point2, 5> spire{Point2(0.8 * radius, z), Point2(0.5 * radius, z + 1.0),
                                    Point2(0.15, z + 1.4), Point2(0.35, z + 2.2),
                                    Point2(0.05, z + 4.5)};
  append(mesh, make_lathe(Point3::Zero(), spire, 16));
  return mesh;
}

/// A shaft with a belfry open to four sides, a bell in it, buttresses and a pointed roof.
inline TriangleMesh belfry(Draw draw) {
  TriangleMesh mesh;
  BoxSolid s;
  const double w = draw.in(3.0, 4.0), shaft = draw.in(13.0, 19.0), room = draw.in(4.0, 5.5);
  const double arch = 0.62 * w, top = shaft + room;
  s.add({-w, -w, 0}, {w, w, top});
  s.cut({-w + 0.5, -w + 0.5, shaft}, {w - 0.5, w - 0.5, top - 0.5});
  s.cut({-arch, -w, shaft + 0.8}, {arch, w, top - 1.0})
      .cut({-w, -arch, shaft + 0.8}, {w, arch, top - 1.0});
  for (double z = 3.0; z + 2.0 < shaft; z += draw.in(3.0, 4.5))
    for (const double y : {-w, w - 0.4}) s.cut({-0.5, y, z}, {0.5, y + 0.4, z + 1.6});
  s.cut({-0.9, -w, 0}, {0.9, -w + 0.6, 2.6});
  append(mesh, s.mesh());
  const double out = draw.in(1.0, 2.0), up = draw.in(0.4, 0.7) * shaft;
  for (int k = 0; k < 4; ++k) {  // buttresses
    const Eigen::AngleAxisd turn(kPi * (0.25 + 0.5 * k), Eigen::Vector3d::UnitZ());
    const double reach = 1.42 * w;
    append(mesh, make_beam(turn * Point3(reach + out, 0, -0.0), turn * Point3(reach - 0.1, 0, up),
                           0.9, 0.9));
  }
  append(mesh, make_box({-w - 0.7, -w - 0.7, top}, {w + 0.7, w + 0.7, top + 0.25}));
  const double roof = draw.in(4.0, 8.0);
  const std::array<std::vector<Point3>, 3> rings{
      polygon_ring(4, 1.42 * w, top + 0.25, 0.25 * kPi),
      polygon_ring(4, 0.8 * w, top + 0.25 + 0.3 * roof, 0.25 * kPi),
      polygon_ring(4, 0.08, top + 0.25 + roof, 0.25 * kPi)};
  append(mesh, make_loft(rings, {0, 0, top + 0.25}, {0, 0, top + 0.25 + roof}));
  const std::array<Point2, 5> bell{Point2(1.1, 0), Point2(0.8, 0.5), Point2(0.6, 1.2),
                                   Point2(0.35, 1.5), Point2(0.05, 1.55)};
  append(mesh, placed(make_revolved_sheet(bell, 24), {0, 0, shaft + 0.6 * room - 1.0}));
  append(mesh, make_cylinder({0, 0, shaft + 0.6 * room + 0.5}, {0, 0, top - 0.4}, 0.08, 8));
  const double angle = draw.in(0.0, kPi);  // a weather vane, one sheet
  const Point3 tip(0, 0, top + roof + 0.2), along = on_circle(0.9, angle, 0);
  append(mesh, make_cylinder(tip - Point3(0, 0, 0.3), tip + Point3(0, 0, 1.6), 0.05, 6));
  append(mesh, make_wall_sheet(tip + Point3(0, 0, 0.8), tip + Point3(0, 0, 0.8) + along, 0.7));
  return mesh;
}
}  // namespace tower

inline Structure make_tower(const Draw& draw, std::uint64_t seed) {
  Draw site = draw("site");
  constexpr std::array<TriangleMesh (*)(Draw), 4> kForms{tower::stepped, tower::twisted,
                                                         tower::pagoda, tower::belfry};
  Structure made;
  made.mesh = turned_form(kForms, draw("tower"), site, seed);
  const int stones = site.whole(2, 4);  // stand free around it
  for (int k = 0; k < stones; ++k) {
    Draw own = draw("stone", k);
    const double angle = 2.0 * kPi * (k + own.in(0.0, 0.5)) / stones;
    const Point3 at = on_circle(own.in(10.5, 12.0), angle, 0);
    const double h = own.in(1.5, 3.5);
    if (own.chance(0.5))
      append(
          made.mesh,
          make_lathe(
              at, std::array<Point2, 3>{Point2(0.6, 0), Point2(0.4, h), Point2(0.9, h + 0.4)}, 16));
    else
      append(made.mesh, placed(make_wall_sheet({-1.2, 0, 0}, {1.2, 0, 0}, h), at, angle));
  }
  return made;
}
}  // namespace surfleet::detail::random_scene
