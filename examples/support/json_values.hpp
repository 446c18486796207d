// SPDX-License-Identifier: MIT
/// @file
/// @brief Values of ours as JSON.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include <surfleet/core/types.hpp>

namespace surfleet::examples {
/// Counts by the names of what is counted: of a map, or what `count(k)` says of the first `kinds`
/// values of an enumeration.
template <typename Kind>
nlohmann::json by_name(const std::map<Kind, std::size_t>& counts) {
  nlohmann::json named = nlohmann::json::object();
  for (const auto& [kind, count] : counts) named[std::string(name_of(kind))] = count;
  return named;
}
template <typename Kind, typename Count>
nlohmann::json by_name(std::size_t kinds, const Count& count) {
  nlohmann::json named = nlohmann::json::object();
  for (std::size_t k = 0; k < kinds; ++k) {
    const auto kind = static_cast<Kind>(k);
    named[std::string(name_of(kind))] = count(kind);
  }
  return named;
}
inline nlohmann::json triple(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
}  // namespace surfleet::examples
