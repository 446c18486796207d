// SPDX-License-Identifier: MIT
// requires: inspection
// Many inspections: planners, fleet sizes and seeds; mean and spread.
//
//   drone_inspection_trials --scene powerplant --planners surfleet,tsga,nnb --trials 10
//   drone_inspection_trials --scenes random:all:1000-1019 --planners surfleet --fleets 2 --trials 1
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/cli.hpp"
#include "support/inspection.hpp"
#include "support/inspection_report.hpp"
#include "support/scene_trials.hpp"

#include <surfleet/core/binary_io.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/statistics.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;

std::string spread(const std::vector<double>& values, double scale, int digits) {
  const Moments m = moments(values);
  return format_number(scale * m.mean(), digits) + " ± " +
         format_number(scale * m.sample_deviation(), digits);
}

/// Mean paths to the milestones of coverage, of the trials that reached them; how many did not.
std::string at_milestones(const std::array<std::vector<double>, kMilestones.size()>& paths,
                          std::size_t trials) {
  std::string text;
  for (const std::vector<double>& p : paths) {
    text += (text.empty() ? "" : ", ") +
            (p.empty() ? std::string("-") : format_number(moments(p).mean(), 0));
    if (!p.empty() && p.size() < trials)
      text += " (" + std::to_string(trials - p.size()) + " never)";
  }
  return text;
}

int run(int argc, char** argv) {
  cli::Options app(
      "Runs an inspection for every planner, fleet size and seed, and prints mean and "
      "standard deviation.\nWrites trials.json and report.html to --out. Missions that --max-time "
      "cuts short are counted and told of; one that Ctrl-C ends is in trials.json alone.\nWith "
      "--scenes it flies over many scenes, writes a JSON file a mission in place of trials.json, "
      "and "
      "goes on where an earlier run in the same folder ended.");
  InspectionOptions options(app, InspectionProgram::trials);
  std::string out = "out/trials";
  std::vector<std::string> planners{"surfleet", "tsga", "nnb"};
  std::vector<int> fleets{1, 3, 5};
  std::vector<std::string> scenes;
  int trials = 3;
  app.begin_group("Trials");
  app.add("--out", out, "folder for the results");
  app.add("--planners", planners, "comma-separated").separated_by(',');
  app.add("--fleets", fleets, "comma-separated numbers of drones").separated_by(',');
  app.add("--trials", trials, "seeds from --seed on");
  app.add("--scenes", scenes,
          "comma-separated, in place of --scene: random:KIND:FIRST-LAST, random:KIND:SEED, or what "
          "--scene takes")
      .separated_by(',');
  // Each of several scenes has parameters of its own.
  app.leave_out_of_config([&](const std::string&) { return !scenes.empty(); });
  app.add_examples(
      "  drone_inspection_trials --scene house --fleets 1,3 --trials 5\n"
      "  drone_inspection_trials --scenes random:all:1-20 --planners surfleet,tsga --fleets 1 "
      "--trials 1");
  app.parse(argc, argv);
  if (!scenes.empty()) {
    require(!app.was_given("--scene"), "--scenes: expected no --scene beside it");
    options.settings.scene = "powerplant";
  }
  InspectionSettings base = options.settle();
  require(trials >= 1 && trials <= 1000, "--trials: expected 1 to 1000");
  for (const int n : fleets) require(n >= 1 && n <= 64, "--fleets: expected numbers of 1 to 64");
  for (const std::string& p : planners) check_planner(p, base.gimbal, "--planners");
  if (!scenes.empty())
    return run_scene_trials({.scenes = scenes,
                             .planners = planners,
                             .fleets = fleets,
                             .trials = trials,
                             .out = out,
                             .given = app.given()},
                            options);
  InspectionSite site(open_scene(base), base);
  const int most = *std::max_element(fleets.begin(), fleets.end());
  const auto starts = site.starts(base, most);
  const auto folder = cli::prepare_output_folder(out);
  cli::watch_interrupts();
  cli::ProgressLine line;
  site.find_reference(base, starts.front().position);

  nlohmann::json all = nlohmann::json::array();
  Table table{.caption = "Mean ± standard deviation over " + std::to_string(trials) + " seeds",
              .columns = {"planner", "drones", "path to 90, 95, 98 % [m]", "path [m]", "time [s]",
                          "coverage [%]", "RMSE [cm]", "collisions", "least clearance [m]",
                          "planning [s]", "machine [s]", "complete"}};
  bool complete = true;
  for (const std::string& planner : planners)
    for (const int n : fleets) {
      std::vector<double> path, time, coverage, rmse, planning, wall;
      std::array<std::vector<double>, kMilestones.size()> milestones;
      int collisions = 0, completed = 0;
      double clearance = std::numeric_limits<double>::infinity();
      for (int k = 0; k < trials && !cli::interrupted(); ++k) {
        InspectionSettings s = base;
        s.planner = planner;
        s.robots = n;
        s.seed = base.seed + static_cast<std::uint64_t>(k);
        CoverageWatch watch(site, s);
        const InspectionRun one =
            run_inspection(s, site, [&](const MissionProgress& p, const TsdfMap& map) {
              watch(p, map);
              char text[160];
              std::snprintf(text, sizeof text,
                            "%s, %d drones, seed %llu: %5.0f s  %7.1f m  %zu left", planner.c_str(),
                            n, static_cast<unsigned long long>(s.seed), p.time, p.path_length,
                            p.incomplete);
              line(text);
              return !cli::interrupted();
            });
        const InspectionJudgement judged = judge_inspection(s, site, one);
        if (const std::string doubt = doubts(judged); !doubt.empty())
          std::fprintf(stderr, "drone_inspection_trials: %s\n", doubt.c_str());
        all.push_back(inspection_metrics(s, site, one, judged, watch.curve()));
        // Written after every trial, so that an interrupt loses nothing.
        write_file(folder / "trials.json", all.dump(2) + "\n");
        complete = complete && one.result.complete;
        if (cli::interrupted()) break;
        completed += one.result.complete ? 1 : 0;
        path.push_back(one.result.total_path_length());
        for (std::size_t i = 0; i < kMilestones.size(); ++i)
          if (const auto at = watch.curve().reached(kMilestones[i]))
            milestones[i].push_back(at->path);
        time.push_back(one.result.completion_time);
        coverage.push_back(judged.evaluation.metrics.surface_coverage);
        rmse.push_back(judged.evaluation.metrics.rmse_m);
        planning.push_back(one.result.planning_time);
        wall.push_back(one.wall_time);
        collisions += judged.paths.collisions;
        clearance = std::min(clearance, judged.paths.min_clearance_m);
      }
      if (path.empty()) continue;
      table.add_row({planner, std::to_string(n), at_milestones(milestones, path.size()),
                     spread(path, 1.0, 0), spread(time, 1.0, 0), spread(coverage, 100.0, 1),
                     spread(rmse, 100.0, 2), std::to_string(collisions),
                     format_number(clearance, 2), spread(planning, 1.0, 1), spread(wall, 1.0, 1),
                     std::to_string(completed) + " of " + std::to_string(path.size())});
    }
  line.finish();
  const auto print = [](const std::vector<std::string>& row) {
    for (const std::string& cell : row) std::printf("%-20s", cell.c_str());
    std::printf("\n");
  };
  print(table.columns);
  for (const auto& row : table.rows) print(row);
  Report report("Trials on " + site.scene.name, table.caption);
  report.add_table(table);
  report.write(folder / "report.html");
  return complete && !cli::interrupted() ? cli::kDone : cli::kIncomplete;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("drone_inspection_trials", [&] { return run(argc, argv); });
}
