// SPDX-License-Identifier: MIT
#include <surfleet/coverage/surface_maps.hpp>

#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/fleet/impaired.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

struct Slope {
  SurfaceGraph graph = MeshGraph{}(bumpy_slope({.edge = 0.08}), EdgeGeodesic{}, MetricField{});
  std::vector<std::int32_t> sites;
  explicit Slope(std::uint64_t seed, std::size_t robots) {
    Random random(seed);
    while (sites.size() < robots)
      sites.push_back(static_cast<std::int32_t>(random.below(graph.size())));
  }
  SurfaceMaps sensed(double communication) const {
    SurfaceMaps maps(graph, sites.size(), 0.35, communication);
    for (std::size_t i = 0; i < sites.size(); ++i)
      maps.sense(graph, static_cast<std::int32_t>(i), sites[i]);
    return maps;
  }
};
}  // namespace

TEST(robots_that_share_a_site_in_range_are_one_team_with_one_map) {
  int teams = 0, alone = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Slope slope(seed, 9);
    const double range = 0.2 + 0.03 * static_cast<double>(seed);
    SurfaceMaps maps = slope.sensed(range);
    const SurfaceMaps before = maps;
    PerfectTransport<SurfaceMapReport> network(9);
    const bool changed = maps.exchange(slope.graph, slope.sites, network);
    // By brute force: pairs that may join by what they or their teams know, until none is left.
    DisjointSets sets(9);
    const auto team = [&](std::size_t i) { return sets.find(static_cast<std::int32_t>(i)); };
    std::vector<std::vector<std::uint8_t>> known;
    for (int i = 0; i < 9; ++i) known.push_back(before.known(i));
    for (bool fresh = true; fresh;) {
      fresh = false;
      for (std::size_t i = 0; i < 9; ++i)
        for (std::size_t j = 0; j < 9; ++j) {
          const auto place = [&](std::size_t r) {
            return slope.graph.position[static_cast<std::size_t>(slope.sites[r])];
          };
          bool shares = false;
          for (std::size_t v = 0; v < known[i].size(); ++v)
            shares |= known[i][v] != 0 && known[j][v] != 0;
          const bool mates = team(i) == team(j);
          if (!mates && (!shares || (place(i) - place(j)).norm() > range)) continue;
          fresh |= !mates;
          sets.unite(team(i), team(j));
          for (std::size_t v = 0; v < known[i].size(); ++v)
            if (const std::uint8_t both = known[i][v] | known[j][v]; both != known[i][v]) {
              known[i][v] = both;
              fresh = true;
            }
        }
    }
    for (std::size_t i = 0; i < 9; ++i) {
      CHECK(maps.known(static_cast<std::int32_t>(i)) == known[i]);
      for (std::size_t j = 0; j < 9; ++j)
        CHECK((maps.teams()[i] == maps.teams()[j]) == (team(i) == team(j)));
      CHECK(maps.teams()[i] <= static_cast<std::int32_t>(i));
      alone += maps.teams()[i] == static_cast<std::int32_t>(i) ? 1 : 0;
      teams += maps.teams()[i] != static_cast<std::int32_t>(i) ? 1 : 0;
    }
    CHECK(!maps.exchange(slope.graph, slope.sites, network));
    // A team does not split, however far its robots go.
    std::vector<std::int32_t> gone(9, -1);
    const auto named = maps.teams();
    maps.exchange(slope.graph, gone, network);
    CHECK(maps.teams() == named);
    CHECK(changed || named == before.teams());
  }
  CHECK(teams > 30 && alone > 30);
}

TEST(what_a_network_loses_is_told_again) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Slope slope(seed, 7);
    SurfaceMaps whole = slope.sensed(0.6), poor = slope.sensed(0.6);
    PerfectTransport<SurfaceMapReport> perfect(7);
    SimulatedNetwork<SurfaceMapReport> lossy(7, {.loss = 0.6, .seed = seed});
    whole.exchange(slope.graph, slope.sites, perfect);
    for (int round = 0; round < 30; ++round) {
      poor.exchange(slope.graph, slope.sites, lossy);
      for (std::size_t i = 0; i < 7; ++i) {  // names are those of robots that bear them
        const auto name = static_cast<std::size_t>(poor.teams()[i]);
        CHECK(poor.teams()[name] == poor.teams()[i]);
      }
    }
    CHECK(lossy.dropped(NetworkDrop::loss) > 100);
    CHECK(poor.teams() == whole.teams());
    for (int i = 0; i < 7; ++i) CHECK(poor.known(i) == whole.known(i));
  }
}
