// SPDX-License-Identifier: MIT
// Short missions, bit by bit: whoever changes what robots do records the new hashes here, and says
// why in the same commit. Whoever only moves code changes none.
#include <surfleet/simulation/fly_mission.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <set>

#include <features.h>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/planning/named_planners.hpp>

namespace {
using namespace surfleet;

/// FNV-1a.
struct Hash {
  std::uint64_t value = 1469598103934665603U;
  void operator()(const void* data, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i)
      value = (value ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211U;
  }
  void operator()(double x) { (*this)(&x, sizeof x); }
};

std::uint64_t hash_of(const FlownMission& flown) {
  Hash hash;
  for (const auto& trajectory : flown.result.trajectories)
    for (const TimedConfiguration& t : trajectory) {
      hash(t.time);
      for (int k = 0; k < 3; ++k) hash(t.configuration.position[k]);
      hash(t.configuration.yaw);
    }
  flown.map.for_each_block([&](const TsdfMap::Block& block) {
    for (const TsdfVoxel& v : block.voxels) {
      hash(&v.distance, sizeof v.distance);
      hash(&v.weight, sizeof v.weight);
    }
  });
  return hash.value;
}

/// Whether this is the build and the machine that the hashes are of: rounding is the compiler's,
/// and sines are the C library's, which asks the processor.
bool is_reference_build() {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__FMA__) && \
    defined(__GLIBC__) && __GLIBC__ == 2 && __GLIBC_MINOR__ == 36
  return __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

TEST(short_missions_are_what_they_were) {
  if (!is_reference_build()) return;
  struct Recorded {
    const char* planner;
    int robots;
    std::uint64_t hash;
  };
  for (const Recorded& r :
       {Recorded{"surfleet", 1, 0x6da7c79a059e7b23U}, Recorded{"surfleet", 3, 0xaf2012b1b4040719U},
        Recorded{"tsga", 2, 0xc80f3f8613cf9ed5U}, Recorded{"nnb", 3, 0xe2f7edced587901eU}}) {
    box_world::World world;
    MissionOptions o = box_world::options(world);
    o.max_time = 40.0;
    const std::uint64_t hash =
        hash_of(fly_mission(o, world, box_world::starts(r.robots), make_planner(r.planner)));
    if (hash != r.hash)
      std::printf("%s, %d robots: 0x%016llxU\n", r.planner, r.robots,
                  static_cast<unsigned long long>(hash));
    CHECK(hash == r.hash);
  }
}

TEST(an_observer_sees_every_step_plan_and_changed_block) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.max_time = 20.0;
  std::size_t steps = 0, plans = 0, routes = 0;
  std::set<std::array<int, 3>> blocks;
  std::uint64_t seen = 0;
  Point3 last = Point3::Zero();
  MissionObserver observer;
  observer.on_step = [&](const MissionStep& step) {
    ++steps;
    CHECK(step.robots.size() == 2);
    last = step.robots[1].position;
    for (const std::uint32_t slot : step.belief.map().changed_since(seen)) {
      const BlockIndex& b = step.belief.map().block(slot).index;
      blocks.insert({b.x(), b.y(), b.z()});
    }
    seen = step.belief.map().revision();
  };
  observer.on_plan = [&](const SurfaceSituation& situation, const Plan& plan) {
    ++plans;
    CHECK(situation.team.size() == 2 && !situation.alone());
    routes += plan.routes.size();
  };
  const FlownMission flown =
      fly_mission(o, world, box_world::starts(2), make_planner("tsga"), {}, observer);
  CHECK(steps == 80 && plans == flown.result.plans && plans > 0 && routes >= plans);
  CHECK(last == flown.result.trajectories[1].back().configuration.position);
  std::size_t all = 0;
  flown.map.for_each_block([&](const TsdfMap::Block&) { ++all; });
  CHECK(blocks.size() == all);
  // Watching changes nothing.
  CHECK(hash_of(flown) ==
        hash_of(fly_mission(o, world, box_world::starts(2), make_planner("tsga"))));
}
}  // namespace
