// SPDX-License-Identifier: MIT
#include <surfleet/fleet/stall_watch.hpp>

#include <array>
#include <memory>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/fleet/central_planning.hpp>
#include <surfleet/planning/default_planner.hpp>
#include <surfleet/simulation/simulated_drone.hpp>

namespace {
using namespace surfleet;

TEST(a_body_stalls_that_neither_moves_nor_turns_though_it_should) {
  const auto stalls = [](auto&& at, bool in_place, double rests_at = -1.0) {
    StallWatch watch;
    int n = 0;
    for (double time = 0.0; time < 100.0; time += 0.25) {
      n += watch.moves(at(time), in_place, time) ? 1 : 0;
      if (time == rests_at) watch.rests();
    }
    return n;
  };
  const auto still = [](double) { return Configuration{}; };
  const auto creeping = [](double t) { return Configuration{Point3(0.01 * t, 0, 0), 0.0}; };
  const auto turning = [](double t) { return Configuration{Point3::Zero(), 0.02 * t}; };
  CHECK(stalls(still, false) == 4 && stalls(still, true) == 4);
  CHECK(stalls(creeping, false) == 0);
  // A robot that looks around on its way has to come farther all the same.
  CHECK(stalls(turning, true) == 0 && stalls(turning, false) == 4);
  CHECK(stalls(still, false, 19.0) < 4 + 1 && stalls(still, false, 95.0) == 4);
  StallWatch watch;
  for (int k = 1; k <= 3; ++k) {
    CHECK(!watch.stranded());
    for (int i = 0; i <= 80; ++i) watch.moves({}, false, 100.0 * k + 0.25 * i);
  }
  CHECK(watch.stranded());
  watch.arrives();
  CHECK(!watch.stranded());
}

/// A drone whose motors fail for good at a time of its own clock: it stands where it is.
struct FailingDrone : SimulatedDrone<box_world::World> {
  using SimulatedDrone::SimulatedDrone;
  double fails_at = 1e9, time = 0.0;

  bool failed() const { return time >= fails_at; }
  bool standing() const { return failed() || SimulatedDrone::standing(); }
  bool finished() const { return !failed() && SimulatedDrone::finished(); }
  void advance(double dt) {
    time += dt;
    if (!failed()) SimulatedDrone::advance(dt);
  }
};
static_assert(RobotBody<FailingDrone> && MeasuredBody<FailingDrone>);

struct Outcome {
  bool finished = false;
  double time = 0.0, share = 0.0;
  std::vector<std::optional<StopReason>> reasons;
};
Outcome fly(const std::vector<double>& fails_at) {
  box_world::World world;
  const MissionOptions o = box_world::options(world);
  std::vector<Configuration> fleet = box_world::starts(static_cast<int>(fails_at.size()));
  SurfaceBelief belief(o.belief, std::span<const RobotKind>(&o.kind, 1));
  std::vector<std::unique_ptr<FailingDrone>> bodies;
  std::vector<std::unique_ptr<Agent<FailingDrone>>> agents;
  for (std::size_t r = 0; r < fleet.size(); ++r) {
    belief.add_known_free(0, {fleet[r].position, o.start_clearance});
    bodies.push_back(std::make_unique<FailingDrone>(world, r, fleet, o.kind.limits, o.neighbours));
    bodies.back()->fails_at = fails_at[r];
  }
  belief.update();
  for (std::size_t r = 0; r < fleet.size(); ++r)
    agents.push_back(std::make_unique<Agent<FailingDrone>>(static_cast<RobotId>(r), 0, *bodies[r],
                                                           belief, o.agent));
  CentralPlanning<DefaultPlanner> planning(default_planner({.standoff = 2.0}));
  Outcome out;
  for (; out.time < 400.0 && !out.finished; out.time += o.agent.image_period) {
    for (auto& a : agents) a->sense();
    for (auto& a : agents) a->integrate();
    belief.update();
    for (auto& a : agents) a->check_stop();
    planning(agents, belief, out.time);
    out.finished = planning.finished(agents, belief);
    for (auto& a : agents)
      for (auto& b : agents)
        if (a != b) b->hear(a->announce(out.time));
    belief.goals();
    if (!out.finished)
      for (auto& a : agents) a->move(out.time);
  }
  out.share = belief.estimate_coverage().share();
  for (auto& a : agents) out.reasons.push_back(a->stop_reason());
  return out;
}
TEST(mates_do_the_work_of_a_robot_that_does_not_move) {
  const Outcome all = fly({1e9, 1e9});
  CHECK(all.finished && !all.reasons[0] && !all.reasons[1]);
  // Under way, or while it turns for its first views.
  for (const double time : {10.0, 1.0}) {
    const Outcome one = fly({1e9, time});
    CHECK(one.finished && one.share > all.share - 0.03);
    CHECK(!one.reasons[0] && one.reasons[1] == StopReason::stranded);
  }
}
}  // namespace
