// SPDX-License-Identifier: MIT
/// @file
/// @brief How far LinKernighan ends from the best tour known, by time, minimising and maximising.
///
/// usage: tour_quality [--times 0.1,1] [--reference S] [--seeds K] [--set medium|large]
///        [FILE.atsp[=OPTIMUM] ...]
///
/// Without files, on generated instances. The best known is the given optimum, the tour that meets
/// the assignment bound, or the best of all runs, a reference run of S seconds among them. JSON.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/allocation/tsplib.hpp>

#include "../allocation/tour_instances.hpp"

int main(int argc, char** argv) {
  using namespace surfleet;
  std::vector<double> times = {0.1};
  double reference_s = 0.5;
  int seeds = 1;
  std::string set = "medium";
  struct Instance {
    std::string name;
    CostMatrix costs;
    double optimum;  // NaN: not known
  };
  std::vector<Instance> instances;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string arg = argv[i];
      if (arg.starts_with("--")) {
        require(i + 1 < argc, arg + ": expected a value");
        const std::string value = argv[++i];
        if (arg == "--times") {
          times.clear();
          std::stringstream list(value);
          for (std::string t; std::getline(list, t, ',');) times.push_back(std::atof(t.c_str()));
        } else if (arg == "--reference") {
          reference_s = std::atof(value.c_str());
        } else if (arg == "--seeds") {
          seeds = std::atoi(value.c_str());
        } else if (arg == "--set") {
          set = value;
        } else {
          throw Error(arg + ": unknown; expected --times, --reference, --seeds or --set");
        }
      } else {
        const std::size_t equals = arg.rfind('=');
        TsplibInstance file = read_tsplib(arg.substr(0, equals));
        instances.push_back(
            {file.name, std::move(file.costs),
             equals == std::string::npos ? kUnknown : std::atof(arg.c_str() + equals + 1)});
      }
    }
    if (instances.empty())
      for (auto& [name, costs] :
           set == "large" ? tour_instances::large() : tour_instances::medium())
        instances.push_back({name, std::move(costs), kUnknown});

    std::vector<double> sum(2 * times.size(), 0.0), worst(2 * times.size(), 0.0);
    std::printf("{\"instances\": [");
    for (std::size_t k = 0; k < instances.size(); ++k) {
      for (const bool maximize : {false, true}) {
        TourProblem problem;
        problem.costs = instances[k].costs;
        problem.maximize = maximize;
        LinKernighan solve;
        solve.search.max_iterations = std::numeric_limits<std::int64_t>::max();
        const auto solved = [&](double seconds, std::uint64_t seed) {
          solve.search.time_limit_s = seconds;
          solve.search.seed = seed;
          return solve(problem);
        };
        const Tour reference = solved(reference_s, 1000);
        double best =
            maximize || std::isnan(instances[k].optimum) ? reference.length : instances[k].optimum;
        std::vector<std::vector<double>> lengths(times.size());
        for (std::size_t t = 0; t < times.size(); ++t) {
          for (int s = 1; s <= seeds; ++s) {
            lengths[t].push_back(solved(times[t], static_cast<std::uint64_t>(s)).length);
            best = maximize ? std::max(best, lengths[t].back()) : std::min(best, lengths[t].back());
          }
        }
        std::printf(
            "%s\n  {\"name\": \"%s\", \"nodes\": %d, \"maximize\": %s, \"best\": %.10g, "
            "\"bound\": %.10g, \"gap_percent\": [",
            k == 0 && !maximize ? "" : ",", instances[k].name.c_str(), problem.costs.size(),
            maximize ? "true" : "false", best, reference.bound);
        for (std::size_t t = 0; t < times.size(); ++t) {
          double gap = 0.0;
          for (const double length : lengths[t])
            gap += 100.0 * std::abs(length - best) / std::max(std::abs(best), 1e-300) / seeds;
          sum[2 * t + (maximize ? 1 : 0)] += gap;
          worst[2 * t + (maximize ? 1 : 0)] = std::max(worst[2 * t + (maximize ? 1 : 0)], gap);
          std::printf("%s%.4f", t == 0 ? "" : ", ", gap);
        }
        std::printf("]}");
        std::fflush(stdout);
      }
    }
    std::printf("\n],\n\"summary\": [");
    for (std::size_t t = 0; t < times.size(); ++t) {
      const double n = static_cast<double>(instances.size());
      std::printf(
          "%s\n  {\"time_s\": %g, \"mean_gap_percent_minimising\": %.4f, "
          "\"worst_minimising\": %.4f, \"mean_gap_percent_maximising\": %.4f, "
          "\"worst_maximising\": %.4f}",
          t == 0 ? "" : ",", times[t], sum[2 * t] / n, worst[2 * t], sum[2 * t + 1] / n,
          worst[2 * t + 1]);
    }
    std::printf("\n]}\n");
    return 0;
  } catch (const Error& e) {
    std::fprintf(stderr, "tour_quality: %s\n", e.what());
    return 2;
  }
}
