// SPDX-License-Identifier: MIT
/// @file  The names of the planners that the binaries know.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <surfleet/core/error.hpp>

namespace surfleet::examples {
inline const std::vector<std::string>& planner_names() {
  static const std::vector<std::string> names{"surfleet",      "tsga",       "nnb",
                                              "nnb-exclusive", "tsga-async", "tsga-improved",
                                              "makespan",      "rate",       "tours"};
  return names;
}

/// Whether a planner is meant to be as its authors describe it.
inline bool is_published(std::string_view name) {
  return name == "tsga" || name == "tsga-async" || name == "nnb";
}

/// All of them, with commas between.
inline std::string planner_list() {
  std::string list;
  for (const std::string& n : planner_names()) list += (list.empty() ? "" : ", ") + n;
  return list;
}
/// Throws `Error` for a name not in `planner_names()`.
inline void check_planner_name(std::string_view name) {
  const auto& names = planner_names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw Error("planner " + std::string(name) + ": not known; expected one of " + planner_list());
}
}  // namespace surfleet::examples
