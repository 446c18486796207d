// SPDX-License-Identifier: MIT
// `tsga` and `nnb` are [000 Alg. 1-4], line by line: docs/planner.md says which line is which.
#include <surfleet/planning/named_planners.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <surfleet/simulation/simulation.hpp>

#include "box_world.hpp"
#include "check.hpp"

namespace {
using namespace surfleet;

TEST(printed_planners_are_flown_on_voxels_of_the_whole_weight) {
  box_world::World world;
  const MissionOptions o = box_world::options(world);
  const auto share = [&](const char* name) {
    return Simulation<AnyPlanner, box_world::World>(o, world, box_world::starts(1),
                                                    make_planner(name))
        .belief()
        .options()
        .observed_share;
  };
  for (const NamedPlanner& p : kPlanners)
    CHECK(share(p.name.data()) == (p.as_printed ? 1.0 : o.belief.observed_share));
}

TEST(nnb_chooses_at_every_map_and_for_every_robot) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.max_time = 60.0;
  Simulation<AnyPlanner, box_world::World> mission(o, world, box_world::starts(2),
                                                   make_planner("nnb", {.standoff = 2.0}));
  std::uint64_t last = 0, planned = 0;
  std::size_t plans = 0, maps = 0, missed = 0, longest = 0;
  bool all = true;
  mission.observer.on_plan = [&](const SurfaceSituation& s, const Plan& plan) {
    ++plans;
    planned = s.belief.known().grid().revision();
    all = all && s.asked.size() == 2;
    for (const auto& [robot, route] : plan.routes) longest = std::max(longest, route.size());
  };
  mission.observer.on_step = [&](const MissionStep& step) {
    const std::uint64_t now = step.belief.known().grid().revision();
    if (plans > 0 && now != last) {
      ++maps;
      missed += planned == now ? 0 : 1;
    }
    last = now;
  };
  const MissionResult r = mission.run();
  CHECK(maps > 20 && missed == 0 && all && plans >= maps);
  CHECK(longest > 0 && r.total_path_length() > 3.0);
}
}  // namespace
