// SPDX-License-Identifier: MIT
/// @file
/// @brief The planners that the binaries know by name, and what each of them asks of a mission.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <surfleet/core/error.hpp>

namespace surfleet::examples {
struct NamedPlanner {
  std::string_view name;
  /// Whether clusters have a greatest extent; the published planners set none.
  bool bounded_clusters = true;
};

constexpr std::array<NamedPlanner, 9> kPlanners{{
    {.name = "surfleet"},
    {.name = "tsga", .bounded_clusters = false},
    {.name = "nnb", .bounded_clusters = false},
    {.name = "nnb-exclusive"},
    {.name = "tsga-async", .bounded_clusters = false},
    {.name = "tsga-improved"},
    {.name = "makespan"},
    {.name = "rate"},
    {.name = "tours"},
}};

/// All their names, with commas between.
inline std::string planner_list() {
  std::string list;
  for (const NamedPlanner& p : kPlanners) list += (list.empty() ? "" : ", ") + std::string(p.name);
  return list;
}
/// Throws `Error` for a name that none of them has.
inline const NamedPlanner& planner_by_name(std::string_view name) {
  const auto it = std::find_if(kPlanners.begin(), kPlanners.end(),
                               [&](const NamedPlanner& p) { return p.name == name; });
  if (it == kPlanners.end())
    throw Error("planner " + std::string(name) + ": not known; expected one of " + planner_list());
  return *it;
}
}  // namespace surfleet::examples
