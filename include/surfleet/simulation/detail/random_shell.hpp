// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated shells: cooling towers, domes, open cylinders, canopies, vaults.
///
/// Each is a sheet without thickness or of 2 to 10 cm, open below, above or at its sides.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene {
namespace shell {
/// A hyperboloid on raking struts, open below and above.
inline TriangleMesh cooling_tower(Draw draw, double thickness) {
  const double throat = draw.in(4.2, 6.0), base = throat + draw.in(2.0, 3.5);
  const double low = draw.in(2.4, 3.2), height = draw.in(15.0, 20.0), waist = draw.in(0.65, 0.8);
  const double z0 = low + waist * (height - low);
  const double slope = std::sqrt(base * base / (throat * throat) - 1.0) / (z0 - low);
  std::vector<Point2> profile;
  for (int k = 0; k <= 24; ++k) {
    const double z = low + (height - low) * k / 24;
    profile.emplace_back(throat * std::sqrt(1.0 + std::pow((z - z0) * slope, 2)), z);
  }
  TriangleMesh mesh = thickened(make_revolved_sheet(profile, 64), thickness);
  const int struts = draw.whole(8, 12);
  for (int k = 0; k < struts; ++k)
    for (const double side : {-0.5, 0.5}) {
      const double step = 2.0 * kPi / struts;
      append(mesh, make_cylinder(on_circle(base + 0.5, step * k, 0),
                                 on_circle(base - 0.05, step * (k + side), low + 0.1), 0.18, 8));
    }
  return mesh;
}

/// Part of a sphere on a ring of columns, with an eye, and as a rule not all the way round.
inline TriangleMesh dome(Draw draw, double thickness) {
  const double radius = draw.in(7.0, 10.0), low = draw.in(2.6, 4.0), eye = draw.in(0.06, 0.3);
  const double flat = draw.in(0.6, 1.0), begin = draw.in(0.0, 0.35);
  const double arc = draw.chance(0.5) ? 2.0 * kPi : draw.in(1.3, 1.8) * kPi;
  std::vector<Point2> profile;
  for (int k = 0; k <= 16; ++k) {
    const double a = begin + (0.5 * kPi - eye - begin) * k / 16;
    profile.emplace_back(radius * std::cos(a),
                         low + flat * radius * (std::sin(a) - std::sin(begin)));
  }
  TriangleMesh mesh = thickened(make_revolved_sheet(profile, 56, 0.0, arc), thickness);
  const int columns = draw.whole(7, 11);
  for (int k = 0; k < columns; ++k) {
    const Point3 p = on_circle(profile[0].x() - 0.02, arc * (k + 0.02) / columns, 0);
    append(mesh, make_cylinder(p, p + Point3(0, 0, low + 0.15), 0.22, 10));
  }
  const double block = draw.in(0.8, 1.6), wide = draw.in(1.0, 2.5);
  append(mesh, make_cylinder({0, 0, 0}, {0, 0, block}, wide, 24));
  return mesh;
}

/// A vessel without a lid, with doorways and a slit, stiffened by rings.
inline TriangleMesh open_cylinder(Draw draw, double thickness) {
  const double radius = draw.in(5.5, 8.0), height = draw.in(7.0, 11.0);
  const double slit = draw.in(0.45, 0.7);  // half its angle [rad]: wide enough to fly in
  const std::array<Point2, 4> profile{Point2(radius, 0), Point2(radius, 0.4 * height),
                                      Point2(radius, 0.8 * height),
                                      Point2(radius * draw.in(0.8, 1.1), height)};
  const bool has_slit = draw.chance(0.6);
  TriangleMesh mesh = thickened(
      make_revolved_sheet(profile, 64, has_slit ? slit : 0.0, has_slit ? 2 * kPi - slit : 2 * kPi),
      thickness);
  for (const double f : {0.4, 0.8}) {
    const std::array<Point2, 2> brim{Point2(radius + 0.35, f * height),
                                     Point2(radius + 0.01, f * height)};
    append(mesh, make_revolved_sheet(brim, 64, slit, 2.0 * kPi - slit));
  }
  const double inner = draw.in(0.3, 0.45) * radius;
  const std::array<Point2, 2> core{Point2(inner, 0), Point2(inner, draw.in(0.5, 1.2) * height)};
  append(mesh, thickened(make_revolved_sheet(core, 40), thickness));
  return mesh;
}

/// Saddles, waves and umbrellas on posts.
inline TriangleMesh canopy(Draw draw, double thickness) {
  TriangleMesh mesh;
  const int fields = draw.whole(1, 3);
  const double span = fields == 1 ? draw.in(14.0, 18.0) : draw.in(8.0, 10.0);
  const int form = draw.whole(0, 2);
  for (int k = 0; k < fields; ++k) {
    const double h = draw.in(4.5, 6.5), bend = draw.in(1.5, 2.8) * (form == 2 ? 0.8 : 1.0);
    const double half = 0.5 * span, x0 = (k - 0.5 * (fields - 1)) * (span + 0.6);
    const auto height = [&](double x, double y) {
      const double u = (x - x0) / half, v = y / half;
      if (form == 0) return h + bend * u * v;
      if (form == 1) return h + 0.5 * bend * std::sin(2.5 * u) * std::cos(1.5 * v);
      return h + bend * (std::max(std::abs(u), std::abs(v)) - 0.5);
    };
    const Box2 area(Point2(x0 - half, -half), Point2(x0 + half, half));
    append(mesh, thickened(make_sheet(area, 20, 20, height), thickness));
    if (form == 2) {
      append(mesh, make_cylinder({x0, 0, 0}, {x0, 0, height(x0, 0)}, 0.4, 16));
      continue;
    }
    for (const double u : {-0.94, 0.94})
      for (const double v : {-0.94, 0.94}) {
        const double x = x0 + u * half, y = v * half;
        append(mesh, make_cylinder({x, y, 0}, {x, y, height(x, y)}, 0.2, 10));
      }
  }
  return mesh;
}

/// A barrel on the ground, closed or pierced at one end by a sheet with a gap.
inline TriangleMesh vault(Draw draw, double thickness) {
  const double radius = draw.in(5.0, 7.0), length = draw.in(12.0, 18.0), rise = draw.in(0.8, 1.2);
  const double ribs = draw.in(0.0, 0.35);
  std::vector<std::vector<Point3>> rows;
  for (int k = 0; k <= 28; ++k) {
    const double a = kPi * k / 28;
    rows.emplace_back();
    for (int i = 0; i <= 24; ++i) {
      const double x = length * (i / 24.0 - 0.5), r = radius + ribs * std::cos(2.0 * kPi * i / 6.0);
      rows.back().emplace_back(x, -r * std::cos(a), rise * r * std::sin(a));
    }
  }
  TriangleMesh mesh = thickened(make_rows(rows), thickness);
  const double x = 0.5 * length - 0.3, gap = draw.in(0.0, 0.3) * radius,
               tall = 0.55 * rise * radius;
  append(mesh, make_wall_sheet({x, -0.75 * radius, 0}, {x, -gap - 1.0, 0}, tall));
  append(mesh, make_wall_sheet({x, 2.6 - gap, 0}, {x, 0.75 * radius, 0}, tall));
  return mesh;
}
}  // namespace shell

inline Structure make_shell(const Draw& draw, std::uint64_t seed) {
  Draw site = draw("site");
  using Kind = TriangleMesh (*)(Draw, double);
  constexpr std::array<Kind, 5> kKinds{shell::cooling_tower, shell::dome, shell::open_cylinder,
                                       shell::canopy, shell::vault};
  const auto kind = static_cast<std::size_t>(next_form(seed, static_cast<int>(kKinds.size())));
  const bool has_thickness = site.chance(0.5);
  const double thickness = site.in(0.02, 0.10);
  Structure made;
  made.mesh = placed(kKinds[kind](draw("shell"), has_thickness ? thickness : 0.0), Point3::Zero(),
                     site.in(0.0, 2.0 * kPi));
  const int screens = site.whole(1, 3);  // free-standing sheets, curved
  for (int k = 0; k < screens; ++k) {
    Draw own = draw("screen", k);
    const double angle = 2.0 * kPi * (k + own.in(0.0, 0.5)) / screens, h = own.in(2.0, 3.5);
    const std::array<Point2, 2> profile{Point2(3.0, 0), Point2(3.0, h)};
    const double away = own.in(13.0, 14.5), yaw = own.in(0.0, 2.0 * kPi);
    append(made.mesh,
           placed(make_revolved_sheet(profile, 10, -0.4, 0.4), on_circle(away, angle, 0), yaw));
  }
  return made;
}
}  // namespace surfleet::detail::random_scene
