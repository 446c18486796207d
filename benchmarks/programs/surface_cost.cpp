// SPDX-License-Identifier: MIT
// Final cost of the coordinators from random starts, above the best known, on the bumpy slope
// [004 §6.5.1]. Prints JSON.
//
//   surface_cost [--starts 20] [--edge 0.05] [--distance edges|faces] [--searches 8]
//                [--search-rounds 300] [--bound 600] [--perturbations 40] [--robots 5,10,20]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "support/stopwatch.hpp"

#include <surfleet/coverage/p_median_bound.hpp>
#include <surfleet/coverage/surface_coverage.hpp>
#include <surfleet/simulation/surfaces.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;

struct Outcome {
  std::vector<double> cost;
  double steps = 0.0, time = 0.0;
  bool monotone = true, connected = true, covering = true, converged = true;
};

template <typename Surface, typename Distance, typename Coordinator>
void deploy(const TriangleMesh& mesh, const SurfaceGraph& yardstick, std::size_t robots,
            std::uint64_t seed, Coordinator coordinator, Outcome& outcome) {
  const SurfaceGraph sites = Surface{}(mesh, EdgeGeodesic{});
  SurfaceCoverageOptions options;
  options.seed = seed;
  const auto begin = Clock::now();
  SurfaceCoverage<Surface, Distance, Coordinator> cover(
      mesh, random_robot_sites(sites, robots, seed), options, coordinator);
  double last = 0.0;
  bool whole = false;
  while (!cover.converged() && cover.steps() < 20000) {
    cover.step();
    const auto& region = cover.partition().region;
    const bool all = std::find(region.begin(), region.end(), -1) == region.end();
    if (whole && (!all || cover.cost() > last * (1.0 + 1e-12)))
      (all ? outcome.monotone : outcome.covering) = false;
    if (all) last = cover.cost();
    whole = all;
    outcome.connected = outcome.connected && cover.connected();
  }
  outcome.time += seconds_since(begin);
  outcome.steps += static_cast<double>(cover.steps());
  outcome.covering = outcome.covering && whole;
  outcome.converged = outcome.converged && cover.converged();
  std::vector<std::int32_t> at = cover.partition().generator;
  if constexpr (std::same_as<Surface, DualMeshGraph>)
    at = centroid_vertices(mesh, cover.graph(), cover.partition().region, robots);
  outcome.cost.push_back(surface_cost(yardstick, at));
}

struct Settings {
  int starts = 20, searches = 8, search_rounds = 300, bound = 600, perturbations = 40;
  double edge = 0.05;
  std::vector<std::size_t> robots{5, 10, 20};
};

template <typename Distance>
void run(const Settings& s, const char* distance) {
  const TriangleMesh mesh = bumpy_slope({.edge = s.edge});
  const SurfaceGraph graph = MeshGraph{}(mesh, Distance{});
  const PMedianProblem problem = p_median_problem(graph);
  std::printf("{\"vertices\": %zu, \"distance\": \"%s\", \"starts\": %d, \"groups\": [\n",
              graph.size(), distance, s.starts);
  for (std::size_t g = 0; g < s.robots.size(); ++g) {
    const std::size_t robots = s.robots[g];
    PMedianBound bound = bound_p_median(problem, robots, s.searches, s.search_rounds, 99, s.bound);
    Outcome wave, exchange, ours;
    for (int k = 1; k <= s.starts; ++k) {
      const auto seed = static_cast<std::uint64_t>(k);
      deploy<MeshGraph, Distance>(mesh, graph, robots, seed, WavefrontPropagation{}, wave);
      deploy<DualMeshGraph, Distance>(mesh, graph, robots, seed, VertexExchange{}, exchange);
      VertexSubstitution substitution;
      substitution.perturbations = s.perturbations;
      deploy<MeshGraph, Distance>(mesh, graph, robots, seed, substitution, ours);
    }
    for (const Outcome* o : {&wave, &exchange, &ours})
      for (const double c : o->cost) bound.best = std::min(bound.best, c);
    std::printf(" {\"robots\": %zu, \"best_known\": %.8f, \"lower_bound\": %.8f, \"gap\": %.4f",
                robots, bound.best, bound.lower, bound.best / bound.lower - 1.0);
    const auto print = [&](const char* name, const Outcome& o) {
      const double n = static_cast<double>(o.cost.size());
      const double mean = std::accumulate(o.cost.begin(), o.cost.end(), 0.0) / n;
      const auto [low, high] = std::minmax_element(o.cost.begin(), o.cost.end());
      std::printf(
          ",\n  \"%s\": {\"mean_above\": %.4f, \"min_above\": %.4f, \"max_above\": %.4f, "
          "\"mean_steps\": %.1f, \"mean_s\": %.3f, \"cost_never_rose\": %s, "
          "\"connected\": %s, \"covering\": %s, \"converged\": %s}",
          name, mean / bound.best - 1.0, *low / bound.best - 1.0, *high / bound.best - 1.0,
          o.steps / n, o.time / n, o.monotone ? "true" : "false", o.connected ? "true" : "false",
          o.covering ? "true" : "false", o.converged ? "true" : "false");
    };
    print("wavefront", wave);
    print("exchange", exchange);
    print("substitution", ours);
    std::printf("}%s\n", g + 1 < s.robots.size() ? "," : "");
    std::fflush(stdout);
  }
  std::printf("]}\n");
}
}  // namespace

int main(int argc, char** argv) {
  Settings s;
  bool faces = false;
  for (int k = 1; k + 1 < argc; k += 2) {
    const std::string option = argv[k], value = argv[k + 1];
    if (option == "--starts") s.starts = std::max(1, std::atoi(value.c_str()));
    if (option == "--edge") s.edge = std::atof(value.c_str());
    if (option == "--distance") faces = value == "faces";
    if (option == "--searches") s.searches = std::max(1, std::atoi(value.c_str()));
    if (option == "--search-rounds") s.search_rounds = std::max(0, std::atoi(value.c_str()));
    if (option == "--bound") s.bound = std::max(1, std::atoi(value.c_str()));
    if (option == "--perturbations") s.perturbations = std::max(0, std::atoi(value.c_str()));
    if (option == "--robots") {
      s.robots.clear();
      for (std::size_t at = 0; at < value.size();
           at = value.find(',', at) == std::string::npos ? value.size() : value.find(',', at) + 1)
        s.robots.push_back(static_cast<std::size_t>(std::max(1, std::atoi(&value[at]))));
    }
  }
  if (faces)
    run<FaceGeodesic>(s, "faces");
  else
    run<EdgeGeodesic>(s, "edges");
  return 0;
}
