// SPDX-License-Identifier: MIT
/// @file
/// @brief The bundled power plant, 65 × 42 × 15 m: hall with roof, monitor and an open loading bay,
/// boiler house, five flues of one height, pipe rack and crane of thin members, tank farm with
/// narrow passages, conveyor, cooling units [000 §2.6.1].
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/scene.hpp>

namespace surfleet {
namespace detail::powerplant {
/// Windows or louvres: niches along a wall that is normal to axis `k` (0: x, 1: y), whose face lies
/// at `face`; `inward` is +1 or −1.
inline void niches(BoxSolid& solid, int k, double face, double inward, double from, double to,
                   double pitch, double width, double low, double high, double depth) {
  for (double s = from; s + width <= to + 1e-9; s += pitch) {
    Point3 a, b;
    a[k] = std::min(face, face + inward * depth);
    b[k] = std::max(face, face + inward * depth);
    a[1 - k] = s;
    b[1 - k] = s + width;
    a.z() = low;
    b.z() = high;
    solid.cut(a, b);
  }
}

/// The turbine hall. Its west end is a bay open to the outside, wide enough to fly in.
inline TriangleMesh hall() {
  BoxSolid s;
  s.add({-32.5, -4, 0}, {-6.5, 14, 9});
  s.add({-32.5, -4, 9}, {-6.5, 14, 9.6}).cut({-32.1, -3.6, 9}, {-6.9, 13.6, 9.6});  // parapet
  s.add({-30, 2.5, 9}, {-9, 7.5, 11.4});                                            // monitor
  s.add({-30.4, 2.1, 11.4}, {-8.6, 7.9, 11.7});                                     // its eaves
  niches(s, 1, 2.5, 1, -29.2, -9.4, 2.4, 1.6, 9.8, 11.0, 0.3);
  niches(s, 1, 7.5, -1, -29.2, -9.4, 2.4, 1.6, 9.8, 11.0, 0.3);
  for (int i = 0; i < 5; ++i)  // ventilators
    s.add({-29.0 + 4.6 * i, 9.8, 9}, {-27.2 + 4.6 * i, 11.6, 10.2});
  s.cut({-32.1, -1.5, 0}, {-21, 9.5, 6.8}).cut({-32.5, 0, 0}, {-32.1, 8, 6.2});  // bay and gate
  s.add({-24.5, -1.5, 0}, {-21, 2, 2.4});                                        // loading ramp
  niches(s, 1, -4, 1, -31.4, -15.4, 2.6, 1.3, 4.2, 7.4, 0.35);
  niches(s, 1, -4, 1, -8.9, -7.0, 2.6, 1.3, 4.2, 7.4, 0.35);
  niches(s, 1, 14, -1, -31.4, -7.0, 2.6, 1.3, 4.2, 7.4, 0.35);
  s.cut({-14.6, -4, 0}, {-10.2, -3.3, 4.6});    // gate, closed
  s.cut({-32.5, 10.4, 0}, {-32.2, 11.6, 2.3});  // door
  s.add({-15.2, -5.2, 4.9}, {-9.6, -4, 5.2});   // its canopy
  return s.mesh();
}

inline TriangleMesh boiler_house() {
  BoxSolid s;
  s.add({-3.5, -2, 0}, {9.5, 12, 12.4}).add({-1.5, 0.5, 12.4}, {6, 8, 14});
  s.add({9.5, 3, 0}, {12.2, 10, 4.6});
  s.add({-4.1, -2.6, 12.0}, {10.1, 12.6, 12.4});  // cornice
  niches(s, 1, -2, 1, -2.6, 9.0, 2.4, 0.9, 2.0, 10.8, 0.4);
  niches(s, 1, 12, -1, -2.6, 0.5, 2.4, 0.9, 2.0, 10.8, 0.4);
  niches(s, 1, 12, -1, 5.0, 9.0, 2.4, 0.9, 2.0, 10.8, 0.4);
  niches(s, 0, 9.5, -1, 4.0, 10.5, 2.2, 0.9, 6.0, 10.8, 0.4);
  niches(s, 0, 12.2, -1, 3.6, 9.8, 1.6, 0.9, 1.0, 3.6, 0.3);
  return s.mesh();
}

/// A ring of a service platform around a flue.
inline TriangleMesh platform(const Point3& axis, double inner, double outer, double z) {
  const std::array<Point2, 4> profile{Point2(inner, z), Point2(outer, z), Point2(outer, z + 0.3),
                                      Point2(inner, z + 0.3)};
  return make_lathe(axis, profile, 40);
}

inline void add_flues(TriangleMesh& mesh) {
  const std::array<Point2, 8> profile{Point2(1.75, 0),   Point2(1.75, 1.2), Point2(1.4, 1.7),
                                      Point2(1.2, 14.3), Point2(1.4, 14.5), Point2(1.4, 15),
                                      Point2(1.0, 15),   Point2(1.0, 13.4)};
  for (int i = 0; i < 5; ++i) {
    const Point3 base(-27.0 + 6.5 * i, 18.4, 0);
    append(mesh, make_lathe(base, profile, 56));
    append(mesh, platform(base, 1.0, 1.95, 10.2));
    for (int k = 0; k < 8; ++k) {  // railing
      const double a = 2 * kPi * k / 8;
      const Point3 p = base + Point3(1.8 * std::cos(a), 1.8 * std::sin(a), 10.4);
      append(mesh, make_cylinder(p, p + Point3(0, 0, 1.0), 0.15, 10));
    }
    append(mesh, make_torus(base + Point3(0, 0, 11.4), 1.8, 0.15, 40, 10));
  }
  const std::array<Point3, 3> duct{Point3(3, 11.8, 6), Point3(3, 18.4, 6), Point3(-27, 18.4, 6)};
  append(mesh, make_tube(duct, 0.75, 32));
}

/// Two decks of pipes on portal frames along the south of the hall, with a walkway's railing.
inline void add_pipe_rack(TriangleMesh& mesh) {
  constexpr double kSouth = -10.2, kNorth = -7.8, kWest = -16.5, kEast = 11.5;
  for (int i = 0; i <= 7; ++i) {
    const double x = kWest + 4.0 * i;
    for (const double y : {kSouth, kNorth})
      append(mesh, make_beam({x, y, 0}, {x, y, 6.6}, 0.4, 0.4));
    for (const double z : {4.6, 6.4})
      append(mesh, make_beam({x, kSouth, z}, {x, kNorth, z}, 0.35, 0.35));
  }
  for (const double y : {kSouth, kNorth})
    append(mesh, make_beam({kWest, y, 6.5}, {kEast, y, 6.5}, 0.3, 0.4));
  for (const double y : {-9.8, -9.0, -8.2})
    append(mesh, make_cylinder({kWest - 0.6, y, 5.0}, {kEast + 0.6, y, 5.0}, 0.22, 16));
  const std::array<Point3, 4> steam{Point3(kWest - 0.6, -9.4, 6.95), Point3(4.0, -9.4, 6.95),
                                    Point3(4.0, -9.4, 8.4), Point3(4.0, -1.9, 8.4)};
  append(mesh, make_tube(steam, 0.3, 20));
  const std::array<Point3, 4> feed{Point3(-17.1, -8.5, 6.9), Point3(kEast + 0.4, -8.5, 6.9),
                                   Point3(kEast + 0.4, -8.5, 1.4), Point3(17, -8.5, 1.4)};
  append(mesh, make_tube(feed, 0.25, 20));
  for (int i = 0; i <= 14; ++i)
    append(mesh,
           make_cylinder({kWest + 2.0 * i, kSouth, 6.6}, {kWest + 2.0 * i, kSouth, 7.7}, 0.15, 8));
  append(mesh, make_cylinder({kWest, kSouth, 7.7}, {kEast, kSouth, 7.7}, 0.16, 10));
}

/// A portal crane over two heaps of coal.
inline void add_crane(TriangleMesh& mesh) {
  constexpr double kWest = -30.5, kEast = -20.0, kSouth = -19.6, kNorth = -10.4, kTop = 9.6;
  for (const double x : {kWest, kEast})
    for (const double y : {kSouth, kNorth}) {
      append(mesh, make_beam({x, y, 0}, {x, y, kTop}, 0.5, 0.5));
      append(mesh, make_beam({x, y, 6.4}, {x + (x < -25 ? 3.0 : -3.0), y, kTop}, 0.3, 0.3));
    }
  for (const double y : {kSouth, kNorth}) {
    append(mesh, make_beam({kWest - 0.4, y, kTop}, {kEast + 0.4, y, kTop}, 0.5, 0.6));
    append(mesh, make_beam({kWest, y, kTop + 1.5}, {kEast, y, kTop + 1.5}, 0.3, 0.3));
    for (int i = 0; i < 5; ++i) {
      const double x = kWest + 2.1 * i;
      append(mesh, make_beam({x, y, kTop + 0.2}, {x, y, kTop + 1.5}, 0.3, 0.3));
      append(mesh, make_beam({x, y, kTop + 0.2}, {x + 2.1, y, kTop + 1.5}, 0.3, 0.3));
    }
    append(mesh, make_beam({kEast, y, kTop + 0.2}, {kEast, y, kTop + 1.5}, 0.3, 0.3));
  }
  for (const double x : {kWest, kEast})
    append(mesh, make_beam({x, kSouth, kTop}, {x, kNorth, kTop}, 0.45, 0.5));
  append(mesh, make_beam({-27, kSouth, kTop + 0.4}, {-27, kNorth, kTop + 0.4}, 0.6, 0.6));
  append(mesh, make_box({-28.2, -17.4, 8.2}, {-25.8, -15.2, 10.6}));  // trolley
  append(mesh, make_cylinder({-27, -16.3, 5.6}, {-27, -16.3, 8.3}, 0.18, 12));
  append(mesh, make_cone({-27, -16.3, 4.8}, {-27, -16.3, 5.7}, 0.8, 0.3, 20));  // grab
  append(mesh, make_cone({-25.2, -13.4, 0}, {-25.2, -13.4, 2.4}, 2.6, 0.15, 36));
  append(mesh, make_cone({-23.2, -17.2, 0}, {-23.2, -17.2, 2.0}, 2.2, 0.15, 36));
}

/// Four tanks two robots' widths apart within a low wall.
inline void add_tank_farm(TriangleMesh& mesh) {
  BoxSolid wall;
  wall.add({12.6, -21, 0}, {32.5, -3.4, 0.9}).cut({12.9, -20.7, 0}, {32.2, -3.7, 0.9});
  append(mesh, wall.mesh());
  constexpr double kRadius = 3.1;
  for (const double x : {16.8, 26.2})
    for (const double y : {-16.9, -7.5}) {
      const std::array<Point2, 7> profile{Point2(kRadius, 0),
                                          Point2(kRadius, 7.0),
                                          Point2(kRadius + 0.2, 7.1),
                                          Point2(kRadius + 0.2, 7.4),
                                          Point2(kRadius - 0.1, 7.5),
                                          Point2(1.6, 8.2),
                                          Point2(0.3, 8.5)};
      append(mesh, make_lathe({x, y, 0}, profile, 64));
      std::vector<Point3> stair;  // a spiral rail up the shell
      for (int i = 0; i <= 36; ++i) {
        const double a = -0.5 * kPi + 1.5 * kPi * i / 36;
        stair.push_back(Point3(x + 3.3 * std::cos(a), y + 3.3 * std::sin(a), 0.4 + 6.8 * i / 36));
      }
      append(mesh, make_tube(stair, 0.2, 10));
      append(mesh, make_cylinder({x, y, 8.3}, {x, y, 9.2}, 0.35, 16));
    }
  const std::array<Point3, 2> link{Point3(16.8, -12.2, 1.2), Point3(26.2, -12.2, 1.2)};
  append(mesh, make_tube(link, 0.2, 12));
  for (const double x : {16.8, 26.2})
    append(mesh, make_cylinder({x, -16.9, 1.2}, {x, -7.5, 1.2}, 0.2, 12));
}

/// A spherical gas holder on legs and two pressure vessels on saddles.
inline void add_gas_storage(TriangleMesh& mesh) {
  const Point3 centre(26, 12.5, 6.6);
  append(mesh, make_sphere(centre, 4.2, 4));
  append(mesh, make_torus(centre, 4.5, 0.18, 72, 12));
  for (int k = 0; k < 8; ++k) {
    const double a = 2 * kPi * (k + 0.5) / 8;
    const Point3 p = centre + Point3(3.95 * std::cos(a), 3.95 * std::sin(a), 0);
    append(mesh, make_cylinder({p.x(), p.y(), 0}, p, 0.22, 12));
  }
  for (const double y : {14.6, 18.8}) {
    constexpr double kRadius = 1.3, kWest = 10.2, kEast = 18.0;
    std::vector<Point3> path;
    std::vector<double> radii;
    for (int i = 0; i <= 20; ++i) {
      const double a = 0.5 * kPi * std::min(i, 10) / 10, b = 0.5 * kPi * std::max(i - 10, 0) / 10;
      const double x =
          i <= 10 ? kWest + kRadius * (1 - std::cos(a)) : kEast - kRadius * (1 - std::sin(b));
      path.emplace_back(x, y, 2.3);
      radii.push_back(std::max(0.05, kRadius * (i <= 10 ? std::sin(a) : std::cos(b))));
    }
    append(mesh, make_tube(path, radii, 40));
    for (const double x : {12.0, 16.2})
      append(mesh, make_box({x - 0.3, y - 1.0, 0}, {x + 0.3, y + 1.0, 1.6}));
  }
}

inline void add_cooling_units(TriangleMesh& mesh) {
  BoxSolid s;
  s.add({-7, -20.5, 0}, {6, -14.2, 4.6});
  niches(s, 1, -20.5, 1, -6.4, 5.6, 1.5, 0.9, 0.8, 3.8, 0.35);
  niches(s, 1, -14.2, -1, -6.4, 5.6, 1.5, 0.9, 0.8, 3.8, 0.35);
  append(mesh, s.mesh());
  const std::array<Point2, 5> stack{Point2(1.5, 4.4), Point2(1.3, 5.1), Point2(1.45, 5.9),
                                    Point2(1.2, 5.9), Point2(1.1, 4.8)};
  for (int i = 0; i < 4; ++i) append(mesh, make_lathe({-5.3 + 3.2 * i, -17.35, 0}, stack, 44));
}

/// An inclined gallery from the crusher house up to the boiler house, on trestles.
inline void add_conveyor(TriangleMesh& mesh) {
  append(mesh, make_box({25.6, -1.6, 0}, {30.0, 2.6, 4.2}));
  const Point3 low(26.4, 0.5, 2.6), high(9.0, 0.5, 10.6);
  append(mesh, make_beam(low, high, 1.8, 1.9));
  for (const double s : {0.33, 0.68}) {
    const Point3 p = low + s * (high - low);
    for (const double y : {-0.2, 1.2})
      append(mesh, make_beam({p.x(), y, 0}, {p.x(), y, p.z() - 0.5}, 0.4, 0.4));
    append(mesh, make_beam({p.x(), -0.2, 0.5 * p.z()}, {p.x(), 1.2, 0.5 * p.z()}, 0.3, 0.3));
  }
}
}  // namespace detail::powerplant

/// The power plant. A pure function; about 50 000 triangles; each part is a closed shell.
inline TriangleMesh powerplant_mesh() {
  namespace plant = detail::powerplant;
  TriangleMesh mesh = plant::hall();
  append(mesh, plant::boiler_house());
  append(mesh, make_box({-6.6, 4, 5.6}, {-3.4, 7, 8.4}));  // bridge between the two
  plant::add_flues(mesh);
  append(mesh, make_box({-30, 20.6, 0}, {2, 21, 2.4}));  // wall behind the flues
  plant::add_pipe_rack(mesh);
  plant::add_crane(mesh);
  plant::add_tank_farm(mesh);
  plant::add_gas_storage(mesh);
  plant::add_cooling_units(mesh);
  plant::add_conveyor(mesh);
  return mesh;
}

inline Scene powerplant_scene() {
  SceneOptions options;
  options.name = "powerplant";
  options.ground = 0.0;
  options.start = Point3(-12.5, -16.0, 2.2);
  return scene_from_mesh(powerplant_mesh(), options);
}
}  // namespace surfleet
