// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated hulls on stands: ships, submarines, aircraft.
///
/// Bilge keels, rudders, propeller blades, fins and engine cowls are single sheets or a few
/// centimetres thick.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <surfleet/simulation/detail/random_aircraft.hpp>
#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene {
namespace hull {
/// Blocks and raking props under a body whose keel lies at `z`.
inline void add_stands(TriangleMesh& mesh, double from, double to, int count, double z,
                       double spread, double contact) {
  for (int k = 0; k < count; ++k) {
    const double x = from + (to - from) * k / (count - 1);
    append(mesh, make_box({x - 0.4, -0.5, 0}, {x + 0.4, 0.5, z + 0.1}));
    for (const double side : {-1.0, 1.0})
      append(mesh,
             make_beam({x, side * (spread + 0.8), 0}, {x, side * spread, contact}, 0.18, 0.18));
  }
}

/// A ship in a dock: flared hull, deck house, funnel, mast, keels, rudder, propellers.
inline TriangleMesh ship(Draw draw) {
  TriangleMesh mesh;
  const double length = draw.in(22.0, 32.0), beam = draw.in(0.2, 0.25) * length,
               deep = draw.in(3.4, 4.6);
  const double keel = draw.in(1.6, 2.2), flare = draw.in(0.75, 1.0), sheer = draw.in(0.4, 1.2);
  std::vector<std::vector<Point3>> rings;
  constexpr int kStations = 20;
  for (int i = 0; i <= kStations; ++i) {
    const double s = static_cast<double>(i) / kStations;  // from the stern to the bow
    const double full =
        std::max(0.03, (s < 0.35 ? 0.72 + 0.28 * std::sin(0.5 * kPi * s / 0.35)
                                 : std::pow(std::cos(0.5 * kPi * (s - 0.35) / 0.65), 0.75)));
    const double rake = s > 0.8 ? std::pow((s - 0.8) / 0.2, 2) : 0.0,
                 rise = s < 0.3 ? std::pow((0.3 - s) / 0.3, 2) : 0.0;
    const double low = keel + 0.55 * deep * rise,
                 top = keel + deep + sheer * std::pow(2.0 * s - 0.9, 2);
    std::vector<Point3> ring;
    for (int k = 0; k <= 10; ++k) {  // one rail, the keel, the other rail
      const double a = kPi * k / 10, up = 1.0 - std::pow(std::sin(a), 1.6);
      const double half = 0.5 * beam * full * (flare + (1.0 - flare) * up) * std::cos(a);
      ring.emplace_back(length * (s - 0.5) + rake * up * 1.5, -half, low + (top - low) * up);
    }
    rings.push_back(ring);
  }
  const Point3 stern = 0.5 * (rings.front().front() + rings.front()[5]),
               bow = 0.5 * (rings.back().front() + rings.back()[5]);
  mesh = make_loft(rings, stern, bow);
  const double deck = keel + deep + 0.35 * sheer;
  BoxSolid house;  // its lowest storey reaches into the hull
  const double aft = -0.3 * length, storey = 2.4;
  const int decks = draw.whole(1, 2);
  for (int k = 0; k < decks; ++k) {
    const double low = deck + k * storey, high = low + storey, in = 0.35 * k;
    const double fore = aft + 0.24 * length - 1.4 * k;
    house.add({aft - 1.5 + in, -0.3 * beam + in, low - (k == 0 ? 0.8 : 0.0)},
              {fore, 0.3 * beam - in, high});
    append(mesh, make_box({aft - 1.7, -0.42 * beam, high}, {fore + 0.8, 0.42 * beam, high + 0.08}));
  }
  append(mesh, house.mesh());
  const double top = deck + decks * storey;
  const std::array<Point2, 3> funnel{Point2(0.9, 0), Point2(0.7, 1.2), Point2(0.75, 2.4)};
  append(mesh, placed(make_revolved_sheet(funnel, 28), {aft + 0.4, 0, top + 0.05}));
  const double mast = draw.in(3.5, 6.0), mid = draw.in(0.05, 0.25) * length;
  append(mesh, make_cone({mid, 0, deck - 0.6}, {mid, 0, deck + mast}, 0.2, 0.08, 10));
  append(mesh, make_cylinder({mid, -0.3 * beam, deck + 0.7 * mast},
                             {mid, 0.3 * beam, deck + 0.7 * mast}, 0.06, 8));
  for (const double side : {-1.0, 1.0}) {
    std::vector<Point3> rail;
    for (std::size_t i = 2; i < kStations; i += 2) {
      const Point3& p = side > 0 ? rings[i].front() : rings[i].back();
      rail.emplace_back(p.x(), 0.96 * p.y(), p.z());
    }
    add_railing(mesh, rail, 1.0, 0.035, 3.0);
    const double z = keel + 0.35 * deep, y = side * 0.5 * beam * (0.93 * flare);
    append(mesh, make_panel({-0.2 * length, y, z}, {0.18 * length, y, z},
                            {0.18 * length, y + side * 0.7, z - 0.5},
                            {-0.2 * length, y + side * 0.7, z - 0.5}));
  }
  const Point3 shaft(-0.44 * length, 0, keel + 0.2 * deep);
  const double screw = draw.in(0.8, 1.1);
  add_propeller(mesh, shaft, screw, draw.whole(3, 5), 0.3);
  append(mesh, make_cylinder(shaft, shaft + Point3(0.16 * length, 0, 0), 0.14, 12));
  const double x = -0.5 * length + 0.1;
  append(mesh, make_wall_sheet({x, 0, keel}, {x + 0.05 * length, 0, keel}, 0.6 * deep));  // rudder
  add_stands(mesh, -0.25 * length, 0.2 * length, 4, keel, 0.42 * beam, keel + 0.35 * deep);
  return mesh;
}

/// A body of revolution with a sail, planes, a cross of rudders, and a screw in a ring.
inline TriangleMesh submarine(Draw draw) {
  TriangleMesh mesh;
  const double length = draw.in(22.0, 30.0), radius = draw.in(1.7, 2.4),
               z = radius + draw.in(1.4, 2.0);
  std::vector<Point3> axis;
  std::vector<double> radii;
  for (int k = 0; k <= 24; ++k) {
    const double s = k / 24.0, u = s < 0.3 ? (0.3 - s) / 0.3 : s > 0.8 ? (s - 0.8) / 0.2 : 0.0;
    axis.emplace_back(length * (s - 0.5), 0, z);
    radii.push_back(
        std::max(0.12, radius * (s < 0.3 ? 1.0 - std::pow(u, 1.7) : std::sqrt(1.0 - u * u))));
  }
  append(mesh, make_tube(axis, radii, 36));
  const double sail = draw.in(0.08, 0.2) * length, tall = draw.in(1.6, 2.6),
               chord = draw.in(3.0, 4.5);
  append(mesh,
         make_fin(
             {Point3(sail + chord, 0, z + 0.8 * radius), Point3(sail, 0, z + 0.8 * radius)},
             {Point3(sail + chord - 0.5, 0, z + radius + tall), Point3(sail, 0, z + radius + tall)},
             Eigen::Vector3d::UnitY(), 1.6));
  for (const double y : {-0.3, 0.2})
    append(mesh, make_cylinder({sail + 0.5 * chord, y, z + radius},
                               {sail + 0.5 * chord, y, z + radius + tall + 1.6}, 0.08, 8));
  const bool diagonal = draw.chance(0.5);
  const double reach = draw.in(1.1, 1.4) * radius, stern = -0.44 * length;
  for (int k = 0; k < 4; ++k) {
    const double a = 0.5 * kPi * k + (diagonal ? 0.25 * kPi : 0.0);
    const Eigen::Vector3d out(0, std::cos(a), std::sin(a)), across(0, -std::sin(a), std::cos(a));
    const Point3 base = Point3(stern, 0, z) + 0.15 * out, end = Point3(stern, 0, z) + reach * out;
    append(mesh, make_fin({base + Point3(2.0, 0, 0), base}, {end + Point3(1.2, 0, 0), end}, across,
                          0.16));
  }
  for (const double side : {-1.0, 1.0})  // planes of one sheet
    append(mesh, make_panel({0.25 * length, side * 0.9 * radius, z},
                            {0.25 * length + 1.4, side * 0.9 * radius, z},
                            {0.25 * length + 1.2, side * (radius + 1.4), z},
                            {0.25 * length + 0.2, side * (radius + 1.4), z}));
  const Point3 screw(-0.5 * length - 0.5, 0, z);
  add_propeller(mesh, screw, 0.75 * radius, draw.whole(4, 7), 0.0);
  if (draw.chance(0.5)) {
    const std::array<Point2, 2> cowl{Point2(-0.5, 0.85 * radius),
                                     Point2(-0.5 + 1.2, (0.85 + 0.06) * radius)};
    append(mesh, make_cowl(screw, cowl, 32));
  }
  add_stands(mesh, -0.2 * length, 0.3 * length, 4, z - radius, 0.75 * radius, z - 0.62 * radius);
  return mesh;
}

}  // namespace hull

inline Structure make_hull(const Draw& draw, std::uint64_t seed) {
  Draw site = draw("site");
  constexpr std::array<TriangleMesh (*)(Draw), 3> kForms{hull::ship, hull::submarine,
                                                         hull::aircraft};
  Structure made;
  made.mesh = turned_form(kForms, draw("hull"), site, seed);
  const double angle = site.in(0.0, 2.0 * kPi), height = site.in(2.5, 4.5);  // a work platform
  const double half = 0.5 * made.mesh.bounds().sizes().head<2>().maxCoeff() + 1.5;
  TriangleMesh platform = make_panel({-1.2, -0.8, height}, {1.2, -0.8, height}, {1.2, 0.8, height},
                                     {-1.2, 0.8, height});
  for (const double x : {-1.15, 1.15})
    for (const double y : {-0.75, 0.75})
      append(platform, make_cylinder({x, y, 0}, {x, y, height + 1.0}, 0.05, 6));
  append(made.mesh, placed(platform, on_circle(half, angle, 0), angle));
  return made;
}
}  // namespace surfleet::detail::random_scene
