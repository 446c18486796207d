// SPDX-License-Identifier: MIT
/// @file  The bundled scenes by name.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <surfleet/core/error.hpp>
#include <surfleet/simulation/house.hpp>
#include <surfleet/simulation/powerplant.hpp>
#include <surfleet/simulation/scene.hpp>
#include <surfleet/simulation/statue.hpp>

namespace surfleet {
inline constexpr std::array<std::string_view, 3> kSceneNames{"powerplant", "statue", "house"};

/// A bundled scene. Throws `Error` on a name that is none of `kSceneNames`.
inline Scene scene_by_name(std::string_view name) {
  if (name == "powerplant") return powerplant_scene();
  if (name == "statue") return statue_scene();
  if (name == "house") return house_scene();
  throw Error("scene '" + std::string(name) +
              "' is not known; expected powerplant, statue, house or a mesh file");
}
}  // namespace surfleet
