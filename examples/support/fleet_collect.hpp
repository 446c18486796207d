// SPDX-License-Identifier: MIT
/// @file
/// @brief What the robots of a distributed fleet have left, put together and judged as one mission.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "support/agent_folder.hpp"
#include "support/inspection.hpp"
#include "support/inspection_report.hpp"

#include <surfleet/mapping/map_file.hpp>

namespace surfleet::examples {
struct CollectedFleet {
  InspectionRun run;
  InspectionJudgement judged;
  nlohmann::json more;  ///< Keys that only a fleet of processes has.
  /// Robots of the team that are no part of its end, from 1 on: with no folder; with no end, as
  /// they were killed; with an end that nobody asked for, as by a signal or `--max-time`.
  std::vector<int> missing, killed, early;

  /// Whether every robot of the team stopped for a reason that was asked for, with the same map.
  bool ended_well() const {
    return missing.empty() && killed.empty() && early.empty() && run.distributed->maps_equal;
  }
};

namespace fleet_collect {
/// The sum of what all say under a key, number by number and name by name.
inline void add_to(nlohmann::json& sum, const nlohmann::json& value) {
  if (value.is_object()) {
    for (const auto& [key, v] : value.items()) add_to(sum[key], v);
  } else if (value.is_number_unsigned()) {
    sum = (sum.is_number_unsigned() ? sum.get<std::uint64_t>() : 0) + value.get<std::uint64_t>();
  }
}
/// Why a robot stopped, as it says itself; `ended` if it says nothing known.
inline StopReason reason_of(const AgentFolder& folder) {
  const std::string name = folder.metrics->value("stop_reason", "");
  for (const StopReason r : kStopReasons)
    if (name == name_of(r)) return r;
  return StopReason::ended;
}
inline Configuration configuration_of(const Pose& T_world_body) {
  return {T_world_body.translation(), std::atan2(T_world_body(1, 0), T_world_body(0, 0))};
}
/// Paths at common instants, for the judge.
inline std::vector<std::vector<TimedConfiguration>> at_common_instants(
    const std::map<int, FlownPath>& paths) {
  std::vector<double> times;
  for (const auto& [id, path] : paths) path.add_instants(times);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<std::vector<TimedConfiguration>> all;
  for (const auto& [id, path] : paths) {
    all.emplace_back();
    for (const double t : times) all.back().push_back({t, {path.at(t), 0.0}});
  }
  return all;
}
}  // namespace fleet_collect

/// Throws `Error` for folders that are not of one mission, or not of this scene.
inline std::vector<AgentFolder> read_agent_folders(const std::vector<std::string>& names,
                                                   const InspectionSettings& s) {
  std::vector<AgentFolder> folders;
  for (const std::string& name : names) {
    folders.push_back(read_agent_folder(name));
    const nlohmann::json &about = folders.back().about, &first = folders.front().about;
    for (const char* key : {"team", "scene", "voxel_m", "robots", "speed_up"})
      require(
          about.contains(key) && about[key] == first[key],
          name + ": another " + key + " than " + names[0] + "; expected folders of one mission");
    require(folders.back().id() <= s.robots,
            name + ": of robot " + std::to_string(folders.back().id()) + "; expected 1 to " +
                std::to_string(s.robots) + ", as --robots says");
  }
  const nlohmann::json& about = folders.front().about;
  const auto expect = [&](const char* key, const nlohmann::json& ours, const char* option) {
    require(about[key] == ours, names[0] + ": flown with " + key + " " + about[key].dump() +
                                    "; expected " + option + " to say so");
  };
  expect("scene", s.scene, "--scene");
  expect("voxel_m", s.voxel, "--voxel");
  expect("robots", s.robots, "--robots");
  require(std::any_of(folders.begin(), folders.end(), [](const auto& f) { return f.has_map(); }),
          names[0] + ": no robot has left a map; expected one that came to an end");
  return folders;
}

/// The maps of all that came to an end are compared voxel for voxel, and that of one which ended
/// for a reason that was asked for is judged, if there is one. The mission is complete if every
/// robot of the team is. Throws `Error` where nothing was flown.
inline CollectedFleet collect_fleet(const std::vector<AgentFolder>& folders,
                                    const InspectionSettings& s, const InspectionSite& site) {
  namespace fc = fleet_collect;
  const double speed_up = folders.front().about["speed_up"].get<double>();
  CollectedFleet c;
  MissionResult& m = c.run.result;
  DistributedResult d;
  std::map<int, std::vector<Trajectory>> flights;
  std::map<int, const AgentFolder*> ends;  // the best of each robot
  std::map<int, std::uint64_t> bytes;
  nlohmann::json drops = nlohmann::json::object(), kinds = drops;
  for (const AgentFolder& f : folders) {
    auto& of = flights[f.id()];
    of.insert(of.end(), f.flights.begin(), f.flights.end());
    const AgentFolder*& end = ends[f.id()];
    if (end == nullptr || (f.metrics && !(end->metrics && is_enough(fc::reason_of(*end)))))
      end = &f;
    bytes[f.id()] += 0;
    if (!f.metrics) continue;
    const nlohmann::json& j = *f.metrics;
    bytes[f.id()] += j.value("bytes_sent", std::uint64_t{0});
    fc::add_to(kinds, j.value("bytes_sent_by_kind", nlohmann::json::object()));
    fc::add_to(drops, j.value("messages_dropped", nlohmann::json::object()));
    d.redundant_stops += j.value("redundant_stops", std::size_t{0});
    m.images += j.value("images", std::size_t{0});
    m.plans += j.value("plans", std::size_t{0});
    m.waits += j.value("waits", std::size_t{0});
    m.emergency_stops += j.value("emergency_stops", std::size_t{0});
    m.planning_time += j.value("planning_time_s", 0.0);
    c.run.wall_time = std::max(c.run.wall_time, j.value("wall_time_s", 0.0));
    c.run.mission_memory =
        std::max(c.run.mission_memory, j.value("peak_memory_bytes", std::size_t{0}));
  }

  std::map<int, FlownPath> paths;
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  for (const auto& [id, list] : flights) {
    const auto path = paths.try_emplace(id, list).first;
    for (const Trajectory& t : path->second.flights()) {
      begin = std::min(begin, t.front().time);
      end = std::max(end, t.back().time);
    }
  }
  require(end > begin, folders[0].path.string() + ": nothing was flown; expected trajectories");
  m.completion_time = speed_up * (end - begin);

  nlohmann::json late = nlohmann::json::object(), found = late, stops = late;
  const AgentFolder* judged = nullptr;
  for (const auto& [id, folder] : ends) {
    const std::string name = std::to_string(id);
    const StopReason why = folder->metrics ? fc::reason_of(*folder) : StopReason::lost;
    m.stop_reasons.push_back(why);
    stops[name] = name_of(why);
    m.path_length.push_back(paths.at(id).length());
    m.path_at_work.push_back(folder->metrics ? folder->metrics->value("path_at_work_m", 0.0)
                                             : m.path_length.back());
    d.bytes_sent.push_back(bytes[id]);
    if (!folder->metrics) {
      c.killed.push_back(id);
      continue;
    }
    if (!is_enough(why)) c.early.push_back(id);
    if (folder->has_map() &&
        (judged == nullptr || (is_enough(why) && !is_enough(fc::reason_of(*judged)))))
      judged = folder;
    late[name] = folder->metrics->value("late_steps", std::size_t{0});
    found[name] = folder->metrics->value("found_team_s", nlohmann::json());
  }
  for (int id = 1; id <= s.robots; ++id)
    if (ends.count(id) == 0) {
      c.missing.push_back(id);
      stops[std::to_string(id)] = "missing";
    }
  m.complete =
      c.missing.empty() && std::all_of(m.stop_reasons.begin(), m.stop_reasons.end(),
                                       [](StopReason r) { return r == StopReason::complete; });

  require(judged != nullptr, folders[0].path.string() + ": no robot's last end has left a map");
  c.run.map = load_map(judged->path / "map.sfm");
  const nlohmann::json& j = *judged->metrics;
  const double share = j.value("estimated_coverage", 0.0);
  m.coverage = {.mesh = share, .unmeshed = 1.0 - share, .open = 0.0};
  m.remaining = j.value("remaining_ise", std::size_t{0});
  m.left_area = j.value("left_area_m2", 0.0);
  for (const LeftReason r : {LeftReason::hidden, LeftReason::no_free_pose, LeftReason::unreachable,
                             LeftReason::seen_incomplete, LeftReason::not_attempted})
    if (const std::size_t n = j.value("remaining_ise_reasons", nlohmann::json::object())
                                  .value(std::string(name_of(r)), std::size_t{0}))
      m.reasons[r] = n;
  d.maps_equal = true;
  for (const auto& [id, folder] : ends) {
    if (!folder->metrics || folder == judged) continue;
    d.maps_equal = d.maps_equal && folder->has_map() &&
                   folder->metrics->value("patches_digest", "") == j.value("patches_digest", "") &&
                   equal_maps(c.run.map, load_map(folder->path / "map.sfm"));
  }
  for (std::size_t k = 0; k < kMessageKinds; ++k)
    d.bytes_by_kind[k] =
        kinds.value(std::string(name_of(static_cast<MessageKind>(k))), std::uint64_t{0});
  c.run.distributed = std::move(d);
  MappedSurface surface = mapped_surface(c.run.map, s, site.scene.region);
  c.run.reconstruction = std::move(surface.mesh);
  c.run.points = std::move(surface.points);

  m.trajectories = fc::at_common_instants(paths);
  c.judged = judge_inspection(s, site, c.run);
  // Told last: to the judge, they hover.
  for (const int id : c.killed) c.run.distributed->lost.push_back(static_cast<RobotId>(id - 1));
  m.trajectories.clear();
  for (const auto& [id, path] : paths) {
    m.trajectories.emplace_back();
    for (const Trajectory& t : path.flights())
      for (const StampedPose& p : t)
        m.trajectories.back().push_back(
            {speed_up * (p.time - begin), fc::configuration_of(p.T_world_body)});
  }
  c.more = {{"messages_dropped", drops},   {"late_steps", late},
            {"found_team_s", found},       {"stop_reason_by_robot", stops},
            {"missing_robots", c.missing}, {"ended_well", c.ended_well()},
            {"speed_up", speed_up},        {"team", folders.front().about["team"]}};
  return c;
}
}  // namespace surfleet::examples
