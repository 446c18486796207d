// SPDX-License-Identifier: MIT
/// @file
/// @brief The bundled and the generated scenes by name.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <surfleet/core/error.hpp>
#include <surfleet/simulation/house.hpp>
#include <surfleet/simulation/powerplant.hpp>
#include <surfleet/simulation/random_scene.hpp>
#include <surfleet/simulation/scene.hpp>
#include <surfleet/simulation/statue.hpp>

namespace surfleet {
inline constexpr std::array<std::string_view, 3> kSceneNames{"powerplant", "statue", "house"};

/// Whether `scene_by_name` answers for this name, if only with an `Error` of what is wrong in it.
inline bool is_scene_name(std::string_view name) {
  return std::find(kSceneNames.begin(), kSceneNames.end(), name) != kSceneNames.end() ||
         is_random_scene(name);
}

/// A bundled scene or a random one, `random:KIND:SEED`. Throws `Error` on any other name.
inline Scene scene_by_name(std::string_view name) {
  if (is_random_scene(name)) return random_scene(parse_random_scene(name));
  if (name == "powerplant") return powerplant_scene();
  if (name == "statue") return statue_scene();
  if (name == "house") return house_scene();
  throw Error(
      "scene '" + std::string(name) +
      "' is not known; expected powerplant, statue, house, random:KIND:SEED or a mesh file");
}
}  // namespace surfleet
