// SPDX-License-Identifier: MIT
#include "support/scene_trials.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "support/cli.hpp"
#include "support/inspection.hpp"
#include "support/inspection_report.hpp"

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/version.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/simulation/scenes.hpp>

namespace surfleet::examples {
namespace {
namespace fs = std::filesystem;

/// One mission that is to be flown or was.
struct Mission {
  InspectionSettings settings;
  std::string file;  ///< Its name in the folder.
};

std::string file_name(const InspectionSettings& s) {
  std::string scene = is_scene_name(s.scene) ? s.scene : fs::path(s.scene).filename().string();
  for (char& c : scene)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.') c = '-';
  return scene + "_" + s.planner + "_r" + std::to_string(s.robots) + "_s" + std::to_string(s.seed) +
         ".json";
}

std::string library_version() {
  return std::to_string(SURFLEET_VERSION_MAJOR) + "." + std::to_string(SURFLEET_VERSION_MINOR) +
         "." + std::to_string(SURFLEET_VERSION_PATCH);
}

/// What decides how a mission goes: two files with the same are of the same mission.
nlohmann::json mission_settings(const InspectionSettings& s, const SceneTrials& trials) {
  nlohmann::json options = nlohmann::json::object();
  for (const auto& [name, values] : trials.given)
    // What only tells which missions are flown, where they go, and what changes no result.
    if (name != "scenes" && name != "planners" && name != "fleets" && name != "trials" &&
        name != "seed" && name != "out" && name != "config" && name != "threads")
      options[name] = values;
  return {{"scene", s.scene},
          {"planner", s.planner},
          {"robots", s.robots},
          {"seed", s.seed},
          {"preset", s.preset},
          {"voxel_m", s.voxel},
          {"range_m", {s.nearest, s.farthest}},
          {"standoff_m", s.standoff},
          {"radius_m", s.radius},
          {"margin_m", s.margin},
          {"max_time_s", s.max_time},
          {"options", options},
          {"library_version", library_version()}};
}

/// The keys that the tables need.
bool has_metrics(const nlohmann::json& file) {
  const auto metrics = file.find("metrics");
  if (metrics == file.end() || !metrics->is_object()) return false;
  for (const char* key : {"surface_coverage", "completion_time_s", "total_path_length_m",
                          "collisions", "wall_time_s", "complete"})
    if (!metrics->contains(key) || (*metrics)[key].is_null()) return false;
  return metrics->contains("rmse_m") && metrics->contains("min_clearance_m");
}

/// A mission's file; nothing if there is none or it is not whole.
std::optional<nlohmann::json> read_mission(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  nlohmann::json file = nlohmann::json::parse(in, nullptr, false);
  if (file.is_discarded() || !file.is_object() || !file.contains("settings") || !has_metrics(file))
    return std::nullopt;
  return file;
}

/// Mean and worst of a figure over missions.
struct Figure {
  Moments all{};
  double worst = 0.0;
  std::string where{};
  bool more_is_worse = true;
  void add(const nlohmann::json& value, const std::string& scene) {
    if (!value.is_number()) return;
    const double v = value.get<double>();
    if (all.count() == 0 || (more_is_worse ? v > worst : v < worst)) {
      worst = v;
      where = scene;
    }
    all.add(v);
  }
  std::string text(double scale, int digits, bool name_worst = false) const {
    if (all.count() == 0) return "-";
    return format_number(scale * all.mean(), digits) + ", " + format_number(scale * worst, digits) +
           (name_worst ? " (" + where + ")" : "");
  }
};

/// A row's figures.
struct Summary {
  Figure coverage{.more_is_worse = false}, rmse, path, time, wall;
  Figure clearance{.more_is_worse = false};
  int missions = 0, complete = 0;
  std::int64_t collisions = 0;

  void add(const nlohmann::json& file) {
    const nlohmann::json& m = file["metrics"];
    const auto scene = file["settings"]["scene"].get<std::string>();
    ++missions;
    complete += m["complete"].get<bool>() ? 1 : 0;
    collisions += m["collisions"].get<std::int64_t>();
    coverage.add(m["surface_coverage"], scene);
    if (m["rmse_m"].is_number())
      rmse.add(m["rmse_m"].get<double>() / file["settings"]["voxel_m"].get<double>(), scene);
    path.add(m["total_path_length_m"], scene);
    time.add(m["completion_time_s"], scene);
    wall.add(m["wall_time_s"], scene);
    clearance.add(m["min_clearance_m"], scene);
  }
  static std::vector<std::string> columns(std::vector<std::string> first) {
    for (const char* name : {"missions", "complete", "coverage [%]", "RMSE / voxel", "path [m]",
                             "time [s]", "collisions", "clearance [m]", "machine [s]"})
      first.emplace_back(name);
    return first;
  }
  std::vector<std::string> row(std::vector<std::string> first, bool name_worst) const {
    for (std::string cell :
         {std::to_string(missions), std::to_string(complete), coverage.text(100.0, 1, name_worst),
          rmse.text(1.0, 3), path.text(1.0, 0), time.text(1.0, 0), std::to_string(collisions),
          clearance.text(1.0, 2), wall.text(1.0, 1)})
      first.push_back(std::move(cell));
    return first;
  }
};

void print(const Table& table) {
  std::printf("\n%s\n", table.caption.c_str());
  std::vector<std::size_t> width;
  for (const std::string& c : table.columns) width.push_back(c.size());
  for (const auto& row : table.rows)
    for (std::size_t k = 0; k < row.size(); ++k) width[k] = std::max(width[k], row[k].size());
  const auto line = [&](const std::vector<std::string>& row) {
    for (std::size_t k = 0; k < row.size(); ++k)
      std::printf("%s%-*s", k > 0 ? "  " : "", static_cast<int>(width[k]), row[k].c_str());
    std::printf("\n");
  };
  line(table.columns);
  for (const auto& row : table.rows) line(row);
}

/// Which of the scenes are for what.
std::string seed_uses(const std::vector<std::string>& scenes) {
  std::string text;
  for (const std::string_view use : {"development", "reported", "unassigned"}) {
    std::string list;
    for (const std::string& scene : scenes)
      if (is_random_scene(scene) && random_seed_use(parse_random_scene(scene).seed) == use)
        list += (list.empty() ? "" : ", ") + scene.substr(7);
    if (!list.empty()) text += (text.empty() ? "" : "\n") + std::string(use) + " seeds: " + list;
  }
  return text;
}

InspectionRun fly(const InspectionSettings& s, const InspectionSite& site, CoverageWatch& watch,
                  cli::ProgressLine& line) {
  return run_inspection(s, site, [&](const MissionProgress& p, const TsdfMap& map) {
    watch(p, map);
    char text[200];
    std::snprintf(text, sizeof text, "%s, %s, %d drones, seed %llu: %5.0f s  %7.1f m  %zu left",
                  site.scene.name.c_str(), s.planner.c_str(), s.robots,
                  static_cast<unsigned long long>(s.seed), p.time, p.path_length, p.incomplete);
    line(text);
    return !cli::interrupted();
  });
}
}  // namespace

std::vector<std::string> expand_scenes(const std::vector<std::string>& names) {
  std::vector<std::string> scenes;
  const auto add = [&](std::string name) {
    if (std::find(scenes.begin(), scenes.end(), name) == scenes.end())
      scenes.push_back(std::move(name));
  };
  for (const std::string& name : names) {
    if (is_random_scene(name))
      for (const RandomSceneId& id : parse_random_scenes(name)) add(id.name());
    else
      add(name);
  }
  return scenes;
}

int run_scene_trials(const SceneTrials& trials, InspectionOptions& options) {
  const std::vector<std::string> scenes = expand_scenes(trials.scenes);
  // Grouped by scene, as making one ready takes a while.
  std::vector<std::vector<Mission>> missions;
  for (const std::string& scene : scenes) {
    options.settings.scene = scene;
    InspectionSettings s = options.settle();
    if (!is_random_scene(scene)) open_scene(s);  // what is refused is refused now
    const std::uint64_t first = s.seed;
    missions.emplace_back();
    for (const std::string& planner : trials.planners)
      for (const int robots : trials.fleets)
        for (int k = 0; k < trials.trials; ++k) {
          s.planner = planner;
          s.robots = robots;
          s.seed = first + static_cast<std::uint64_t>(k);
          missions.back().push_back({s, file_name(s)});
        }
  }
  std::size_t all = 0, there = 0;
  for (const auto& group : missions)
    for (const Mission& m : group) {
      ++all;
      const auto file = read_mission(fs::path(trials.out) / m.file);
      if (!file) continue;
      require((*file)["settings"] == mission_settings(m.settings, trials),
              (fs::path(trials.out) / m.file).string() +
                  ": of a mission with other settings; expected the same ones or another --out");
      ++there;
    }
  const auto folder = cli::prepare_output_folder(trials.out);
  cli::watch_interrupts();
  const std::string uses = seed_uses(scenes);
  if (!uses.empty()) std::printf("%s\n", uses.c_str());
  std::printf("%zu missions, %zu of them flown before\n", all, there);
  std::fflush(stdout);

  cli::ProgressLine line;
  std::vector<std::string> failed;
  for (const auto& group : missions) {
    std::unique_ptr<InspectionSite> site;
    for (const Mission& m : group) {
      if (cli::interrupted()) break;
      if (read_mission(folder / m.file)) continue;
      try {
        if (!site) {
          site = std::make_unique<InspectionSite>(open_scene(m.settings), m.settings);
          site->find_reference(m.settings, site->starts(m.settings, 1).front().position);
        }
        CoverageWatch watch(*site, m.settings);
        const InspectionRun run = fly(m.settings, *site, watch, line);
        if (cli::interrupted()) break;  // half a mission is none
        nlohmann::json metrics = inspection_metrics(
            m.settings, *site, run, judge_inspection(m.settings, *site, run), watch.curve());
        // Of all missions of this process so far, so of none.
        metrics.erase("peak_memory_bytes");
        metrics.erase("mission_peak_memory_bytes");
        nlohmann::json file{{"settings", mission_settings(m.settings, trials)},
                            {"metrics", std::move(metrics)}};
        if (is_random_scene(m.settings.scene))
          file["seed_use"] = random_seed_use(parse_random_scene(m.settings.scene).seed);
        write_file(folder / m.file, file.dump(1) + "\n");
      } catch (const Error& e) {
        failed.push_back(m.file + ": " + e.what());
      }
    }
  }
  line.finish();

  std::size_t flown = 0;
  Table by_planner{.caption = "Over all scenes: mean, worst (scene)",
                   .columns = Summary::columns({"planner", "drones"})};
  Table by_scene{.caption = "Over planners, fleets and seeds: mean, worst",
                 .columns = Summary::columns({"scene", "seed is"})};
  Summary total;
  for (const std::string& planner : trials.planners)
    for (const int robots : trials.fleets) {
      Summary row;
      for (const auto& group : missions)
        for (const Mission& m : group)
          if (m.settings.planner == planner && m.settings.robots == robots)
            if (const auto file = read_mission(folder / m.file)) row.add(*file);
      if (row.missions > 0) by_planner.add_row(row.row({planner, std::to_string(robots)}, true));
    }
  for (std::size_t k = 0; k < missions.size(); ++k) {
    Summary row;
    for (const Mission& m : missions[k])
      if (const auto file = read_mission(folder / m.file)) {
        row.add(*file);
        total.add(*file);
        ++flown;
      }
    const std::string use = is_random_scene(scenes[k])
                                ? std::string(random_seed_use(parse_random_scene(scenes[k]).seed))
                                : "-";
    if (row.missions > 0) by_scene.add_row(row.row({scenes[k], use}, false));
  }
  print(by_scene);
  print(by_planner);
  for (const std::string& why : failed) std::printf("not flown: %s\n", why.c_str());
  if (flown < all) std::printf("%zu of %zu missions are missing\n", all - flown, all);
  Report report("Trials on " + std::to_string(scenes.size()) + " scenes", uses);
  report.add_table(by_planner);
  report.add_table(by_scene);
  report.write(folder / "report.html");
  const bool complete = flown == all && total.complete == total.missions;
  return complete ? cli::kDone : cli::kIncomplete;
}
}  // namespace surfleet::examples
