// SPDX-License-Identifier: MIT
/// @file
/// @brief The planners by their names, each behind one type.
///
///     AnyPlanner planner = make_planner("tsga", {.standoff = 3.6});
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <surfleet/core/compiled.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/planner_settings.hpp>

namespace surfleet {
struct NamedPlanner {
  std::string_view name;
  /// Whether it is a published planner just as it is printed [000 Alg. 1–4], line by line as in
  /// docs/planner.md.
  bool as_printed = false;
  /// Where missions by it end if nothing else is said: at routes that gain less for a metre, over
  /// the camera's range [m²/m per m].
  double enough = 0.0;
  bool chooses_pitch = false;  ///< Of a gimbal, with the heading.
};

/// The first is the library's own.
inline constexpr std::array<NamedPlanner, 7> kPlanners{{
    {.name = "surfleet", .enough = 0.05, .chooses_pitch = true},
    {.name = "tsga", .as_printed = true},
    {.name = "nnb", .as_printed = true},
    {.name = "tsga-plus"},
    {.name = "nnb-plus"},
    {.name = "makespan"},
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

/// The planner of this name. Throws `Error` for a name that is not among `kPlanners`.
SURFLEET_INLINE AnyPlanner make_planner(std::string_view name,
                                        const PlannerSettings& settings = {});
}  // namespace surfleet

#ifndef SURFLEET_COMPILED
#include <surfleet/planning/detail/make_planner.hpp>
#endif
