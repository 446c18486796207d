// SPDX-License-Identifier: MIT
/// @file
/// @brief The bundled statue on its pedestal, 20 × 20 × 60 m: a robed figure with raised torch,
/// tablet and crown of spikes, folds and hair in relief [000 §2.6.1].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/scene.hpp>

namespace surfleet {
namespace detail::statue {
/// Piecewise linear through (s, value) pairs of ascending s.
inline double interpolate(std::span<const Point2> table, double s) {
  if (s <= table.front().x()) return table.front().y();
  for (std::size_t i = 1; i < table.size(); ++i)
    if (s <= table[i].x()) {
      const double f = (s - table[i - 1].x()) / (table[i].x() - table[i - 1].x());
      const double smooth = f * f * (3.0 - 2.0 * f);
      return table[i - 1].y() + smooth * (table[i].y() - table[i - 1].y());
    }
  return table.back().y();
}
inline double bump(double x, double width) { return std::exp(-x * x / (width * width)); }

/// The terraces and the tapered shaft with cornices, columns and a recessed panel a side.
inline void add_pedestal(TriangleMesh& mesh) {
  BoxSolid terraces;
  terraces.add({-10, -10, 0}, {10, 10, 1.6}).add({-8.8, -8.8, 1.6}, {8.8, 8.8, 3.0});
  terraces.add({-7.6, -7.6, 3.0}, {7.6, 7.6, 4.2});
  for (const double x : {-10.0, 9.2})
    for (const double y : {-10.0, 9.2}) terraces.add({x, y, 1.6}, {x + 0.8, y + 0.8, 2.6});
  terraces.cut({-1.6, -10, 0}, {1.6, -8.9, 1.6});  // stairs
  for (int i = 0; i < 4; ++i) terraces.add({-1.6, -9.9 + 0.3 * i, 0}, {1.6, -8.9, 0.4 * (i + 1)});
  append(mesh, terraces.mesh());
  const std::array<Point2, 14> profile{
      Point2(6.6, 4.2),  Point2(6.6, 5.2),  Point2(6.1, 5.5),  Point2(5.5, 12.6), Point2(5.9, 12.9),
      Point2(5.9, 13.7), Point2(5.4, 14.0), Point2(5.0, 20.4), Point2(5.5, 20.8), Point2(5.7, 21.4),
      Point2(5.7, 22.0), Point2(5.1, 22.2), Point2(4.9, 23.0), Point2(4.7, 23.4)};
  std::vector<std::vector<Point3>> rings;
  for (const Point2& p : profile)
    rings.push_back({{-p.x(), -p.x(), p.y()},
                     {p.x(), -p.x(), p.y()},
                     {p.x(), p.x(), p.y()},
                     {-p.x(), p.x(), p.y()}});
  append(mesh, make_loft(rings, {0, 0, 4.2}, {0, 0, 23.4}));
  for (int side = 0; side < 4; ++side) {
    const Eigen::AngleAxisd turn(0.5 * kPi * side, Eigen::Vector3d::UnitZ());
    for (const double x : {-3.6, -1.2, 1.2, 3.6}) {
      const Point3 base = turn * Point3(x, -5.25, 14.0), head = turn * Point3(x, -5.25, 20.5);
      append(mesh, make_cylinder(base, head, 0.42, 20));
    }
    for (const double x : {-4.6, 4.6})
      append(mesh, make_beam(turn * Point3(x, -6.0, 5.3), turn * Point3(x, -5.5, 12.8), 1.0, 0.9));
    for (int i = 0; i < 5; ++i)  // shields
      append(mesh, make_sphere(turn * Point3(-3.6 + 1.8 * i, -5.75, 13.3), 0.42, 2));
  }
}

/// The robed body: an oval column whose radius carries the folds.
inline void add_body(TriangleMesh& mesh) {
  constexpr double kFoot = 23.3, kHeight = 21.6;
  constexpr int kRings = 190, kAround = 220;
  const std::array<Point2, 11> wide{Point2(0, 4.0),     Point2(3, 3.75),   Point2(7, 3.4),
                                    Point2(11, 3.15),   Point2(14, 2.75),  Point2(16.5, 3.0),
                                    Point2(18.8, 3.1),  Point2(19.8, 2.5), Point2(20.4, 1.4),
                                    Point2(20.9, 0.95), Point2(21.6, 0.9)};
  const std::array<Point2, 11> deep{Point2(0, 3.7),    Point2(3, 3.4),    Point2(7, 3.0),
                                    Point2(11, 2.7),   Point2(14, 2.2),   Point2(16.5, 2.4),
                                    Point2(18.8, 2.0), Point2(19.8, 1.6), Point2(20.4, 1.15),
                                    Point2(20.9, 0.9), Point2(21.6, 0.9)};
  const std::array<Point2, 5> fold_depth{Point2(0, 0.34), Point2(10, 0.26), Point2(15, 0.16),
                                         Point2(19, 0.10), Point2(20.6, 0.0)};
  std::vector<std::vector<Point3>> rings;
  for (int i = 0; i <= kRings; ++i) {
    const double h = kHeight * i / kRings;
    const double a = interpolate(wide, h), b = interpolate(deep, h);
    const double depth = interpolate(fold_depth, h);
    std::vector<Point3> ring;
    for (int k = 0; k < kAround; ++k) {
      const double t = 2.0 * kPi * k / kAround;
      // Hanging folds that wander and part toward the hem.
      const double wander = 0.9 * std::sin(0.31 * h + 2.0 * t) + 0.35 * std::sin(0.8 * h - 3.0 * t);
      const double hanging = 1.0 - 1.6 * std::abs(std::sin(8.0 * t + wander));
      const double small = 0.35 * std::sin(23.0 * t + 0.6 * h + 2.0 * std::sin(3.0 * t));
      // The cloak's edge runs from the left shoulder to the right hip, its folds across the chest.
      const double edge = h - (12.5 + 5.5 * std::cos(t));
      const double cloak =
          0.30 * bump(edge, 0.45) +
          (edge > 0.0 && h < 19.5 ? 0.09 * std::sin(4.2 * edge) * bump(edge - 2.5, 3.0) : 0.0);
      const double r = depth * (hanging + small) + (h < 19.5 ? cloak : 0.0);
      ring.emplace_back((a + r) * std::cos(t), (b + r) * std::sin(t), kFoot + h);
    }
    rings.push_back(std::move(ring));
  }
  append(mesh, make_loft(rings, {0, 0, kFoot}, {0, 0, kFoot + kHeight}));
}

/// The head, with brow, eyes, nose, mouth, chin and waved hair; it faces −y.
inline void add_head(TriangleMesh& mesh) {
  const Point3 centre(0, -0.1, 46.35);
  TriangleMesh head = make_sphere({0, 0, 0}, 1.0, 5);
  for (Point3& v : head.vertices) {
    const Point3 d = v;
    double r = 1.0;
    const double front = -d.y();
    if (front > 0.0) {
      const auto at = [&](double x, double z, double wx, double wz) {
        return bump(d.x() - x, wx) * bump(d.z() - z, wz);
      };
      r += 0.20 * at(0, -0.05, 0.10, 0.22) * front;                                    // nose
      r -= 0.13 * (at(0.30, 0.10, 0.15, 0.10) + at(-0.30, 0.10, 0.15, 0.10)) * front;  // eyes
      r += 0.07 * at(0, 0.26, 0.50, 0.09) * front;                                     // brow
      r -= 0.06 * at(0, -0.38, 0.22, 0.04) * front;                                    // mouth
      r += 0.07 * at(0, -0.62, 0.22, 0.16) * front;                                    // chin
    }
    const double hair =
        std::clamp((d.y() + 0.35 + 0.9 * std::max(0.0, d.z() - 0.35)) * 3.0, 0.0, 1.0);
    r += hair * (0.10 + 0.05 * std::sin(16.0 * std::atan2(d.x(), d.y()) + 6.0 * d.z()));
    v = centre + Point3(1.5 * r * d.x(), 1.65 * r * d.y(), 2.0 * r * d.z());
  }
  append(mesh, head);
  append(mesh, make_sphere({0, 1.5, 45.6}, 0.75, 3));  // knot of hair
  Pose tilt = Pose::Identity();
  tilt.translate(Point3(0, -0.1, 47.3))
      .rotate(Eigen::AngleAxisd(radians(-18), Eigen::Vector3d::UnitX()));
  append(mesh, transformed(make_torus({0, 0, 0}, 1.7, 0.26, 64, 16), tilt));
  for (int i = -3; i <= 3; ++i) {
    const double a = radians(26.0 * i);
    const Point3 d(std::sin(a), -0.45 - 0.15 * std::cos(a), std::cos(a));
    const Point3 base = Point3(0, -0.3, 47.3) + 1.4 * d.normalized();
    append(mesh, make_cone(base, base + 2.5 * d.normalized(), 0.30, 0.05, 16));
  }
}

/// A limb through `joints` with sleeve folds; `radii` belong to the joints.
inline void add_limb(TriangleMesh& mesh, std::span<const Point3> joints,
                     std::span<const double> radii, double fold) {
  std::vector<Point3> path;
  std::vector<double> widths;
  constexpr int kSteps = 40;
  const auto legs = static_cast<int>(joints.size()) - 1;
  for (int i = 0; i <= kSteps * legs; ++i) {
    // A Catmull–Rom curve through the joints.
    const int leg = std::min(i / kSteps, legs - 1);
    const double u = static_cast<double>(i) / kSteps - leg;
    const auto joint = [&](int j) {
      return joints[static_cast<std::size_t>(std::clamp(j, 0, legs))];
    };
    const Point3 p0 = joint(leg - 1), p1 = joint(leg), p2 = joint(leg + 1), p3 = joint(leg + 2);
    path.push_back(0.5 * (2.0 * p1 + (p2 - p0) * u + (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3) * u * u +
                          (3.0 * p1 - p0 - 3.0 * p2 + p3) * u * u * u));
    const double r0 = radii[static_cast<std::size_t>(leg)];
    const double r1 = radii[static_cast<std::size_t>(leg + 1)];
    widths.push_back(r0 + (r1 - r0) * u + fold * std::sin(0.55 * i) * (i < kSteps * legs ? 1 : 0));
  }
  append(mesh, make_tube(path, widths, 36));
}

inline void add_arms(TriangleMesh& mesh) {
  const std::array<Point3, 4> raised{Point3(-1.9, 0, 41.6), Point3(-3.3, -0.2, 44.6),
                                     Point3(-3.7, -0.5, 49.0), Point3(-3.4, -0.8, 53.4)};
  add_limb(mesh, raised, std::array<double, 4>{1.25, 1.15, 0.8, 0.5}, 0.05);
  append(mesh, make_sphere({-3.4, -0.8, 53.7}, 0.68, 3));  // hand
  const Point3 torch(-3.4, -0.8, 52.8);
  const std::array<Point2, 9> handle{Point2(0.20, 0),   Point2(0.32, 0.5), Point2(0.36, 2.2),
                                     Point2(0.70, 2.9), Point2(1.25, 3.2), Point2(1.25, 3.5),
                                     Point2(1.05, 3.6), Point2(1.05, 3.3), Point2(0.5, 3.3)};
  append(mesh, make_lathe(torch, handle, 48));
  std::vector<std::vector<Point3>> flame;
  for (int i = 0; i <= 44; ++i) {
    const double s = i / 44.0;
    const double r = 0.04 + 0.85 * std::pow(std::sin(kPi * std::min(1.0, 0.22 + 0.78 * s)), 1.2);
    std::vector<Point3> ring;
    for (int k = 0; k < 60; ++k) {
      const double t = 2 * kPi * k / 60;
      const double lick = 1.0 + 0.16 * std::sin(5 * t + 5.0 * s) * (1.0 - s);
      ring.push_back(torch + Point3(r * lick * std::cos(t) + 0.25 * std::sin(2.5 * s),
                                    r * lick * std::sin(t), 3.2 + 4.0 * s));
    }
    flame.push_back(std::move(ring));
  }
  append(mesh, make_loft(flame, flame.front()[0] * 0.5 + flame.front()[30] * 0.5,
                         flame.back()[0] * 0.5 + flame.back()[30] * 0.5));
  const std::array<Point3, 4> bent{Point3(1.9, 0, 41.8), Point3(3.4, -0.3, 39.6),
                                   Point3(3.7, -1.4, 37.0), Point3(2.6, -3.0, 36.6)};
  add_limb(mesh, bent, std::array<double, 4>{1.2, 1.2, 1.0, 0.55}, 0.06);
  append(mesh, make_sphere({2.5, -3.2, 36.6}, 0.62, 3));
  Pose held = Pose::Identity();
  held.translate(Point3(2.7, -3.1, 38.2))
      .rotate(Eigen::AngleAxisd(radians(20), Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(radians(-12), Eigen::Vector3d::UnitX()));
  append(mesh, transformed(make_box({-1.0, -0.25, -1.7}, {1.0, 0.25, 1.7}), held));
  for (int i = 0; i < 4; ++i)  // lines on the tablet
    append(mesh,
           transformed(make_box({-0.7, -0.33, 1.0 - 0.6 * i}, {0.7, -0.2, 1.2 - 0.6 * i}), held));
}
}  // namespace detail::statue

/// The statue. A pure function; about 150 000 triangles of about 10 cm; each part is a closed
/// shell.
inline TriangleMesh statue_mesh() {
  TriangleMesh mesh;
  detail::statue::add_pedestal(mesh);
  detail::statue::add_body(mesh);
  detail::statue::add_head(mesh);
  detail::statue::add_arms(mesh);
  return mesh;
}

inline Scene statue_scene() {
  SceneOptions options;
  options.name = "statue";
  options.ground = 0.0;
  options.standoff = 7.0;
  options.ground_slab = 0.3;
  options.region_margin = 0.4;
  options.start = Point3(0, -13.5, 2.0);
  return scene_from_mesh(statue_mesh(), options);
}
}  // namespace surfleet
