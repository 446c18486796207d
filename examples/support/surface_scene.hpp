// SPDX-License-Identifier: MIT
/// @file
/// @brief The surfaces that programs know by name, and a user's own.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/climbing_scenes.hpp>
#include <surfleet/simulation/steam_chest.hpp>
#include <surfleet/simulation/surfaces.hpp>

namespace surfleet::examples {
inline constexpr const char* kSurfaceScenes =
    "bumpy_slope, bumpy_slope_hole, sphere, torus, steam_chest, mock_up, l_shape, tube (with a "
    "hole), "
    "or a mesh file (.ply .obj .stl .off)";

/// A bundled surface with edges of about `edge` [m], by default its own, or the mesh in a file,
/// as it is. Throws `Error`.
inline TriangleMesh surface_scene(const std::string& name, std::optional<double> edge) {
  const auto edge_or = [&](double otherwise) { return edge.value_or(otherwise); };
  if (name == "bumpy_slope") return bumpy_slope({.edge = edge_or(0.05)});
  if (name == "bumpy_slope_hole") return bumpy_slope({.edge = edge_or(0.05), .hole = true});
  if (name == "steam_chest") return steam_chest(edge_or(0.04));
  if (name == "mock_up") return mock_up(edge_or(0.05));
  if (name == "l_shape") return l_shape(edge_or(0.05));
  if (name == "tube") return holed_tube({.edge = edge_or(0.03)});
  if (name == "sphere") {
    require(edge_or(0.07) > 0.004, "--edge: expected more than 4 mm on the sphere");
    return make_sphere(Point3::Zero(), 1.0,
                       std::max(0, static_cast<int>(std::lround(std::log2(1.1 / edge_or(0.07))))));
  }
  if (name == "torus") {
    const double side = edge_or(0.065);
    require(side > 0.004, "--edge: expected more than 4 mm on the torus");
    return make_torus(Point3::Zero(), 1.0, 0.4,
                      std::max(3, static_cast<int>(std::lround(2.0 * kPi / side))),
                      std::max(3, static_cast<int>(std::lround(0.8 * kPi / side))));
  }
  return read_mesh(name);
}
}  // namespace surfleet::examples
