// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated bridges: beams, trusses, arches and stayed decks on piers, with railings.
///
/// Railings, hangers and stays are 6 to 16 cm thick; noise barriers and signs are single sheets.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <surfleet/simulation/detail/random_parts.hpp>

namespace surfleet::detail::random_scene {
namespace bridge {
/// What the parts of one bridge agree on; it runs along x.
struct Layout {
  double length = 30.0, width = 6.0, deck = 7.0;  ///< Deck: height of the carriageway [m].
  double gap = 0.0;                               ///< Half width of a joint at mid-span [m].
};

/// The carriageway on its girders, in two halves if there is a joint, and an inclined foot path.
inline void add_deck(TriangleMesh& mesh, Draw draw, const Layout& b) {
  const double slab = draw.in(0.25, 0.4), girder = draw.in(0.6, 1.2);
  const int girders = draw.whole(2, 4);
  const auto part = [&](double from, double to) {
    append(mesh, make_box({from, -0.5 * b.width, b.deck - slab}, {to, 0.5 * b.width, b.deck}));
    for (int k = 0; k < girders; ++k) {
      const double y = 0.4 * b.width * (2.0 * k / (girders - 1) - 1.0),
                   low = b.deck - slab - girder;
      append(mesh, make_box({from, y - 0.12, low}, {to, y + 0.12, b.deck - slab}));
      append(mesh, make_box({from, y - 0.3, low - 0.12}, {to, y + 0.3, low}));
    }
  };
  if (b.gap > 0.0) {
    part(-0.5 * b.length, -b.gap);
    part(b.gap, 0.5 * b.length);
  } else {
    part(-0.5 * b.length, 0.5 * b.length);
  }
}

/// Railings on both sides, or a barrier of one sheet on one.
inline void add_sides(TriangleMesh& mesh, Draw draw, const Layout& b) {
  const bool barrier = draw.chance(0.5);
  const double radius = draw.in(0.03, 0.06), height = draw.in(1.0, 1.3);
  const double from = draw.in(-0.5, -0.1) * b.length, to = draw.in(0.1, 0.5) * b.length;
  for (const double side : {-0.5, 0.5}) {
    const double y = side * (b.width - 0.3);
    std::vector<std::array<double, 2>> spans{{-0.5 * b.length, 0.5 * b.length}};
    if (b.gap > 0.0) spans = {{-0.5 * b.length, -b.gap}, {b.gap, 0.5 * b.length}};
    for (const auto& [a, c] : spans)
      add_railing(mesh, std::array<Point3, 2>{Point3(a, y, b.deck), Point3(c, y, b.deck)}, height,
                  radius);
    if (barrier && side > 0.0)
      append(mesh,
             make_wall_sheet({from, y + 0.1, b.deck + 0.05}, {to, y + 0.1, b.deck + 0.05}, 2.2));
  }
}

/// Walls, pairs of columns or hammerheads, and an abutment at each end.
inline void add_piers(TriangleMesh& mesh, Draw draw, const Layout& b, int piers) {
  const int form = draw.whole(0, 2);
  const double under = b.deck - 1.3, half = 0.45 * b.width, thick = draw.in(0.6, 1.0);
  for (int k = 1; k <= piers; ++k) {
    const double x = b.length * (static_cast<double>(k) / (piers + 1) - 0.5);
    append(mesh, make_box({x - 1.2, -half, 0}, {x + 1.2, half, 0.7}));
    if (form == 0)
      append(mesh,
             make_box({x - 0.5 * thick, -0.8 * half, 0.7}, {x + 0.5 * thick, 0.8 * half, under}));
    if (form == 1)
      for (const double y : {-0.6 * half, 0.6 * half})
        append(mesh, make_cylinder({x, y, 0.7}, {x, y, under}, 0.6 * thick, 20));
    if (form == 2) append(mesh, make_cylinder({x, 0, 0.7}, {x, 0, under - 0.6}, 0.9 * thick, 24));
    if (form > 0) append(mesh, make_box({x - 0.6, -half, under - 0.7}, {x + 0.6, half, under}));
  }
  for (const double side : {-1.0, 1.0}) {
    const double x = side * (0.5 * b.length - 0.4);
    append(mesh, make_box({x - 1.0, -0.5 * b.width, 0}, {x + 1.0, 0.5 * b.width, under}));
  }
}

/// Two truss walls above the deck, tied across at the top.
inline void add_truss_walls(TriangleMesh& mesh, Draw draw, const Layout& b) {
  const double rise = draw.in(3.2, 4.8), thick = draw.in(0.2, 0.32);
  const int bays = 2 * static_cast<int>(b.length / draw.in(6.5, 8.5));
  const bool bowed = draw.chance(0.5);
  const auto top = [&](int k) {
    const double f = static_cast<double>(k) / bays;
    return b.deck + 0.2 +
           rise * (bowed                 ? std::sqrt(std::max(0.0, 4.0 * f * (1.0 - f)))
                   : k == 0 || k == bays ? 0.0
                                         : 1.0);
  };
  const auto at = [&](int k) { return b.length * (static_cast<double>(k) / bays - 0.5); };
  for (const double y : {-0.5 * b.width - 0.2, 0.5 * b.width + 0.2}) {
    append(mesh, make_beam({at(0), y, b.deck}, {at(bays), y, b.deck}, thick, thick));
    for (int k = 0; k < bays; ++k) {
      append(mesh, make_beam({at(k), y, top(k)}, {at(k + 1), y, top(k + 1)}, thick, thick));
      if (k > 0)
        append(mesh, make_beam({at(k), y, b.deck}, {at(k), y, top(k)}, 0.7 * thick, 0.7 * thick));
      const int low = k % 2 == 0 ? k + 1 : k, high = k % 2 == 0 ? k : k + 1;
      if (k > 0 && k + 1 < bays)
        append(mesh,
               make_beam({at(low), y, b.deck}, {at(high), y, top(high)}, 0.6 * thick, 0.6 * thick));
    }
  }
  for (int k = 2; k + 1 < bays; k += 2)
    append(mesh, make_beam({at(k), -0.5 * b.width - 0.2, top(k)},
                           {at(k), 0.5 * b.width + 0.2, top(k)}, thick, thick));
}

/// Two arches beside the deck that carry it by thin hangers.
inline void add_arches(TriangleMesh& mesh, Draw draw, const Layout& b) {
  const double rise = draw.in(0.22, 0.32) * b.length, base = draw.in(0.0, 0.8) * b.deck;
  const double radius = draw.in(0.25, 0.4), lean = draw.in(0.0, 0.14), wire = draw.in(0.03, 0.08);
  constexpr int kSteps = 24;
  for (const double side : {-1.0, 1.0}) {
    std::vector<Point3> path;
    for (int k = 0; k <= kSteps; ++k) {
      const double f = 2.0 * k / kSteps - 1.0, z = base + rise * (1.0 - f * f);
      path.emplace_back(0.46 * b.length * f,
                        side * (0.5 * b.width + 0.6 - lean * std::max(0.0, z - b.deck)), z);
    }
    append(mesh, make_tube(path, radius, 12));
    for (int k = 2; k + 1 < kSteps; k += 2) {
      const Point3& p = path[static_cast<std::size_t>(k)];
      if (p.z() > b.deck + 0.5)
        append(mesh, make_cylinder(p, {p.x(), side * 0.5 * b.width, b.deck - 0.1}, wire, 6));
    }
  }
}

/// One or two pylons with fans of stays.
inline void add_stays(TriangleMesh& mesh, Draw draw, const Layout& b) {
  const double height = b.deck + draw.in(8.0, 12.0), wire = draw.in(0.04, 0.08);
  const bool twin = draw.chance(0.5);
  const int stays = draw.whole(3, 5);
  for (const double f : twin ? std::vector<double>{-0.25, 0.25} : std::vector<double>{0.0}) {
    const double x = f * b.length, reach = (twin ? 0.23 : 0.45) * b.length;
    for (const double side : {-1.0, 1.0}) {
      const Point3 base(x, side * (0.5 * b.width + 0.9), 0), head(x, side * 0.5, height);
      append(mesh, make_beam(base, head, 0.8, 0.8));
      for (int k = 1; k <= stays; ++k)
        for (const double along : {-1.0, 1.0}) {
          const double s = static_cast<double>(k) / stays;
          append(mesh, make_cylinder(base + (0.6 + 0.38 * s) * (head - base),
                                     {x + along * reach * s, side * 0.5 * b.width, b.deck - 0.1},
                                     wire, 6));
        }
    }
    append(mesh, make_beam({x, -0.5 * b.width - 1.2, b.deck - 1.4},
                           {x, 0.5 * b.width + 1.2, b.deck - 1.4}, 0.7, 0.7));
  }
}
}  // namespace bridge

inline Structure make_bridge(const Draw& draw, std::uint64_t seed) {
  Draw site = draw("site");
  bridge::Layout b;
  b.length = site.in(24.0, 38.0);
  b.width = site.in(4.5, 7.0);
  b.deck = site.in(6.0, 8.5);
  const int form = next_form(seed, 4);
  const bool joint = site.chance(0.4);
  const double gap = site.in(0.1, 1.2);
  if (form == 0 && joint) b.gap = gap;
  Structure made;
  bridge::add_deck(made.mesh, draw("deck"), b);
  bridge::add_sides(made.mesh, draw("sides"), b);
  // An even number where there is a joint, so that no pier stands under it.
  const int piers = form == 2 ? 0 : form == 3 ? 1 : b.gap > 0.0 ? 2 : site.whole(1, 2);
  bridge::add_piers(made.mesh, draw("piers"), b, piers);
  if (form == 1) bridge::add_truss_walls(made.mesh, draw("truss"), b);
  if (form == 2) bridge::add_arches(made.mesh, draw("arches"), b);
  if (form == 3) bridge::add_stays(made.mesh, draw("stays"), b);
  Draw loose = draw("loose");  // lamps, a sign, a boat below
  const int lamps = loose.whole(1, 3);
  for (int k = 0; k < lamps; ++k) {
    const double x = b.length * ((k + 0.7) / (lamps + 0.4) - 0.5), y = -0.5 * b.width + 0.15;
    append(made.mesh,
           make_tube(std::array<Point3, 3>{Point3(x, y, b.deck), Point3(x, y, b.deck + 4.0),
                                           Point3(x, y + 1.3, b.deck + 4.4)},
                     0.06, 8));
  }
  const double x = loose.in(-0.3, 0.3) * b.length, y = 0.5 * b.width + loose.in(2.5, 4.0);
  append(made.mesh,
         placed(make_box({-2.2, -0.9, 0}, {2.2, 0.9, 0.9}), {x, y, 0}, loose.in(0.0, kPi)));
  append(made.mesh, make_cylinder({x, y, 0.9}, {x, y, 3.6}, 0.06, 8));
  append(made.mesh, make_wall_sheet({x, y, 1.4}, {x + 1.6, y, 1.4}, 1.8));
  return made;
}
}  // namespace surfleet::detail::random_scene
