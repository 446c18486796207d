// SPDX-License-Identifier: MIT
// requires: inspection
// What knowing nothing costs: the coverage tour of the known scene beside a mission's path.
//
//   clairvoyant_tour --scene powerplant --coverage 0.9 --coverage 0.95
//
// Prints one JSON object a line: the share that the plan was asked for, the coverage of what the
// images of the tour show, by the yardstick of missions, and the length.
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "support/cli.hpp"
#include "support/inspection.hpp"
#include "support/known_tour.hpp"

namespace {
using namespace surfleet;
using namespace surfleet::examples;

int run(int argc, char** argv) {
  cli::Options app(
      "The coverage tour of a known scene: a yardstick for planners that do not know it.");
  InspectionOptions options(app);
  std::vector<double> coverages{0.9, 0.95};
  CoverageTourOptions tour_options;
  double density = 2.0;
  app.add("--coverage", coverages, "shares to be seen, by the plan's lines of sight");
  app.add("--spacing", tour_options.spacing, "lattice of candidates [m]");
  app.add("--stop-cost", tour_options.stop_cost, "[m]");
  app.add("--density", density, "samples per square metre").positive();
  app.parse(argc, argv);
  InspectionSettings s = options.settle();
  require(!s.has_lidar(), "--sensor lidar: tours are of a camera; expected that");
  s.robots = 1;
  InspectionSite site(open_scene(s), s);
  const Configuration start = site.starts(s, 1).front();
  site.find_reference(s, start.position);
  KnownSitePlanner planner(s, site, start, density, 0.0);
  for (const double coverage : coverages) {
    CoverageTourOptions o = tour_options;
    o.coverage = coverage;
    const auto before = std::chrono::steady_clock::now();
    const CoverageTour tour = planner.plan(o);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    const FlownTour flown = fly_known_tour(tour, s, site, start, hold_for(s, s.farthest));
    const nlohmann::json line{{"scene", site.scene.name},
                              {"asked", coverage},
                              {"surface_coverage", flown.evaluation.metrics.surface_coverage},
                              {"length_m", tour.length},
                              {"time_s", flown.images.back().first},
                              {"viewpoints", tour.viewpoints.size()},
                              {"reachable_m2", tour.reachable_area},
                              {"seconds", seconds}};
    std::printf("%s\n", line.dump().c_str());
    std::fflush(stdout);
  }
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("clairvoyant_tour", [&] { return run(argc, argv); });
}
