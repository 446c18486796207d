// SPDX-License-Identifier: MIT
/// @file
/// @brief Inspections of many scenes, one small file a mission, which a later run does not repeat.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "support/inspection_settings.hpp"

namespace surfleet::examples {
struct SceneTrials {
  std::vector<std::string> scenes;  ///< As `--scene` takes them, and ranges of random ones.
  std::vector<std::string> planners;
  std::vector<int> fleets;  ///< Numbers of drones.
  int trials = 1;           ///< Seeds from `--seed` on.
  std::string out;
  std::map<std::string, std::vector<std::string>> given{};  ///< Options, for the record.
};

/// The scenes one by one, in order, each once. Throws `Error` on a malformed random one.
std::vector<std::string> expand_scenes(const std::vector<std::string>& names);

/// Flies what has no file in `out` yet, then makes the tables from the files alone. Returns the
/// exit status: `kIncomplete` if a mission is missing or ended early. Throws `Error`, having
/// written nothing, on names that are wrong and on files of missions that were flown otherwise.
int run_scene_trials(const SceneTrials& trials, InspectionOptions& options);
}  // namespace surfleet::examples
