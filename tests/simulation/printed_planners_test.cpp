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

}  // namespace
