// SPDX-License-Identifier: MIT
/// @file
/// @brief Time to 95 % of the ground for the variants of hybrid coverage against random coverage,
/// as JSON. Arguments: number of seeds (default 3), then numbers of robots (default 4 6 8 10).
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include <surfleet/coverage/hybrid_flocking.hpp>
#include <surfleet/coverage/hybrid_voronoi.hpp>
#include <surfleet/coverage/random_coverage.hpp>
#include <surfleet/coverage/robotic_band.hpp>
#include <surfleet/simulation/planar_environments.hpp>

using namespace surfleet;

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 3;
  std::vector<std::size_t> teams;
  for (int k = 2; k < argc; ++k) teams.push_back(static_cast<std::size_t>(std::atoi(argv[k])));
  if (teams.empty()) teams = {4, 6, 8, 10};
  const HybridOptions options;
  std::printf("[");
  const char* separator = "\n";
  for (const char* scene : {"arena", "arena_triangle"})
    for (const std::size_t n : teams) {
      const PlanarEnvironment world = planar_environment(scene);
      const auto start = group_start(world.domain, world.start, n, 0.12);
      const auto time = [&](const std::vector<TimedPath>& paths, double& final_share) {
        const CoverageHistory h = replay(world.domain, paths, options);
        final_share = h.fraction.back();
        return h.time_to(0.95).value_or(-1.0);
      };
      double share1 = 0.0, share2 = 0.0, share3 = 0.0, share_spiral = 0.0, unused = 0.0;
      double random_mean = 0.0, flocking_mean = 0.0;
      for (int s = 0; s < seeds; ++s) {
        const Random random(static_cast<std::uint64_t>(s + 1));
        random_mean += time(random_coverage(world.domain, start, random, options), unused) / seeds;
      }
      flocking_mean = time(flocking_coverage(world.domain, start, options).paths, share1);
      const double band = time(robotic_band(world.domain, start, options).paths, share2);
      const double voronoi = time(hybrid_voronoi(world.domain, start, options).paths, share3);
      const double spiral =
          time(hybrid_voronoi(world.domain, start, options, {}, SpiralSweep{}).paths, share_spiral);
      std::printf(
          "%s {\"scene\": \"%s\", \"robots\": %zu, \"seeds\": %d, \"random_s\": %.0f,\n"
          "  \"variant1_s\": %.0f, \"variant2_s\": %.0f, \"variant3_s\": %.0f, "
          "\"variant3_spiral_s\": %.0f,\n"
          "  \"ratio2\": %.3f, \"ratio3\": %.3f, \"ratio3_spiral\": %.3f,\n"
          "  \"final_share\": [%.4f, %.4f, %.4f, %.4f]}",
          separator, scene, n, seeds, random_mean, flocking_mean, band, voronoi, spiral,
          band / random_mean, voronoi / random_mean, spiral / random_mean, share1, share2, share3,
          share_spiral);
      std::fflush(stdout);
      separator = ",\n";
    }
  std::printf("\n]\n");
  return 0;
}
