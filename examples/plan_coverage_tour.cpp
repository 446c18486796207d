// SPDX-License-Identifier: MIT
// requires: inspection
// A structure that is known, as from a CAD model: viewpoints and a tour that sees all of it.
//
//   plan_coverage_tour bridge.stl --out out/bridge
//   plan_coverage_tour tank.ply --voxel 0.1 --range 1 5 --standoff 3 --radius 0.4 --coverage 0.98
//   plan_coverage_tour --scene statue
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "support/cli.hpp"
#include "support/inspection.hpp"
#include "support/known_tour.hpp"
#include "support/tour_report.hpp"

namespace {
using namespace surfleet;
using namespace surfleet::examples;

int run(int argc, char** argv) {
  cli::Options app(
      "Plans from where a drone that knows a structure views it, and the tour by all of these "
      "places; flies it in simulation and tells what the images show.\n"
      "Writes viewpoints.csv, tour.json, tour.tum, reconstruction.ply, metrics.json and "
      "report.html "
      "to --out.\nExit status: 0 done, 2 input refused, 3 the images show less than --coverage.");
  std::string mesh, out = "out/plan_coverage_tour";
  CoverageTourOptions plan;
  std::optional<double> standoff, density, hold;
  app.add("MESH", mesh, "the structure (.ply .obj .stl .off) [m]; else --scene");
  InspectionOptions options(app, InspectionProgram::tour);
  app.begin_group("Tour");
  app.add("--coverage", plan.coverage, "share to be seen of what can be seen");
  app.add("--standoff", standoff, "depth up to which a view counts [m]; default all of --range");
  app.add("--spacing", plan.spacing, "between candidate places [m]").positive();
  app.add("--stop-cost", plan.stop_cost, "what a viewpoint costs beside its detour [m]").positive();
  app.add(
      "--hold", hold,
      "time spent at a viewpoint [s]; default as long as it takes to know surface at the farthest "
      "depth from there alone");
  app.add("--density", density, "samples a square metre; default 0.18 a square of a voxel");
  app.begin_group("Results");
  app.add("--out", out, "folder for the results");
  app.leave_out_of_config(
      [&](const std::string& name) { return name == "scene" && !mesh.empty(); });
  app.add_examples(
      "  plan_coverage_tour bridge.stl --out out/bridge\n"
      "  plan_coverage_tour tank.ply --voxel 0.1 --range 1 5 --standoff 3 --radius 0.4 --coverage "
      "0.98\n"
      "  plan_coverage_tour --scene statue");
  app.parse(argc, argv);
  if (!mesh.empty()) {
    require(!app.was_given("--scene"), "MESH and --scene: expected one of them");
    options.settings.scene = mesh;
  }
  InspectionSettings s = options.settle();
  s.robots = 1;
  require(plan.coverage > 0.0 && plan.coverage <= 1.0, "--coverage: expected a share in (0, 1]");
  if (standoff) {
    require(*standoff > s.nearest, "--standoff: expected more than the nearest depth of --range");
    plan.max_range = *standoff;
  }
  const double farthest = std::min(s.farthest, standoff.value_or(s.farthest));
  if (hold) require(*hold >= 0.0, "--hold: expected 0 or more seconds");
  if (density) require(*density > 0.0, "--density: expected a positive number");
  InspectionSite site(open_scene(s), s);
  const Configuration start = site.starts(s, 1).front();
  site.find_reference(s, start.position);
  const auto folder = cli::prepare_output_folder(out);

  constexpr double kSamplesPerVoxelFace = 0.18;
  KnownSitePlanner planner(s, site, start,
                           density.value_or(kSamplesPerVoxelFace / (s.voxel * s.voxel)), s.margin);
  // Lines of sight to what candidates can see promise other than images of what could be seen:
  // where these show too little, more is asked of the plan.
  CoverageTour tour;
  FlownTour flown;
  for (const double goal : {plan.coverage, 0.5 * (plan.coverage + 1.0), 1.0}) {
    CoverageTourOptions o = plan;
    o.coverage = goal;
    tour = planner.plan(o);
    flown = fly_known_tour(tour, s, site, start, hold.value_or(hold_for(s, farthest)));
    if (flown.evaluation.metrics.surface_coverage >= plan.coverage) break;
  }
  const std::vector<std::vector<Point3>> paths{tour.path};
  const JudgeReport path = judge_paths(site.judge, paths, s.radius);
  write_tour(folder, s, site, plan, tour, flown, path);

  const ReconstructionMetrics& m = flown.evaluation.metrics;
  const bool reached = m.surface_coverage >= plan.coverage;
  std::printf("%s: %zu viewpoints, %.1f m, %.0f s\n", site.scene.name.c_str(),
              tour.viewpoints.size(), tour.length, flown.images.back().first);
  std::printf("  coverage %.1f %% of what could be seen%s, RMSE %.2f cm, least clearance %.2f m\n",
              100.0 * m.surface_coverage, reached ? "" : ", less than asked for", 100.0 * m.rmse_m,
              path.min_clearance_m);
  std::printf("  see %s\n", (folder / "report.html").c_str());
  return reached ? cli::kDone : cli::kIncomplete;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("plan_coverage_tour", [&] { return run(argc, argv); });
}
