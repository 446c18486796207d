// SPDX-License-Identifier: MIT
// requires: inspection
// One drone or a fleet reconstructs a structure it does not know.
//
//   drone_inspection                                     three drones, the bundled power plant
//   drone_inspection --scene bridge.ply --robots 5 --out out/bridge
//   drone_inspection --scene statue --planner tsga --seed 7
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/cli.hpp"
#include "support/inspection.hpp"
#include "support/inspection_report.hpp"
#include "support/recorded_world.hpp"

namespace {
using namespace surfleet;
using namespace surfleet::examples;

struct Arguments {
  InspectionSettings settings;
  std::string out = "out/drone_inspection";
  bool quiet = false;
};

Arguments arguments(int argc, char** argv) {
  cli::Options app(
      "One drone or a fleet reconstructs a structure it does not know.\n"
      "Writes metrics.json, reconstruction.ply, points.ply, trajectory_K.tum, map.sfm and "
      "report.html "
      "to --out.\nExit status: 0 complete, or ended as it was asked to; 2 input refused; 3 ended "
      "early, as by --max-time.");
  Arguments a;
  InspectionOptions options(app);
  app.begin_group("Results");
  app.add("--save-images", options.settings.save_images,
          "folder for the depth images and their poses, as fuse_depth reads them");
  app.add("--out", a.out, "folder for the results");
  app.add_flag("--quiet", a.quiet, "no progress line");
  app.add_examples(
      "  drone_inspection --robots 3 --out out/plant          the bundled power plant\n"
      "  drone_inspection --scene bridge.ply --preset statue  your own mesh, finer voxels\n"
      "  drone_inspection --scene random:hall:7 --robots 2    a generated scene\n"
      "  drone_inspection --scene statue --planner tsga       a published planner\n"
      "  drone_inspection --print-config > my.toml            then --config my.toml");
  app.parse(argc, argv);
  a.settings = options.settle();
  check_recording(a.settings);
  return a;
}

int run(int argc, char** argv) {
  const Arguments a = arguments(argc, argv);
  const InspectionSettings& s = a.settings;
  InspectionSite site(open_scene(s), s);
  // Whatever can be refused is refused before the first file is made.
  const InspectionInputs inputs = read_inputs(s);
  site.find_reference(s, site.starts(s, s.robots).front().position);
  const auto out = cli::prepare_output_folder(a.out);
  if (!s.save_images.empty()) cli::prepare_output_folder(s.save_images);
  cli::watch_interrupts();
  cli::ProgressLine line(!a.quiet);

  CoverageWatch watch(site, s);
  const InspectionRun run = run_inspection(
      s, site,
      [&](const MissionProgress& p, const TsdfMap& map) {
        watch(p, map);
        char text[160];
        std::snprintf(
            text, sizeof text,
            "%5.0f s  %7.1f m  %5.1f %% covered by its own account (%.1f %% in truth)  %5zu "
            "incomplete elements",
            p.time, p.path_length, 100.0 * p.estimated_coverage, 100.0 * watch.curve().last(),
            p.incomplete);
        line(text);
        return !cli::interrupted();
      },
      inputs);
  line.finish();
  // The reconstruction comes first, so that it is there whatever happens to the rest.
  write_inspection(out, run);
  const InspectionJudgement judged = judge_inspection(s, site, run);
  write_judgement(out, s, site, run, judged, watch.curve(), nlohmann::json::object());

  const ReconstructionMetrics& m = judged.evaluation.metrics;
  std::printf("%s: %s, %d drone%s, planner %s\n",
              run.result.complete   ? "complete"
              : run.result.enough() ? "enough"
                                    : "ended early",
              site.scene.name.c_str(), s.robots, s.robots == 1 ? "" : "s", s.planner.c_str());
  std::printf("  path %.1f m, time %.0f s, planning %.1f s, machine %.1f s\n",
              run.result.total_path_length(), run.result.completion_time, run.result.planning_time,
              run.wall_time);
  if (!run.result.complete && run.result.enough())
    std::printf("  %.1f m at work; about %.1f m^2 of surface known to be there were left\n",
                run.result.total_path_at_work(), run.result.left_area);
  if (const auto& left = run.result.left_out)
    std::printf("  going on would have gained %.1f m^2 in %.1f m, by its own estimate\n",
                left->gain, left->distance);
  std::printf("  coverage %.1f %%, RMSE %.2f cm, M3C2 %.2f +- %.2f cm\n",
              100.0 * m.surface_coverage, 100.0 * m.rmse_m, 100.0 * m.m3c2_mean_m,
              100.0 * m.m3c2_std_m);
  std::printf("  by its own account %.1f %% of what it met", 100.0 * run.result.coverage.share());
  if (judged.points)
    std::printf("; points: coverage %.1f %%, RMSE %.2f cm", 100.0 * judged.points->surface_coverage,
                100.0 * judged.points->rmse_m);
  std::printf("\n  collisions %d, least clearance %.2f m, %zu incomplete elements left\n",
              judged.paths.collisions, judged.paths.min_clearance_m, run.result.remaining);
  if (run.distributed) {
    std::uint64_t bytes = 0;
    for (const std::uint64_t b : run.distributed->bytes_sent) bytes += b;
    std::printf("  %.2f MB sent, maps %s, %zu robots lost\n", 1e-6 * static_cast<double>(bytes),
                run.distributed->maps_equal ? "equal" : "not equal", run.distributed->lost.size());
  }
  if (judged.keep_out_violations > 0)
    std::printf("  keep-out boxes entered %d times\n", judged.keep_out_violations);
  if (const std::string doubt = doubts(judged); !doubt.empty())
    std::fprintf(stderr, "drone_inspection: %s\n", doubt.c_str());
  std::printf("  see %s\n", (out / "report.html").c_str());
  return run.result.enough() ? cli::kDone : cli::kIncomplete;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("drone_inspection", [&] { return run(argc, argv); });
}
