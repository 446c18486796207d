// SPDX-License-Identifier: MIT
/// @file
/// @brief A small house, 8 × 6 × 5 m, for quick tests.
#pragma once

#include <array>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/scene.hpp>

namespace surfleet {
/// Walls with a door and windows, a gable roof, a chimney and a porch. A pure function.
inline TriangleMesh house_mesh() {
  BoxSolid walls;
  walls.add({-3.5, -2.4, 0}, {3.5, 2.4, 2.9});
  walls.cut({-0.5, -2.4, 0}, {0.5, -2.15, 2.1});
  for (const double x : {-2.6, 1.6})
    for (const double y : {-2.4, 2.15}) walls.cut({x, y, 0.9}, {x + 1.0, y + 0.25, 2.1});
  for (const double x : {-3.5, 3.25}) walls.cut({x, -0.6, 0.9}, {x + 0.25, 0.6, 2.1});
  TriangleMesh mesh = walls.mesh();
  // The gable lies in the y-z plane and runs along x.
  const std::array<Point2, 5> gable{Point2(-3, 2.5), Point2(3, 2.5), Point2(3, 2.7), Point2(0, 4.6),
                                    Point2(-3, 2.7)};
  Pose T = Pose::Identity();
  T.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  append(mesh, transformed(make_prism(gable, -4, 4), T));
  BoxSolid chimney;
  chimney.add({1.6, 0.5, 3.0}, {2.4, 1.3, 5.0}).cut({1.8, 0.7, 4.6}, {2.2, 1.1, 5.0});
  append(mesh, chimney.mesh());
  for (const double x : {-1.2, 1.2})
    append(mesh, make_box({x - 0.15, -2.95, 0}, {x + 0.15, -2.65, 2.55}));
  return mesh;
}

inline Scene house_scene() {
  SceneOptions options;
  options.name = "house";
  options.ground = 0.0;
  options.standoff = 6.5;
  options.start = Point3(0, -7.0, 2.0);
  return scene_from_mesh(house_mesh(), options);
}
}  // namespace surfleet
