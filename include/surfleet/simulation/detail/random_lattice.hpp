// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated steel lattices: masts, pylons with arms, tower cranes, water towers on legs.
///
/// Every member is 5 to 15 cm thick: round or square bars, or angles of two single sheets.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene {
namespace lattice {
constexpr double kThinnest = 0.05, kThickest = 0.15;  // [m]

enum class Section { round, square, angle };

/// What members of one lattice have in common.
struct Steel {
  Section section = Section::round;
  double chord = 0.14, brace = 0.08;  ///< Thickness [m].
};
inline Steel draw_steel(Draw draw) {
  Steel s;
  s.section = static_cast<Section>(draw.whole(0, 2));
  s.chord = draw.in(0.10, kThickest);
  s.brace = draw.in(kThinnest, 0.10);
  return s;
}

inline TriangleMesh member(const Point3& a, const Point3& b, double thickness, Section section) {
  if (section == Section::round) return make_cylinder(a, b, 0.5 * thickness, 8);
  if (section == Section::square) return make_beam(a, b, thickness, thickness);
  const auto [u, v] = frame_around((b - a).normalized());
  const std::array<std::vector<Point3>, 3> rows{
      {{a + thickness * u, b + thickness * u}, {a, b}, {a + thickness * v, b + thickness * v}}};
  return make_rows(rows);
}

/// Corners of a level cross-section.
using Ring = std::vector<Point3>;

/// Chords through consecutive rings, and between them horizontals and diagonals, single or crossed.
inline void add_truss(TriangleMesh& mesh, std::span<const Ring> rings, const Steel& steel,
                      bool crossed) {
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const std::size_t n = rings[r].size();
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t next = (k + 1) % n;
      append(mesh, member(rings[r][k], rings[r][next], steel.brace, steel.section));
      if (r + 1 == rings.size()) continue;
      append(mesh, member(rings[r][k], rings[r + 1][k], steel.chord, steel.section));
      if (crossed || (r + k) % 2 == 0)
        append(mesh, member(rings[r][k], rings[r + 1][next], steel.brace, steel.section));
      if (crossed || (r + k) % 2 != 0)
        append(mesh, member(rings[r][next], rings[r + 1][k], steel.brace, steel.section));
    }
  }
}

/// Rings of a mast that narrows from `base` to `head` (half diagonals) up to `height`.
inline std::vector<Ring> mast_rings(int corners, double base, double head, double height,
                                    double bend) {
  std::vector<Ring> rings;
  double z = 0.0;
  while (true) {
    const double f = z / height, r = base + (head - base) * std::pow(f, bend);
    rings.push_back(polygon_ring(corners, r, z, kPi / corners));
    if (z >= height) break;
    z += std::max(1.1, 1.5 * r);
    if (z > height - 0.8) z = height;
  }
  return rings;
}

/// A platform of one thin sheet with a railing.
inline void add_platform(TriangleMesh& mesh, double radius, double z, const Steel& steel) {
  std::vector<Point3> rim = polygon_ring(4, radius, z, 0.25 * kPi);
  append(mesh, make_panel(rim[0], rim[1], rim[2], rim[3]));
  rim.push_back(rim.front());
  add_railing(mesh, rim, 1.1, 0.5 * std::max(kThinnest, 0.8 * steel.brace), 1.2);
}

/// A mast with platforms, antennas and round dishes of one sheet.
inline TriangleMesh radio_mast(Draw draw) {
  TriangleMesh mesh;
  const Steel steel = draw_steel(draw("steel"));
  const int corners = draw.whole(3, 4);
  const double height = draw.in(14.0, 22.0), base = draw.in(1.8, 2.8), head = draw.in(0.5, 0.8);
  const double bend = draw.in(0.6, 1.1);
  const bool crossed = draw.chance(0.6);
  add_truss(mesh, mast_rings(corners, base, head, height, bend), steel, crossed);
  add_platform(mesh, 1.5, draw.in(0.55, 0.7) * height, steel);
  add_platform(mesh, 1.2, height, steel);
  append(mesh, member({0, 0, height}, {0, 0, height + 3.0}, 0.08, Section::round));
  const int dishes = draw.whole(2, 4);
  for (int k = 0; k < dishes; ++k) {
    Draw own = draw("dish", k);
    const double z = own.in(0.72, 0.95) * height, angle = own.in(0.0, 2.0 * kPi),
                 r = own.in(0.4, 0.8);
    const double away = head + 0.5;
    const std::array<Point2, 4> bowl{Point2(0.05, 0), Point2(0.5 * r, 0.08 * r),
                                     Point2(0.8 * r, 0.22 * r), Point2(r, 0.36 * r)};
    Pose T = Pose::Identity();
    T.translation() = on_circle(away, angle, z);
    T.linear() = (Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitY()))
                     .toRotationMatrix();
    append(mesh, transformed(make_revolved_sheet(bowl, 20), T));
    append(mesh, member(on_circle(0.5 * head, angle, z), on_circle(away, angle, z), 0.08,
                        Section::round));
  }
  return mesh;
}

/// A mast with two or three pairs of arms, insulators, and wires' stubs.
inline TriangleMesh pylon(Draw draw) {
  TriangleMesh mesh;
  const Steel steel = draw_steel(draw("steel"));
  const double height = draw.in(16.0, 22.0), head = 0.6;
  const double base = draw.in(2.2, 3.0), bend = draw.in(0.55, 0.8);
  const auto rings = mast_rings(4, base, head, height, bend);
  add_truss(mesh, rings, steel, draw.chance(0.7));
  const int arms = draw.whole(2, 3);
  for (int k = 0; k < arms; ++k) {
    const double z = height - 1.2 - 3.0 * k, reach = draw.in(2.6, 4.6);
    for (const double side : {-1.0, 1.0}) {
      const Point3 tip(side * reach, 0, z);
      std::array<Point3, 4> root;
      for (int c = 0; c < 4; ++c)
        root[static_cast<std::size_t>(c)] =
            Point3(side * 0.5, c % 2 == 0 ? -0.5 : 0.5, z + (c < 2 ? 0.0 : 0.9));
      for (const Point3& p : root) append(mesh, member(p, tip, steel.brace, steel.section));
      for (const double f : {0.33, 0.66}) {
        std::array<Point3, 4> q;
        for (std::size_t c = 0; c < 4; ++c) q[c] = root[c] + f * (tip - root[c]);
        append(mesh, member(q[0], q[1], steel.brace, steel.section));
        append(mesh, member(q[0], q[2], steel.brace, steel.section));
        append(mesh, member(q[1], q[3], steel.brace, steel.section));
      }
      append(mesh, member(tip, tip - Point3(0, 0, 1.3), 0.1, Section::round));
      append(mesh, member(tip - Point3(0, 1.0, 1.3), tip + Point3(0, 1.0, -1.3), kThinnest,
                          Section::round));
    }
  }
  return mesh;
}

/// A tower crane: mast, jib, counter jib with weights of 15 cm plates, stays, hook.
inline TriangleMesh crane(Draw draw) {
  TriangleMesh mesh;
  const Steel steel = draw_steel(draw("steel"));
  const double height = draw.in(11.0, 16.0), reach = draw.in(10.0, 15.0), back = 0.35 * reach;
  add_truss(mesh, mast_rings(4, 1.1, 1.1, height, 1.0), steel, draw.chance(0.5));
  const auto boom = [&](double from, double to, double deep) {
    std::vector<Ring> rings;
    const int bays = std::max(2, static_cast<int>(std::abs(to - from) / 1.4));
    for (int k = 0; k <= bays; ++k) {
      const double x = from + (to - from) * k / bays;
      rings.push_back({{x, -0.6, height}, {x, 0.6, height}, {x, 0, height + deep}});
    }
    add_truss(mesh, rings, steel, false);
  };
  boom(-0.8, reach, 1.1);
  boom(-0.8, -back, 0.9);
  const Point3 peak(0, 0, height + 3.6);
  for (const double x : {-0.7, 0.7})
    for (const double y : {-0.6, 0.6})
      append(mesh, member({x, y, height}, peak, steel.chord, steel.section));
  for (const double x : {0.5 * reach, 0.85 * reach, -0.9 * back})
    append(mesh, member(peak, {x, 0, height + 1.0}, kThinnest, Section::round));
  for (int k = 0; k < 5; ++k)
    append(mesh,
           make_box({-back + 0.3 * k, -0.6, height - 1.4}, {-back + 0.3 * k + 0.15, 0.6, height}));
  const double x = draw.in(0.4, 0.9) * reach, hook = draw.in(0.4, 0.7) * height;
  append(mesh, make_box({x - 0.4, -0.5, height - 0.2}, {x + 0.4, 0.5, height - 0.05}));
  append(mesh, member({x, 0, height - 0.1}, {x, 0, hook}, kThinnest, Section::round));
  append(mesh, make_sphere({x, 0, hook}, 0.25, 2));
  append(mesh,
         make_panel({0.9, -1.0, height - 1.9}, {0.9, 0.2, height - 1.9}, {0.9, 0.2, height - 0.3},
                    {0.9, -1.0, height - 0.3}));  // the cabin's window
  return mesh;
}

/// A tank or a look-out on raking legs.
inline TriangleMesh water_tower(Draw draw) {
  TriangleMesh mesh;
  const Steel steel = draw_steel(draw("steel"));
  const double height = draw.in(9.0, 13.0), head = draw.in(1.5, 2.0);
  const int corners = draw.whole(4, 6);
  add_truss(mesh, mast_rings(corners, head + draw.in(0.6, 1.4), head, height, 1.0), steel, true);
  const double r = head + draw.in(0.1, 0.5), tall = draw.in(1.8, 3.0);
  const std::array<Point2, 5> tank{
      Point2(0.1, height - 0.3), Point2(r, height + 0.4), Point2(r, height + 0.4 + tall),
      Point2(1.12 * r, height + 0.4 + tall), Point2(0.05, height + 1.2 + tall)};
  append(mesh, make_revolved_sheet(tank, 32));
  append(mesh, make_ring({0, 0, height + 0.1}, 0.95 * r, r + 0.8, 0.08, 24));
  add_railing(mesh, circle({0, 0, height + 0.15}, r + 0.72, 12), 1.1, 0.5 * kThinnest, 1.0);
  append(mesh, member({0, 0, 0}, {0, 0, height}, kThickest, Section::round));
  return mesh;
}
}  // namespace lattice

inline Structure make_lattice(const Draw& draw, std::uint64_t seed) {
  Draw site = draw("site");
  constexpr std::array<TriangleMesh (*)(Draw), 4> kForms{lattice::radio_mast, lattice::pylon,
                                                         lattice::crane, lattice::water_tower};
  Structure made;
  made.mesh = turned_form(kForms, draw("lattice"), site, seed);
  const int cabins = site.whole(1, 2);  // stand free beside it, one with a sheet for a roof
  for (int k = 0; k < cabins; ++k) {
    const double angle = site.in(0.0, 2.0 * kPi), h = site.in(1.6, 2.4);
    const Point3 at = on_circle(site.in(4.8, 6.0), angle + kPi * k, 0);
    append(made.mesh, placed(make_box({-1.0, -0.8, 0}, {1.0, 0.8, h}), at, angle));
    append(made.mesh, placed(make_panel({-1.3, -1.1, h + 0.15}, {1.3, -1.1, h + 0.15},
                                        {1.3, 1.1, h + 0.4}, {-1.3, 1.1, h + 0.4}),
                             at, angle));
  }
  return made;
}
}  // namespace surfleet::detail::random_scene
