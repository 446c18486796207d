// SPDX-License-Identifier: MIT
/// @file
/// @brief The published results that every report shows beside its own.
///
/// They were had on other machines, in other simulators and on other models of the same name and
/// size: path length, coverage and error compare, wall-clock does not.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/statistics.hpp>

namespace surfleet::examples {
/// One column of a published table; NaN where the table prints nothing.
struct PublishedRun {
  std::string_view environment;  ///< "powerplant", "statue", "arena" or "parking".
  int robots = 1;
  std::string_view planner;  ///< "single", "nnb", "tsga", "dist-tsga", "centralized", …
  bool noisy = true;         ///< With noise on the depth (real sensors included).
  double total_path_m = 0.0;
  double completion_time_s = 0.0;
  double surface_coverage = 0.0;  ///< Share in [0, 1].
  double m3c2_mean_m = 0.0, m3c2_std_m = 0.0, rmse_m = 0.0;
  double bytes_exchanged = std::numeric_limits<double>::quiet_NaN();
  std::string_view source;  ///< Seed file and table.
};

/// Drones: ten trials each. Ground robots: five [000 Tables 2.4, 3.2, 3.3, 4.2, 5.4].
inline std::span<const PublishedRun> published_runs() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  static constexpr std::array<PublishedRun, 23> kRuns{{
      {"powerplant", 1, "single", false, 780.0, 1920.0, 0.915, 0.0014, 0.0585, 0.0586, kNone,
       "000 Table 2.4"},
      {"powerplant", 1, "single", true, 785.0, 1990.0, 0.904, -0.0013, 0.0751, 0.0751, kNone,
       "000 Table 2.4"},
      {"powerplant", 3, "nnb", true, 1038.0, 669.0, 0.9, -0.0015, 0.0752, 0.0752, kNone,
       "000 Table 3.2"},
      {"powerplant", 3, "tsga", true, 790.0, 620.0, 0.91, -0.0026, 0.0754, 0.0755, kNone,
       "000 Table 3.2"},
      {"powerplant", 3, "dist-tsga", true, 781.0, 596.0, 0.959, 0.0062, 0.0333, 0.0339, kNone,
       "000 Table 4.2"},
      {"powerplant", 5, "nnb", true, 1113.0, 411.0, 0.905, -0.0011, 0.075, 0.075, kNone,
       "000 Table 3.2"},
      {"powerplant", 5, "tsga", true, 879.0, 382.0, 0.906, -0.003, 0.0752, 0.0752, kNone,
       "000 Table 3.2"},
      {"powerplant", 5, "dist-tsga", true, 872.0, 369.0, 0.956, -0.0073, 0.0343, 0.0351, kNone,
       "000 Table 4.2"},
      {"statue", 1, "single", false, 547.0, 2160.0, 0.923, 0.0029, 0.0341, 0.0343, kNone,
       "000 Table 2.4"},
      {"statue", 1, "single", true, 550.0, 2220.0, 0.912, -0.0002, 0.0367, 0.0367, kNone,
       "000 Table 2.4"},
      {"statue", 3, "nnb", true, 733.0, 790.0, 0.911, -0.008, 0.0361, 0.0369, kNone,
       "000 Table 3.3"},
      {"statue", 3, "tsga", true, 721.0, 618.0, 0.91, -0.0003, 0.0369, 0.0369, kNone,
       "000 Table 3.3"},
      {"statue", 5, "nnb", true, 580.0, 450.0, 0.909, 0.0006, 0.0365, 0.0365, kNone,
       "000 Table 3.3"},
      {"statue", 5, "tsga", true, 574.2, 405.0, 0.911, -0.0001, 0.0366, 0.0366, kNone,
       "000 Table 3.3"},
      {"arena", 1, "single", true, 20.6, 173.0, 0.856, 0.0027, 0.0399, 0.04, 0.75e9,
       "000 Table 5.4"},
      {"arena", 2, "centralized", true, 27.0, 165.0, 0.803, 0.004, 0.0416, 0.0418, 0.888e9,
       "000 Table 5.4"},
      {"arena", 2, "distributed", true, 24.2, 157.0, 0.91, 0.0012, 0.0333, 0.0333, 3.981e9,
       "000 Table 5.4"},
      {"parking", 1, "single", true, 106.0, 836.0, 0.891, 0.0001, 0.0837, 0.0837, 4.849e9,
       "000 Table 5.4"},
      {"parking", 2, "centralized", true, 113.6, 666.0, 0.811, -0.0048, 0.0829, 0.083, 6.029e9,
       "000 Table 5.4"},
      {"parking", 2, "distributed", true, 107.1, 641.0, 0.884, 0.0007, 0.0585, 0.0585, 24.11e9,
       "000 Table 5.4"},
      {"parking", 3, "centralized", true, 134.2, 614.0, 0.764, -0.0018, 0.0893, 0.0894, 10.72e9,
       "000 Table 5.4"},
      {"parking", 4, "centralized", true, 161.0, 576.0, 0.73, 0.0061, 0.0897, 0.0899, 13.27e9,
       "000 Table 5.4"},
      {"powerplant", 1, "other planner", true, 324.0, 2100.0, kNone, kNone, kNone, kNone, kNone,
       "000 Sect. 2.6.4"},
  }};
  return kRuns;
}

/// A published number that is not a mission of its own.
struct PublishedValue {
  std::string_view subject, quantity;
  double value = 0.0;
  std::string_view unit, source;
};
inline std::span<const PublishedValue> published_values() {
  static constexpr std::array<PublishedValue, 17> kValues{{
      {"exploration, 2 robots", "mission time against one robot", -25.0, "%", "002 Sect. 3.4.2"},
      {"exploration, 3 robots", "mission time against one robot", -30.0, "%", "002 Sect. 3.4.2"},
      {"exploration, 2 robots", "path per robot against one robot", -55.0, "%", "002 Sect. 3.4.2"},
      {"exploration, 3 robots", "path per robot against one robot", -62.0, "%", "002 Sect. 3.4.2"},
      {"exploration", "data exchanged against sending maps", 10.0, "%", "002 Sect. 3.4.2"},
      {"bumpy slope, wavefront, simulated", "cost above the bound", 18.8, "%", "004 Sect. 6.5"},
      {"bumpy slope, wavefront, robots", "cost above the bound", 12.8, "%", "004 Sect. 6.5"},
      {"bumpy slope, vertex exchange, simulated", "cost above the bound", 6.5, "%",
       "004 Sect. 6.5"},
      {"bumpy slope, vertex exchange, robots", "cost above the bound", 10.4, "%", "004 Sect. 6.5"},
      {"tensor voting, two laser scanners", "orientation error, at most", 2.5, "deg",
       "004 Sect. 8.4.1"},
      {"tensor voting", "voting scale", 6.0, "cm", "004 Sect. 8.4.1"},
      {"tensor voting, scanner 1", "noise", 2.8, "cm", "004 Sect. 8.4.1"},
      {"tensor voting, scanner 2", "noise", 1.8, "cm", "004 Sect. 8.4.1"},
      {"relative localisation, 0.7 to 1.7 m", "mean position error", 1.5, "cm", "004 Sect. 9.5"},
      {"relative localisation, 0.7 to 1.7 m", "mean orientation error", 1.2, "deg",
       "004 Sect. 9.5"},
      {"relative localisation, up to 3 m", "mean position error", 2.6, "cm", "004 Sect. 9.5"},
      {"relative localisation, up to 3 m", "mean orientation error", 1.0, "deg", "004 Sect. 9.5"},
  }};
  return kValues;
}

/// What a report sets beside the published runs.
struct OwnRun {
  std::string label;  ///< "this run", "mean of 10 seeds", …
  int robots = 1;
  std::string planner;
  double total_path_m = 0.0, completion_time_s = 0.0, surface_coverage = 0.0;
  double m3c2_mean_m = 0.0, m3c2_std_m = 0.0, rmse_m = 0.0;
};

/// The runs of `own` above all published runs of `environment` (of any name: none if unknown).
inline Table comparison_table(std::string_view environment, std::span<const OwnRun> own) {
  Table table;
  table.caption = "Beside the published figures for " + std::string(environment) +
                  " (other simulator and model; compare path, coverage and error, not time)";
  table.columns = {"source",       "robots",         "planner",       "path [m]", "time [min:s]",
                   "coverage [%]", "M3C2 mean [cm]", "M3C2 std [cm]", "RMSE [cm]"};
  const auto row = [&](std::string source, int robots, std::string planner, const auto& run) {
    table.add_row({std::move(source), std::to_string(robots), std::move(planner),
                   format_number(run.total_path_m, 1), format_minutes(run.completion_time_s),
                   format_number(100.0 * run.surface_coverage, 1),
                   format_number(100.0 * run.m3c2_mean_m, 2),
                   format_number(100.0 * run.m3c2_std_m, 2), format_number(100.0 * run.rmse_m, 2)});
  };
  for (const OwnRun& run : own) row(run.label, run.robots, run.planner, run);
  for (const PublishedRun& run : published_runs())
    if (run.environment == environment)
      row(std::string("[").append(run.source).append("]"), run.robots,
          std::string(run.planner) + (run.noisy ? "" : ", no noise"), run);
  return table;
}
}  // namespace surfleet::examples
