// SPDX-License-Identifier: MIT
/// @file
/// @brief Bundled planar worlds: those of [004 Fig. 4.4–5.9], an office, and cracks to be found.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/polygon.hpp>
#include <surfleet/geometry/prism.hpp>

namespace surfleet {
/// A planar world and where robots are set down in it.
struct PlanarEnvironment {
  std::string name;
  Polygon domain;
  Point2 start = Point2::Zero();  ///< Robots are placed in a close group around this point.
};

/// An office of ten rooms with doors of 1 m on both sides of a corridor, 20 × 12 m, with desks,
/// cupboards and pillars.
inline Polygon office_floor_plan() {
  constexpr int kRooms = 5;
  constexpr double kWidth = 4.0, kWall = 0.2, kDoor = 1.0, kLow = 5.0, kHigh = 7.0, kTop = 12.0;
  Ring outer{{0.0, kLow}};
  const auto pocket = [&](double x0, double x1, double door, double mouth, double inner, double end,
                          bool leftwards) {
    Ring points{{door - kDoor / 2, mouth},
                {door - kDoor / 2, inner},
                {x0, inner},
                {x0, end},
                {x1, end},
                {x1, inner},
                {door + kDoor / 2, inner},
                {door + kDoor / 2, mouth}};
    if (leftwards) std::reverse(points.begin(), points.end());
    outer.insert(outer.end(), points.begin(), points.end());
  };
  for (int k = 0; k < kRooms; ++k)
    pocket(kWidth * k + (k == 0 ? 0.0 : kWall / 2),
           kWidth * (k + 1) - (k == kRooms - 1 ? 0.0 : kWall / 2),
           kWidth * k + (k % 2 == 0 ? 1.0 : 3.0), kLow, kLow - kWall, 0.0, false);
  outer.push_back({kWidth * kRooms, kLow});
  outer.push_back({kWidth * kRooms, kHigh});
  for (int k = kRooms - 1; k >= 0; --k)
    pocket(kWidth * k + (k == 0 ? 0.0 : kWall / 2),
           kWidth * (k + 1) - (k == kRooms - 1 ? 0.0 : kWall / 2),
           kWidth * k + (k % 2 == 0 ? 3.0 : 1.0), kHigh, kHigh + kWall, kTop, true);
  outer.push_back({0.0, kHigh});
  std::vector<Ring> furniture;
  const auto box = [&](double x, double y, double w, double h) {
    furniture.push_back({{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}});
  };
  box(1.2, 1.5, 1.6, 0.8);
  box(5.0, 2.0, 0.8, 1.8);
  box(9.2, 1.2, 1.6, 1.6);
  box(13.0, 1.0, 2.0, 0.7);
  box(13.0, 2.6, 2.0, 0.7);
  box(17.4, 1.8, 1.4, 1.0);
  box(1.0, 9.0, 0.8, 1.8);
  box(9.0, 9.2, 2.0, 0.8);
  box(17.0, 8.8, 0.6, 2.0);
  box(18.4, 8.8, 0.6, 2.0);
  box(7.85, 5.85, 0.3, 0.3);
  box(13.85, 5.85, 0.3, 0.3);
  furniture.push_back({{5.2, 9.5}, {6.0, 8.6}, {6.8, 9.5}, {6.0, 10.4}});
  furniture.push_back(
      {{13.0, 8.6}, {15.0, 8.6}, {15.0, 10.6}, {14.2, 10.6}, {14.2, 9.4}, {13.0, 9.4}});
  return make_polygon(std::move(outer), std::move(furniture));
}

inline std::vector<std::string> planar_environment_names() {
  return {"arena",         "arena_triangle",     "u_shape", "l_shape", "narrow_passage",
          "two_obstacles", "nonconvex_obstacle", "office",  "square"};
}

/// A bundled world by name. Throws `Error` that lists the names.
inline PlanarEnvironment planar_environment(std::string_view name) {
  const auto make = [&](Ring outer, std::vector<Ring> holes, const Point2& start) {
    return PlanarEnvironment{std::string(name), make_polygon(std::move(outer), std::move(holes)),
                             start};
  };
  if (name == "arena")  // [004 Fig. 4.4]
    return make({{0, 0}, {5, 0}, {5, 3}, {0, 3}}, {}, {0.3, 1.5});
  if (name == "arena_triangle")  // [004 Fig. 4.5]
    return make({{0, 0}, {5, 0}, {5, 3}, {0, 3}}, {{{2.0, 1.5}, {3.0, 0.9}, {3.0, 2.1}}},
                {0.3, 1.5});
  if (name == "u_shape")  // [004 Fig. 5.2, 5.9]
    return make({{0, 0}, {3, 0}, {3, 2.4}, {2, 2.4}, {2, 0.9}, {1, 0.9}, {1, 2.4}, {0, 2.4}}, {},
                {0.4, 1.9});
  if (name == "l_shape")  // [004 Fig. 5.8]
    return make({{0, 0}, {3, 0}, {3, 1.2}, {1.2, 1.2}, {1.2, 3}, {0, 3}}, {}, {2.6, 0.4});
  if (name == "narrow_passage")  // [004 Fig. 5.4]
    return make({{0, 0},
                 {1.4, 0},
                 {1.4, 0.9},
                 {1.7, 0.9},
                 {1.7, 0},
                 {4, 0},
                 {4, 2},
                 {1.7, 2},
                 {1.7, 1.1},
                 {1.4, 1.1},
                 {1.4, 2},
                 {0, 2}},
                {}, {0.5, 1.0});
  if (name == "two_obstacles")  // [004 Fig. 5.5]
    return make({{0, 0}, {3, 0}, {3, 2.4}, {0, 2.4}},
                {{{0.9, 0.6}, {1.5, 0.8}, {1.3, 1.5}, {0.8, 1.3}},
                 {{1.9, 1.1}, {2.5, 1.0}, {2.6, 1.7}, {2.1, 1.9}}},
                {0.3, 0.3});
  if (name == "nonconvex_obstacle")  // [004 Fig. 5.6]
    return make({{0, 0}, {3, 0}, {3, 2.4}, {0, 2.4}},
                {{{1.0, 0.7},
                  {2.0, 0.7},
                  {2.0, 1.7},
                  {1.0, 1.7},
                  {1.0, 1.45},
                  {1.7, 1.45},
                  {1.7, 0.95},
                  {1.0, 0.95}}},
                {0.3, 0.3});
  if (name == "office") return {std::string(name), office_floor_plan(), {0.8, 6.0}};
  if (name == "square") return make({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {}, {0.2, 0.2});
  std::string known;
  for (const std::string& n : planar_environment_names()) known += (known.empty() ? "" : ", ") + n;
  throw Error("no bundled planar scene is called '" + std::string(name) + "'; there are " + known);
}

/// The 3-D U shape of [004 Fig. 5.7].
inline Prism u_prism() { return {planar_environment("u_shape").domain, 0.0, 1.5}; }

/// `count` places in a close group around `centre`: rings of a hexagonal lattice, those outside the
/// domain skipped. Throws `Error` if the domain has not room for them.
inline std::vector<Point2> group_start(const Polygon& domain, const Point2& centre,
                                       std::size_t count, double spacing) {
  std::vector<Point2> places;
  const auto add = [&](const Point2& p) {
    if (places.size() < count && locate(domain, p) == Side::Inside) places.push_back(p);
  };
  add(centre);
  for (int ring = 1; places.size() < count; ++ring) {
    require(ring * spacing < 2.0 * domain.bounds().diagonal().norm(),
            "the domain has no room for " + std::to_string(count) + " robots " +
                std::to_string(spacing) + " m apart");
    for (int side = 0; side < 6; ++side)
      for (int k = 0; k < ring; ++k) {
        const double a = side * kPi / 3, b = (side + 2) * kPi / 3;
        add(centre + spacing * (ring * Point2(std::cos(a), std::sin(a)) +
                                k * Point2(std::cos(b), std::sin(b))));
      }
  }
  return places;
}

/// A crack in the ground.
struct Defect {
  Point2 from, to;
  /// Whether a footprint of `radius` [m] that moves along ab passes over the crack.
  bool found_from(const Point2& a, const Point2& b, double radius) const {
    if (segments_intersect(a, b, from, to)) return true;
    const auto near = [&](const Point2& p, const Point2& c, const Point2& d) {
      return (closest_on_segment(c, d, p) - p).norm() <= radius;
    };
    return near(from, a, b) || near(to, a, b) || near(a, from, to) || near(b, from, to);
  }
};
/// Cracks of random length at random places, inside the domain [004 §4.4.1: ten of them].
inline std::vector<Defect> random_defects(const Polygon& domain, std::size_t count, Random& random,
                                          double shortest = 0.05, double longest = 0.3) {
  std::vector<Defect> defects;
  const Box2 box = domain.bounds();
  while (defects.size() < count) {
    const double x = random.uniform(box.min().x(), box.max().x());
    const Point2 a(x, random.uniform(box.min().y(), box.max().y()));
    const double angle = random.uniform(0.0, 2.0 * kPi), length = random.uniform(shortest, longest);
    const Point2 b = a + length * Point2(std::cos(angle), std::sin(angle));
    bool inside = contains(domain, a) && contains(domain, b);
    for_each_edge(domain, [&](const Point2& c, const Point2& d) {
      inside = inside && !segments_intersect(a, b, c, d);
    });
    if (inside) defects.push_back({a, b});
  }
  return defects;
}
}  // namespace surfleet
